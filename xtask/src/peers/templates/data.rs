//! Seeded words as files of `u64`.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use super::super::dice::Dice;

pub(super) const COLUMNS: usize = 100;
pub(super) const FRAMES: usize = 25_000;
const FEATURES: usize = 39;
/// That a feature is another one in the next frame.
const FLIP: f64 = 0.04;
/// A class as large as the paper's: its motions, and their common length about which they vary.
const MOTIONS: usize = 26;
const LENGTH: usize = 45;
const SEED: u64 = 20_261_122;

pub(super) struct Data {
    /// The words of a template and of a clip.
    pub(super) words: Vec<u64>,
    pub(super) curve: PathBuf,
    /// Motions, each after its length.
    pub(super) motions: PathBuf,
    pub(super) lengths: Vec<usize>,
}

/// Writes all files, the same ones at each call.
pub(super) fn write(folder: &Path) -> Result<Data> {
    let mut dice = Dice::seeded(SEED);
    fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    let file = |name: &str, numbers: &[u64]| {
        let path = folder.join(name);
        let bytes: Vec<u8> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
        fs::write(&path, bytes).with_context(|| format!("cannot write {}", path.display()))?;
        anyhow::Ok(path)
    };
    let words = [walk(COLUMNS, &mut dice), walk(FRAMES, &mut dice)].concat();
    let pattern = walk(LENGTH, &mut dice);
    let motions: Vec<Vec<u64>> = (0..MOTIONS).map(|_| varied(&pattern, &mut dice)).collect();
    let of_motion = |motion: &Vec<u64>| [&[motion.len() as u64][..], motion].concat();
    let listed: Vec<u64> = motions.iter().flat_map(of_motion).collect();
    Ok(Data {
        curve: file("curve.u64", &words)?,
        words,
        motions: file("motions.u64", &listed)?,
        lengths: motions.iter().map(Vec::len).collect(),
    })
}

/// Features that stay for a while each.
fn walk(n_frames: usize, dice: &mut Dice) -> Vec<u64> {
    let mut word = flips(0.5, dice);
    let mut next = || {
        word ^= flips(FLIP, dice);
        word
    };
    (0..n_frames).map(|_| next()).collect()
}

fn flips(share: f64, dice: &mut Dice) -> u64 {
    (0..FEATURES).fold(0, |word, f| word | u64::from(dice.uniform() < share) << f)
}

/// The same motion, here slower and there faster, with a few features of its own.
fn varied(pattern: &[u64], dice: &mut Dice) -> Vec<u64> {
    const SLOWER: f64 = 0.15;
    const FASTER: f64 = 0.85;
    const NOISE: f64 = 0.02;
    let mut motion = Vec::new();
    for word in pattern {
        let pace = dice.uniform();
        let n = if pace < SLOWER {
            2
        } else {
            usize::from(pace < FASTER)
        };
        motion.extend((0..n).map(|_| word ^ flips(NOISE, dice)));
    }
    motion
}
