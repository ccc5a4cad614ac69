//! Laws over random skeletons and motions.

use mocap_io::{
    Bvh, FrameRate, Motion, OffsetFrame, forward_kinematics, parse_amc, parse_asf, parse_bvh,
    write_amc, write_asf, write_bvh,
};
use proptest::prelude::*;

use crate::naive;
use crate::strategies::{Freedom, angle, any_way_up, asf_of, motion, skeleton};

/// Positions are rounded to `f32` once, and stay below some ten metres plus the translations.
const POSITION_RELATIVE: f64 = 1e-6;

/// A direction, its length and their product are rounded: a few units of the last place.
const OFFSET_RELATIVE: f64 = 8.0 * f64::EPSILON;

/// Near a gimbal lock an arc sine turns a rounding error of 1e-16 into one of 1e-8 rad; there are
/// at most nine bones of two metres.
const CONVERTED_METRES: f32 = 1e-5;

fn values() -> impl Strategy<Value = f64> + Clone {
    prop_oneof![3 => -400.0..400.0, 1 => -1.0..1.0, 1 => Just(90.0)].boxed()
}

/// Any number that is one.
fn any_values() -> impl Strategy<Value = f64> + Clone {
    use proptest::num::f64::{NEGATIVE, NORMAL, POSITIVE, SUBNORMAL, ZERO};
    prop_oneof![
        POSITIVE | NEGATIVE | NORMAL | SUBNORMAL | ZERO,
        -400.0..400.0
    ]
    .boxed()
}

fn check_against_naive(motion: &Motion) -> Result<(), TestCaseError> {
    let found = forward_kinematics(motion);
    let expected = naive::positions(motion);
    prop_assert_eq!(
        found.dim(),
        (motion.n_frames(), motion.skeleton.joints().len(), 3)
    );
    for (frame, pose) in expected.iter().enumerate() {
        for (joint_idx, position) in pose.iter().enumerate() {
            for (axis, &expected) in position.iter().enumerate() {
                let found = f64::from(found[[frame, joint_idx, axis]]);
                let largest = position.iter().fold(1.0f64, |m, v| m.max(v.abs()));
                // Translations up to 400 units cancel on the way down the chain.
                let tolerance = POSITION_RELATIVE * (largest + 400.0 * motion.unit.metres());
                prop_assert!(
                    (found - expected).abs() <= tolerance,
                    "frame {frame}, joint {joint_idx}, axis {axis}: {found} against {expected}"
                );
            }
        }
    }
    Ok(())
}

fn bits(motion: &Motion) -> Vec<u64> {
    motion.channels.iter().map(|v| v.to_bits()).collect()
}

