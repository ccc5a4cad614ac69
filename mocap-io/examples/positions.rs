//! What is in a motion file: joints, rate, unit, and where everything is in the first frame.
//!
//! `positions FILE.bvh`, `positions FILE.asf FILE.amc`, or without arguments a deep bow.

use std::error::Error;
use std::fs;

use mocap_io::{Motion, Warning, forward_kinematics, parse_amc, parse_asf, parse_bvh};

const BOW: &str = "HIERARCHY
ROOT Feet
{
    OFFSET 0 0 0
    CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
    JOINT Hips
    {
        OFFSET 0 95 0
        CHANNELS 1 Xrotation
        End Site { OFFSET 0 80 0 }
    }
}
MOTION
Frames: 1
Frame Time: 0.033333
0 0 0 0 0 0 90
";

fn main() -> Result<(), Box<dyn Error>> {
    let paths: Vec<String> = std::env::args().skip(1).collect();
    let (motion, warnings) = match paths.as_slice() {
        [] => read_bvh(BOW.as_bytes())?,
        [bvh] => read_bvh(&fs::read(bvh)?)?,
        [asf, amc, ..] => {
            let asf = parse_asf(&fs::read(asf)?)?;
            let amc = parse_amc(&fs::read(amc)?, &asf)?;
            (amc.motion, [asf.warnings, amc.warnings].concat())
        }
    };
    for warning in warnings {
        println!("warning: {warning}");
    }
    let (n_frames, rate, seconds) = (motion.n_frames(), motion.rate.hz(), motion.duration());
    println!(
        "{n_frames} frames at {rate} Hz ({:?}), {seconds:.2} s",
        motion.rate_source
    );
    println!("unit {} ({:?})", motion.unit, motion.unit_source);
    let positions = forward_kinematics(&motion);
    for (joint_idx, name) in motion.skeleton.names().enumerate().filter(|_| n_frames > 0) {
        let at: Vec<f32> = (0..3).map(|axis| positions[[0, joint_idx, axis]]).collect();
        println!("{name:>20} {:8.3} {:8.3} {:8.3} m", at[0], at[1], at[2]);
    }
    Ok(())
}

fn read_bvh(bytes: &[u8]) -> Result<(Motion, Vec<Warning>), Box<dyn Error>> {
    let bvh = parse_bvh(bytes)?;
    Ok((bvh.motion, bvh.warnings))
}
