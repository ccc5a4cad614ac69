//! Takes with noise, and their bundles.

use std::f64::consts::TAU;
use std::ops::Range;

use anyhow::{Context, Result};
use cli::bundling::{Poses, pose_vectors};
use cli::recording::{Files, ReadOptions, parse};
use mocap_io::Motion;
use ndarray::{Array2, ArrayView2, Axis, concatenate, s};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use crate::stages::{Clips, Letters, Smooth};
use crate::takes::{How, Set};

/// Of the standard deviation of each degree of freedom.
pub(crate) const AMPLITUDE: f64 = 0.1;

/// Seeds of the noise.
pub(crate) const NOISES: [u64; 5] = [1, 2, 3, 4, 5];

/// Dimensions of a pose that are rates: of the yaw, and two velocities. They are the last ones.
const N_RATES: usize = 3;

/// The poses of clips as they are, and with the noise of each seed.
pub(crate) struct Noisy {
    rate: f64,
    ranges: Vec<Range<usize>>,
    pub(crate) clean: Array2<f64>,
    /// Noise on the poses.
    pub(crate) poses: Vec<Array2<f64>>,
    /// Noise on the channels.
    pub(crate) channels: Vec<Array2<f64>>,
}

impl Noisy {
    pub(crate) fn of(set: &Set) -> Result<Noisy> {
        let (clean, ranges) = set.vectors()?;
        let rate = set.rate()?;
        let motions: Vec<Motion> = set.poses.iter().map(motion).collect::<Result<_>>()?;
        let views: Vec<_> = motions
            .iter()
            .map(|motion| motion.channels.view())
            .collect();
        let channels = concatenate(Axis(0), &views)?;
        let of_seed = |&seed: &u64| {
            let noisy = disturbed(channels.view(), seed);
            let of_clip = motions.iter().zip(&ranges).map(|(motion, range)| {
                let mut motion = motion.clone();
                motion.channels = noisy.slice(s![range.clone(), ..]).to_owned();
                pose_vectors(&motion)
            });
            let vectors: Vec<_> = of_clip.collect::<std::result::Result<_, _>>()?;
            let views: Vec<_> = vectors.iter().map(|vectors| vectors.view()).collect();
            Ok(concatenate(Axis(0), &views)?)
        };
        Ok(Noisy {
            rate,
            poses: NOISES
                .iter()
                .map(|&seed| disturbed(clean.view(), seed))
                .collect(),
            channels: NOISES.iter().map(of_seed).collect::<Result<_>>()?,
            clean,
            ranges,
        })
    }

    /// Noise of the channels as the poses have it: of the last dimensions of a pose, the deviation of the noise
    /// over that of the dimension.
    pub(crate) fn of_rates(&self) -> Result<[f64; N_RATES]> {
        let noisy = self.channels.first().context("no noise")?;
        let noise = (noisy - &self.clean).std_axis(Axis(0), 0.0);
        let ratios = noise / self.clean.std_axis(Axis(0), 0.0);
        let rates = ratios.iter().copied().skip(ratios.len() - N_RATES);
        rates
            .collect::<Vec<_>>()
            .try_into()
            .ok()
            .context("no rates")
    }

    /// Poses of these clips, smoothed, and their letters.
    pub(crate) fn spelt<'a>(
        &'a self,
        poses: &'a Array2<f64>,
        (how, kappa, seed): (How, usize, u64),
    ) -> Result<(Smooth<'a>, Letters)> {
        let smooth = self.smooth(poses, how);
        let letters = smooth.letters(kappa, seed, &mut |_| ())?;
        Ok((smooth, letters))
    }

    /// Poses of these clips, smoothed.
    pub(crate) fn smooth<'a>(&'a self, poses: &'a Array2<f64>, how: How) -> Smooth<'a> {
        let clips = Clips {
            vectors: poses.view(),
            ranges: &self.ranges,
        };
        Smooth::new(clips, self.rate, how)
    }
}

fn motion(poses: &Poses) -> Result<Motion> {
    let options = ReadOptions::default();
    let path = &poses.clip.path;
    let loaded = parse(path, Files::read(path, &options)?, &options)?;
    loaded.recording.motion().cloned().context("no motion")
}

/// With Gaussian noise in proportion to the standard deviation of each column.
fn disturbed(columns: ArrayView2<'_, f64>, seed: u64) -> Array2<f64> {
    let mut dice = ChaCha8Rng::seed_from_u64(seed);
    let sigmas = columns.std_axis(Axis(0), 0.0);
    let mut noisy = columns.to_owned();
    for mut row in noisy.rows_mut() {
        for (x, sigma) in row.iter_mut().zip(&sigmas) {
            *x += AMPLITUDE * sigma * normal(&mut dice);
        }
    }
    noisy
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
        let noisy = disturbed(clean.view(), 7);
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
