//! The mixture during estimation, about the centre of its frames, and the M step.

use std::f64::consts::TAU;

use ndarray::{Array1, Array2};

use super::packed::Packed;
use crate::{BundlesError, PoseClusters};

/// Of the frames' mean variance: no cluster is tighter.
const VARIANCE_FLOOR: f64 = 1e-6;

/// Frames: a cluster whose responsibilities sum to less is empty.
const EMPTY: f64 = 1e-6;

#[derive(Debug, Clone)]
pub(super) struct State {
    dims: usize,
    /// Row by row.
    means: Vec<f64>,
    pub(super) variances: Vec<f64>,
    pub(super) weights: Vec<f64>,
}

/// The least variance of a cluster of these frames; positive even where they do not vary.
pub(super) fn variance_floor(packed: &Packed) -> f64 {
    (VARIANCE_FLOOR * packed.mean_variance).max(f64::MIN_POSITIVE)
}

impl State {
    /// Clusters about the centre of the frames, none tighter than they allow.
    pub(super) fn of_clusters(clusters: &PoseClusters, packed: &Packed) -> Self {
        let means = clusters.means();
        let centred = means.outer_iter().flat_map(|mean| {
            let numbers = mean.into_iter().zip(&packed.centre);
            numbers.map(|(x, centre)| x - centre).collect::<Vec<_>>()
        });
        let floor = variance_floor(packed);
        let variances = clusters.sigmas().into_iter();
        Self {
            dims: packed.dims,
            means: centred.collect(),
            variances: variances
                .map(|sigma| (sigma * sigma).clamp(floor, f64::MAX))
                .collect(),
            weights: clusters.weights().to_vec(),
        }
    }

    pub(super) fn to_clusters(&self, packed: &Packed) -> Result<PoseClusters, BundlesError> {
        let shape = (self.n_letters(), self.dims);
        let means = Array2::from_shape_fn(shape, |(letter, dim)| {
            self.mean(letter)[dim] + packed.centre[dim]
        });
        let sigmas = self.variances.iter().map(|variance| variance.sqrt());
        let clusters = PoseClusters::new(means.view(), sigmas.collect::<Array1<f64>>().view())?;
        clusters.with_weights(Array1::from(self.weights.clone()).view())
    }

    pub(super) fn dims(&self) -> usize {
        self.dims
    }

    pub(super) fn n_letters(&self) -> usize {
        self.weights.len()
    }

    pub(super) fn mean(&self, letter: usize) -> &[f64] {
        &self.means[letter * self.dims..][..self.dims]
    }

    /// ln w - (dims/2) ln 2πσ².
    pub(super) fn log_scale(&self, letter: usize) -> f64 {
        let log_variance = TAU.ln() + self.variances[letter].ln();
        self.weights[letter].ln() - 0.5 * self.dims as f64 * log_variance
    }

    /// The M step, from the sums over frames of responsibility times row, a row of sums for each
    /// of `n_letters`. Also the clusters that are empty; nothing is known of those.
    pub(super) fn of_sums(sums: &[f64], n_letters: usize, packed: &Packed) -> (Self, Vec<usize>) {
        let dims = packed.dims;
        let floor = variance_floor(packed);
        let mut state = Self {
            dims,
            means: vec![0.0; n_letters * dims],
            variances: vec![floor; n_letters],
            weights: vec![0.0; n_letters],
        };
        let mut empty = Vec::new();
        for (letter, sums) in sums.chunks_exact(packed.width).take(n_letters).enumerate() {
            let amount = sums[dims + 1];
            if amount < EMPTY {
                empty.push(letter);
                continue;
            }
            let mut square = 0.0;
            for (mean, sum) in state.means[letter * dims..].iter_mut().zip(&sums[..dims]) {
                *mean = sum / amount;
                square += *mean * *mean;
            }
            if dims > 0 {
                let variance = (sums[dims] / amount - square) / dims as f64;
                state.variances[letter] = variance.max(floor);
            }
            state.weights[letter] = amount;
        }
        state.normalise();
        (state, empty)
    }

    /// Puts the empty clusters where frames are explained worst, ties to the earlier frame: each
    /// with the mean variance of the others and the weight of a frame.
    pub(super) fn reseed(&mut self, empty: &[usize], log_densities: &[f64], packed: &Packed) {
        let mut frames: Vec<usize> = (0..log_densities.len()).collect();
        frames.sort_by(|&a, &b| log_densities[a].total_cmp(&log_densities[b]));
        let n_others = self.n_letters() - empty.len();
        // Empty clusters have the floor's variance as yet.
        let floor = variance_floor(packed);
        let excess: f64 = self.variances.iter().map(|variance| variance - floor).sum();
        let variance = floor + excess / n_others.max(1) as f64;
        for (&letter, &frame) in empty.iter().zip(frames.iter().cycle()) {
            self.means[letter * self.dims..][..self.dims].copy_from_slice(packed.frame(frame));
            self.variances[letter] = variance;
            self.weights[letter] = 1.0 / packed.n_frames as f64;
        }
        self.normalise();
    }

    fn normalise(&mut self) {
        let total: f64 = self.weights.iter().sum();
        if total > 0.0 {
            self.weights.iter_mut().for_each(|weight| *weight /= total);
        }
    }
}
