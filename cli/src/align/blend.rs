//! From an alignment to the positions that a blend plays.

/// Half the window in which the path is smoothed, in seconds: a warping path goes in stairs, and
/// a motion that follows them stops and starts.
const SMOOTHING_SECONDS: f64 = 0.1;

/// Positions in both clips for each frame of their blend, `weight` of the way from the first to the second.
///
/// `steps` is a path from both first to both last frames, in (fractional) frames of equal rate. A blend
/// of weight w lasts as long as w of the way from one duration to the other, and its frame k lies
/// where (1 − w)·i + w·j = k; the path's stairs are smoothed over up to 0.1 s to either side,
/// which leaves both ends and that sum as they are.
///
/// O(steps + frames · window).
#[must_use]
pub fn positions(steps: &[(f64, f64)], weight: f64, rate: f64) -> Vec<(f64, f64)> {
    let (Some(&first), Some(&last)) = (steps.first(), steps.last()) else {
        return Vec::new();
    };
    let clock = |(i, j): (f64, f64)| (1.0 - weight) * (i - first.0) + weight * (j - first.1);
    let n_frames = clock(last).round() as usize + 1;
    let tick = clock(last) / (n_frames - 1).max(1) as f64;
    let mut next = 0;
    let at = |k: usize| {
        if k > 0 && k + 1 == n_frames {
            return last;
        }
        let time = k as f64 * tick;
        while next + 1 < steps.len() && clock(steps[next + 1]) <= time {
            next += 1;
        }
        let here = steps[next];
        match steps.get(next + 1) {
            Some(&then) => {
                let share = (time - clock(here)) / (clock(then) - clock(here));
                (
                    here.0 + share * (then.0 - here.0),
                    here.1 + share * (then.1 - here.1),
                )
            }
            None => last,
        }
    };
    let stairs: Vec<(f64, f64)> = (0..n_frames).map(at).collect();
    smoothed(
        &stairs,
        (SMOOTHING_SECONDS * rate).round() as usize,
        first,
        last,
    )
}

/// The mean of each position's neighbours up to `radius` to both sides, as many to one as to the other.
fn smoothed(
    stairs: &[(f64, f64)],
    radius: usize,
    first: (f64, f64),
    last: (f64, f64),
) -> Vec<(f64, f64)> {
    let n = stairs.len();
    let mean = |k: usize| {
        let reach = radius.min(k).min(n - 1 - k);
        let window = &stairs[k - reach..=k + reach];
        let (i, j) = window
            .iter()
            .fold((0.0, 0.0), |sum, p| (sum.0 + p.0, sum.1 + p.1));
        let n = window.len() as f64;
        // Rounding must not lead beyond the ends.
        (
            (i / n).clamp(first.0, last.0),
            (j / n).clamp(first.1, last.1),
        )
    };
    (0..n).map(mean).collect()
}
