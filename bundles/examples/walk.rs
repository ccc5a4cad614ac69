//! Finds the bundles of a made-up recording, links them, and walks at random.
//!
//! `cargo run -p bundles --example walk`

use bundles::ndarray::Array2;
use bundles::{
    Accessibility, DeadEnds, ExtractOptions, MappingOptions, RandomWalk, extract, link, map_frames,
    max_letters, spell,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Four poses per cycle, with a detour over pose 4 in every third.
    let pose = |frame: usize| match (frame / 6 % 4, frame / 24 % 3) {
        (2, 2) => 4,
        (phase, _) => phase as u32,
    };
    let labels: Vec<u32> = (0..600).map(pose).collect();
    let string = spell(&labels, &[0..300, 300..600])?;
    let apart = Array2::from_shape_fn((5, 5), |(a, b)| if a == b { 0.0 } else { 9.0 });
    let access = Accessibility::new(apart.view(), 1.0)?;

    let options = ExtractOptions::new(max_letters(&string, 40.0));
    let partition = extract(&string, &access, &options)?;
    let poses = Array2::from_shape_fn((600, 1), |(frame, _)| f64::from(pose(frame)));
    let mapping = map_frames(
        &string,
        &partition,
        poses.view(),
        &MappingOptions::default(),
    )?;
    let graph = link(&string, &partition, &mapping).ok_or("the mapping is of this partition")?;
    for (id, bundle) in graph.bundles().iter().enumerate() {
        let (height, frames) = (bundle.height(), bundle.mean_frames());
        println!("B{id}: {height} submotions of {frames:.0} frames");
    }

    let walk = graph.random_walk(&RandomWalk {
        n_bundles: 6,
        start: None,
        dead_ends: DeadEnds::Avoid,
        seed: 1,
    })?;
    println!("{:?}", walk.bundles);
    for piece in &walk.pieces {
        println!("{} frames: {piece:?}", piece.n_frames());
    }
    Ok(())
}
