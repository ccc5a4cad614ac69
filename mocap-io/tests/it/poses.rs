//! Poses whose positions are known without calculation: right angles and unit bones.

use mocap_io::ndarray::Array3;
use mocap_io::{Motion, forward_kinematics, parse_amc, parse_asf, parse_bvh};

/// The sine of a right angle is off by 1e-16, positions are rounded to `f32`.
const RIGHT_ANGLE: f32 = 1e-6;

#[track_caller]
fn check(positions: &Array3<f32>, frame: usize, joint_idx: usize, expected: [f32; 3]) {
    for (axis, expected) in expected.into_iter().enumerate() {
        let found = positions[[frame, joint_idx, axis]];
        assert!(
            (found - expected).abs() <= RIGHT_ANGLE,
            "axis {axis}: {found} instead of {expected}"
        );
    }
}

/// A root with the given channels and a tip at `tip`, in metres.
fn bvh(channels: &str, tip: &str, rows: &str) -> Motion {
    let text = format!(
        "HIERARCHY\nROOT a\n{{\nOFFSET 0 0 0\nCHANNELS {channels}\nEnd Site\n{{\nOFFSET {tip}\n}}\n}}\n\
         MOTION\nFrames: 1\nFrame Time: 1\n{rows}\n"
    );
    parse_bvh(text.as_bytes())
        .unwrap()
        .with_unit(mocap_io::LengthUnit::METRE)
        .motion
}

#[test]
fn a_right_angle_turns_one_axis_into_the_next() {
    for (channel, tip, expected) in [
        ("1 Xrotation", "0 1 0", [0.0, 0.0, 1.0]),
        ("1 Yrotation", "0 0 1", [1.0, 0.0, 0.0]),
        ("1 Zrotation", "1 0 0", [0.0, 1.0, 0.0]),
        ("1 Zrotation", "0 1 0", [-1.0, 0.0, 0.0]),
    ] {
        check(
            &forward_kinematics(&bvh(channel, tip, "90")),
            0,
            1,
            expected,
        );
    }
}

#[test]
fn the_last_channel_is_applied_first() {
    // X to Y by the rotation about Z, then Y to Z by the one about X.
    check(
        &forward_kinematics(&bvh("2 Xrotation Zrotation", "1 0 0", "90 90")),
        0,
        1,
        [0.0, 0.0, 1.0],
    );
    // X stays X, then becomes Y.
    check(
        &forward_kinematics(&bvh("2 Zrotation Xrotation", "1 0 0", "90 90")),
        0,
        1,
        [0.0, 1.0, 0.0],
    );
}

#[test]
fn positions_replace_the_offset_and_do_not_turn_with_the_joint() {
    let text = "HIERARCHY ROOT a { OFFSET 7 7 7 CHANNELS 4 Xposition Yposition Zposition Zrotation
        JOINT b { OFFSET 5 5 5 CHANNELS 2 Yposition Zrotation
        End Site { OFFSET 1 0 0 } } }
        MOTION Frames: 2\nFrame Time: 1\n1 2 3 90 0 0\n1 2 3 90 10 90\n";
    let motion = parse_bvh(text.as_bytes())
        .unwrap()
        .with_unit(mocap_io::LengthUnit::METRE)
        .motion;
    let positions = forward_kinematics(&motion);
    check(&positions, 0, 0, [1.0, 2.0, 3.0]);
    // The offset (5, 0, 5) turned by 90° about Z is (0, 5, 5).
    check(&positions, 0, 1, [1.0, 7.0, 8.0]);
    check(&positions, 0, 2, [1.0, 8.0, 8.0]);
    // (5, 10, 5) becomes (-10, 5, 5); both turns together make X into -X.
    check(&positions, 1, 1, [-9.0, 7.0, 8.0]);
    check(&positions, 1, 2, [-10.0, 7.0, 8.0]);
}

