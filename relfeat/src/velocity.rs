use nalgebra::Vector3;

/// Number of frames in an averaging window (spec.md a.1): max(1, ⌈ms · fs / 1000⌉).
pub(crate) fn window_frames(window_ms: f64, rate: f64) -> usize {
    /// Rates come from frame times of about six digits: 0.0083333 s means 120 Hz, and a window of
    /// 250 ms then has 30 frames, not the 31 that 30.0001 would round up to.
    const RATE_TOLERANCE: f64 = 1e-5;
    let frames = window_ms * rate / 1000.0;
    let nearest = frames.round();
    let whole = if (frames - nearest).abs() <= RATE_TOLERANCE * nearest {
        nearest
    } else {
        frames.ceil()
    };
    (whole as usize).max(1)
}

/// Mean velocity in metres per second (spec.md a.1): forward differences, the last one repeated,
/// averaged over `window` samples t+1−⌈W/2⌉ … t+W−⌈W/2⌉, mirrored at both ends with the edge
/// repeated. One frame alone stands still.
///
/// O(frames + window).
pub(crate) fn mean_velocity(path: &[Vector3<f64>], window: usize, rate: f64) -> Vec<Vector3<f64>> {
    let n_frames = path.len();
    if n_frames < 2 {
        return vec![Vector3::zeros(); n_frames];
    }
    let step = |t: usize| {
        let t = t.min(n_frames - 2);
        path[t + 1] - path[t]
    };
    if window == 1 {
        return (0..n_frames).map(|t| step(t) * rate).collect();
    }
    let before = window.div_ceil(2) - 1;
    let after = window - window.div_ceil(2);
    let scale = rate / window as f64;
    let at = |t: isize| step(mirrored(t, n_frames));
    (0..n_frames)
        .map(|t| {
            let (first, last) = (t as isize - before as isize, t + after);
            let sum = if first >= 0 && last + 1 < n_frames {
                // Away from the ends the differences cancel.
                path[last + 1] - path[first as usize]
            } else {
                (first..=last as isize).map(at).sum()
            };
            sum * scale
        })
        .collect()
}

/// The index that a position outside `0..n` is mirrored to, as often as it takes.
fn mirrored(t: isize, n: usize) -> usize {
    let wrapped = t.rem_euclid(2 * n as isize) as usize;
    wrapped.min(2 * n - 1 - wrapped)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_have_the_frames_of_the_spec() {
        let at_120 = [(250.0, 30), (100.0, 12), (0.0, 1)];
        for (ms, frames) in at_120 {
            assert_eq!(window_frames(ms, 120.0), frames);
        }
        assert_eq!(window_frames(250.0, 1.0 / 0.00833333), 30);
        assert_eq!(window_frames(100.0, 25.0), 3);
    }

    #[test]
    fn positions_outside_are_mirrored_with_the_edge_repeated() {
        let found: Vec<usize> = (-4..8).map(|t| mirrored(t, 3)).collect();
        assert_eq!(found, [2, 2, 1, 0, 0, 1, 2, 2, 1, 0, 0, 1]);
    }

    #[test]
    fn an_even_window_leads_by_one_frame() {
        // spec.md a.1: for even W it is [x(t+1+W/2) − x(t+1−W/2)]·fs/W.
        let path: Vec<Vector3<f64>> = (0..40)
            .map(|t| Vector3::new((t * t) as f64, 0.0, 0.0))
            .collect();
        let found = mean_velocity(&path, 4, 120.0);
        assert_eq!(found[10].x, (13.0f64 * 13.0 - 9.0 * 9.0) * 120.0 / 4.0);
    }
}
