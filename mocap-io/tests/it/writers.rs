//! What cannot be written is refused: a file that no reader takes helps nobody.

use mocap_io::ndarray::Array2;
use mocap_io::{
    Axis, AxisFrame, Channel, FrameRate, Joint, LengthUnit, Motion, OffsetFrame, Skeleton,
    SkeletonError, write_amc, write_asf, write_bvh,
};

use crate::strategies::asf_of;

fn joint(name: &str, parent: Option<usize>) -> Joint {
    Joint {
        name: name.to_owned(),
        parent,
        offset: [0.0, 1.0, 0.0],
        channels: Vec::new(),
        axis: None,
        end_site: false,
    }
}

fn motion(joints: Vec<Joint>, frame: OffsetFrame, value: f64) -> Motion {
    let skeleton = Skeleton::new(joints, frame).unwrap();
    let channels = Array2::from_elem((2, skeleton.n_channels()), value);
    let rate = FrameRate::from_hz(30.0).unwrap();
    Motion::new(skeleton, channels, rate, LengthUnit::METRE).unwrap()
}

#[track_caller]
fn check_bvh(joints: Vec<Joint>, expected: &str) {
    let motion = motion(joints, OffsetFrame::Parent, 0.0);
    assert_eq!(
        write_bvh(&motion, Vec::new()).unwrap_err().to_string(),
        expected
    );
}

#[test]
fn bvh_refuses_what_it_cannot_hold() {
    for name in ["", "a\nb", "a{", " a", "a\t"] {
        check_bvh(
            vec![joint(name, None)],
            &format!("joint {name:?}: a name that BVH cannot hold"),
        );
    }
    check_bvh(
        Vec::new(),
        "expected a skeleton with non-empty offsets; convert it first",
    );
    let twice = vec![Channel::Rotation(Axis::X); 2];
    check_bvh(
        vec![Joint {
            channels: twice,
            ..joint("a", None)
        }],
        "joint \"a\": a channel that appears twice",
    );
    check_bvh(
        vec![Joint {
            channels: vec![Channel::Length],
            ..joint("a", None)
        }],
        "joint \"a\": a length channel",
    );
    check_bvh(
        vec![Joint {
            axis: Some(AxisFrame::xyz([0.0; 3])),
            ..joint("a", None)
        }],
        "joint \"a\": an axis frame",
    );
    let tip = |parent| Joint {
        end_site: true,
        ..joint("t", parent)
    };
    check_bvh(
        vec![tip(None)],
        "joint \"t\": an End Site without parent or with channels",
    );
    check_bvh(
        vec![joint("a", None), tip(Some(0)), joint("b", Some(1))],
        "joint \"b\": its parent is an End Site",
    );
    check_bvh(
        vec![
            joint("a", None),
            joint("b", Some(0)),
            joint("c", Some(0)),
            joint("d", Some(1)),
        ],
        "joint \"d\": its parent's children do not stand together",
    );
    let acclaim = motion(vec![joint("root", None)], OffsetFrame::Own, 0.0);
    let error = write_bvh(&acclaim, Vec::new()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "expected a skeleton with BVH offsets; convert it first"
    );
}

#[track_caller]
fn check_asf(joints: Vec<Joint>, expected: &str) {
    let skeleton = Skeleton::new(joints, OffsetFrame::Own).unwrap();
    let error = write_asf(&asf_of(&skeleton, LengthUnit::INCH), Vec::new()).unwrap_err();
    assert_eq!(error.to_string(), expected);
}

#[test]
fn asf_refuses_what_it_cannot_hold() {
    for name in ["", "a b", "begin", "end", "#a", ":a", "a\n"] {
        check_asf(
            vec![joint("root", None), joint(name, Some(0))],
            &format!("joint {name:?}: a name that Acclaim files cannot hold"),
        );
    }
    check_asf(
        vec![joint("hips", None), joint("a", Some(0))],
        "joint \"hips\": the root of an ASF file is called root",
    );
    check_asf(
        vec![joint("root", None)],
        "joint \"root\": a root without bones",
    );
    check_asf(
        vec![joint("root", None), joint("b", None)],
        "joint \"b\": a second root",
    );
    check_asf(
        Vec::new(),
        "expected a skeleton with non-empty offsets; convert it first",
    );
    let twice = Joint {
        channels: vec![Channel::Length; 2],
        ..joint("a", Some(0))
    };
    check_asf(
        vec![joint("root", None), twice],
        "joint \"a\": a degree of freedom that appears twice",
    );
    let skeleton = Skeleton::new(vec![joint("a", None)], OffsetFrame::Parent).unwrap();
    let error = write_asf(&asf_of(&skeleton, LengthUnit::INCH), Vec::new()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "expected a skeleton with Acclaim offsets; convert it first"
    );
}

