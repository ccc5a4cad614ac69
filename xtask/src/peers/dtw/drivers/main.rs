//! Crates of dynamic time warping: `rust_peers PEER RUNS JOB FILE`. FILE holds numbers as `f32`; peers
//! get them as `f64`.

use std::{env, fs};

use dtw_rs::Solution;

mod stopwatch;

const FRAMES: usize = 1000;
const DIMS: usize = 62;
const RADIUS: usize = 100;

fn main() {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [peer, runs, job, path] = arguments.try_into().expect("PEER RUNS JOB FILE");
    let runs = runs.parse().expect("a number of runs");
    let bytes = fs::read(path).expect("a file");
    let (numbers, _) = bytes.as_chunks();
    let numbers = numbers.iter().map(|b| f64::from(f32::from_le_bytes(*b)));
    let numbers: Vec<f64> = numbers.collect();
    let (a, b) = numbers.split_at(numbers.len() / 2);
    match (peer.as_str(), job.as_str()) {
        ("augurs-dtw", "univariate") => {
            let dtw = augurs_dtw::Dtw::euclidean().with_window(RADIUS);
            stopwatch::report(runs, || dtw.distance(a, b), |cost| [("cost", *cost)]);
        }
        ("dtw_rs", "multi" | "path") => {
            let work = || {
                let solution = dtw_rs::dtw_with_distance(frames(a), frames(b), euclidean);
                found(&solution, job == "path")
            };
            stopwatch::report(runs, work, facts);
        }
        ("dtw_rs", "band") => {
            let work = || {
                let (a, b) = (frames(a), frames(b));
                found(&dtw_rs::sakoe_chiba_with_distance(a, b, RADIUS, euclidean), false)
            };
            stopwatch::report(runs, work, facts);
        }
        other => panic!("nobody does {other:?}"),
    }
}

fn frames(numbers: &[f64]) -> &[[f64; DIMS]] {
    let (frames, _) = numbers.as_chunks();
    assert_eq!(frames.len(), FRAMES);
    frames
}

fn euclidean(x: &[f64; DIMS], y: &[f64; DIMS]) -> f64 {
    let squares = x.iter().zip(y).map(|(x, y)| (x - y) * (x - y));
    squares.sum::<f64>().sqrt()
}

/// Cost, and the path where it is asked for.
fn found(solution: &impl Solution<f64>, is_path: bool) -> (f64, Vec<(usize, usize)>) {
    let path = if is_path { solution.path() } else { Vec::new() };
    (solution.distance(), path)
}

fn facts((cost, path): &(f64, Vec<(usize, usize)>)) -> [(&'static str, f64); 2] {
    [("cost", *cost), ("steps", path.len() as f64)]
}
