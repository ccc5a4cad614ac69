//! Seeded random walks as a file of `f64`, and a start that ours draws.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

use super::super::dice::Dice;
use crate::workspace::{capture, text};

pub(super) const FRAMES: usize = 7300;
/// As many as the paper keeps components at most.
pub(super) const DIMS: usize = 12;
pub(super) const KAPPA: usize = 250;
const SEED: u64 = 20_261_123;

pub(super) struct Data {
    pub(super) frames: Vec<[f64; DIMS]>,
    pub(super) frames_path: PathBuf,
    /// Weights, variances and means.
    pub(super) start: Vec<f64>,
    pub(super) start_path: PathBuf,
}

/// Writes both files, the same ones at each call; `ours` draws the start.
pub(super) fn write(folder: &Path, ours: &Path) -> Result<Data> {
    fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    let (frames_path, start_path) = (folder.join("frames.f64"), folder.join("start.f64"));
    let frames = frames();
    let bytes: Vec<u8> = frames
        .iter()
        .flatten()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    fs::write(&frames_path, bytes)
        .with_context(|| format!("cannot write {}", frames_path.display()))?;
    let mut command = Command::new(ours);
    command.args(["seed", &KAPPA.to_string()]);
    let output = capture(command.arg(&frames_path).arg(&start_path))?;
    if !output.status.success() {
        bail!("ours draws no start: {}", text(&output.stderr));
    }
    let bytes =
        fs::read(&start_path).with_context(|| format!("cannot read {}", start_path.display()))?;
    let start: Vec<f64> = bytes
        .as_chunks()
        .0
        .iter()
        .map(|b| f64::from_le_bytes(*b))
        .collect();
    if start.len() != KAPPA * (DIMS + 2) {
        bail!("ours draws {} numbers for a start", start.len());
    }
    Ok(Data {
        frames,
        frames_path,
        start,
        start_path,
    })
}

/// A walk in each dimension, with mean 0 and deviation 1.
fn frames() -> Vec<[f64; DIMS]> {
    let mut dice = Dice::seeded(SEED);
    let mut frames = vec![[0.0; DIMS]; FRAMES];
    for dim in 0..DIMS {
        let mut place = 0.0;
        let mut walk: Vec<f64> = Vec::with_capacity(FRAMES);
        for _ in 0..FRAMES {
            place += dice.normal();
            walk.push(place);
        }
        let mean = walk.iter().sum::<f64>() / FRAMES as f64;
        let squares: f64 = walk.iter().map(|x| (x - mean) * (x - mean)).sum();
        let deviation = (squares / FRAMES as f64).sqrt();
        for (frame, x) in frames.iter_mut().zip(walk) {
            frame[dim] = (x - mean) / deviation;
        }
    }
    frames
}
