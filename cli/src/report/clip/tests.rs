use std::path::PathBuf;

use proptest::prelude::*;

use super::*;
use crate::corpus_files::write_corpus;
use crate::output::Voice;

/// Rounding to millimetres, and the coordinates' own rounding to 32 bits at up to 32 m.
const TOLERANCE_M: f32 = 0.000_5 + 0.000_01;

fn drawn(positions: Array3<f32>) -> Drawn {
    let names: Vec<String> = (0..positions.dim().1).map(|i| format!("m{i}")).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    Drawn {
        name: "clip".to_owned(),
        source_rate: 30.0,
        span: Span {
            start: 0,
            end: positions.dim().0,
        },
        rig: None,
        figure: figure::of_joints(&names, &[]),
        rate: 30.0,
        positions,
    }
}

/// What a page makes of a motion.
fn decoded(motion: &Motion, n_points: usize) -> Array3<f32> {
    let bytes = STANDARD.decode(&motion.bytes).unwrap();
    let values: Vec<i16> = bytes
        .chunks_exact(2)
        .map(|pair| i16::from_le_bytes([pair[0], pair[1]]))
        .collect();
    let mut axes = [0, 1, 2].into_iter().cycle();
    let metres = values.iter().map(|&value| {
        let axis = axes.next().unwrap();
        match value {
            MISSING => f32::NAN,
            value => (f64::from(i32::from(value) + motion.origin[axis]) / 1000.0) as f32,
        }
    });
    Array3::from_shape_vec((motion.frames, n_points, 3), metres.collect()).unwrap()
}

proptest! {
    #[test]
    fn what_is_decoded_is_what_was_recorded(
        n_frames in 1usize..20,
        n_points in 1usize..6,
        at in prop::array::uniform3(-2000f32..2000.0),
        seed in prop::collection::vec(-30f32..30.0, 20 * 6 * 3),
        gaps in prop::collection::vec(prop::bool::weighted(0.1), 20 * 6),
    ) {
        let positions = Array3::from_shape_fn((n_frames, n_points, 3), |(t, p, axis)| {
            let i = t * n_points + p;
            if gaps[i] { f32::NAN } else { at[axis] + seed[i * 3 + axis] }
        });
        let back = decoded(&drawn(positions.clone()).motion(), n_points);
        for (found, expected) in back.iter().zip(&positions) {
            if expected.is_nan() {
                prop_assert!(found.is_nan());
            } else {
                // 32-bit metres at 2 km are a tenth of a millimetre apart.
                prop_assert!((found - expected).abs() <= TOLERANCE_M + 2e-4, "{} {}", found, expected);
            }
        }
    }
}

#[test]
fn a_point_without_one_coordinate_is_missing() {
    let mut positions = Array3::zeros((2, 2, 3));
    positions[[1, 0, 2]] = f32::NAN;
    let found = drawn(positions).millimetres().values;
    let mut expected = [0; 12];
    expected[6..9].fill(MISSING);
    assert_eq!(found, expected);
}

#[test]
fn a_stray_point_is_missing_and_moves_nothing() {
    let mut positions = Array3::from_elem((3, 4, 3), 1.5);
    positions[[1, 2, 0]] = 1e30;
    positions[[2, 2, 0]] = -100.0;
    let drawn = drawn(positions.clone());
    let back = decoded(&drawn.motion(), 4);
    for (t, p) in [(0, 0), (0, 2), (1, 3), (2, 1)] {
        assert!((back[[t, p, 0]] - 1.5).abs() <= TOLERANCE_M);
    }
    assert!(back[[1, 2, 0]].is_nan() && back[[2, 2, 0]].is_nan());
    let strip = drawn.strip().unwrap();
    assert_eq!(strip.poses, 3);
    let bytes = STANDARD.decode(strip.bytes).unwrap();
    assert_eq!(bytes.len(), 3 * 4 * 2);
    assert_eq!(bytes[(4 + 2) * 2..][..2], [u8::MAX; 2]);
}

#[test]
fn nothing_but_gaps_is_drawn_without_a_panic() {
    let gaps = drawn(Array3::from_elem((1, 2, 3), f32::NAN));
    assert_eq!(gaps.millimetres().origin, [0; 3]);
    assert_eq!(
        STANDARD.decode(gaps.strip().unwrap().bytes).unwrap(),
        [255; 4]
    );
    assert_eq!(drawn(Array3::zeros((0, 2, 3))).strip(), None);
    assert_eq!(drawn(Array3::zeros((0, 2, 3))).motion().frames, 0);
    assert_eq!(drawn(Array3::zeros((2, 0, 3))).strip(), None);
}

#[test]
fn a_strip_shows_heights_above_the_floor() {
    // One pose: a foot on a floor at 0.3 m, a head 1.7 m above it.
    let mut positions = Array3::from_elem((1, 2, 3), 0.3);
    positions[[0, 1, 1]] = 2.0;
    let strip = drawn(positions).strip().unwrap();
    let bytes = STANDARD.decode(strip.bytes).unwrap();
    assert_eq!(bytes, [128, 0, 128, 170]);
}

fn a_file() -> (tempfile::TempDir, PathBuf) {
    let dir = tempfile::tempdir().unwrap();
    let files = write_corpus(dir.path(), 7, Voice::default()).unwrap();
    let path = files[0].path.clone();
    (dir, path)
}

#[test]
fn a_file_is_drawn_by_its_body_points() {
    let (_dir, path) = a_file();
    let whole = ClipRef { path, span: None };
    let options = ReadOptions::default();
    let take = Take::load(&whole, &options).unwrap();
    let drawn = Drawn::of_take(&take, 30.0);
    let read = Drawn::load(&whole, &options, 30.0).unwrap();
    assert_eq!(
        read.positions.mapv(f32::to_bits),
        drawn.positions.mapv(f32::to_bits)
    );
    assert_eq!(drawn.figure.points.len(), BodyPoint::COUNT);
    assert_eq!(drawn.figure.bones.len(), BodyPoint::COUNT - 1);
    let n_poses = drawn.positions.dim().0;
    let last = source_frame(n_poses - 1, take.rate(), 30.0);
    assert!(last < take.span.end && source_frame(n_poses, take.rate(), 30.0) >= take.span.end);
    let back = decoded(&drawn.motion(), BodyPoint::COUNT);
    for k in [0, n_poses / 2, n_poses - 1] {
        let frame = source_frame(k, take.rate(), 30.0);
        for point in BodyPoint::ALL {
            let expected = take.body().point(frame, point);
            for (axis, expected) in expected.into_iter().enumerate() {
                let found = back[[k, point.idx(), axis]];
                assert!(
                    (found - expected).abs() <= TOLERANCE_M,
                    "{point}: {found} {expected}"
                );
            }
        }
    }
    assert_eq!(drawn.motion().bytes.len(), drawn.motion_bytes());
}

#[test]
fn a_span_is_drawn_from_its_first_frame() {
    let (_dir, path) = a_file();
    let span = Span { start: 7, end: 8 };
    let clip = ClipRef {
        path,
        span: Some(span),
    };
    let one = Drawn::load(&clip, &ReadOptions::default(), 30.0).unwrap();
    assert_eq!(one.positions.dim().0, 1);
    let take = Take::load(&clip, &ReadOptions::default()).unwrap();
    let root = take.body().point(7, BodyPoint::Root);
    assert_eq!(one.positions[[0, 0, 1]], root[1]);
    assert_eq!(one.strip().unwrap().poses, 1);
}
