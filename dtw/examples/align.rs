//! Aligns a wave with a slower one, prints which frames fall together, and finds a piece of it.

use std::error::Error;
use std::f64::consts::TAU;

use dtw::ndarray::{Array2, s};
use dtw::{Band, BandRadius, Dtw, Ends};

fn wave(frames: usize) -> Array2<f64> {
    Array2::from_shape_fn((frames, 1), |(i, _)| (TAU * i as f64 / frames as f64).sin())
}

fn main() -> Result<(), Box<dyn Error>> {
    let (fast, slow) = (wave(8), wave(12));
    let radius = BandRadius::cells(1);
    for band in [Band::SakoeChiba(radius), Band::Slanted(radius), Band::Full] {
        let name = format!("{band:?}");
        match Dtw::new(band).align(fast.view(), slow.view())? {
            Some(path) => println!("{name}: cost {:.3}, {:?}", path.cost, path.steps),
            None => println!("{name}: no path"),
        }
    }

    let piece = slow.slice(s![3..7, ..]);
    let found = Dtw::default().with_ends(Ends::Open);
    if let Some(path) = found.align(piece, slow.view())? {
        println!("frames 3 to 6 are found again: {:?}", path.steps);
    }
    Ok(())
}
