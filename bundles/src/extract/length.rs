//! λ from λ′ (equation 7).

use crate::MotionString;

/// The number λ of letters that `max_frames` frames take on average, rounded down, at least 2.
///
/// The average is over neighbouring letters of all clips: λ = λ′·n / Σ(F̄(j) - F̄(j - 1)) for n
/// pairs. The paper uses 200 frames. At most the length of the string, or 2.
pub fn max_letters(string: &MotionString, max_frames: f64) -> usize {
    let (mut n_pairs, mut widths) = (0_usize, 0.0);
    for clip in 0..string.n_clips() {
        let span = string.clip_span(clip).unwrap_or_default();
        if let Some(width) = span
            .end
            .checked_sub(1)
            .and_then(|l| string.width(span.start, l))
        {
            n_pairs += span.len() - 1;
            widths += width;
        }
    }
    if n_pairs == 0 {
        return 2;
    }
    // A quotient that is no number becomes 0.
    let letters = (max_frames * n_pairs as f64 / widths) as usize;
    letters.min(string.len()).max(2)
}
