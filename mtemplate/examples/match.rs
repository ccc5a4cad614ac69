//! Takes a template from one motion, loosens it by a second one, and finds it in a clip.

use std::error::Error;

use mtemplate::{Cell, MatchConfig, MotionTemplate};

fn main() -> Result<(), Box<dyn Error>> {
    // Bit 0: a foot is raised. Bit 1: a hand is raised.
    let first = MotionTemplate::from_words(&[0b00, 0b01, 0b11, 0b00], 2)?;
    let second = MotionTemplate::from_words(&[0b00, 0b01, 0b01, 0b00], 2)?;
    let mean = (&first.values() + &second.values()) / 2.0;
    let template = MotionTemplate::new(mean, first.weights().to_owned())?.quantize(0.1)?;
    for feature in 0..template.n_features() {
        let row = (0..template.n_columns()).map(|column| match template.cell(column, feature) {
            Some(Cell::Zero) => '0',
            Some(Cell::One) => '1',
            _ => '*',
        });
        println!("feature {feature}: {}", row.collect::<String>());
    }

    let clip = [0b10, 0b10, 0b00, 0b00, 0b01, 0b01, 0b00, 0b10];
    let curve = template.distance_curve(&clip);
    for (end, cost) in curve.costs().enumerate() {
        println!(
            "frame {end}: {}",
            cost.map_or("-".into(), |cost| format!("{cost:.3}"))
        );
    }
    if let Some(best) = template
        .find_matches(&clip, &MatchConfig::up_to(1.0))
        .first()
    {
        println!(
            "best match: frames {:?} at cost {:.3}",
            best.span, best.cost
        );
    }
    Ok(())
}
