//! Short blends, spread over the frames around them.

use bundles::{Piece, Walk};
use mocap_io::{Motion, blend_along};

/// Blends of so many seconds are long enough: half of a step's time, in which a body does change its pose.
const MIN_SECONDS: f64 = 0.3;

/// How fast the reach grows from frame to frame, in frames: below 1, so that time never runs back.
const SLOPE: f64 = 0.5;

/// The motion of `walk` with blends shorter than 0.3 s spread: a jump within one frame over 0.2 s.
///
/// Each frame becomes the mean of the poses so many frames before and after it as its reach says, in the
/// sense of [`blend_along`]; then of half as many, and so on, which makes a jump a line. The reach is
/// largest inside a short blend, by as much as that lacks on each side, and nothing where none is near.
pub(super) fn soften(motion: Motion, walk: &Walk) -> Motion {
    let reach = reach(walk, motion.n_frames(), motion.rate.hz());
    let longest = reach.iter().fold(0.0, |a: f64, &b| a.max(b));
    let weights = vec![0.5; reach.len()];
    let mut softened = motion;
    let mut share = 1.0;
    while share * longest >= 0.5 {
        let path = places(&reach, share);
        // A motion goes with itself.
        match blend_along(&softened, &softened, &path, &weights) {
            Ok(next) => softened = next,
            Err(_) => return softened,
        }
        share /= 2.0;
    }
    softened
}

/// The two places that each frame is the mean of, at a share of its reach.
fn places(reach: &[f64], share: f64) -> Vec<(f64, f64)> {
    let last = reach.len().saturating_sub(1);
    let place = |(k, reach): (usize, &f64)| {
        // As far on both sides, so that the ends stay.
        let reach = (share * reach).min(k as f64).min((last - k) as f64);
        (k as f64 - reach, k as f64 + reach)
    };
    reach.iter().enumerate().map(place).collect()
}

/// How many frames to both sides each frame is a mean of.
fn reach(walk: &Walk, n_frames: usize, hz: f64) -> Vec<f64> {
    let mut reach = vec![0.0; n_frames];
    let mut at: usize = 0;
    for piece in &walk.pieces {
        let n = piece.n_frames();
        let lacking = (MIN_SECONDS * hz - n as f64) / 4.0;
        if matches!(piece, Piece::Blend { .. }) && lacking > 0.0 {
            let aside = (lacking / SLOPE).ceil() as usize;
            let near = at.saturating_sub(aside)..(at + n + aside + 1).min(n_frames);
            for (k, known) in near.clone().zip(&mut reach[near]) {
                let far = at.saturating_sub(k).max(k.saturating_sub(at + n));
                *known = (lacking - SLOPE * far as f64).max(*known);
            }
        }
        at += n;
    }
    reach
}

#[cfg(test)]
mod tests;
