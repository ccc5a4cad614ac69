//! Finds where a gesture is repeated in a long recording, at another size and pace.

use std::error::Error;
use std::f64::consts::TAU;

use dtw::ndarray::{Array2, Axis, concatenate};
use dtw::{BandRadius, LocalCost, Search};

/// Once around an ellipse, faster in the beginning or in the end.
fn gesture(size: f64, haste: f64) -> Array2<f64> {
    Array2::from_shape_fn((60, 2), |(i, dim)| {
        let turn = (i as f64 / 60.0).powf(haste) * TAU;
        size * if dim == 0 {
            turn.cos()
        } else {
            0.5 * turn.sin()
        }
    })
}

/// Swaying that is no gesture.
fn pause(frames: usize) -> Array2<f64> {
    Array2::from_shape_fn((frames, 2), |(i, dim)| (0.05 * i as f64 + dim as f64).sin())
}

fn main() -> Result<(), Box<dyn Error>> {
    let query = gesture(1.0, 1.0);
    let (hasty, large) = (gesture(0.8, 1.2), gesture(3.0, 0.9));
    let parts = [pause(400), hasty, pause(700), large, pause(300)];
    let views = parts.each_ref().map(|part| part.view());
    let recording = concatenate(Axis(0), &views)?;

    let search = Search::new(BandRadius::cells(6))
        .with_local_cost(LocalCost::SquaredEuclidean)
        .z_normalised();
    let windows = search.best_windows(query.view(), recording.view(), 3, query.nrows())?;
    for window in windows {
        println!("frame {:4}: cost {:.3}", window.start, window.cost);
    }
    Ok(())
}
