use std::num::NonZeroUsize;

use bundles::ndarray::{Array1, Array2, Axis, array, concatenate};
use bundles::{
    EmOptions, Kappa, LabelRule, Letter, MixtureError, MixtureFit, PoseClusters, fit_mixture,
    fit_mixture_from,
};
use proptest::prelude::*;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use crate::naive_em::{self, Mixture};

/// Of the frames' scale and of weights. Expanded squares lose up to eight digits where a cluster is
/// as tight as the floor allows.
const EM_TOL: f64 = 1e-6;

/// Of the greatest exponent: a few roundings of sums of a few terms.
const LABEL_TOL: f64 = 1e-12;

fn options(kappa: usize) -> EmOptions {
    EmOptions::new(Kappa::Letters(NonZeroUsize::new(kappa).unwrap()))
}

fn array_of(frames: &[Vec<f64>]) -> Array2<f64> {
    let dims = frames.first().map_or(0, Vec::len);
    Array2::from_shape_vec((frames.len(), dims), frames.concat()).unwrap()
}

/// Few frames, many of them equal or equally far apart, of one to four dimensions.
fn frames() -> impl Strategy<Value = Vec<Vec<f64>>> {
    (1_usize..5).prop_flat_map(|dims| {
        let number = prop_oneof![(-2..3_i32).prop_map(f64::from), -10.0..10.0_f64];
        prop::collection::vec(prop::collection::vec(number, dims), 1..40)
    })
}

/// Frames and a mixture to start from.
fn started() -> impl Strategy<Value = (Vec<Vec<f64>>, Mixture)> {
    frames().prop_flat_map(|frames| {
        let letter = (0..frames.len(), 0.3..4.0_f64, 0.1..1.0_f64);
        prop::collection::vec(letter, 1..6).prop_map(move |letters| {
            let total: f64 = letters.iter().map(|(_, _, weight)| weight).sum();
            let frames = naive_em::centred(&frames);
            let start = Mixture {
                weights: letters
                    .iter()
                    .map(|(_, _, weight)| weight / total)
                    .collect(),
                means: letters
                    .iter()
                    .map(|(frame, ..)| frames[*frame].clone())
                    .collect(),
                variances: letters.iter().map(|(_, sigma, _)| sigma * sigma).collect(),
            };
            (frames, start)
        })
    })
}

fn clusters_of(mixture: &Mixture) -> PoseClusters {
    let sigmas: Array1<f64> = mixture.variances.iter().map(|v| v.sqrt()).collect();
    let clusters = PoseClusters::new(array_of(&mixture.means).view(), sigmas.view()).unwrap();
    clusters
        .with_weights(Array1::from(mixture.weights.clone()).view())
        .unwrap()
}

#[track_caller]
fn assert_equal(fit: &MixtureFit, expected: &(Mixture, Vec<f64>), frames: &[Vec<f64>]) {
    let (mixture, log_likelihoods) = expected;
    let variance = naive_em::mean_variance(&naive_em::centred(frames));
    let mean = naive_em::mean_of(frames);
    assert_eq!(fit.clusters.n_letters(), mixture.weights.len());
    assert_eq!(fit.log_likelihoods.len(), log_likelihoods.len());
    for (found, expected) in fit.log_likelihoods.iter().zip(log_likelihoods) {
        let tolerance = EM_TOL * (frames.len() as f64 + expected.abs());
        assert!(
            (found - expected).abs() <= tolerance,
            "{found} is not {expected}"
        );
    }
    for letter in 0..mixture.weights.len() {
        let weight = fit.clusters.weights()[letter];
        assert!((weight - mixture.weights[letter]).abs() <= EM_TOL);
        let found = fit.clusters.sigmas()[letter].powi(2);
        let tolerance = EM_TOL * (variance + f64::MIN_POSITIVE);
        assert!((found - mixture.variances[letter]).abs() <= tolerance);
        for (dim, x) in mixture.means[letter].iter().enumerate() {
            let found = fit.clusters.means()[[letter, dim]] - mean[dim];
            assert!(
                (found - x).abs() <= EM_TOL * variance.sqrt(),
                "{found} is not {x}"
            );
        }
    }
}

