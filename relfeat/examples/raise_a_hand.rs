//! A stick figure raises its right hand: which features go on, and when?

use ndarray::Array3;
use relfeat::{BodyMap, FeatureSet, extract};

const RATE: f64 = 30.0;
const SECONDS: f64 = 2.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // An upright figure in metres, seen from the front: its left is +X, it faces +Z.
    let figure: [(&str, [f32; 3]); 10] = [
        ("Hips", [0.0, 1.0, 0.0]),
        ("LeftUpLeg", [0.1, 0.95, 0.0]),
        ("RightUpLeg", [-0.1, 0.95, 0.0]),
        ("Spine", [0.0, 1.1, 0.0]),
        ("Spine1", [0.0, 1.25, 0.0]),
        ("Neck", [0.0, 1.4, 0.0]),
        ("LeftArm", [0.2, 1.4, 0.0]),
        ("RightArm", [-0.2, 1.4, 0.0]),
        ("RightForeArm", [-0.2, 1.1, 0.0]),
        ("RightHand", [-0.2, 0.85, 0.0]),
    ];
    let names = figure.map(|(name, _)| name);
    let n_frames = (RATE * SECONDS) as usize;
    let mut positions = Array3::from_shape_fn((n_frames, names.len(), 3), |(_, joint, axis)| {
        figure[joint].1[axis]
    });
    for frame in 0..n_frames {
        // The arm swings forwards and up around the shoulder, by half a turn.
        let turn = std::f32::consts::PI * frame as f32 / (n_frames - 1) as f32;
        for (joint, length) in [(8, 0.3), (9, 0.55)] {
            positions[[frame, joint, 1]] = 1.4 - length * turn.cos();
            positions[[frame, joint, 2]] = length * turn.sin();
        }
    }
    let map = BodyMap::recognise(&names).ok_or("no rig fits")?;
    let set = FeatureSet::builtin("mueller2006").ok_or("no such set")?;
    let found = extract(&set, positions.view(), &map, RATE, RATE)?;
    println!(
        "rig {}, {} features unavailable",
        map.rig(),
        found.unavailable.len()
    );
    for (bit, feature) in set.features().iter().enumerate() {
        let on: Vec<usize> = (0..n_frames)
            .filter(|&t| found.words[t] >> bit & 1 == 1)
            .collect();
        if let (Some(first), Some(last)) = (on.first(), on.last()) {
            let seconds = |frame: &usize| *frame as f64 / RATE;
            println!(
                "{:<24} {:.2} s to {:.2} s",
                feature.name,
                seconds(first),
                seconds(last)
            );
        }
    }
    Ok(())
}