#[test]
fn numbers_that_are_not_finite_are_refused() {
    let joints = || {
        let turning = |name, parent| Joint {
            channels: vec![Channel::Rotation(Axis::X)],
            ..joint(name, parent)
        };
        vec![
            turning("root", None),
            joint("rigid", Some(0)),
            turning("a", Some(1)),
        ]
    };
    let expected = |value| format!("joint \"a\", frame 1: expected finite values, found {value}");
    for value in [f64::NAN, f64::INFINITY] {
        let mut bvh = motion(joints(), OffsetFrame::Parent, 0.0);
        bvh.channels[[1, 1]] = value;
        assert_eq!(
            write_bvh(&bvh, Vec::new()).unwrap_err().to_string(),
            expected(value)
        );
        let mut amc = motion(joints(), OffsetFrame::Own, 0.0);
        amc.channels[[1, 1]] = value;
        assert_eq!(
            write_amc(&amc, Vec::new()).unwrap_err().to_string(),
            expected(value)
        );
    }
}

#[test]
fn amc_refuses_what_it_cannot_hold() {
    let bvh = motion(vec![joint("root", None)], OffsetFrame::Parent, 0.0);
    let error = write_amc(&bvh, Vec::new()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "expected a skeleton with Acclaim offsets; convert it first"
    );
    let named = motion(
        vec![joint("root", None), joint("a b", Some(0))],
        OffsetFrame::Own,
        0.0,
    );
    let error = write_amc(&named, Vec::new()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "joint \"a b\": a name that Acclaim files cannot hold"
    );
}

/// A sink that is full.
struct Full;

impl std::io::Write for Full {
    fn write(&mut self, _: &[u8]) -> std::io::Result<usize> {
        Err(std::io::Error::other("full"))
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_failing_sink_is_an_error() {
    let bvh = motion(vec![joint("a", None)], OffsetFrame::Parent, 0.0);
    assert_eq!(write_bvh(&bvh, Full).unwrap_err().to_string(), "full");
    let amc = motion(
        vec![joint("root", None), joint("a", Some(0))],
        OffsetFrame::Own,
        0.0,
    );
    assert_eq!(write_amc(&amc, Full).unwrap_err().to_string(), "full");
    assert_eq!(
        write_asf(&asf_of(&amc.skeleton, amc.unit), Full)
            .unwrap_err()
            .to_string(),
        "full"
    );
}

#[test]
fn skeletons_and_motions_are_consistent() {
    let order = Skeleton::new(vec![joint("a", Some(0))], OffsetFrame::Parent);
    assert_eq!(
        order,
        Err(SkeletonError::ParentOrder {
            joint_idx: 0,
            parent_idx: 0
        })
    );
    let nan = Joint {
        offset: [f64::NAN; 3],
        ..joint("a", None)
    };
    assert_eq!(
        Skeleton::new(vec![nan], OffsetFrame::Own),
        Err(SkeletonError::NotFinite { joint_idx: 0 })
    );
    let skeleton = Skeleton::new(vec![joint("a", None)], OffsetFrame::Own).unwrap();
    let rate = FrameRate::from_hz(30.0).unwrap();
    let error = Motion::new(skeleton, Array2::zeros((1, 2)), rate, LengthUnit::METRE).unwrap_err();
    assert_eq!(error.to_string(), "expected 0 channels per frame, found 2");
}

#[test]
fn a_motion_whose_channels_were_taken_away_has_missing_positions_and_is_not_written() {
    let mut joints = vec![joint("root", None), joint("tip", Some(0))];
    joints[0].channels = Axis::ALL.map(Channel::Rotation).to_vec();
    for frame in [OffsetFrame::Parent, OffsetFrame::Own] {
        let mut broken = motion(joints.clone(), frame, 0.0);
        broken.channels = Array2::zeros((2, 1));
        let positions = mocap_io::forward_kinematics(&broken);
        assert_eq!(positions.dim(), (2, 2, 3));
        assert!(positions[[1, 1, 1]].is_nan(), "{frame:?}");
        assert_eq!(broken.to_parent_offsets().n_frames(), 2);
        assert!(write_bvh(&broken, Vec::new()).is_err());
        assert!(write_amc(&broken, Vec::new()).is_err());

        // One column too many changes nothing.
        let mut wide = motion(joints.clone(), frame, 0.0);
        let expected = mocap_io::forward_kinematics(&wide);
        wide.channels = Array2::zeros((2, 9));
        assert_eq!(mocap_io::forward_kinematics(&wide), expected);
    }
}