proptest! {
    #[test]
    fn iterations_equal_the_textbook((frames, start) in started(), iterations in 0_usize..5) {
        let options = EmOptions { max_iterations: iterations, tolerance: 0.0, ..options(1) };
        let fit = fit_mixture_from(array_of(&frames).view(), &clusters_of(&start), &options);
        let fit = fit.unwrap();
        if fit.reseeded.is_empty() {
            assert_equal(&fit, &naive_em::iterate(&frames, &start, iterations), &frames);
        }
    }

    #[test]
    fn fits_from_a_seed_equal_the_textbook(
        frames in frames(),
        kappa in 1_usize..9,
        seed in 0_u64..4,
        iterations in 0_usize..4,
    ) {
        let options = EmOptions { seed, max_iterations: iterations, tolerance: 0.0, ..options(kappa) };
        let fit = fit_mixture(array_of(&frames).view(), &options).unwrap();
        if fit.reseeded.is_empty() {
            let centred = naive_em::centred(&frames);
            let start = naive_em::seed(&centred, kappa, seed);
            assert_equal(&fit, &naive_em::iterate(&centred, &start, iterations), &frames);
        }
    }

    #[test]
    fn likelihood_never_falls_and_weights_sum_to_one(frames in frames(), kappa in 1_usize..9) {
        let fit = fit_mixture(array_of(&frames).view(), &options(kappa)).unwrap();
        prop_assert!((fit.clusters.weights().sum() - 1.0).abs() <= f64::EPSILON * 16.0);
        for (i, pair) in fit.log_likelihoods.windows(2).enumerate() {
            let tolerance = EM_TOL * (frames.len() as f64 + pair[0].abs());
            prop_assert!(pair[1] >= pair[0] - tolerance || fit.reseeded.contains(&i));
        }
        prop_assert!(fit.log_likelihoods.len() <= 100);
        prop_assert!(fit.has_converged || fit.log_likelihoods.len() == 100);
    }

    #[test]
    fn labels_equal_the_definition((frames, mixture) in started()) {
        let clusters = clusters_of(&mixture);
        for rule in [LabelRule::Likelihood, LabelRule::Posterior] {
            let labels = clusters.label(array_of(&frames).view(), rule).unwrap();
            for (x, label) in frames.iter().zip(labels) {
                let mut exponents = naive_em::log_joint(x, &mixture);
                if rule == LabelRule::Likelihood {
                    let both = exponents.iter_mut().zip(&mixture.weights);
                    both.for_each(|(exponent, weight)| *exponent -= weight.ln());
                }
                let label = label as usize;
                for (other, exponent) in exponents.iter().enumerate() {
                    let tolerance = LABEL_TOL * (1.0 + exponent.abs());
                    prop_assert!(*exponent <= exponents[label] + tolerance);
                    // Equal clusters are exactly equally likely.
                    let is_twin = mixture.means[other] == mixture.means[label]
                        && mixture.variances[other] == mixture.variances[label]
                        && (rule == LabelRule::Likelihood
                            || mixture.weights[other] == mixture.weights[label]);
                    prop_assert!(!is_twin || other >= label);
                }
            }
        }
    }

    #[test]
    fn distance_matrices_hold_the_distances((_, mixture) in started()) {
        let clusters = clusters_of(&mixture);
        for ((a, b), distance) in clusters.distances().indexed_iter() {
            let letter = |row: usize| Letter::from_label(row as u32);
            prop_assert_eq!(clusters.distance(letter(a), letter(b)), Some(*distance));
        }
    }
}

/// `n_frames` about each of `centres`, normal with deviation `sigma`, one centre after the other.
fn blobs(centres: &[[f64; 3]], n_frames: usize, sigma: f64) -> Array2<f64> {
    let mut dice = ChaCha8Rng::seed_from_u64(7);
    let mut uniform = || (f64::from(dice.next_u32()) + 0.5) / 2.0_f64.powi(32);
    let mut normal = || {
        let radius = (-2.0 * uniform().ln()).sqrt();
        sigma * radius * (std::f64::consts::TAU * uniform()).cos()
    };
    let shape = (centres.len() * n_frames, 3);
    Array2::from_shape_fn(shape, |(frame, dim)| {
        centres[frame / n_frames][dim] + normal()
    })
}

