//! Writes a motion as GLB.
//!
//! `glb FILE.bvh OUT.glb`, `glb FILE.asf FILE.amc OUT.glb`; with `--points` at the end the joints alone, as
//! markers. Without arguments a deep bow is written to memory.

use std::error::Error;
use std::fs;

use mocap_io::{
    Motion, forward_kinematics, parse_amc, parse_asf, parse_bvh, write_glb, write_glb_points,
};

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
Frames: 3
Frame Time: 0.5
0 0 0 0 0 0 0
0 0 0 0 0 0 90
0 0 0 0 0 0 0
";

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments: Vec<String> = std::env::args().skip(1).collect();
    let is_points = arguments.pop_if(|last| last == "--points").is_some();
    let out = arguments.pop();
    let motion = match arguments.as_slice() {
        [] => parse_bvh(BOW.as_bytes())?.motion,
        [bvh] => parse_bvh(&fs::read(bvh)?)?.motion,
        [asf, amc, ..] => {
            let asf = parse_asf(&fs::read(asf)?)?;
            parse_amc(&fs::read(amc)?, &asf)?.motion
        }
    };
    let bytes = written(&motion, is_points)?;
    let (n_frames, n_joints) = (motion.n_frames(), motion.skeleton.joints().len());
    println!(
        "{n_frames} frames of {n_joints} joints: {} bytes",
        bytes.len()
    );
    if let Some(out) = out {
        fs::write(out, bytes)?;
    }
    Ok(())
}

fn written(motion: &Motion, is_points: bool) -> Result<Vec<u8>, Box<dyn Error>> {
    let mut bytes = Vec::new();
    if is_points {
        let names: Vec<&str> = motion.skeleton.names().collect();
        let positions = forward_kinematics(motion);
        write_glb_points(&names, positions.view(), motion.rate, &mut bytes)?;
    } else {
        write_glb(motion, &mut bytes)?;
    }
    Ok(bytes)
}
