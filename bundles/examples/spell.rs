//! Spells two short clips and finds from which distance on their letters differ.

use std::error::Error;

use bundles::ndarray::array;
use bundles::{PoseClusters, adjacent_distance_median, spell};

fn main() -> Result<(), Box<dyn Error>> {
    let labels = [0, 0, 1, 1, 1, 2, 0, 0, 1, 2, 2, 3, 3];
    let clips = [0..6, 6..13];
    let string = spell(&labels, &clips)?;
    for clip in 0..string.n_clips() {
        let runs = &string.runs()[string.clip_span(clip).unwrap_or_default()];
        let letters = runs
            .iter()
            .filter_map(|run| char::from_digit(run.letter.label() + 10, 36));
        println!("clip {clip}: {}", letters.collect::<String>());
        for run in runs {
            println!("  frames {:?}, mean {}", run.frames, run.mean_frame());
        }
    }

    let means = array![[0.0, 0.0], [1.0, 0.0], [1.0, 2.0], [4.0, 2.0]];
    let clusters = PoseClusters::new(means.view(), array![0.5, 0.5, 1.0, 1.0].view())?;
    if let Some(threshold) = adjacent_distance_median(&string, &clusters)? {
        println!("letters up to {threshold} apart count as equal");
    }
    Ok(())
}
