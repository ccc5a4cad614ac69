//! Crates that read motion capture: `rust_peers PEER RUNS FILE`.

use std::{env, fs};

mod stopwatch;

fn main() {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [peer, runs, path] = arguments.try_into().expect("PEER RUNS FILE");
    let runs = runs.parse().expect("a number of runs");
    let bytes = fs::read(path).expect("a file");
    match peer.as_str() {
        "bvh_anim" => stopwatch::report(
            runs,
            || bvh_anim::from_bytes(&bytes).expect("a BVH"),
            |bvh| {
                let values = bvh.frames().flat_map(|frame| frame.as_slice());
                let sum = values.map(|&value| f64::from(value)).sum();
                [("frames", bvh.frames().count() as f64), ("sum", sum)]
            },
        ),
        "bvh_anim_parser" => {
            let text = str::from_utf8(&bytes).expect("text");
            stopwatch::report(
                runs,
                || bvh_anim_parser::parse::load_bvh_from_string(text),
                |(_, data)| {
                    let root = &data.pose_global_positions[0];
                    let sum = root.iter().map(|p| p.x + p.y + p.z).sum();
                    [("frames", root.len() as f64), ("root_sum", sum)]
                },
            );
        }
        "c3dio" => stopwatch::report(
            runs,
            || c3dio::C3d::from_bytes(&bytes).expect("a C3D"),
            |c3d| {
                let coordinates = c3d.points.iter().flat_map(|marker| marker.point);
                let sum = coordinates.map(f64::from).sum();
                [("frames", c3d.points.rows() as f64), ("sum", sum)]
            },
        ),
        other => panic!("no peer is named {other}"),
    }
}
