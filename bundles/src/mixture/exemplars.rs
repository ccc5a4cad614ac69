//! Letters that are poses themselves.

use std::num::NonZeroUsize;

use ndarray::{Array1, ArrayView2, Axis, Zip};

use super::packed::Packed;
use super::state::variance_floor;
use super::{LabelRule, MixtureError};
use crate::PoseClusters;

/// Clusters about `n_letters` of `frames`, of shape `(frames, dims)`, at even distances in time: the
/// middles of as many stretches of equal length, rounded down. Fewer where there are fewer frames.
///
/// All have one standard deviation, the root of the mean over frames and dimensions of squared
/// distances from the nearest letter, ties to the lower label; their weights are the shares of the
/// frames. A cluster is what is nearest to its letter, so that neither labels nor the order of
/// distances hang on that deviation, which is floored as in [`fit_mixture`](super::fit_mixture).
///
/// This is not the paper's mixture (section 3.2). A little noise on the poses moves the letters of a
/// mixture, and with them all bundles; it moves no letter here to another frame.
///
/// Takes O(frames·letters·dims) time and O((frames + letters)·dims) memory.
///
/// # Errors
///
/// As [`fit_mixture`](super::fit_mixture).
pub fn exemplars(
    frames: ArrayView2<'_, f64>,
    n_letters: NonZeroUsize,
) -> Result<PoseClusters, MixtureError> {
    let packed = Packed::new(frames)?;
    let n_frames = packed.n_frames;
    let n_letters = n_letters.get().min(n_frames);
    let middle = |i: usize| (2 * i as u128 + 1) * n_frames as u128 / (2 * n_letters as u128);
    let chosen: Vec<usize> = (0..n_letters).map(|i| middle(i) as usize).collect();
    let letters = frames.select(Axis(0), &chosen);
    let unit = PoseClusters::new(letters.view(), Array1::ones(n_letters).view())?;
    let labels = unit.label(frames, LabelRule::Likelihood)?;
    let mut weights: Array1<f64> = Array1::zeros(n_letters);
    let mut squares = 0.0;
    // A frame may be as far from its letter as can be: divide first.
    let share = 1.0 / (n_frames as f64 * packed.dims.max(1) as f64);
    for (frame, &label) in frames.rows().into_iter().zip(&labels) {
        let letter = label as usize;
        weights[letter] += 1.0;
        Zip::from(frame)
            .and(letters.row(letter))
            .for_each(|x, mean| squares += (x - mean).powi(2) * share);
    }
    let sigma = squares.max(variance_floor(&packed)).sqrt();
    let sigmas = Array1::from_elem(n_letters, sigma);
    let clusters = PoseClusters::new(letters.view(), sigmas.view())?;
    Ok(clusters.with_weights(weights.view())?)
}