fn written(motion: &Motion) -> Bvh {
    let mut text = Vec::new();
    write_bvh(motion, &mut text).unwrap();
    parse_bvh(&text).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn bvh_kinematics_match_naive(
        motion in any_way_up(motion(skeleton(OffsetFrame::Parent, Freedom::of_bvh()), values(), 3))
    ) {
        check_against_naive(&motion)?;
    }

    #[test]
    fn acclaim_kinematics_match_naive(
        motion in any_way_up(motion(skeleton(OffsetFrame::Own, Freedom::of_acclaim()), values(), 3))
    ) {
        check_against_naive(&motion)?;
    }

    #[test]
    fn a_written_bvh_reads_back_to_the_bit(
        motion in motion(skeleton(OffsetFrame::Parent, Freedom::of_bvh()), any_values(), 3)
    ) {
        let Bvh { motion: again, warnings } = written(&motion);
        prop_assert_eq!(&again.skeleton, &motion.skeleton);
        prop_assert_eq!(again.rate, motion.rate);
        if motion.skeleton.n_channels() > 0 {
            prop_assert_eq!(warnings, []);
            prop_assert_eq!(again.n_frames(), motion.n_frames());
            prop_assert_eq!(bits(&again), bits(&motion));
        }
    }

    #[test]
    fn a_written_asf_reads_back(skeleton in skeleton(OffsetFrame::Own, Freedom::of_acclaim()), cmu in any::<bool>()) {
        let unit = if cmu { mocap_io::LengthUnit::ACCLAIM_CMU } else { mocap_io::LengthUnit::METRE };
        let asf = asf_of(&skeleton, unit);
        let mut text = Vec::new();
        write_asf(&asf, &mut text).unwrap();
        let again = parse_asf(&text).unwrap();
        prop_assert_eq!((&again.name, again.angle_unit), (&asf.name, asf.angle_unit));
        prop_assert_eq!(&again.warnings, &[]);
        prop_assert!((again.unit.metres() / unit.metres() - 1.0).abs() <= OFFSET_RELATIVE);
        prop_assert_eq!(again.skeleton.joints().len(), skeleton.joints().len());
        for (again, joint) in again.skeleton.joints().iter().zip(skeleton.joints()) {
            prop_assert_eq!((&again.name, again.parent, &again.channels), (&joint.name, joint.parent, &joint.channels));
            prop_assert_eq!(again.axis, joint.axis);
            let length = joint.offset.iter().map(|v| v * v).sum::<f64>().sqrt();
            for i in 0..3 {
                prop_assert!((again.offset[i] - joint.offset[i]).abs() <= OFFSET_RELATIVE * length);
            }
        }
    }

    #[test]
    fn a_written_amc_reads_back_to_the_bit(
        motion in motion(skeleton(OffsetFrame::Own, Freedom::of_acclaim()), any_values(), 3)
    ) {
        let asf = asf_of(&motion.skeleton, motion.unit);
        let mut text = Vec::new();
        write_amc(&motion, &mut text).unwrap();
        let again = parse_amc(&text, &asf).unwrap();
        prop_assert_eq!(again.warnings, []);
        prop_assert_eq!(again.first_frame_number, (motion.n_frames() > 0).then_some(1));
        let again = again.motion;
        prop_assert_eq!((again.n_frames(), again.rate, again.unit), (motion.n_frames(), motion.rate, motion.unit));
        prop_assert_eq!(bits(&again), bits(&motion));
    }

    #[test]
    fn converted_offsets_keep_every_bone_end(
        motion in motion(skeleton(OffsetFrame::Own, Freedom::of_turning_bones()), angle().boxed(), 3)
    ) {
        let motion = Motion { unit: mocap_io::LengthUnit::METRE, ..motion };
        let converted = motion.to_parent_offsets();
        prop_assert_eq!(converted.skeleton.offset_frame(), OffsetFrame::Parent);
        prop_assert_eq!(&converted.to_parent_offsets(), &converted);
        prop_assert_eq!((converted.rate, converted.unit), (motion.rate, motion.unit));
        let (before, after) = (forward_kinematics(&motion), forward_kinematics(&converted));
        let joints = converted.skeleton.joints();
        for (bone_idx, bone) in motion.skeleton.joints().iter().enumerate() {
            let joint_idx = converted.skeleton.find(&bone.name).unwrap();
            let child = joints.iter().position(|j| j.parent == Some(joint_idx)).unwrap();
            for place in if bone.parent.is_none() { vec![joint_idx, child] } else { vec![child] } {
                for frame in 0..motion.n_frames() {
                    for axis in 0..3 {
                        let (a, b) = (before[[frame, bone_idx, axis]], after[[frame, place, axis]]);
                        prop_assert!((a - b).abs() <= CONVERTED_METRES * (1.0 + a.abs()), "{a} against {b}");
                    }
                }
            }
        }
        let again = written(&converted).motion;
        prop_assert_eq!(&again.skeleton, &converted.skeleton);
        prop_assert_eq!(bits(&again), bits(&converted));
    }

    #[test]
    fn a_slice_has_the_frames_of_its_span(
        motion in motion(skeleton(OffsetFrame::Parent, Freedom::of_bvh()), values(), 6),
        start in 0usize..8,
        end in 0usize..8,
    ) {
        match motion.slice(start..end) {
            None => prop_assert!(start > end || end > motion.n_frames()),
            Some(part) => {
                prop_assert_eq!(part.n_frames(), end - start);
                prop_assert_eq!(&part.skeleton, &motion.skeleton);
                prop_assert_eq!((part.rate, part.unit), (motion.rate, motion.unit));
                for frame in start..end {
                    prop_assert_eq!(part.channels.row(frame - start), motion.channels.row(frame));
                }
            }
        }
    }

    #[test]
    fn rates_are_positive_and_finite(hz in proptest::num::f64::ANY) {
        let is_rate = hz > 0.0 && hz < f64::INFINITY && 1.0 / hz < f64::INFINITY;
        prop_assert_eq!(FrameRate::from_hz(hz).map(FrameRate::hz), is_rate.then_some(hz));
        if let Some(rate) = FrameRate::from_frame_time(hz) {
            prop_assert!(rate.hz() > 0.0 && rate.hz().is_finite() && rate.frame_time().is_finite());
        }
    }

    #[test]
    fn a_written_rate_reads_back(
        seconds in prop_oneof![
            1e-4..10.0,
            (1u32..2000).prop_map(|n| f64::from(n) / 1000.0),
            (1u32..2000).prop_map(|n| 1.0 / f64::from(n)),
            (-300i32..300).prop_map(|n| 10f64.powi(n)),
        ],
        hz in prop_oneof![0.1..2000.0, (1u32..8000).prop_map(|n| f64::from(n) / 4.0)],
        whole in (1u32..1_000_000_000).prop_map(f64::from),
    ) {
        // What was read once reads back to the bit, and so does every whole number.
        let rate = read_back(FrameRate::from_frame_time(seconds).unwrap());
        prop_assert_eq!(read_back(rate), rate);
        prop_assert_eq!(read_back(FrameRate::from_hz(whole).unwrap()).hz(), whole);
        // Not every rate is the reciprocal of a number; the nearest is one unit of the last place off.
        for hz in [hz, 1.0 / seconds] {
            let again = read_back(FrameRate::from_hz(hz).unwrap()).hz();
            prop_assert!((again / hz - 1.0).abs() <= f64::EPSILON, "{} became {}", hz, again);
        }
    }
}

/// The rate of a file that was written with `rate`.
fn read_back(rate: FrameRate) -> FrameRate {
    let joint = mocap_io::Joint {
        name: "a".to_owned(),
        parent: None,
        offset: [0.0; 3],
        channels: Vec::new(),
        axis: None,
        end_site: false,
    };
    let skeleton = mocap_io::Skeleton::new(vec![joint], OffsetFrame::Parent).unwrap();
    let none = mocap_io::ndarray::Array2::zeros((0, 0));
    let motion = Motion::new(skeleton, none, rate, mocap_io::LengthUnit::METRE).unwrap();
    written(&motion).motion.rate
}
