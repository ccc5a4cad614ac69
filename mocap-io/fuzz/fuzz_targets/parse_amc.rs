//! Arbitrary bytes as an AMC file: of a fixed skeleton if the first byte is even, else of the skeleton
//! that stands before the first zero byte. What is read has positions, and reads back the same once
//! written.

#![no_main]

use libfuzzer_sys::fuzz_target;
use mocap_io::{Asf, Motion, forward_kinematics, parse_amc, parse_asf, write_amc};

const SKELETON: &[u8] = b":root\norder TX TY TZ RX RY RZ\n:bonedata\n\
    begin\nname a\ndirection 0 1 0\nlength 1\naxis 0 0 20 XYZ\ndof rx rz\nend\n\
    begin\nname ab\ndirection 1 0 0\nlength 1\ndof l tx rz\nend\n\
    begin\nname c\ndirection 1 0 0\nlength 1\nend\n:hierarchy\nroot a c\na ab\n";

/// Rows are dense however few bones a frame names, so large skeletons make small files large.
const MAX_CHANNELS: usize = 64;

fuzz_target!(|bytes: &[u8]| {
    let Some((&first, rest)) = bytes.split_first() else {
        return;
    };
    let (skeleton, motion) = match rest.iter().position(|&b| b == 0) {
        Some(at) if first % 2 == 1 => (&rest[..at], &rest[at + 1..]),
        _ => (SKELETON, rest),
    };
    if let Ok(asf) = parse_asf(skeleton) {
        if asf.skeleton.n_channels() <= MAX_CHANNELS {
            try_motion(motion, &asf);
        }
    }
});

fn try_motion(bytes: &[u8], asf: &Asf) {
    let amc = match parse_amc(bytes, asf) {
        Ok(amc) => amc,
        Err(error) => {
            assert!(error.at.byte() <= bytes.len() && !error.to_string().is_empty());
            return;
        }
    };
    let motion = amc.motion;
    let n_joints = motion.skeleton.joints().len();
    let shape = (motion.n_frames(), n_joints, 3);
    assert_eq!(forward_kinematics(&motion).dim(), shape);
    assert_eq!(
        forward_kinematics(&motion.to_parent_offsets()).dim().0,
        shape.0
    );
    // A leaf may have a name that means something else at the start of a line.
    if motion
        .skeleton
        .names()
        .any(|name| name.starts_with(['#', ':']))
    {
        return;
    }
    let mut text = Vec::new();
    write_amc(&motion, &mut text).expect("what is read can be written");
    let again = parse_amc(&text, asf).expect("what is written can be read");
    assert_eq!(bits(&again.motion), bits(&motion));
    assert_eq!(
        (again.motion.n_frames(), again.motion.rate),
        (motion.n_frames(), motion.rate)
    );
}

/// The values with the signs of their zeros.
fn bits(motion: &Motion) -> Vec<u64> {
    motion.channels.iter().map(|v| v.to_bits()).collect()
}
