//! How much of the bundles of boxing is left when the poses are noisy.

use std::f64::consts::TAU;

use anyhow::{Context, Result};
use bundles::Closure;
use cli::bundling::pose_vectors;
use cli::output::table;
use cli::recording::{Files, ReadOptions, parse};
use ndarray::{Array2, Axis};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use crate::overlap::{Kept, kept, owners};
use crate::stages::{self, Clips, Letters};
use crate::takes::{CLOSURES, Sets, percent};

/// Of the standard deviation of each degree of freedom.
const AMPLITUDE: f64 = 0.1;

/// Seeds of the noise.
const NOISES: [u64; 5] = [1, 2, 3, 4, 5];

/// Where the paper finds boxing to go well: from 100 to 250 letters.
const KAPPAS: [usize; 2] = [100, 250];

/// The least share of frames that stay, as the project asks.
const LEAST: f64 = 0.8;

/// What is disturbed, and what is made anew.
#[derive(Clone, Copy, PartialEq)]
enum Trial {
    /// Noise on the 62 dimensions of the poses; components, letters and bundles are made anew.
    Poses,
    /// The same on the 62 channels of the recording.
    Channels,
    /// Noise on the poses, spelt with the letters of the clean ones.
    SameLetters,
    /// No noise: letters from another seed.
    OtherSeed,
}

const TRIALS: [(&str, Trial); 4] = [
    ("noise on poses", Trial::Poses),
    ("noise on channels", Trial::Channels),
    ("noise on poses, old letters", Trial::SameLetters),
    ("no noise, another seed", Trial::OtherSeed),
];

/// The take as it is and as each trial has it.
struct Take {
    clean: Array2<f64>,
    /// Of each seed, with noise on the channels.
    noisy_channels: Vec<Array2<f64>>,
}

pub(crate) fn report(sets: &Sets) -> Result<String> {
    let take = read(sets)?;
    let mut rows = table(&[
        "letters",
        "closure",
        "",
        "matching",
        "least",
        "most",
        "likeliest",
        "any",
        "stands",
    ]);
    for kappa in KAPPAS {
        for (name, closure) in CLOSURES {
            for (what, trial) in TRIALS {
                let found: Vec<Kept> = NOISES
                    .iter()
                    .map(|&seed| try_out(&take, (kappa, closure), trial, seed))
                    .collect::<Result<_>>()?;
                let mean =
                    |of: fn(&Kept) -> f64| found.iter().map(of).sum::<f64>() / found.len() as f64;
                let matching = found.iter().map(|kept| kept.matching);
                let least = matching.clone().fold(1.0, f64::min);
                let stands = if mean(|kept| kept.matching) >= LEAST {
                    "yes"
                } else {
                    "no"
                };
                rows.add_row([
                    kappa.to_string(),
                    name.to_owned(),
                    what.to_owned(),
                    percent(mean(|kept| kept.matching)),
                    percent(least),
                    percent(matching.fold(0.0, f64::max)),
                    percent(mean(|kept| kept.likeliest)),
                    percent(mean(|kept| kept.any)),
                    stands.to_owned(),
                ]);
            }
        }
    }
    Ok(format!(
        "Noise of {AMPLITUDE} standard deviations on boxing, mean of {} seeds: share of the frames of bundles that are in the \
         matching bundle afterwards (at least {LEAST}). Each bundle matches at most one, by descending number of common frames; \
         likeliest: in the one with most of the bundle's frames, whatever else is there; any: in a bundle. \
         The paper's right punches go from 20x36 to 19x41, its left ones from 7x32 to 7x30\n{}\n\n",
        NOISES.len(),
        rows.trim_fmt()
    ))
}

fn read(sets: &Sets) -> Result<Take> {
    let poses = sets.boxing.poses.first().context("no take")?;
    let options = ReadOptions::default();
    let path = &poses.clip.path;
    let loaded = parse(path, Files::read(path, &options)?, &options)?;
    let motion = loaded.recording.motion().context("no motion")?;
    let of_seed = |&seed: &u64| {
        let mut noisy = motion.clone();
        disturb(&mut noisy.channels, seed);
        pose_vectors(&noisy)
    };
    Ok(Take {
        clean: poses.vectors.clone(),
        noisy_channels: NOISES
            .iter()
            .map(of_seed)
            .collect::<std::result::Result<_, _>>()?,
    })
}

