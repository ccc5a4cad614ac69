//! Time warping of random walks in f32 and f64, against the textbook's table.
#![allow(missing_docs)]

use std::hint::black_box;

use criterion::measurement::WallTime;
use criterion::{
    BenchmarkGroup, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main,
};
use dtw::{Band, BandRadius, Dtw, LocalCost, Sample, Search};
use ndarray::{Array2, ArrayView2, Axis, s};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// As many as an AMC file has channels.
const DIMS: usize = 62;
const LENGTHS: [usize; 3] = [250, 500, 1000];
/// Of single precision, relative, for sums of a few thousand local costs.
const ROUNDING: f64 = 1e-4;

/// A random walk with mean 0 and deviation 1 in each dimension, rounded to `f32`.
fn walk(n_frames: usize, dims: usize, seed: u64) -> Array2<f64> {
    let mut dice = ChaCha8Rng::seed_from_u64(seed);
    let mut walk = Array2::from_shape_simple_fn((n_frames, dims), || {
        f64::from(dice.next_u32()) / f64::from(u32::MAX) - 0.5
    });
    walk.accumulate_axis_inplace(Axis(0), |before, step| *step += before);
    for mut one in walk.columns_mut() {
        let (mean, deviation) = (one.mean().unwrap_or(0.0), one.std(0.0));
        one.mapv_inplace(|x| f64::from(((x - mean) / deviation) as f32));
    }
    walk
}

/// D(i,j) = C(i,j) + min(D(i-1,j-1), D(i,j-1), D(i-1,j)) in a whole table; infinite outside the band.
fn textbook(dtw: &Dtw, cost: LocalCost, a: &Array2<f64>, b: &Array2<f64>) -> f64 {
    let shape = (a.nrows(), b.nrows());
    let mut table = Array2::from_elem((shape.0 + 1, shape.1 + 1), f64::INFINITY);
    table[[0, 0]] = 0.0;
    for i in 0..shape.0 {
        for j in dtw.band().columns(i, shape) {
            let squares = a.row(i).into_iter().zip(b.row(j));
            let squares: f64 = squares.map(|(x, y)| (x - y) * (x - y)).sum();
            let local = match cost {
                LocalCost::SquaredEuclidean => squares,
                _ => squares.sqrt(),
            };
            let best = table[[i, j]].min(table[[i + 1, j]]).min(table[[i, j + 1]]);
            table[[i + 1, j + 1]] = local + best;
        }
    }
    table[[shape.0, shape.1]]
}

fn distance_of<T: Sample>(dtw: &Dtw, a: ArrayView2<'_, T>, b: ArrayView2<'_, T>) -> f64 {
    dtw.distance(a, b).ok().flatten().expect("there is a path")
}

fn assert_close(found: f64, expected: f64) {
    assert!(
        (found - expected).abs() <= ROUNDING * expected,
        "{found} is not {expected}"
    );
}

/// Distances of two walks: ours in both precisions and the textbook's.
fn distances(
    group: &mut BenchmarkGroup<'_, WallTime>,
    dims: usize,
    cost: LocalCost,
    band: impl Fn(usize) -> Band,
) {
    for n in LENGTHS {
        let (a, b) = (walk(n, dims, 1), walk(n, dims, 2));
        let (a32, b32) = (a.mapv(|x| x as f32), b.mapv(|x| x as f32));
        let dtw = Dtw::new(band(n)).with_local_cost(cost);
        let expected = textbook(&dtw, cost, &a, &b);
        assert_close(distance_of(&dtw, a.view(), b.view()), expected);
        assert_close(distance_of(&dtw, a32.view(), b32.view()), expected);
        group.throughput(Throughput::Elements(dtw.band().cells(n, n)));
        group.bench_function(BenchmarkId::new("f32", n), |bench| {
            bench.iter(|| dtw.distance(black_box(a32.view()), b32.view()));
        });
        group.bench_function(BenchmarkId::new("f64", n), |bench| {
            bench.iter(|| dtw.distance(black_box(a.view()), b.view()));
        });
        group.bench_function(BenchmarkId::new("naive", n), |bench| {
            bench.iter(|| textbook(&dtw, cost, black_box(&a), &b));
        });
    }
}

/// A tenth of the length to either side.
fn tenth(n: usize) -> Band {
    BandRadius::cells(n / 10).into()
}

fn pairs(c: &mut Criterion) {
    let (euclidean, squared) = (LocalCost::Euclidean, LocalCost::SquaredEuclidean);
    let mut group = c.benchmark_group("dtw multi");
    distances(&mut group, DIMS, euclidean, |_| Band::Full);
    group.finish();
    let mut group = c.benchmark_group("dtw band");
    distances(&mut group, DIMS, euclidean, tenth);
    group.finish();
    let mut group = c.benchmark_group("dtw univariate");
    distances(&mut group, 1, squared, tenth);
    group.finish();
}