/// A bone `a` of length 2 along X with the given axis and freedom, then a rigid bone `b` of length 1
/// along Y; the unit is an inch. Positions are in inches, of root, `a`, `b`.
fn acclaim(axis: &str, dof: &str, frame: &str) -> Array3<f32> {
    let skeleton = format!(
        ":root\norder TX TY TZ RX RY RZ\nposition 10 0 0\n:bonedata\n\
         begin\nname a\ndirection 3 0 0\nlength 2\naxis {axis}\ndof {dof}\nend\n\
         begin\nname b\ndirection 0 1 0\nlength 1\naxis 45 45 45 XYZ\nend\n:hierarchy\nroot a\na b\n"
    );
    let asf = parse_asf(skeleton.as_bytes()).unwrap();
    let mut motion = parse_amc(frame.as_bytes(), &asf).unwrap().motion;
    motion.unit = mocap_io::LengthUnit::METRE;
    forward_kinematics(&motion)
}

#[test]
fn an_acclaim_joint_is_the_end_of_its_bone_and_turns_it() {
    let positions = acclaim(
        "0 0 0 XYZ",
        "rz",
        "1\nroot 1 2 3 0 0 0\na 0\n2\nroot 0 0 0 0 0 0\na 90\n",
    );
    check(&positions, 0, 0, [11.0, 2.0, 3.0]);
    check(&positions, 0, 1, [13.0, 2.0, 3.0]);
    check(&positions, 0, 2, [13.0, 3.0, 3.0]);
    check(&positions, 1, 1, [10.0, 2.0, 0.0]);
    check(&positions, 1, 2, [9.0, 2.0, 0.0]);
}

#[test]
fn acclaim_angles_are_meant_in_the_axis_frame() {
    // The axis frame turns X into Y, so a turn about its own X is one about Y of the world.
    let positions = acclaim("0 0 90 XYZ", "rx", "1\nroot 0 0 0 0 0 0\na 90\n");
    check(&positions, 0, 1, [10.0, 0.0, -2.0]);
    check(&positions, 0, 2, [10.0, 1.0, -2.0]);
    // The axis frame applies X first, then Z: its own Z is Z turned by 90° about X, which is -Y, then
    // by 90° about Z, which is X. A bone along X stays.
    let positions = acclaim("90 0 90 XYZ", "rz", "1\nroot 0 0 0 0 0 0\na 90\n");
    check(&positions, 0, 1, [12.0, 0.0, 0.0]);
    check(&positions, 0, 2, [12.0, 0.0, 1.0]);
}

#[test]
fn acclaim_angles_are_applied_in_axis_order_whatever_the_order_of_the_dof() {
    // Rz·Rx: the rotation about X leaves the bone, the one about Z turns it to Y.
    for dof in ["rx rz", "rz rx"] {
        let positions = acclaim("0 0 0 XYZ", dof, "1\nroot 0 0 0 0 0 0\na 90 90\n");
        check(&positions, 0, 1, [10.0, 2.0, 0.0]);
        // Y to Z by the rotation about X; Z stays.
        check(&positions, 0, 2, [10.0, 2.0, 1.0]);
    }
    // Rx·Rz: X to Y, then to Z.
    let positions = acclaim("0 0 0 ZYX", "rx rz", "1\nroot 0 0 0 0 0 0\na 90 90\n");
    check(&positions, 0, 1, [10.0, 0.0, 2.0]);
}

#[test]
fn acclaim_bones_stretch_along_themselves_and_shift_along_their_axes() {
    let positions = acclaim("0 0 90 XYZ", "l", "1\nroot 0 0 0 0 0 0\na 3\n");
    check(&positions, 0, 1, [15.0, 0.0, 0.0]);
    // X of the axis frame is Y.
    let positions = acclaim("0 0 90 XYZ", "tx", "1\nroot 0 0 0 0 0 0\na 3\n");
    check(&positions, 0, 1, [12.0, 3.0, 0.0]);
    check(&positions, 0, 2, [12.0, 4.0, 0.0]);
}

#[test]
fn an_acclaim_root_turns_all_bones_about_its_place() {
    let positions = acclaim("0 0 0 XYZ", "rx", "1\nroot 0 0 0 0 0 180\na 0\n");
    check(&positions, 0, 0, [10.0, 0.0, 0.0]);
    check(&positions, 0, 1, [8.0, 0.0, 0.0]);
    check(&positions, 0, 2, [8.0, -1.0, 0.0]);
}
