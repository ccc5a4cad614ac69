//! BVH skeletons with the offsets of Acclaim.

use mocap_io::{
    AngleUnit, Asf, Joint, LengthUnit, Motion, OffsetFrame, SeveralRoots, Skeleton,
    forward_kinematics, parse_amc, parse_asf, write_amc, write_asf,
};
use proptest::prelude::*;
use proptest::sample::select;

use crate::ops::{any_motion, any_value, check_places, places};
use crate::strategies::{Freedom, motion, rotations, skeleton};

/// Directions, lengths and their products are rounded, nine bones in a row; positions to `f32`.
const WRITTEN_METRES: f32 = 1e-4;

/// What a writer and a reader of Acclaim files make of a motion.
pub(crate) fn through_asf_and_amc(motion: &Motion) -> Motion {
    let asf = Asf {
        name: "converted".to_owned(),
        skeleton: motion.skeleton.clone(),
        unit: motion.unit,
        angle_unit: AngleUnit::Degrees,
        warnings: Vec::new(),
    };
    let (mut skeleton, mut frames) = (Vec::new(), Vec::new());
    write_asf(&asf, &mut skeleton).unwrap();
    write_amc(motion, &mut frames).unwrap();
    let asf = parse_asf(&skeleton).unwrap();
    let amc = parse_amc(&frames, &asf).unwrap();
    assert_eq!((asf.warnings, amc.warnings), (Vec::new(), Vec::new()));
    amc.motion
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn own_offsets_keep_every_joint(motion in any_motion(any_value(), 3)) {
        let own = motion.to_own_offsets().unwrap();
        prop_assert_eq!(own.skeleton.offset_frame(), OffsetFrame::Own);
        prop_assert_eq!((own.rate, own.unit, own.up), (motion.rate, motion.unit, motion.up));
        check_places(&places(&own), &places(&motion))?;
        let parents = |m: &Motion| -> Vec<Option<usize>> { m.skeleton.joints().iter().map(|j| j.parent).collect() };
        prop_assert_eq!(parents(&own), parents(&motion));
        prop_assert_eq!(own.to_own_offsets().unwrap(), own);
    }

    #[test]
    fn own_offsets_can_be_written_whatever_the_names(
        motion in motion(skeleton(OffsetFrame::Parent, Freedom::of_bvh()), -400.0..400.0, 3),
        names in proptest::collection::vec(select(vec!["root", "a b", "a_b", "", "12", "1e5", "nan", "END", "#", ":x", "a\u{a0}b", "Hips:Hips"]), 10),
    ) {
        if motion.n_frames() == 0 {
            return Ok(());
        }
        let named = |(joint, name): (&Joint, &&str)| Joint { name: (*name).to_owned(), ..joint.clone() };
        let joints = motion.skeleton.joints().iter().zip(&names).map(named).collect();
        let skeleton = Skeleton::new(joints, OffsetFrame::Parent).unwrap();
        let motion = Motion { skeleton, unit: LengthUnit::CENTIMETRE, ..motion };
        let own = motion.to_own_offsets().unwrap();
        let again = through_asf_and_amc(&own);
        let (a, b) = (forward_kinematics(&motion), forward_kinematics(&again));
        prop_assert_eq!(a.dim(), b.dim());
        for (j, name) in own.skeleton.names().enumerate() {
            // Siblings may come back in another order.
            let k = again.skeleton.find(name).unwrap();
            for frame in 0..motion.n_frames() {
                for axis in 0..3 {
                    prop_assert!((a[[frame, j, axis]] - b[[frame, k, axis]]).abs() <= WRITTEN_METRES);
                }
            }
        }
        for (new, old) in own.skeleton.names().zip(&names).skip(1) {
            prop_assert!(*old != "Hips:Hips" || new.starts_with(old));
        }
    }

    #[test]
    fn there_and_back_every_joint_is_a_bone_end(
        motion in motion(skeleton(OffsetFrame::Parent, Freedom { root: rotations(), joint: rotations() }), any_value(), 3)
    ) {
        let own = motion.to_own_offsets().unwrap();
        let back = own.to_parent_offsets();
        let (expected, found) = (places(&motion), places(&back));
        for (j, name) in own.skeleton.names().enumerate() {
            let start = back.skeleton.find(name).unwrap();
            let end = back.skeleton.joints().iter().position(|c| c.parent == Some(start)).unwrap();
            for (expected, found) in expected.iter().zip(&found) {
                check_places(&[vec![found[end]]], &[vec![expected[j]]])?;
            }
        }
    }
}

#[test]
fn several_roots_are_refused() {
    let joint = |name: &str| Joint {
        name: name.to_owned(),
        parent: None,
        offset: [0.0; 3],
        channels: Vec::new(),
        axis: None,
        end_site: false,
    };
    let skeleton = Skeleton::new(vec![joint("a"), joint("b")], OffsetFrame::Parent).unwrap();
    let none = mocap_io::ndarray::Array2::zeros((1, 0));
    let rate = mocap_io::FrameRate::from_hz(1.0).unwrap();
    let motion = Motion::new(skeleton, none, rate, LengthUnit::METRE).unwrap();
    let error = SeveralRoots {
        joint_idx: 1,
        name: "b".to_owned(),
    };
    assert_eq!(motion.to_own_offsets().unwrap_err(), error);
}
