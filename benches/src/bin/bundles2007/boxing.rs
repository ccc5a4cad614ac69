//! Boxing with noise, and its bundles.

use std::f64::consts::TAU;
use std::ops::Range;

use anyhow::{Context, Result};
use bundles::{BundleGraph, Closure, ExtractOptions, SeedInstance};
use cli::bundling::{pose_vectors, smoothed};
use cli::recording::{Files, ReadOptions, parse};
use ndarray::{Array2, ArrayView2, Axis};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use crate::overlap::owners;
use crate::stages::{self, Clips, Letters};
use crate::takes::Sets;

/// Of the standard deviation of each degree of freedom.
pub(crate) const AMPLITUDE: f64 = 0.1;

/// Seeds of the noise.
pub(crate) const NOISES: [u64; 5] = [1, 2, 3, 4, 5];

/// All frames as one clip.
pub(crate) fn one_clip<'a>(vectors: ArrayView2<'a, f64>, whole: &'a Range<usize>) -> Clips<'a> {
    let ranges = std::slice::from_ref(whole);
    Clips { vectors, ranges }
}

/// Poses, and what of them is put into clusters.
pub(crate) struct Take {
    poses: Array2<f64>,
    pub(crate) smooth: Array2<f64>,
}

impl Take {
    fn new(poses: &Array2<f64>, smooth: f64, rate: f64) -> Take {
        Take {
            poses: poses.clone(),
            smooth: smoothed(poses.view(), smooth * rate),
        }
    }

    pub(crate) fn letters(&self, kappa: usize, seed: u64) -> Result<Letters> {
        let whole = 0..self.smooth.nrows();
        let clips = one_clip(self.smooth.view(), &whole);
        Letters::fit(clips, kappa, seed, &mut |_| ())
    }

    /// Bundles of the letters of the take, with their own threshold unless `tau` is given.
    pub(crate) fn bundles(
        &self,
        letters: &Letters,
        tau: Option<f64>,
        (closure, from): (Closure, SeedInstance),
    ) -> Result<BundleGraph> {
        let whole = 0..self.poses.nrows();
        let string = letters.spell(one_clip(self.smooth.view(), &whole))?;
        let tau = tau.map_or_else(|| letters.threshold(&string), Ok)?;
        let options = ExtractOptions {
            seed: from,
            ..stages::options(&string, closure, 0)
        };
        let access = letters.access(tau)?;
        let poses = one_clip(self.poses.view(), &whole);
        stages::graph(poses, (&string, &access), &options, &mut |_| ())
    }

    pub(crate) fn owners(&self, graph: &BundleGraph) -> Vec<Option<usize>> {
        owners(graph, self.poses.nrows())
    }
}

/// The poses of boxing as they are, and with the noise of each seed.
pub(crate) struct Boxing {
    rate: f64,
    pub(crate) clean: Array2<f64>,
    /// Noise on the poses.
    pub(crate) poses: Vec<Array2<f64>>,
    /// Noise on the channels.
    pub(crate) channels: Vec<Array2<f64>>,
}

impl Boxing {
    pub(crate) fn read(sets: &Sets) -> Result<Boxing> {
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
        let channels = NOISES.iter().map(of_seed);
        let of_seed = |&seed: &u64| {
            let mut noisy = poses.vectors.clone();
            disturb(&mut noisy, seed);
            noisy
        };
        Ok(Boxing {
            rate: poses.rate,
            clean: poses.vectors.clone(),
            poses: NOISES.iter().map(of_seed).collect(),
            channels: channels.collect::<std::result::Result<_, _>>()?,
        })
    }

    pub(crate) fn smooth(&self, poses: &Array2<f64>, smooth: f64) -> Take {
        Take::new(poses, smooth, self.rate)
    }
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
