//! κ by the Bayesian information criterion.

use ndarray::{ArrayView2, Axis};

use super::packed::Packed;
use super::{EmOptions, KappaCandidate, MixtureError, em, seeding};

/// Frames, evenly spaced, that decide. BIC is that of these frames.
const SAMPLE: usize = 8192;

/// A letter is to have so many of those frames on average.
const FRAMES_PER_LETTER: usize = 4;

/// Candidates are these, and these times powers of two.
const FIRST: [usize; 2] = [4, 6];

/// The search ends after so many candidates in a row that are worse than the best.
const PATIENCE: usize = 2;

/// The candidate of least BIC, ties to the smaller, and all that were tried.
pub(super) fn choose(
    frames: ArrayView2<'_, f64>,
    options: &EmOptions,
) -> Result<(usize, Vec<KappaCandidate>), MixtureError> {
    let n_frames = frames.nrows();
    let n_sampled = n_frames.min(SAMPLE);
    let spaced: Vec<usize> = (0..n_sampled)
        .map(|i| (i as u128 * n_frames as u128 / n_sampled as u128) as usize)
        .collect();
    let packed = Packed::new(frames.select(Axis(0), &spaced).view())?;
    let mut tried: Vec<KappaCandidate> = Vec::new();
    let mut best = 0;
    for n_letters in candidates(n_sampled) {
        let start = seeding::seed(&packed, n_letters, options.seed);
        let n_distinct = start.n_letters();
        let state = em::run(&packed, start, options).state;
        tried.push(KappaCandidate {
            n_letters: n_distinct,
            bic: bic(&packed, n_distinct, em::log_likelihood(&packed, &state)),
        });
        let last = tried.len() - 1;
        if tried[last].bic < tried[best].bic {
            best = last;
        }
        if last - best >= PATIENCE || n_distinct < n_letters {
            break;
        }
    }
    Ok((tried[best].n_letters, tried))
}

/// 1, 2, 3, then 4, 6, 8, 12, 16, … in ascending order.
fn candidates(n_frames: usize) -> impl Iterator<Item = usize> {
    let most = (n_frames / FRAMES_PER_LETTER).max(1);
    let doubled = (0..usize::BITS - 4).flat_map(|power| FIRST.map(|first| first << power));
    (1..FIRST[0])
        .chain(doubled)
        .take_while(move |n_letters| *n_letters <= most)
}

/// A mean and a variance for each letter, and weights that sum to 1.
fn bic(packed: &Packed, n_letters: usize, log_likelihood: f64) -> f64 {
    let n_parameters = n_letters * (packed.dims + 2) - 1;
    n_parameters as f64 * (packed.n_frames as f64).ln() - 2.0 * log_likelihood
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn candidates_grow_by_halves_and_thirds_and_leave_frames_for_each() {
        assert_eq!(candidates(1).collect::<Vec<_>>(), [1]);
        let up_to_16: Vec<usize> = candidates(95).collect();
        assert_eq!(up_to_16, [1, 2, 3, 4, 6, 8, 12, 16]);
        assert_eq!(candidates(SAMPLE).last(), Some(2048));
    }
}