const CENTRES: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [9.0, 0.0, 3.0], [0.0, 9.0, -3.0]];

#[test]
fn threads_and_repetition_change_nothing() {
    // Enough frames for several chunks, and for threads in the seeding.
    let frames = blobs(&CENTRES, 60_000, 2.0);
    let options = EmOptions {
        max_iterations: 3,
        ..options(20)
    };
    let work = || {
        let fit = fit_mixture(frames.view(), &options).unwrap();
        let labels = fit
            .clusters
            .label(frames.view(), LabelRule::Posterior)
            .unwrap();
        (fit, labels)
    };
    let on = |n_threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(n_threads)
            .build()
            .unwrap();
        pool.install(work)
    };
    let one = on(1);
    assert_eq!(one, on(4));
    assert_eq!(one, work());
    let other = EmOptions { seed: 1, ..options };
    assert_ne!(one.0, fit_mixture(frames.view(), &other).unwrap());
}

#[test]
fn the_criterion_finds_blobs_far_apart() {
    for n_centres in 1..=3 {
        let frames = blobs(&CENTRES[..n_centres], 400, 0.5);
        let fit = fit_mixture(frames.view(), &EmOptions::new(Kappa::Auto)).unwrap();
        assert_eq!(fit.clusters.n_letters(), n_centres, "{:?}", fit.candidates);
        let least = fit
            .candidates
            .iter()
            .min_by(|a, b| a.bic.total_cmp(&b.bic))
            .unwrap();
        assert_eq!(least.n_letters, n_centres);
        let labels = fit
            .clusters
            .label(frames.view(), LabelRule::default())
            .unwrap();
        assert_eq!(labels.chunk_by(|a, b| a == b).count(), n_centres);
        // Four standard errors of a mean of 400 normal numbers, and of a deviation of 1,200.
        for (letter, mean) in fit.clusters.means().outer_iter().enumerate() {
            let is_near = |centre: &&[f64; 3]| {
                mean.iter()
                    .zip(*centre)
                    .all(|(x, c)| (x - c).abs() < 4.0 * 0.5 / 20.0)
            };
            assert_eq!(CENTRES.iter().filter(is_near).count(), 1);
            assert!((fit.clusters.sigmas()[letter] - 0.5).abs() < 4.0 * 0.5 / 2400_f64.sqrt());
        }
    }
}

#[test]
fn there_are_no_more_letters_than_distinct_frames() {
    let frames = array![[1.0, 2.0], [3.0, 4.0], [1.0, 2.0], [3.0, 4.0], [3.0, 4.0]];
    let fit = fit_mixture(frames.view(), &options(9)).unwrap();
    assert_eq!(fit.clusters.n_letters(), 2);
    let labels = fit
        .clusters
        .label(frames.view(), LabelRule::Likelihood)
        .unwrap();
    let first = labels[0];
    assert_eq!(labels, [first, 1 - first, first, 1 - first, 1 - first]);
    // Two of five frames are 1.2 from the mean and three 0.8: a variance of 0.96, and the floor.
    assert!((fit.clusters.sigmas()[0] - 0.96e-6_f64.sqrt()).abs() < EM_TOL * 1e-3);
}

#[test]
fn frames_that_do_not_differ_are_one_letter() {
    let alone = array![[0.1, 1e9, -3.0]];
    let equal = concatenate![Axis(0), alone, alone, alone];
    let no_dims = Array2::zeros((4, 0));
    for frames in [alone.clone(), equal, no_dims] {
        for kappa in [Kappa::Auto, options(5).kappa] {
            let fit = fit_mixture(frames.view(), &EmOptions::new(kappa)).unwrap();
            assert_eq!(fit.clusters.n_letters(), 1);
            assert_eq!(fit.clusters.means().row(0), frames.row(0));
            assert_eq!(fit.clusters.weights(), array![1.0]);
            let labels = fit.clusters.label(frames.view(), LabelRule::Posterior);
            assert_eq!(labels.unwrap(), vec![0; frames.nrows()]);
        }
    }
}

