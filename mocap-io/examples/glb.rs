//! Writes a motion as GLB, which browsers and modelling programs open.
//!
//! `glb FILE.bvh OUT.glb`, `glb FILE.asf FILE.amc OUT.glb`, or without a file to read a deep bow; `--up AXIS`
//! in front overrules the axis that points up. `glb --markers OUT.glb` writes two markers, one of which
//! is covered for a while. Without arguments nothing is kept.

use std::error::Error;
use std::f32::consts::TAU;
use std::fs;

use mocap_io::ndarray::Array3;
use mocap_io::{FrameRate, UpAxis, parse_amc, parse_asf, parse_bvh, write_glb, write_glb_points};

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
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let mut arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let out = arguments.pop();
    let bytes = match arguments.as_slice() {
        ["--markers"] => markers()?,
        ["--up", axis, files @ ..] => motion(files, UpAxis::from_name(axis))?,
        files => motion(files, None)?,
    };
    println!("{} bytes", bytes.len());
    if let Some(out) = out {
        fs::write(out, bytes)?;
    }
    Ok(())
}

fn motion(files: &[&str], up: Option<UpAxis>) -> Result<Vec<u8>, Box<dyn Error>> {
    let mut motion = match files {
        [] => parse_bvh(BOW.as_bytes())?.motion,
        [bvh] => parse_bvh(&fs::read(bvh)?)?.motion,
        [asf, amc, ..] => {
            let asf = parse_asf(&fs::read(asf)?)?;
            parse_amc(&fs::read(amc)?, &asf)?.motion
        }
    };
    motion.up = up.unwrap_or(motion.up);
    let mut bytes = Vec::new();
    write_glb(&motion, &mut bytes)?;
    let (n_frames, n_joints) = (motion.n_frames(), motion.skeleton.joints().len());
    print!("{n_frames} frames of {n_joints} joints: ");
    Ok(bytes)
}

/// A hand that goes round, and an elbow that nobody sees in between.
fn markers() -> Result<Vec<u8>, Box<dyn Error>> {
    let mut positions = Array3::zeros((60, 2, 3));
    for frame in 0..60 {
        let (sin, cos) = (frame as f32 / 60.0 * TAU).sin_cos();
        for (marker, radius) in [0.3, 0.6].into_iter().enumerate() {
            positions[[frame, marker, 0]] = radius * cos;
            positions[[frame, marker, 1]] = 1.5 + radius * sin;
        }
        if (20..30).contains(&frame) {
            positions[[frame, 0, 1]] = f32::NAN;
        }
    }
    let rate = FrameRate::from_hz(30.0).ok_or("a rate is positive")?;
    let mut bytes = Vec::new();
    write_glb_points(&["LELB", "LWRA"], positions.view(), rate, &mut bytes)?;
    Ok(bytes)
}
