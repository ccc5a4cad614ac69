//! Gaps of markers, and what fills them.

use mocap_io::ndarray::{Array2, Array3};
use mocap_io::{FrameRate, Gap, LengthUnit, Markers, RateSource, UnitSource, UpAxis, UpSource};
use proptest::collection::vec;
use proptest::prelude::*;

const HZ: f64 = 120.0;
/// Positions are `f32` of about a metre in millimetres; the cubic through four of them multiplies their
/// rounding by the sum of its weights, which is some hundred for the longest gaps made here.
const TOLERANCE: f32 = 0.05;

fn markers(positions: Array3<f32>) -> Markers {
    let (n_frames, n_markers, _) = positions.dim();
    let residuals = Array2::from_shape_fn((n_frames, n_markers), |(frame, marker)| {
        if positions[[frame, marker, 0]].is_nan() {
            f32::NAN
        } else {
            1.5
        }
    });
    Markers {
        names: (0..n_markers).map(|i| format!("M{i}")).collect(),
        positions,
        residuals,
        rate: FrameRate::from_hz(HZ).unwrap(),
        rate_source: RateSource::File,
        unit: LengthUnit::MILLIMETRE,
        unit_source: UnitSource::File,
        up: UpAxis::Z,
        up_source: UpSource::File,
        first_frame_number: 1,
    }
}

/// One marker on `at`, missing where `there` is false.
fn one(there: &[bool], at: impl Fn(f64) -> f64) -> Markers {
    let n_frames = there.len();
    markers(Array3::from_shape_fn(
        (n_frames, 1, 3),
        |(frame, _, axis)| {
            let value = at(frame as f64) + axis as f64;
            if there[frame] { value as f32 } else { f32::NAN }
        },
    ))
}

/// A flag per frame: is the marker there?
fn presence() -> impl Strategy<Value = Vec<bool>> {
    vec((any::<bool>(), 1usize..6), 0..10).prop_map(|runs| {
        runs.into_iter()
            .flat_map(|(there, n)| vec![there; n])
            .collect()
    })
}

/// Frame by frame, and the polynomial by Neville's scheme.
fn naive_fill(there: &[bool], values: &[f32], max_frames: usize) -> Vec<f32> {
    let mut filled = values.to_vec();
    for frame in (0..there.len()).filter(|&f| !there[f]) {
        let before: Vec<usize> = (0..frame).filter(|&f| there[f]).collect();
        let after: Vec<usize> = (frame..there.len()).filter(|&f| there[f]).collect();
        let (Some(&last), Some(&next)) = (before.last(), after.first()) else {
            continue;
        };
        if next - last - 1 > max_frames {
            continue;
        }
        let known: Vec<usize> = before[before.len().saturating_sub(2)..]
            .iter()
            .chain(&after[..after.len().min(2)])
            .copied()
            .collect();
        let mut table: Vec<f64> = known.iter().map(|&f| f64::from(values[f])).collect();
        for width in 1..known.len() {
            for i in 0..known.len() - width {
                let (a, b) = (known[i] as f64, known[i + width] as f64);
                table[i] =
                    ((frame as f64 - b) * table[i] + (a - frame as f64) * table[i + 1]) / (a - b);
            }
        }
        filled[frame] = table[0] as f32;
    }
    filled
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn filling_does_what_the_textbook_does(
        there in presence(),
        (a, b) in (-1.0..1.0f64, 0.1..2.0f64),
        max_frames in 0usize..12,
    ) {
        let markers = one(&there, |t| 1000.0 * (a * t + b * (b * t).sin()));
        let (filled, which) = markers.filled(max_frames as f64 / HZ);
        let column = |m: &Markers| -> Vec<f32> { (0..there.len()).map(|f| m.positions[[f, 0, 0]]).collect() };
        let expected = naive_fill(&there, &column(&markers), max_frames);
        for (frame, (found, expected)) in column(&filled).into_iter().zip(expected).enumerate() {
            let same = found.is_nan() == expected.is_nan() && (found.is_nan() || (found - expected).abs() <= TOLERANCE);
            prop_assert!(same, "frame {}: {} instead of {}", frame, found, expected);
            let is_filled = which.iter().any(|gap| gap.frames.contains(&frame));
            let residual = filled.residuals[[frame, 0]];
            prop_assert_eq!(is_filled, !found.is_nan() && !there[frame]);
            if is_filled {
                prop_assert_eq!(residual, 0.0);
            } else {
                prop_assert_eq!(residual.to_bits(), markers.residuals[[frame, 0]].to_bits());
                prop_assert_eq!(found.to_bits(), markers.positions[[frame, 0, 0]].to_bits());
            }
        }
        prop_assert!(which.iter().all(|gap| gap.frames.len() <= max_frames));
    }

    #[test]
    fn gaps_are_where_the_marker_is_not(there in presence()) {
        let gaps = one(&there, |t| t).gaps();
        let missing: Vec<usize> = gaps.iter().flat_map(|gap| gap.frames.clone()).collect();
        let expected: Vec<usize> = (0..there.len()).filter(|&f| !there[f]).collect();
        prop_assert_eq!(missing, expected);
        // As long as can be.
        prop_assert!(gaps.windows(2).all(|pair| pair[0].frames.end < pair[1].frames.start));
    }

    #[test]
    fn a_cubic_is_restored(
        (a, b, c) in (-500.0..500.0f64, -5.0..5.0f64, -0.1..0.1f64),
        start in 2usize..10,
        n_missing in 1usize..20,
        n_after in 2usize..8,
    ) {
        let n_frames = start + n_missing + n_after;
        let there: Vec<bool> = (0..n_frames).map(|f| f < start || f >= start + n_missing).collect();
        let at = |t: f64| a + b * t + c * t * t - 0.001 * t * t * t;
        let (filled, which) = one(&there, at).filled(1.0);
        prop_assert_eq!(which, vec![Gap { marker: 0, frames: start..start + n_missing }]);
        for frame in 0..n_frames {
            let off = (filled.positions[[frame, 0, 0]] - at(frame as f64) as f32).abs();
            prop_assert!(off <= TOLERANCE, "frame {}: off by {}", frame, off);
        }
    }
}

#[test]
fn a_gap_of_exactly_the_given_length_is_filled() {
    for (n_missing, seconds) in [(30, 0.25), (12, 0.1), (36, 0.3), (84, 0.7)] {
        let there: Vec<bool> = (0..n_missing + 4)
            .map(|f| f < 2 || f >= n_missing + 2)
            .collect();
        let markers = one(&there, |t| t);
        assert_eq!(markers.filled(seconds).1.len(), 1, "{seconds}");
        assert_eq!(markers.filled(seconds - 0.5 / HZ).1.len(), 0, "{seconds}");
    }
}

#[test]
fn nothing_is_made_up_at_the_ends_or_for_strange_lengths() {
    let there = [false, true, false, true, true, false];
    let markers = one(&there, |t| t);
    let (filled, which) = markers.filled(f64::INFINITY);
    assert_eq!(
        which,
        [Gap {
            marker: 0,
            frames: 2..3
        }]
    );
    assert!(filled.positions[[0, 0, 0]].is_nan() && filled.positions[[5, 0, 0]].is_nan());
    for seconds in [0.0, -1.0, f64::NAN] {
        assert_eq!(markers.filled(seconds).1, []);
    }
}
