//! Sums over the members of a bundle, from which a variance with one member more follows.

use ndarray::{Array1, ArrayView1};

use super::distance_to_mean;

/// Sums of a bundle's first poses, last poses and durations. Durations are whole numbers of
/// frames, so their sums are exact.
#[derive(Debug, Clone)]
pub(super) struct Moments {
    n: f64,
    first: Array1<f64>,
    last: Array1<f64>,
    durations: f64,
    squares: f64,
}

impl Moments {
    /// Those of a bundle of `n` members, before any is added.
    pub(super) fn new(n: usize, dims: usize) -> Self {
        Self {
            n: n as f64,
            first: Array1::zeros(dims),
            last: Array1::zeros(dims),
            durations: 0.0,
            squares: 0.0,
        }
    }

    pub(super) fn add_first(&mut self, pose: ArrayView1<'_, f64>, sign: f64) {
        self.first.scaled_add(sign, &pose);
    }

    pub(super) fn add_last(&mut self, pose: ArrayView1<'_, f64>, sign: f64) {
        self.last.scaled_add(sign, &pose);
    }

    pub(super) fn add_duration(&mut self, duration: f64, sign: f64) {
        self.durations += sign * duration;
        self.squares += sign * duration * duration;
    }

    /// The part of tr cov{first poses} that depends on `pose`, the other n - 1 being summed up:
    /// (n - 1)/n²·‖x - mean of the others‖².
    pub(super) fn first_cost(&self, pose: ArrayView1<'_, f64>) -> f64 {
        self.pose_cost(pose, &self.first)
    }

    /// As [`first_cost`](Self::first_cost), of the last poses.
    pub(super) fn last_cost(&self, pose: ArrayView1<'_, f64>) -> f64 {
        self.pose_cost(pose, &self.last)
    }

    fn pose_cost(&self, pose: ArrayView1<'_, f64>, sum: &Array1<f64>) -> f64 {
        if self.n < 2.0 {
            return 0.0;
        }
        let others = self.n - 1.0;
        others / (self.n * self.n) * distance_to_mean(pose, sum, others)
    }

    /// The variance of all durations, `added` being those that are not summed up.
    pub(super) fn duration_cost(&self, added: &[f64]) -> f64 {
        let sum = self.durations + added.iter().sum::<f64>();
        let squares = self.squares + added.iter().map(|d| d * d).sum::<f64>();
        (self.n * squares - sum * sum) / (self.n * self.n)
    }
}
