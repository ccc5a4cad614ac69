//! Letters at even distances in time.

use std::num::NonZeroUsize;

use bundles::ndarray::{Array2, Axis, array};
use bundles::{LabelRule, MixtureError, PoseClusters, exemplars};
use proptest::prelude::*;

/// Of a mean of squares: roundings of sums of a few dozen terms.
const TOLERANCE: f64 = 1e-12;

fn of(frames: &Array2<f64>, n_letters: usize) -> Result<PoseClusters, MixtureError> {
    exemplars(frames.view(), NonZeroUsize::new(n_letters).unwrap())
}

/// Few frames, many of them equal or equally far apart, of no to four dimensions.
fn frames() -> impl Strategy<Value = Array2<f64>> {
    (1_usize..40, 0_usize..5).prop_flat_map(|(n_frames, dims)| {
        let number = prop_oneof![(-2..3_i32).prop_map(f64::from), -10.0..10.0_f64];
        prop::collection::vec(number, n_frames * dims)
            .prop_map(move |numbers| Array2::from_shape_vec((n_frames, dims), numbers).unwrap())
    })
}

fn square(frames: &Array2<f64>, a: usize, b: usize) -> f64 {
    let both = frames.row(a).into_iter().zip(frames.row(b));
    both.map(|(x, y)| (x - y).powi(2)).sum()
}

proptest! {
    #[test]
    fn letters_are_the_middles_and_clusters_what_is_nearest(
        frames in frames(),
        n_letters in 1_usize..50,
    ) {
        let clusters = of(&frames, n_letters).unwrap();
        let n_frames = frames.nrows();
        let n_letters = n_letters.min(n_frames);
        // The frame in which the middle of a stretch is, counting half frames.
        let is_middle = |i: usize, frame: &usize| {
            let middle = (2 * i + 1) * n_frames;
            (2 * n_letters * frame..2 * n_letters * (frame + 1)).contains(&middle)
        };
        let chosen: Vec<usize> = (0..n_letters)
            .map(|i| (0..n_frames).find(|frame| is_middle(i, frame)).unwrap())
            .collect();
        let letters = frames.select(Axis(0), &chosen);
        prop_assert_eq!(clusters.means(), letters.view());

        let (mut counts, mut sum) = (vec![0.0; n_letters], 0.0);
        let labels = clusters.label(frames.view(), LabelRule::Likelihood).unwrap();
        for (frame, label) in labels.iter().enumerate() {
            let squares = chosen.iter().map(|letter| square(&frames, frame, *letter));
            let nearest = squares.enumerate().reduce(|a, b| if b.1 < a.1 { b } else { a });
            let (nearest, least) = nearest.unwrap();
            prop_assert_eq!(*label as usize, nearest);
            counts[nearest] += 1.0 / n_frames as f64;
            sum += least;
        }
        for (weight, count) in clusters.weights().iter().zip(counts) {
            prop_assert!((weight - count).abs() <= TOLERANCE);
        }
        let variance = sum / (n_frames * frames.ncols().max(1)) as f64;
        let mean = frames.mean_axis(Axis(0)).unwrap();
        let spread: f64 = (&frames - &mean).mapv(|x| x * x).sum();
        let floor = 1e-6 * spread / frames.len().max(1) as f64;
        for sigma in clusters.sigmas() {
            prop_assert!((sigma.powi(2) - variance.max(floor)).abs() <= TOLERANCE * (1.0 + variance));
        }
    }

    /// Distances are those of the poses, in one unit, so that a multiple of all changes none.
    #[test]
    fn the_unit_of_poses_changes_nothing(frames in frames(), n_letters in 1_usize..50) {
        let doubled = frames.mapv(|x| 2.0 * x);
        let (one, two) = (of(&frames, n_letters).unwrap(), of(&doubled, n_letters).unwrap());
        let labels = |clusters: &PoseClusters, frames: &Array2<f64>| {
            clusters.label(frames.view(), LabelRule::Likelihood).unwrap()
        };
        prop_assert_eq!(labels(&one, &frames), labels(&two, &doubled));
        // Where no pose differs from its letter, the least deviation there is has a unit.
        if frames.iter().any(|x| *x != frames[[0, 0]]) {
            prop_assert_eq!(one.distances(), two.distances());
        }
    }
}

#[test]
fn poses_that_do_not_differ_are_one_cluster() {
    let frames = array![[3.0, -1.0], [3.0, -1.0], [3.0, -1.0]];
    let clusters = of(&frames, 2).unwrap();
    assert_eq!(clusters.weights(), array![1.0, 0.0]);
    assert_eq!(clusters.distances(), Array2::<f64>::zeros((2, 2)));
}

#[test]
fn what_is_no_pose_is_refused() {
    assert_eq!(of(&Array2::zeros((0, 3)), 2), Err(MixtureError::NoFrames));
    let refused = of(&array![[0.0], [f64::NAN]], 2);
    assert!(matches!(
        refused,
        Err(MixtureError::NotFinite {
            frame: 1,
            dim: 0,
            ..
        })
    ));
    let refused = of(&array![[0.0], [1e200]], 2);
    assert!(matches!(refused, Err(MixtureError::Magnitude { .. })));
}