fn paths(c: &mut Criterion) {
    let mut group = c.benchmark_group("dtw path");
    for n in LENGTHS {
        let (a, b) = (walk(n, DIMS, 1), walk(n, DIMS, 2));
        let (a32, b32) = (a.mapv(|x| x as f32), b.mapv(|x| x as f32));
        let dtw = Dtw::default();
        group.throughput(Throughput::Elements(dtw.band().cells(n, n)));
        group.bench_function(BenchmarkId::new("f32", n), |bench| {
            bench.iter(|| dtw.align(black_box(a32.view()), b32.view()));
        });
        group.bench_function(BenchmarkId::new("f64", n), |bench| {
            bench.iter(|| dtw.align(black_box(a.view()), b.view()));
        });
        group.bench_function(BenchmarkId::new("naive, cost only", n), |bench| {
            bench.iter(|| textbook(&dtw, LocalCost::Euclidean, black_box(&a), &b));
        });
    }
    group.finish();
}

/// Half of the distance matrix of series of 200 samples.
fn pairwise(c: &mut Criterion) {
    const LENGTH: usize = 200;
    let cost = LocalCost::SquaredEuclidean;
    for (name, band) in [("full", Band::Full), ("band", tenth(LENGTH))] {
        let dtw = Dtw::new(band).with_local_cost(cost);
        let mut group = c.benchmark_group(format!("dtw pairwise, {name}"));
        for n_series in [8, 16, 32] {
            let all = (0..n_series).map(|seed| walk(LENGTH, 1, seed));
            let all: Vec<Array2<f64>> = all.collect();
            let all32: Vec<Array2<f32>> = all.iter().map(|s| s.mapv(|x| x as f32)).collect();
            let views: Vec<ArrayView2<'_, f64>> = all.iter().map(|s| s.view()).collect();
            let views32: Vec<ArrayView2<'_, f32>> = all32.iter().map(|s| s.view()).collect();
            let n_pairs = n_series * (n_series - 1) / 2;
            let cells = dtw.band().cells(LENGTH, LENGTH);
            group.throughput(Throughput::Elements(n_pairs * cells));
            group.bench_function(BenchmarkId::new("f32", n_series), |bench| {
                bench.iter(|| dtw.distance_matrix(black_box(&views32)));
            });
            group.bench_function(BenchmarkId::new("f64", n_series), |bench| {
                bench.iter(|| dtw.distance_matrix(black_box(&views)));
            });
            group.bench_function(BenchmarkId::new("naive", n_series), |bench| {
                bench.iter(|| matrix(black_box(&all), |a, b| textbook(&dtw, cost, a, b)));
            });
        }
        group.finish();
    }
}

/// The distances below the diagonal.
fn matrix<S>(all: &[S], distance: impl Fn(&S, &S) -> f64) -> Vec<f64> {
    let pairs = (0..all.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
    pairs.map(|(i, j)| distance(&all[i], &all[j])).collect()
}

/// The window nearest to a query of 128 samples, a noisy copy of which lies in the series; all are
/// z-normalised.
fn windows(c: &mut Criterion) {
    const QUERY: usize = 128;
    let cost = LocalCost::SquaredEuclidean;
    let radius = BandRadius::cells(6);
    let search = Search::new(radius).with_local_cost(cost).z_normalised();
    let dtw = Dtw::new(radius);
    let mut group = c.benchmark_group("dtw windows");
    for n_frames in [2_000, 20_000, 200_000] {
        let query = walk(QUERY, 1, 1);
        let mut series = walk(n_frames, 1, 2);
        let place = n_frames / 2;
        let noise = walk(QUERY, 1, 3).mapv(|x| 0.05 * x);
        let copy = &query + &noise;
        series
            .slice_mut(s![place..place + QUERY, ..])
            .assign(&copy.mapv(|x| 3.0 * x + 1.0));
        let (query32, series32) = (query.mapv(|x| x as f32), series.mapv(|x| x as f32));
        let best = search.best_windows(query.view(), series.view(), 1, QUERY);
        let starts: Vec<usize> = best.iter().flatten().map(|window| window.start).collect();
        assert_eq!(starts, [place]);
        group.throughput(Throughput::Elements(n_frames as u64));
        group.bench_function(BenchmarkId::new("f32", n_frames), |bench| {
            let series = black_box(series32.view());
            bench.iter(|| search.best_windows(query32.view(), series, 1, QUERY));
        });
        group.bench_function(BenchmarkId::new("f64", n_frames), |bench| {
            let series = black_box(series.view());
            bench.iter(|| search.best_windows(query.view(), series, 1, QUERY));
        });
        if n_frames > 2_000 {
            continue;
        }
        let query = z_normalised(&query.view());
        let naive = || {
            let windows = series.axis_windows(Axis(0), QUERY).into_iter();
            let distances =
                windows.map(|window| textbook(&dtw, cost, &query, &z_normalised(&window)));
            distances.fold(f64::INFINITY, f64::min)
        };
        let found = best.iter().flatten().map(|window| window.cost);
        found.for_each(|cost| assert_close(cost, naive()));
        group.bench_function(BenchmarkId::new("naive", n_frames), |bench| {
            bench.iter(naive)
        });
    }
    group.finish();
}

fn z_normalised(frames: &ArrayView2<'_, f64>) -> Array2<f64> {
    let (mean, deviation) = (frames.mean().unwrap_or(0.0), frames.std(0.0));
    frames.mapv(|x| (x - mean) / deviation)
}

criterion_group!(benches, pairs, paths, pairwise, windows);
criterion_main!(benches);
