//! Poses without the noise of single frames.

use std::ops::Range;

use ndarray::{Array2, ArrayView2, Axis, s};

/// Beyond so many standard deviations a frame has no weight.
const REACH: f64 = 4.0;

/// Each frame as a mean of those about it, their weights normal with a standard deviation of `sigma`
/// frames up to four of these away; where the clip ends before, those that are there. At 0 nothing changes.
/// Noise that is new at each frame becomes less by a factor of about √(2 √π sigma).
///
/// Takes O(frames · dims · sigma) time.
#[must_use]
pub fn smoothed(vectors: ArrayView2<'_, f64>, sigma: f64) -> Array2<f64> {
    let n_frames = vectors.nrows();
    let reach = ((REACH * sigma) as usize).min(n_frames);
    let weight = |distance: usize| (-0.5 * (distance as f64 / sigma).powi(2)).exp();
    // Frames next to each other may be no number of deviations apart, but a frame is not away from itself.
    let weights: Vec<f64> = std::iter::once(1.0)
        .chain((1..=reach).map(weight))
        .collect();
    let mut means = Array2::zeros(vectors.raw_dim());
    for (frame, mut mean) in means.axis_iter_mut(Axis(0)).enumerate() {
        let mut total = 0.0;
        for near in frame.saturating_sub(reach)..(frame + reach + 1).min(n_frames) {
            let weight = weights[near.abs_diff(frame)];
            total += weight;
            mean.scaled_add(weight, &vectors.row(near));
        }
        mean /= total;
    }
    means
}

/// Each clip, a range of the rows of `vectors`, [`smoothed`] for itself; other rows as they are.
#[must_use]
pub fn smoothed_clips(
    vectors: ArrayView2<'_, f64>,
    clips: &[Range<usize>],
    sigma: f64,
) -> Array2<f64> {
    let mut means = vectors.to_owned();
    for clip in clips {
        let of_clip = s![clip.clone(), ..];
        let smooth = smoothed(vectors.slice(of_clip), sigma);
        means.slice_mut(of_clip).assign(&smooth);
    }
    means
}

#[cfg(test)]
mod tests {
    use ndarray::{Array1, array};

    use super::*;

    /// Of sums of a few hundred weights.
    const TOLERANCE: f64 = 1e-12;

    #[test]
    fn what_does_not_bend_stays_as_it_is() {
        let frames = Array2::from_shape_fn((200, 2), |(i, j)| [5.0, i as f64][j]);
        assert_eq!(smoothed(frames.view(), 0.0), frames);
        let smooth = smoothed(frames.view(), 6.0);
        for (frame, row) in smooth.outer_iter().enumerate() {
            assert!((row[0] - 5.0).abs() < TOLERANCE);
            // The ends are pulled to the inside.
            if (24..176).contains(&frame) {
                assert!((row[1] - frame as f64).abs() < 200.0 * TOLERANCE);
            }
        }
        assert!(smooth[[0, 1]] > 1.0 && smooth[[199, 1]] < 198.0);
        assert_eq!(smoothed(Array2::zeros((0, 3)).view(), 2.0).dim(), (0, 3));
        // A clip shorter than the reach: all of its frames count.
        let pair = smoothed(array![[0.0], [1.0]].view(), 1e9);
        assert!(pair.iter().all(|x| (x - 0.5).abs() < TOLERANCE));
    }

    #[test]
    fn clips_know_nothing_of_each_other() {
        let vectors = array![[0.0], [2.0], [100.0], [104.0], [7.0]];
        let smooth = smoothed_clips(vectors.view(), &[0..2, 2..2, 2..4], 1e9);
        // What is in no clip stays.
        for (found, expected) in smooth.iter().zip([1.0, 1.0, 102.0, 102.0, 7.0]) {
            assert!((found - expected).abs() < 100.0 * TOLERANCE);
        }
    }

    #[test]
    fn a_single_frame_becomes_a_normal_curve() {
        let sigma = 3.0;
        let mut frames = Array2::zeros((101, 1));
        frames[[50, 0]] = 1.0;
        let smooth = smoothed(frames.view(), sigma);
        assert!((smooth.sum() - 1.0).abs() < TOLERANCE);
        let places = Array1::from_iter((0..101).map(|frame| (f64::from(frame) - 50.0).powi(2)));
        let variance = (&smooth.column(0) * &places).sum();
        // Without what is beyond four deviations a normal variable varies by a thousandth less.
        assert!((variance / (sigma * sigma) - 1.0).abs() < 2e-3);
        // White noise of variance 1 would vary by the sum of the squares.
        let left: f64 = smooth.iter().map(|x| x * x).sum();
        let factor = (2.0 * std::f64::consts::PI.sqrt() * sigma).sqrt();
        assert!((left.sqrt() * factor - 1.0).abs() < 2e-3);
    }
}
