//! Seeded recordings as files: a BVH, an AMC with its ASF, a C3D.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use super::super::Fact;
use super::super::dice::Dice;
use super::{c3d, text};

pub(super) const N_FRAMES: usize = 5000;
const SEED: u64 = 7;
/// Of the sum of magnitudes: peers that keep `f32` or turn degrees into radians and back are right.
const ROUNDING: f64 = 1e-6;

/// A file and what a reader must find in it.
pub(super) struct Sample {
    pub(super) path: PathBuf,
    pub(super) bytes: u64,
    pub(super) facts: Vec<Fact>,
}

pub(super) struct Data {
    pub(super) bvh: Sample,
    /// The values of the BVH alone, separated by blanks.
    pub(super) bvh_numbers: PathBuf,
    pub(super) asf: PathBuf,
    pub(super) amc: Sample,
    /// The AMC without its first line `#!OML`, which not every peer takes.
    pub(super) amc_bare: PathBuf,
    pub(super) amc_numbers: PathBuf,
    pub(super) c3d: Sample,
    /// The points of the C3D alone.
    pub(super) c3d_points: PathBuf,
}

/// Writes all files, the same ones at each call.
pub(super) fn write(folder: &Path) -> Result<Data> {
    let mut dice = Dice::seeded(SEED);
    let skeleton = text::bvh_hierarchy(&mut dice);
    let channels = channels(&mut dice);
    let rows = |decimals: fn(f64) -> String, n: usize| -> Vec<Vec<String>> {
        let row = |row: &[f64; text::BVH_CHANNELS]| row[..n].iter().map(|v| decimals(*v)).collect();
        channels.iter().map(row).collect()
    };
    let bvh_rows = rows(|v| format!("{v:.6}"), text::BVH_CHANNELS);
    let amc_rows = rows(text::six_digits, text::AMC_CHANNELS);
    let amc_body = text::amc_body(&amc_rows);
    let amc = format!("#!OML:ASF bench.asf\n{amc_body}");
    let markers = c3d::markers(&mut dice);

    fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    let file = |name: &str, content: &[u8]| {
        let path = folder.join(name);
        fs::write(&path, content).with_context(|| format!("cannot write {}", path.display()))?;
        anyhow::Ok(path)
    };
    let sample = |name: &str, content: &[u8], facts| {
        anyhow::Ok(Sample {
            path: file(name, content)?,
            bytes: content.len() as u64,
            facts,
        })
    };
    let bvh = format!("{skeleton}{}", text::numbers(&bvh_rows));
    Ok(Data {
        bvh: sample("bench.bvh", bvh.as_bytes(), text_facts(&bvh_rows)?)?,
        bvh_numbers: file("bvh_numbers.txt", text::numbers(&bvh_rows).as_bytes())?,
        asf: file("bench.asf", text::asf().as_bytes())?,
        amc: sample("bench.amc", amc.as_bytes(), text_facts(&amc_rows)?)?,
        amc_bare: file("bare.amc", amc_body.as_bytes())?,
        amc_numbers: file("amc_numbers.txt", text::numbers(&amc_rows).as_bytes())?,
        c3d: sample("bench.c3d", &c3d::file(&markers), c3d::facts(&markers))?,
        c3d_points: file("c3d_points.bin", &c3d::points(&markers))?,
    })
}

/// Frame count, sum of all values and sum of the root's positions, as the text has them.
fn text_facts(rows: &[Vec<String>]) -> Result<Vec<Fact>> {
    let mut values: Vec<Vec<f64>> = Vec::with_capacity(rows.len());
    for row in rows {
        values.push(
            row.iter()
                .map(|word| word.parse())
                .collect::<Result<_, _>>()?,
        );
    }
    Ok(vec![
        frames(),
        sum("sum", values.iter().flatten().copied()),
        sum("root_sum", values.iter().flat_map(|row| &row[..3]).copied()),
    ])
}

pub(super) fn frames() -> Fact {
    Fact {
        key: "frames",
        value: N_FRAMES as f64,
        tolerance: 0.0,
    }
}

pub(super) fn sum(key: &'static str, values: impl Iterator<Item = f64> + Clone) -> Fact {
    Fact {
        key,
        value: values.clone().sum(),
        tolerance: ROUNDING * values.map(f64::abs).sum::<f64>(),
    }
}

/// Channels that wander smoothly, with the digits that real angles have; the first three are the
/// root's position.
fn channels(dice: &mut Dice) -> Vec<[f64; text::BVH_CHANNELS]> {
    const ROOT_STEP: f64 = 0.3;
    const JERK: f64 = 0.05 * 0.05;
    const STEP: f64 = 0.2;
    const REACH: f64 = 30.0;
    let scales: [f64; text::BVH_CHANNELS] = std::array::from_fn(|_| 0.1 + 2.9 * dice.uniform());
    let mut speeds = [0.0; text::BVH_CHANNELS];
    let mut places = [0.0; text::BVH_CHANNELS];
    places[..3].copy_from_slice(&[10.0, 17.0, -30.0]);
    let mut frame = || {
        std::array::from_fn(|i| {
            if i < 3 {
                places[i] += ROOT_STEP * dice.normal();
                return places[i];
            }
            speeds[i] += JERK * dice.normal();
            places[i] += speeds[i] + STEP * dice.normal();
            REACH * (places[i] / REACH).sin() * scales[i]
        })
    };
    (0..N_FRAMES).map(|_| frame()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_the_same_at_each_call_and_of_the_size_that_peers_were_measured_with() {
        let scratch = tempfile::tempdir().unwrap();
        let [a, b] = ["a", "b"].map(|name| write(&scratch.path().join(name)).unwrap());
        for (a, b) in [(&a.bvh, &b.bvh), (&a.amc, &b.amc), (&a.c3d, &b.c3d)] {
            assert!(fs::read(&a.path).unwrap() == fs::read(&b.path).unwrap());
        }
        let megabytes = [&a.bvh, &a.amc, &a.c3d].map(|sample| sample.bytes as f64 / 1e6);
        for (found, measured) in megabytes.into_iter().zip([4.90, 3.74, 3.28]) {
            assert!((found / measured - 1.0).abs() < 0.05, "{megabytes:?}");
        }
    }
}
