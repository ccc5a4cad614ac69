//! From one motion into another: `blend A.bvh B.bvh OUT.bvh` starts like A and ends like B. Without
//! arguments a walk straight ahead becomes a walk to the left, wherever that one took place.

use std::error::Error;
use std::fs;

use mocap_io::{Motion, blend, forward_kinematics, parse_bvh, smoothstep_weights, write_bvh};

/// A figure that goes `step` centimetres per frame along Z and turns by `turn` degrees.
fn walk(start: [f64; 2], step: f64, turn: f64) -> Result<Motion, Box<dyn Error>> {
    let mut text = String::from(
        "HIERARCHY\nROOT Hips\n{\nOFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition \
         Yrotation Xrotation Zrotation\nEnd Site\n{\nOFFSET 0 170 0\n}\n}\n\
         MOTION\nFrames: 8\nFrame Time: 0.1\n",
    );
    let ([mut x, mut z], mut yaw) = (start, 0.0f64);
    for _ in 0..8 {
        text += &format!("{x} 90 {z} {yaw} 0 0\n");
        x += step * yaw.to_radians().sin();
        z += step * yaw.to_radians().cos();
        yaw += turn;
    }
    Ok(parse_bvh(text.as_bytes())?.motion)
}

fn main() -> Result<(), Box<dyn Error>> {
    let paths: Vec<String> = std::env::args().skip(1).collect();
    let read = |path: &String| -> Result<Motion, Box<dyn Error>> {
        Ok(parse_bvh(&fs::read(path)?)?.motion)
    };
    let (a, b) = match paths.as_slice() {
        [a, b, ..] => (read(a)?, read(b)?),
        _ => (
            walk([0.0; 2], 15.0, 0.0)?,
            walk([400.0, -70.0], 10.0, 12.0)?,
        ),
    };
    let b = b.resample(a.rate);
    let n_frames = (a.n_frames() + b.n_frames()) / 2;
    let blended = blend(&a, &b, &smoothstep_weights(n_frames))?;
    if let Some(out) = paths.get(2) {
        write_bvh(&blended, fs::File::create(out)?)?;
        return Ok(());
    }
    let positions = forward_kinematics(&blended);
    for frame in 0..n_frames {
        let heading = blended.heading(frame).map(f64::to_degrees);
        let (x, z) = (positions[[frame, 0, 0]], positions[[frame, 0, 2]]);
        println!(
            "{x:6.2} {z:6.2} m, facing {:6.1}°",
            heading.unwrap_or(f64::NAN)
        );
    }
    Ok(())
}
