//! Seeded random walks as files of `f32`.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use super::super::dice::Dice;
use super::textbook::normalised;

/// Of both sequences of a pair.
pub(super) const FRAMES: usize = 1000;
/// As many as an AMC file has channels.
const DIMS: usize = 62;
/// All pairs of these are compared.
pub(super) const SERIES: usize = 200;
/// Of each series.
pub(super) const SAMPLES: usize = 200;
pub(super) const QUERY: usize = 128;
const HAYSTACK: usize = 200_000;
/// Where the window begins that the query was made from.
const PLANTED: usize = 123_456;
const SEED: u64 = 20_261_122;

/// Numbers as everybody reads them: rounded to `f32`.
pub(super) struct Sample {
    pub(super) path: PathBuf,
    pub(super) numbers: Vec<f64>,
}

pub(super) struct Data {
    /// Two sequences of several dimensions, frame after frame.
    pub(super) multi: Sample,
    /// Two sequences of one.
    pub(super) univariate: Sample,
    pub(super) pairwise: Sample,
    /// A query and the series after it.
    pub(super) windows: Sample,
}

/// Writes all files, the same ones at each call.
pub(super) fn write(folder: &Path) -> Result<Data> {
    let mut dice = Dice::seeded(SEED);
    fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    let sample = |name: &str, numbers: Vec<f64>| {
        let path = folder.join(name);
        let rounded: Vec<f32> = numbers.iter().map(|x| *x as f32).collect();
        let bytes: Vec<u8> = rounded.iter().flat_map(|x| x.to_le_bytes()).collect();
        fs::write(&path, bytes).with_context(|| format!("cannot write {}", path.display()))?;
        anyhow::Ok(Sample {
            path,
            numbers: rounded.into_iter().map(f64::from).collect(),
        })
    };
    let mut sequences = |n: usize, n_frames: usize, dims: usize| -> Vec<f64> {
        let sequences = (0..n).map(|_| frames(n_frames, dims, &mut dice));
        sequences.flatten().collect()
    };
    Ok(Data {
        multi: sample("multi.f32", sequences(2, FRAMES, DIMS))?,
        univariate: sample("univariate.f32", sequences(2, FRAMES, 1))?,
        pairwise: sample("pairwise.f32", sequences(SERIES, SAMPLES, 1))?,
        windows: sample("windows.f32", haystack(&mut dice))?,
    })
}

/// A walk, each dimension with mean 0 and deviation 1, frame after frame.
fn frames(n_frames: usize, dims: usize, dice: &mut Dice) -> Vec<f64> {
    let columns: Vec<Vec<f64>> = (0..dims)
        .map(|_| normalised(&walk(n_frames, dice)))
        .collect();
    let frame = |i: usize| columns.iter().map(move |column| column[i]);
    (0..n_frames).flat_map(frame).collect()
}

fn walk(n: usize, dice: &mut Dice) -> Vec<f64> {
    let mut place = 0.0;
    let mut step = || {
        place += dice.normal();
        place
    };
    (0..n).map(|_| step()).collect()
}

/// A query, and a walk that holds the query warped, noisy, larger and elsewhere.
fn haystack(dice: &mut Dice) -> Vec<f64> {
    /// Samples that the copy runs ahead or behind at most.
    const WARP: f64 = 3.0;
    const NOISE: f64 = 0.05;
    const SIZE: f64 = 5.0;
    let query = normalised(&walk(QUERY, dice));
    let mut series = walk(HAYSTACK, dice);
    let level = series[PLANTED];
    for (i, planted) in series[PLANTED..][..QUERY].iter_mut().enumerate() {
        let turn = std::f64::consts::TAU * i as f64 / QUERY as f64;
        let place = (i as f64 + WARP * turn.sin()).clamp(0.0, (QUERY - 1) as f64);
        let (before, part) = (place as usize, place.fract());
        let after = query[(before + 1).min(QUERY - 1)];
        let warped = query[before] * (1.0 - part) + after * part;
        *planted = level + SIZE * (warped + NOISE * dice.normal());
    }
    [query, series].concat()
}
