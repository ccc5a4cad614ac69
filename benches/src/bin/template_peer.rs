//! Our side of `cargo xtask peers templates`: `template_peer motif RUNS JOB FILE`. Files hold `u64`.

use std::{env, fs};

use anyhow::{Context, Result, bail};
use benches::stopwatch;
use mtemplate::{DistanceCurve, LearnConfig, Learned, MotionTemplate, Steps, learn};

const FEATURES: usize = 39;
const COLUMNS: usize = 100;

fn main() -> Result<()> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [_, runs, job, file] = &arguments[..] else {
        bail!("NAME RUNS JOB FILE expected");
    };
    let bytes = fs::read(file)?;
    let (numbers, _) = bytes.as_chunks();
    let words: Vec<u64> = numbers.iter().map(|b| u64::from_le_bytes(*b)).collect();
    let runs = runs.parse()?;
    match job.as_str() {
        "unit" => curve(runs, &words, Steps::Unit),
        "advance" => curve(runs, &words, Steps::Advance),
        "learn" => class(runs, &words),
        _ => bail!("no job is named {job}"),
    }
}

/// The first words are the template. Facts are in disagreements.
fn curve(runs: usize, words: &[u64], steps: Steps) -> Result<()> {
    let (template, clip) = words.split_at_checked(COLUMNS).context("too short")?;
    let template = MotionTemplate::from_words(template, FEATURES)?.quantize(0.0)?;
    let template = template.with_steps(steps);
    let facts = |curve: &DistanceCurve| {
        let one = (COLUMNS * FEATURES) as f64;
        let costs: Vec<f64> = curve.costs().flatten().map(|cost| cost * one).collect();
        let least = costs.iter().copied().fold(f64::INFINITY, f64::min);
        let end = curve
            .costs()
            .position(|cost| cost.is_some_and(|cost| cost * one == least));
        let end = end.map_or(f64::NAN, |end| end as f64);
        [("least", least), ("end", end), ("sum", costs.iter().sum())]
    };
    stopwatch::report(runs, || template.distance_curve(clip), facts);
    Ok(())
}

/// A class template of all motions.
fn class(runs: usize, mut words: &[u64]) -> Result<()> {
    let mut motions = Vec::new();
    while let Some((length, rest)) = words.split_first() {
        let (motion, rest) = rest
            .split_at_checked(*length as usize)
            .context("too short")?;
        motions.push(MotionTemplate::from_words(motion, FEATURES)?);
        words = rest;
    }
    let config = LearnConfig::default();
    learn(&motions, &config)?;
    let template = || learn(&motions, &config).ok();
    stopwatch::report(runs, template, |learned: &Option<Learned>| {
        let mass = learned
            .as_ref()
            .map(|learned| learned.template.weights().sum());
        [("mass", mass.unwrap_or(f64::NAN))]
    });
    Ok(())
}
