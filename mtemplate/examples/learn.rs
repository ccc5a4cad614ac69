//! Learns a class's template and threshold from motions of different pace, and finds it in a clip.

use std::error::Error;

use mtemplate::{Cell, MatchConfig, MotionTemplate, TauConfig, align, learn_tau};

fn main() -> Result<(), Box<dyn Error>> {
    // Bit 0: a foot is raised. Bit 1: the knee is bent. Bit 2: a hand is raised.
    let kicks: [&[u64]; 4] = [
        &[0b000, 0b010, 0b011, 0b001, 0b000],
        &[0b000, 0b010, 0b011, 0b011, 0b001, 0b000],
        &[0b000, 0b000, 0b010, 0b011, 0b101, 0b001, 0b000],
        &[0b000, 0b010, 0b010, 0b011, 0b101, 0b000],
    ];
    let others: [&[u64]; 2] = [
        &[0b000, 0b100, 0b100, 0b100, 0b000],
        &[0b000, 0b010, 0b110, 0b010, 0b000, 0b000],
    ];

    let quick = MotionTemplate::from_words(kicks[0], 3)?;
    let slow = MotionTemplate::from_words(kicks[2], 3)?;
    let alignment = align(&quick, &slow)?;
    println!("{:?} at cost {:.3}", alignment.path, alignment.cost);

    let config = TauConfig::default();
    let found = learn_tau(&kicks, &others, 3, &config)?;
    println!(
        "{} iterations, threshold {:.3}",
        found.learned.iterations, found.tau
    );
    let template = found.learned.template.quantize(config.quantization)?;
    for feature in 0..template.n_features() {
        let row = (0..template.n_columns()).map(|column| match template.cell(column, feature) {
            Some(Cell::Zero) => '0',
            Some(Cell::One) => '1',
            _ => '*',
        });
        println!("feature {feature}: {}", row.collect::<String>());
    }

    let clip = [
        0b100, 0b000, 0b000, 0b010, 0b011, 0b001, 0b001, 0b000, 0b100,
    ];
    for found in template.find_matches(&clip, &MatchConfig::up_to(found.tau)) {
        println!("frames {:?} at cost {:.3}", found.span, found.cost);
    }
    Ok(())
}
