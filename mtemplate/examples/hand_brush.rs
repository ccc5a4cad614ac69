//! A template from nothing but names: sweeping with a hand brush (Müller and Röder 2006, section 5.4),
//! and its mirror image.

use mtemplate::{ClassTemplate, MotionTemplate};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let names = [
        "rhand_fast",
        "lhand_fast",
        "spine_horizontal",
        "rhand_lowered",
        "lhand_lowered",
    ];
    let blank = ClassTemplate {
        name: "sweeping".to_owned(),
        feature_set: "arms and spine".to_owned(),
        rate: 30.0,
        features: names.map(str::to_owned).to_vec(),
        template: MotionTemplate::blank(50, names.len())?,
        n_motions: None,
        tau: None,
        keyframes: Vec::new(),
    };
    let right = blank.painted(1.0, 0b01101, 0..50)?;
    let left = right.mirrored(&[1, 0, 2, 4, 3])?;
    println!("{}", left.to_text()?);

    // Ten still frames, then a left hand that sweeps for 50, and ten more.
    let words = [vec![0; 10], vec![0b10110; 50], vec![0; 10]].concat();
    let matches = |class: &ClassTemplate| {
        let curve = class.template.quantize(0.1)?.distance_curve(&words);
        let best = curve.costs().flatten().fold(f64::INFINITY, f64::min);
        Ok::<f64, mtemplate::TemplateError>(best)
    };
    println!("left {:.3}, right {:.3}", matches(&left)?, matches(&right)?);
    assert_eq!(matches(&left)?, 0.0);
    assert!(matches(&right)? > 0.5);
    Ok(())
}