#[test]
fn an_empty_cluster_goes_where_frames_are_explained_worst() {
    let frames = array![[0.0], [0.1], [0.2], [5.0], [0.3], [0.1]];
    let start = PoseClusters::new(array![[0.1], [1e5]].view(), array![1.0, 1.0].view()).unwrap();
    let fit = |max_iterations| {
        let options = EmOptions {
            max_iterations,
            ..options(1)
        };
        fit_mixture_from(frames.view(), &start, &options).unwrap()
    };
    let once = fit(1);
    assert_eq!(once.reseeded, [0]);
    assert!((once.clusters.means()[[1, 0]] - 5.0).abs() < EM_TOL);
    let fit = fit(100);
    assert_eq!(fit.reseeded, [0]);
    let labels = fit
        .clusters
        .label(frames.view(), LabelRule::Likelihood)
        .unwrap();
    assert_eq!(labels, [0, 0, 0, 1, 0, 0]);
    // Means beyond all squares take no part either, and nothing becomes no number.
    let start = PoseClusters::new(array![[1e200], [-1e300]].view(), array![1.0, 1e-300].view());
    let fit = fit_mixture_from(frames.view(), &start.unwrap(), &options(1)).unwrap();
    assert_eq!(fit.reseeded[0], 0);
    assert!(fit.log_likelihoods.last().unwrap().is_finite());
}

#[test]
fn mixtures_survive_storage_and_no_others_do() {
    let frames = blobs(&CENTRES, 50, 1.0);
    let clusters = fit_mixture(frames.view(), &options(6)).unwrap().clusters;
    let bytes = postcard::to_stdvec(&clusters).unwrap();
    assert_eq!(
        postcard::from_bytes::<PoseClusters>(&bytes).unwrap(),
        clusters
    );
    let stored = |sigma: f64, weights: &[f64]| {
        let parts = (array![[0.0]], array![sigma], Array1::from(weights.to_vec()));
        postcard::from_bytes::<PoseClusters>(&postcard::to_stdvec(&parts).unwrap())
    };
    assert!(stored(1.0, &[1.0]).is_ok());
    for (sigma, weights) in [
        (-1.0, &[1.0][..]),
        (1.0, &[]),
        (1.0, &[f64::NAN]),
        (1.0, &[0.0]),
    ] {
        assert!(stored(sigma, weights).is_err());
    }
}

#[track_caller]
fn check<T: std::fmt::Debug>(result: Result<T, MixtureError>, message: &str) {
    assert_eq!(result.unwrap_err().to_string(), message);
}

#[test]
fn each_error_says_what_was_expected_and_found() {
    let fit = |frames: Array2<f64>| fit_mixture(frames.view(), &options(2));
    check(
        fit(Array2::zeros((0, 3))),
        "expected at least one frame, found none",
    );
    check(
        fit(array![[0.0, 1.0], [2.0, f64::NAN]]),
        "frame 1, dimension 1: expected a finite number, found NaN",
    );
    check(
        fit(array![[0.0], [1e200]]),
        "frame 0: expected a distance from the mean whose square can be summed",
    );
    let clusters = PoseClusters::new(array![[0.0, 0.0]].view(), array![1.0].view()).unwrap();
    check(
        clusters.label(array![[0.0]].view(), LabelRule::Likelihood),
        "expected frames of 2 dimensions, found 1",
    );
    check(
        fit_mixture_from(array![[0.0, f64::INFINITY]].view(), &clusters, &options(1)),
        "frame 0, dimension 1: expected a finite number, found inf",
    );
    let none = PoseClusters::new(Array2::zeros((0, 1)).view(), array![].view()).unwrap();
    check(
        none.label(array![[0.0]].view(), LabelRule::Likelihood),
        "expected at least one letter, found none",
    );
    let weights = |weights: Array1<f64>| {
        clusters
            .clone()
            .with_weights(weights.view())
            .map_err(MixtureError::from)
    };
    check(
        weights(array![1.0, 2.0]),
        "expected a weight for each of 1 letters, found 2",
    );
    check(
        weights(array![-1.0]),
        "letter 0: expected a finite weight of at least 0, found -1",
    );
    check(
        weights(array![0.0]),
        "expected weights with a positive finite sum, found 0",
    );
}
