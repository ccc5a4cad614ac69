//! Blends and joins of motions.

use std::f64::consts::FRAC_PI_2;

use mocap_io::ndarray::{Array2, s};
use mocap_io::{
    Axis, BlendError, Channel, FrameRate, Joint, LengthUnit, Motion, OffsetFrame, Skeleton,
    SkeletonMismatch, UpAxis, blend, blend_along, smoothstep_weights,
};
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::Index;

use crate::ops::{all_moved, any_motion, check_places, places, small_value};

/// Two motions of one skeleton, with at least `min` frames each.
fn two_motions(min: usize) -> impl Strategy<Value = (Motion, Motion)> {
    (any_motion(small_value(), 8), 0usize..9).prop_filter_map("too short", move |(both, cut)| {
        let n = both.n_frames();
        let (a, b) = (both.slice(0..cut.min(n))?, both.slice(cut.min(n)..n)?);
        (a.n_frames() >= min && b.n_frames() >= min).then_some((a, b))
    })
}

fn placement() -> impl Strategy<Value = (f64, [f64; 2])> {
    (-3.0..3.0, [-5.0..5.0, -5.0..5.0])
}

/// Squared distances of all joints of a frame from each other, and their heights.
fn shape(frame: &[[f64; 3]]) -> Vec<f64> {
    let distance = |a: &[f64; 3], b: &[f64; 3]| (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>();
    let distances = frame
        .iter()
        .flat_map(|a| frame.iter().map(move |b| distance(a, b).sqrt()));
    distances.chain(frame.iter().map(|p| p[1])).collect()
}

fn check_shapes(found: &[Vec<[f64; 3]>], expected: &[Vec<[f64; 3]>]) -> Result<(), TestCaseError> {
    prop_assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        for (a, b) in shape(found).into_iter().zip(shape(expected)) {
            prop_assert!(
                (a - b).abs() <= crate::ops::METRES,
                "{} instead of {}",
                a,
                b
            );
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_motion_blended_with_itself_is_itself(
        motion in any_motion(small_value(), 6),
        weights in vec(0.0..=1.0, 6),
    ) {
        let found = blend(&motion, &motion, &weights[..motion.n_frames()]).unwrap();
        prop_assert_eq!((found.rate, found.unit, found.up), (motion.rate, motion.unit, motion.up));
        check_places(&places(&found), &places(&motion))?;
    }

    #[test]
    fn weights_of_zero_give_the_first_motion_and_of_one_the_second((a, b) in two_motions(1)) {
        let first = blend(&a, &b, &vec![0.0; a.n_frames()]).unwrap();
        check_places(&places(&first), &places(&a))?;
        let second = blend(&a, &b, &vec![1.0; b.n_frames()]).unwrap();
        if let (Some(second), Some(b)) = (second.in_facing_frame(0), b.in_facing_frame(0)) {
            check_places(&places(&second), &places(&b))?;
        }
        // It starts where the first motion starts.
        if let (Some(found), Some(expected)) = (second.heading(0), a.heading(0)) {
            prop_assert!((found - expected).sin().abs() <= 1e-6);
            let (found, expected) = (places(&second)[0][0], places(&a)[0][0]);
            prop_assert!((found[0] - expected[0]).hypot(found[2] - expected[2]) <= crate::ops::METRES);
        }
    }

    #[test]
    fn a_blend_does_not_depend_on_where_the_second_motion_stands(
        (a, b) in two_motions(1),
        weights in vec(0.0..=1.0, 1..6),
        (yaw, to) in placement(),
    ) {
        let expected = places(&blend(&a, &b, &weights).unwrap());
        check_places(&places(&blend(&a, &b.moved(yaw, to), &weights).unwrap_or_else(|_| {
            // The move gave the root channels that the first motion lacks.
            blend(&a.with_free_roots(), &b.moved(yaw, to), &weights).unwrap()
        })), &expected)?;
        let moved = blend(&a.moved(yaw, to), &b.with_free_roots(), &weights).unwrap();
        check_places(&places(&moved), &all_moved(&expected, yaw, to))?;
    }

    #[test]
    fn a_path_without_stretching_is_the_blend((a, b) in two_motions(2), weights in vec(0.0..=1.0, 8)) {
        let n = a.n_frames().min(b.n_frames());
        let (a, b) = (a.slice(0..n).unwrap(), b.slice(0..n).unwrap());
        let diagonal: Vec<(f64, f64)> = (0..n).map(|i| (i as f64, i as f64)).collect();
        let along = blend_along(&a, &b, &diagonal, &weights[..n]).unwrap();
        check_places(&places(&along), &places(&blend(&a, &b, &weights[..n]).unwrap()))?;
        // Only the frames that the path names count.
        let part = blend_along(&a, &b, &diagonal[1..], &weights[1..n]).unwrap();
        let (a, b) = (a.slice(1..n).unwrap(), b.slice(1..n).unwrap());
        check_places(&places(&part), &places(&blend(&a, &b, &weights[1..n]).unwrap()))?;
    }

    #[test]
    fn halves_fit_together_again(motion in any_motion(small_value(), 8), from in any::<Index>(), to in any::<Index>()) {
        let n = motion.n_frames();
        let (from, to) = (from.index(n + 1), to.index(n + 1));
        let (start, end) = (from.min(to), from.max(to));
        let (a, b) = (motion.slice(0..end).unwrap(), motion.slice(start..n).unwrap());
        // Without an overlap nothing says how large the step across the cut was.
        if start < end {
            check_places(&places(&a.concatenate(&b, end - start).unwrap()), &places(&motion))?;
        }
        let b = motion.slice(end..n).unwrap();
        prop_assert_eq!(a.append(&b).unwrap(), motion);
    }

    #[test]
    fn joined_motions_keep_their_frames_and_shapes(
        (a, b) in two_motions(1),
        overlap in 0usize..9,
        (yaw, to) in placement(),
    ) {
        let longest = a.n_frames().min(b.n_frames());
        if overlap > longest {
            prop_assert_eq!(a.concatenate(&b, overlap), Err(BlendError::Overlap { longest, overlap }));
            return Ok(());
        }
        let joined = a.concatenate(&b, overlap).unwrap();
        prop_assert_eq!(joined.n_frames(), a.n_frames() + b.n_frames() - overlap);
        let n_before = a.n_frames() - overlap;
        let free = a.with_free_roots();
        prop_assert_eq!(&joined.skeleton, &free.skeleton);
        prop_assert_eq!(joined.channels.slice(s![..n_before, ..]), free.channels.slice(s![..n_before, ..]));
        let found = places(&joined);
        check_shapes(&found[a.n_frames()..], &places(&b)[overlap..])?;
        // Wherever the second motion stood before.
        let b = b.moved(yaw, to);
        check_places(&places(&free.concatenate(&b, overlap).unwrap()), &found)?;
    }
}

fn joint(name: &str, channels: Vec<Channel>) -> Joint {
    Joint {
        name: name.to_owned(),
        parent: None,
        offset: [0.0; 3],
        channels,
        axis: None,
        end_site: false,
    }
}

fn root_channels() -> Vec<Channel> {
    let turns = [Axis::Y, Axis::X, Axis::Z].map(Channel::Rotation);
    [Axis::ALL.map(Channel::Translation), turns].concat()
}

/// A root that walks `step` metres per frame in the direction it faces, which is `yaw` degrees and turns
/// by `turn` degrees per frame.
fn walk(n_frames: usize, start: [f64; 2], yaw: f64, step: f64, turn: f64) -> Motion {
    let skeleton =
        Skeleton::new(vec![joint("root", root_channels())], OffsetFrame::Parent).unwrap();
    let mut channels = Array2::zeros((n_frames, 6));
    let ([mut x, mut z], mut yaw) = (start, yaw);
    for mut row in channels.rows_mut() {
        row.assign(&mocap_io::ndarray::arr1(&[x, 1.0, z, yaw, 0.0, 0.0]));
        x += step * yaw.to_radians().sin();
        z += step * yaw.to_radians().cos();
        yaw += turn;
    }
    Motion::new(
        skeleton,
        channels,
        FrameRate::from_hz(10.0).unwrap(),
        LengthUnit::METRE,
    )
    .unwrap()
}

#[test]
fn two_walks_in_different_directions_blend_to_a_walk() {
    let (a, b) = (
        walk(5, [1.0, 2.0], 0.0, 1.0, 10.0),
        walk(5, [-7.0, 3.0], 120.0, 2.0, -30.0),
    );
    let found = blend(&a, &b, &[0.5; 5]).unwrap();
    let expected = walk(5, [1.0, 2.0], 0.0, 1.5, -10.0);
    check_places(&places(&found), &places(&expected)).unwrap();
    for frame in 0..5 {
        assert!((found.heading(frame).unwrap() - expected.heading(frame).unwrap()).abs() <= 1e-9);
    }
}

#[test]
fn a_walk_goes_on_across_a_join() {
    let (a, b) = (
        walk(4, [0.0, 0.0], 0.0, 1.0, 0.0),
        walk(3, [9.0, 9.0], 90.0, 2.0, 0.0),
    );
    let found = a.concatenate(&b, 0).unwrap();
    let z: Vec<f64> = places(&found).iter().map(|frame| frame[0][2]).collect();
    let expected = [0.0, 1.0, 2.0, 3.0, 4.5, 6.5, 8.5];
    for (found, expected) in z.iter().zip(expected) {
        assert!((found - expected).abs() <= crate::ops::METRES, "{z:?}");
    }
    // Walks that turn alike go on turning.
    let (a, b) = (
        walk(4, [0.0, 0.0], 0.0, 1.0, 15.0),
        walk(4, [3.0, 5.0], -70.0, 1.0, 15.0),
    );
    let found = a.concatenate(&b, 0).unwrap();
    check_places(
        &places(&found),
        &places(&walk(8, [0.0, 0.0], 0.0, 1.0, 15.0)),
    )
    .unwrap();
    let alone = walk(1, [2.0, 0.0], 0.0, 0.0, 0.0);
    let found = alone
        .concatenate(&walk(1, [5.0, 5.0], 50.0, 0.0, 0.0), 0)
        .unwrap();
    assert_eq!(found.n_frames(), 2);
    check_places(
        &places(&found),
        &[vec![[2.0, 1.0, 0.0]], vec![[2.0, 1.0, 0.0]]],
    )
    .unwrap();
}

#[test]
fn nothing_joins_with_anything() {
    let (none, some) = (
        walk(0, [0.0; 2], 0.0, 1.0, 0.0),
        walk(3, [4.0, 5.0], 30.0, 1.0, 0.0),
    );
    for (a, b) in [(&none, &some), (&some, &none)] {
        assert_eq!(a.concatenate(b, 0).unwrap(), some);
    }
    assert_eq!(blend(&none, &none, &[]).unwrap().n_frames(), 0);
}

#[test]
fn a_missing_root_is_stepped_over() {
    let (mut a, b) = (
        walk(5, [0.0; 2], 0.0, 1.0, 0.0),
        walk(5, [8.0; 2], 90.0, 2.0, 0.0),
    );
    a.channels[[2, 0]] = f64::NAN;
    let found = blend(&a, &b, &[0.5; 5]).unwrap();
    let places = places(&found);
    assert!(places[2][0].iter().all(|v| v.is_nan()));
    for (frame, z) in [(0, 0.0), (1, 1.5), (3, 4.5), (4, 6.0)] {
        check_places(&[places[frame].clone()], &[vec![[0.0, 1.0, z]]]).unwrap();
    }
}

/// The heading jumps by half a turn where a somersault passes the vertical; the figure does not.
#[test]
fn a_vertical_root_keeps_its_heading() {
    let mut a = walk(3, [0.0; 2], 20.0, 1.0, 0.0);
    for (frame, pitch) in [(0, 89.0), (1, 90.0), (2, 91.0)] {
        a.channels[[frame, 4]] = pitch;
    }
    assert_eq!(a.heading(1), None);
    let found = blend(&a, &a, &[0.3; 3]).unwrap();
    check_places(&places(&found), &places(&a)).unwrap();
}

#[test]
fn smoothstep_starts_and_ends_gently() {
    assert_eq!(smoothstep_weights(0), [0.0; 0]);
    assert_eq!(smoothstep_weights(1), [0.0]);
    assert_eq!(smoothstep_weights(5), [0.0, 0.15625, 0.5, 0.84375, 1.0]);
}

#[track_caller]
fn check_refused(a: &Motion, b: &Motion, expected: &str) {
    assert_eq!(blend(a, b, &[0.0]).unwrap_err().to_string(), expected);
    assert_eq!(a.concatenate(b, 1).unwrap_err().to_string(), expected);
    assert_eq!(a.append(b).unwrap_err().to_string(), expected);
}

#[test]
fn what_does_not_fit_is_refused_and_named() {
    let a = walk(2, [0.0; 2], 0.0, 1.0, 0.0);
    let with = |joints: Vec<Joint>, frame| {
        let skeleton = Skeleton::new(joints, frame).unwrap();
        let channels = Array2::zeros((2, skeleton.n_channels()));
        Motion::new(skeleton, channels, a.rate, a.unit).unwrap()
    };
    let root = || joint("root", root_channels());
    check_refused(
        &a,
        &with(vec![joint("Hips", root_channels())], OffsetFrame::Parent),
        "joint 0 is \"root\" in the first skeleton, \"Hips\" in the second",
    );
    check_refused(
        &a,
        &with(
            vec![joint("root", root_channels()[..4].to_vec())],
            OffsetFrame::Parent,
        ),
        "joint 0 (\"root\") has channels [Xposition Yposition Zposition Yrotation Xrotation Zrotation] \
         in the first skeleton, [Xposition Yposition Zposition Yrotation] in the second",
    );
    check_refused(
        &a,
        &with(vec![root(), joint("b", Vec::new())], OffsetFrame::Parent),
        "the first skeleton has 1 joints, the second 2",
    );
    let below = Joint {
        parent: Some(0),
        ..joint("b", Vec::new())
    };
    check_refused(
        &with(vec![root(), below], OffsetFrame::Parent),
        &with(vec![root(), joint("b", Vec::new())], OffsetFrame::Parent),
        "joint 1 (\"b\") hangs from joint 0 in the first skeleton, nothing in the second",
    );
    check_refused(
        &a,
        &with(vec![root()], OffsetFrame::Own),
        "offsets are in frame Parent in the first skeleton, Own in the second",
    );
    check_refused(
        &a,
        &Motion {
            up: UpAxis::Z,
            ..a.clone()
        },
        "Y is up in the first motion, Z in the second",
    );
    check_refused(
        &a,
        &Motion {
            rate: FrameRate::from_hz(30.0).unwrap(),
            ..a.clone()
        },
        "the first motion has 10 Hz, the second 30 Hz",
    );
    let up = SkeletonMismatch::Up {
        first: UpAxis::Y,
        second: UpAxis::Z,
    };
    assert_eq!(
        a.append(&Motion {
            up: UpAxis::Z,
            ..a.clone()
        }),
        Err(up.into())
    );

    let path = [(0.0, 0.0), (1.0, 1.5)];
    assert_eq!(
        blend_along(&a, &a, &path, &[0.5]),
        Err(BlendError::WeightCount {
            expected: 2,
            found: 1
        })
    );
    assert_eq!(
        blend_along(&a, &a, &path, &[0.5, 1.5]),
        Err(BlendError::Weight {
            frame: 1,
            weight: 1.5
        })
    );
    assert!(matches!(
        blend(&a, &a, &[f64::NAN]),
        Err(BlendError::Weight { frame: 0, .. })
    ));
    let position = BlendError::Position {
        frame: 1,
        position: (1.0, 1.5),
        first: 2,
        second: 2,
    };
    assert_eq!(blend_along(&a, &a, &path, &[0.5, 0.5]), Err(position));
    let mut upwards = a.clone();
    upwards.channels.column_mut(4).fill(90.0);
    for overlap in [0, 2] {
        assert_eq!(a.concatenate(&upwards, overlap), Err(BlendError::NoHeading));
    }
}

/// The same walk on another performer, in another unit.
#[test]
fn units_are_converted() {
    let (a, b) = (
        walk(4, [0.0; 2], 0.0, 1.0, 0.0),
        walk(4, [0.0; 2], 90.0, 1.0, 0.0),
    );
    let found = blend(&a, &b.in_unit(LengthUnit::CENTIMETRE), &[0.7; 4]).unwrap();
    check_places(&places(&found), &places(&a)).unwrap();
    let turned = a
        .concatenate(&b.in_unit(LengthUnit::CENTIMETRE), 1)
        .unwrap();
    check_places(&places(&turned), &places(&walk(7, [0.0; 2], 0.0, 1.0, 0.0))).unwrap();
    assert!((b.heading(0).unwrap() - FRAC_PI_2).abs() <= 1e-9);
}
