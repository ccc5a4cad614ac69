//! Arbitrary bytes as a BVH file. What is read has positions, and reads back the same once written.

#![no_main]

use libfuzzer_sys::fuzz_target;
use mocap_io::{
    Motion, RateSource, WarningKind, forward_kinematics, guess_unit, parse_bvh, write_bvh,
};

fuzz_target!(|bytes: &[u8]| {
    let bvh = match parse_bvh(bytes) {
        Ok(bvh) => bvh,
        Err(error) => {
            assert!(error.at.byte() <= bytes.len() && !error.to_string().is_empty());
            return;
        }
    };
    let mut motion = bvh.motion;
    let n_joints = motion.skeleton.joints().len();
    assert_eq!(
        forward_kinematics(&motion).dim(),
        (motion.n_frames(), n_joints, 3)
    );
    assert_eq!(
        guess_unit(&motion.skeleton),
        (motion.unit, motion.unit_source)
    );
    assert_eq!(motion.slice(0..motion.n_frames()).as_ref(), Some(&motion));
    let mut text = Vec::new();
    write_bvh(&motion, &mut text).expect("what is read can be written");
    let again = parse_bvh(&text).expect("what is written can be read");
    // Two joints may have one name; whatever else was odd is not written.
    let is_name = |kind: &WarningKind| matches!(kind, WarningKind::DuplicateName { .. });
    assert!(again.warnings.iter().all(|w| is_name(&w.kind)));
    assert_eq!(bits(&again.motion), bits(&motion));
    // A rate that was assumed stands in the file now.
    motion.rate_source = RateSource::File;
    assert_eq!(again.motion, motion);
});

/// The values with the signs of their zeros.
fn bits(motion: &Motion) -> Vec<u64> {
    motion.channels.iter().map(|v| v.to_bits()).collect()
}
