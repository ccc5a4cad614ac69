//! Aligns a wave with a slower one and prints which frames fall together.

use std::error::Error;
use std::f64::consts::TAU;

use dtw::ndarray::Array2;
use dtw::{BandRadius, Dtw};

fn wave(frames: usize) -> Array2<f64> {
    Array2::from_shape_fn((frames, 1), |(i, _)| (TAU * i as f64 / frames as f64).sin())
}

fn main() -> Result<(), Box<dyn Error>> {
    let (fast, slow) = (wave(8), wave(12));
    for radius in [3, 4, 6] {
        let dtw = Dtw::new(BandRadius::cells(radius));
        match dtw.align(fast.view(), slow.view())? {
            Some(path) => println!("radius {radius}: cost {:.3}, {:?}", path.cost, path.steps),
            None => println!("radius {radius}: no path"),
        }
    }
    Ok(())
}