fn try_out(
    take: &Take,
    (kappa, closure): (usize, Closure),
    trial: Trial,
    seed: u64,
) -> Result<Kept> {
    let clean = take.clean.view();
    let whole = 0..clean.nrows();
    let clips = |vectors| Clips {
        vectors,
        ranges: std::slice::from_ref(&whole),
    };
    let letters = Letters::fit(clips(clean), kappa, 0, &mut |_| ())?;
    let string = letters.spell(clips(clean))?;
    let tau = letters.threshold(&string)?;
    let owned =
        |of: Clips<'_>, letters: &Letters, tau: Option<f64>| -> Result<Vec<Option<usize>>> {
            let string = letters.spell(of)?;
            let tau = tau.map_or_else(|| letters.threshold(&string), Ok)?;
            let options = stages::options(&string, closure, 0);
            let graph = stages::graph(of, (&string, &letters.access(tau)?), &options, &mut |_| ())?;
            Ok(owners(&graph, clean.nrows()))
        };
    let before = owned(clips(clean), &letters, Some(tau))?;
    let mut noisy = take.clean.clone();
    disturb(&mut noisy, seed);
    let after = match trial {
        Trial::SameLetters => owned(clips(noisy.view()), &letters, Some(tau))?,
        Trial::OtherSeed => {
            let other = Letters::fit(clips(clean), kappa, seed, &mut |_| ())?;
            owned(clips(clean), &other, None)?
        }
        Trial::Poses | Trial::Channels => {
            let place = NOISES
                .iter()
                .position(|&other| other == seed)
                .unwrap_or_default();
            let vectors = match trial {
                Trial::Channels => take.noisy_channels[place].view(),
                _ => noisy.view(),
            };
            let other = Letters::fit(clips(vectors), kappa, 0, &mut |_| ())?;
            owned(clips(vectors), &other, None)?
        }
    };
    Ok(kept(&before, &after))
}

/// Adds Gaussian noise in proportion to the standard deviation of each column.
fn disturb(columns: &mut Array2<f64>, seed: u64) {
    let mut dice = ChaCha8Rng::seed_from_u64(seed);
    let sigmas = columns.std_axis(Axis(0), 0.0);
    for mut row in columns.rows_mut() {
        for (x, sigma) in row.iter_mut().zip(&sigmas) {
            *x += AMPLITUDE * sigma * normal(&mut dice);
        }
    }
}

/// By Box and Muller.
fn normal(dice: &mut ChaCha8Rng) -> f64 {
    let mut uniform = || {
        let bits = dice.next_u64() >> (u64::BITS - f64::MANTISSA_DIGITS);
        bits as f64 / (1_u64 << f64::MANTISSA_DIGITS) as f64
    };
    let (radius, angle) = ((-2.0 * (1.0 - uniform()).ln()).sqrt(), TAU * uniform());
    radius * angle.cos()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a mean or deviation of 10,000 draws: five standard errors.
    const TOLERANCE: f64 = 0.05;

    #[test]
    fn noise_is_in_proportion_to_each_column() {
        let clean = Array2::from_shape_fn((10_000, 2), |(i, j)| [3.0, 50.0][j] * (i as f64).sin());
        let mut noisy = clean.clone();
        disturb(&mut noisy, 7);
        let noise = &noisy - &clean;
        for (column, sigma) in noise
            .columns()
            .into_iter()
            .zip(clean.std_axis(Axis(0), 0.0))
        {
            let unit = AMPLITUDE * sigma;
            assert!(column.mean().unwrap().abs() < TOLERANCE * unit);
            assert!((column.std(0.0) / unit - 1.0).abs() < TOLERANCE);
        }
    }
}
