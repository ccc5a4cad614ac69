//! An iteration of EM on random walks, against one that is written as it is read.
#![allow(missing_docs)]

use std::hint::black_box;
use std::num::NonZeroUsize;

use bundles::{EmOptions, Kappa, LabelRule, PoseClusters, fit_mixture, fit_mixture_from};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use ndarray::{Array1, Array2, ArrayView1, Axis};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// As many as the paper keeps components at most.
const DIMS: usize = 12;
/// Frames and clusters.
const SIZES: [(usize, usize); 3] = [(900, 30), (2700, 90), (7300, 250)];
/// Of log-likelihoods, relative.
const ROUNDING: f64 = 1e-9;

/// A random walk with mean 0 and deviation 1 in each dimension.
fn walk(n_frames: usize) -> Array2<f64> {
    let mut dice = ChaCha8Rng::seed_from_u64(1);
    let mut walk = Array2::from_shape_simple_fn((n_frames, DIMS), || {
        f64::from(dice.next_u32()) / f64::from(u32::MAX) - 0.5
    });
    walk.accumulate_axis_inplace(Axis(0), |before, step| *step += before);
    for mut one in walk.columns_mut() {
        let (mean, deviation) = (one.mean().unwrap_or(0.0), one.std(0.0));
        one.mapv_inplace(|x| (x - mean) / deviation);
    }
    walk
}

fn options(kappa: usize, max_iterations: usize) -> EmOptions {
    EmOptions {
        max_iterations,
        tolerance: 0.0,
        ..EmOptions::new(Kappa::Letters(
            NonZeroUsize::new(kappa).unwrap_or(NonZeroUsize::MIN),
        ))
    }
}

fn squared_distance(a: ArrayView1<'_, f64>, b: ArrayView1<'_, f64>) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

/// New means and variances, and the log-likelihood before.
fn naive(frames: &Array2<f64>, old: &PoseClusters) -> (Array2<f64>, Array1<f64>, f64) {
    let kappa = old.n_letters();
    let mut means = Array2::<f64>::zeros((kappa, DIMS));
    let (mut amounts, mut variances) = (Array1::<f64>::zeros(kappa), Array1::<f64>::zeros(kappa));
    let mut log_likelihood = 0.0;
    for x in frames.rows() {
        let exponent = |k: usize| {
            let variance = old.sigmas()[k].powi(2);
            let square = squared_distance(x, old.means().row(k));
            let scale = DIMS as f64 / 2.0 * (std::f64::consts::TAU * variance).ln();
            old.weights()[k].ln() - scale - square / (2.0 * variance)
        };
        let exponents: Array1<f64> = (0..kappa).map(exponent).collect();
        let largest = exponents.fold(f64::NEG_INFINITY, |a, b| a.max(*b));
        let shares = exponents.mapv(|exponent| (exponent - largest).exp());
        let total = shares.sum();
        log_likelihood += largest + total.ln();
        for (k, share) in shares.iter().enumerate() {
            let share = share / total;
            amounts[k] += share;
            means.row_mut(k).scaled_add(share, &x);
            variances[k] += share * x.dot(&x) / DIMS as f64;
        }
    }
    for (k, mut mean) in means.outer_iter_mut().enumerate() {
        mean /= amounts[k];
        variances[k] = variances[k] / amounts[k] - mean.dot(&mean) / DIMS as f64;
    }
    (means, variances, log_likelihood)
}

fn em(c: &mut Criterion) {
    let mut group = c.benchmark_group("em_iteration");
    for (n_frames, kappa) in SIZES {
        let frames = walk(n_frames);
        let start = fit_mixture(frames.view(), &options(kappa, 1)).expect("finite frames");
        let start = start.clusters;
        let once = || fit_mixture_from(frames.view(), &start, &options(kappa, 1));
        let (_, _, expected) = naive(&frames, &start);
        let found = once().expect("finite frames").log_likelihoods[0];
        assert!((found - expected).abs() <= ROUNDING * expected.abs());
        group.throughput(Throughput::Elements((n_frames * kappa) as u64));
        let size = format!("{n_frames}x{kappa}");
        group.bench_function(BenchmarkId::new("motif", &size), |b| {
            b.iter(|| black_box(once()));
        });
        group.bench_function(BenchmarkId::new("naive", &size), |b| {
            b.iter(|| black_box(naive(&frames, &start)));
        });
    }
    group.finish();
}

fn seeding_and_labels(c: &mut Criterion) {
    let mut group = c.benchmark_group("seeding_and_labels");
    for (n_frames, kappa) in SIZES {
        let frames = walk(n_frames);
        let size = format!("{n_frames}x{kappa}");
        group.throughput(Throughput::Elements((n_frames * kappa) as u64));
        let seed = || fit_mixture(frames.view(), &options(kappa, 0));
        group.bench_function(BenchmarkId::new("seeding", &size), |b| {
            b.iter(|| black_box(seed()));
        });
        let clusters = seed().expect("finite frames").clusters;
        let label = || clusters.label(frames.view(), LabelRule::Likelihood);
        group.bench_function(BenchmarkId::new("labels", &size), |b| {
            b.iter(|| black_box(label()));
        });
        let naive = || -> Vec<Option<usize>> {
            let density = |x: ArrayView1<'_, f64>, k: usize| {
                let sigma = clusters.sigmas()[k];
                let square = squared_distance(x, clusters.means().row(k));
                -(DIMS as f64) * sigma.ln() - square / (2.0 * sigma * sigma)
            };
            let likeliest = |x: ArrayView1<'_, f64>| {
                let by_density = |a: &usize, b: &usize| density(x, *a).total_cmp(&density(x, *b));
                (0..kappa).max_by(by_density)
            };
            frames.rows().into_iter().map(likeliest).collect()
        };
        group.bench_function(BenchmarkId::new("naive labels", &size), |b| {
            b.iter(|| black_box(naive()));
        });
    }
    group.finish();
}

criterion_group!(benches, em, seeding_and_labels);
criterion_main!(benches);
