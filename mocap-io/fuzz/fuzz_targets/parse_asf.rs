//! Arbitrary bytes as an ASF file. What is read has a rest pose, and reads back the same once written.

#![no_main]

use libfuzzer_sys::fuzz_target;
use mocap_io::ndarray::Array2;
use mocap_io::{
    Asf, FrameRate, Motion, forward_kinematics, guess_unit, parse_asf, write_asf, write_bvh,
};

fuzz_target!(|bytes: &[u8]| {
    let asf = match parse_asf(bytes) {
        Ok(asf) => asf,
        Err(error) => {
            assert!(error.at.byte() <= bytes.len() && !error.to_string().is_empty());
            return;
        }
    };
    assert!(guess_unit(&asf.skeleton).0.metres() > 0.0);
    let rest = Array2::zeros((1, asf.skeleton.n_channels()));
    let rate = FrameRate::from_hz(120.0).expect("120 is a rate");
    let motion =
        Motion::new(asf.skeleton.clone(), rest, rate, asf.unit).expect("one value per channel");
    assert_eq!(
        forward_kinematics(&motion).dim(),
        (1, asf.skeleton.joints().len(), 3)
    );
    let bvh = motion.to_parent_offsets();
    // BVH names cannot hold a brace.
    if !asf.skeleton.names().any(|name| name.contains('{')) {
        write_bvh(&bvh, &mut Vec::new()).expect("rest poses can be written");
    }
    if !can_be_written(&asf) {
        return;
    }
    let mut text = Vec::new();
    write_asf(&asf, &mut text).expect("what is read can be written");
    let again = parse_asf(&text).expect("what is written can be read");
    assert_eq!((again.name, again.warnings), (asf.name, vec![]));
    let pairs = again.skeleton.joints().iter().zip(asf.skeleton.joints());
    assert_eq!(again.skeleton.joints().len(), asf.skeleton.joints().len());
    for (again, joint) in pairs {
        assert_eq!((&again.name, again.parent), (&joint.name, joint.parent));
        assert_eq!((&again.channels, again.axis), (&joint.channels, joint.axis));
    }
});

/// Names that stand at the start of a line once written must not look like something else there, and
/// lengths must not leave the range of a double when they are squared.
fn can_be_written(asf: &Asf) -> bool {
    let mut joints = asf.skeleton.joints().iter();
    joints.all(|joint| {
        let squares: f64 = joint.offset.iter().map(|v| v * v).sum();
        let is_zero = joint.offset.iter().all(|&v| v == 0.0);
        !joint.name.starts_with(['#', ':'])
            && (is_zero || (squares.is_normal() && squares.sqrt().is_normal()))
    })
}
