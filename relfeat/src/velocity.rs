use nalgebra::Vector3;

/// Number of frames in an averaging window (spec.md a.1): max(1, ⌈ms · fs / 1000⌉).
pub(crate) fn window_frames(window_ms: f64, rate: f64) -> usize {
    /// Rates come from frame times of about six digits: 0.0083333 s means 120 Hz, and a window of
    /// 250 ms then has 30 frames, not the 31 that 30.0001 would round up to.
    const RATE_TOLERANCE: f64 = 1e-5;
    const MAX_WINDOW: f64 = 1e12;
    let frames = window_ms * rate / 1000.0;
    let nearest = frames.round();
    let whole = if (frames - nearest).abs() <= RATE_TOLERANCE * nearest {
        nearest
    } else {
        frames.ceil()
    };
    // No motion is long enough to tell longer windows apart, and sums with frame numbers cannot overflow.
    (whole.min(MAX_WINDOW) as usize).max(1)
}

/// Mean velocity in metres per second (spec.md a.1): forward differences, the last one repeated,
/// averaged over `window` samples t+1−⌈W/2⌉ … t+W−⌈W/2⌉, mirrored at both ends with the edge
/// repeated. One frame alone stands still.
///
/// Differences that follow each other add up to the displacement between their ends, so only the
/// positions at the ends of a window count, and a missing one between them does no harm.
///
/// O(frames), whatever the window.
pub(crate) fn mean_velocity(path: &[Vector3<f64>], window: usize, rate: f64) -> Vec<Vector3<f64>> {
    let n_frames = path.len();
    if n_frames < 2 {
        return vec![Vector3::zeros(); n_frames];
    }
    let before = (window.div_ceil(2) - 1) as i64;
    let after = (window - window.div_ceil(2)) as i64;
    let scale = rate / window as f64;
    (0..n_frames as i64)
        .map(|t| {
            let (first, last) = (t - before, t + after + 1);
            // Away from the ends, where almost all frames are, nothing has to be prolonged.
            let way = if first >= 0 && last < n_frames as i64 {
                path[last as usize] - path[first as usize]
            } else {
                extended(path, last) - extended(path, first)
            };
            way * scale
        })
        .collect()
}

/// The path prolonged in both directions so that its steps are those of the padded velocity: frame
/// `n` repeats the last step, steps beyond either end are the ones before it, backwards.
fn extended(path: &[Vector3<f64>], frame: i64) -> Vector3<f64> {
    let n = path.len() as i64;
    let inner = |i: i64| match usize::try_from(i) {
        Ok(i) if i < path.len() => path[i],
        _ => path[path.len() - 1] * 2.0 - path[path.len() - 2],
    };
    match frame {
        _ if (0..=n).contains(&frame) => inner(frame),
        _ if (n..=2 * n).contains(&frame) => inner(n) * 2.0 - inner(2 * n - frame),
        _ if (-n..0).contains(&frame) => inner(0) * 2.0 - inner(-frame),
        _ => {
            // The steps repeat with period 2n, in which the path moves on by twice its way.
            let way = (inner(n) - inner(0)) * 2.0;
            extended(path, frame.rem_euclid(2 * n)) + way * frame.div_euclid(2 * n) as f64
        }
    }
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
    fn steps_outside_are_mirrored_with_the_edge_repeated() {
        // Steps 1, 10 and, repeated, 10 again; mirrored as 10 10 1 | 1 10 10 | 10 10 1 and so on.
        let path = [0.0, 1.0, 11.0].map(|x| Vector3::new(x, 0.0, 0.0));
        let step = |t: i64| extended(&path, t + 1).x - extended(&path, t).x;
        let found: Vec<f64> = (-9..12).map(step).collect();
        let mirrored = [1.0, 10.0, 10.0, 10.0, 10.0, 1.0];
        let expected: Vec<f64> = mirrored.iter().cycle().skip(3).take(21).copied().collect();
        assert_eq!(found, expected);
    }

    #[test]
    fn windows_of_any_length_take_no_longer() {
        let path: Vec<Vector3<f64>> = (0..1000)
            .map(|t| Vector3::new(f64::from(t), 0.0, 0.0))
            .collect();
        assert_eq!(window_frames(60_000.0, 1e300), 1_000_000_000_000);
        for v in mean_velocity(&path, window_frames(60_000.0, 1e300), 1.0) {
            // Every step is one; the way of 10^12 steps is rounded.
            assert!((v.x - 1.0).abs() < 1e-9, "{v}");
        }
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
