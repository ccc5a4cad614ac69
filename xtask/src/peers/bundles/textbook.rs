//! Expectation maximisation of isotropic Gaussians as the textbook has it: all responsibilities of
//! all frames, and new parameters from these.

use std::f64::consts::TAU;

use super::data::DIMS;

pub(super) struct Mixture {
    pub(super) weights: Vec<f64>,
    variances: Vec<f64>,
    means: Vec<[f64; DIMS]>,
}

impl Mixture {
    /// From weights, variances and means one after the other.
    pub(super) fn from_numbers(numbers: &[f64]) -> Self {
        let kappa = numbers.len() / (DIMS + 2);
        let (weights, rest) = numbers.split_at(kappa);
        let (variances, means) = rest.split_at(kappa);
        Self {
            weights: weights.to_vec(),
            variances: variances.to_vec(),
            means: means.as_chunks().0.to_vec(),
        }
    }

    /// One iteration; gives the mean log-likelihood of a frame before it.
    pub(super) fn iterate(&mut self, frames: &[[f64; DIMS]]) -> f64 {
        let mut log_likelihood = 0.0;
        let kappa = self.weights.len();
        let mut amounts = vec![0.0; kappa];
        let mut sums = vec![[0.0; DIMS]; kappa];
        let mut squares = vec![0.0; kappa];
        let mut densities = vec![0.0; kappa];
        let scale =
            |k: usize| self.weights[k].ln() - 0.5 * DIMS as f64 * (TAU * self.variances[k]).ln();
        let scales: Vec<f64> = (0..kappa).map(scale).collect();
        for x in frames {
            for (k, density) in densities.iter_mut().enumerate() {
                let square = squared_distance(x, &self.means[k]);
                *density = scales[k] - 0.5 * square / self.variances[k];
            }
            let largest = densities.iter().copied().fold(f64::MIN, f64::max);
            let total: f64 = densities.iter().map(|d| (d - largest).exp()).sum();
            log_likelihood += largest + total.ln();
            for (k, density) in densities.iter().enumerate() {
                let share = (density - largest).exp() / total;
                amounts[k] += share;
                squares[k] += share * squared_distance(x, &[0.0; DIMS]);
                sums[k].iter_mut().zip(x).for_each(|(s, x)| *s += share * x);
            }
        }
        for k in 0..kappa {
            self.weights[k] = amounts[k] / frames.len() as f64;
            self.means[k] = sums[k].map(|sum| sum / amounts[k]);
            let of_mean = squared_distance(&self.means[k], &[0.0; DIMS]);
            self.variances[k] = (squares[k] / amounts[k] - of_mean) / DIMS as f64;
        }
        log_likelihood / frames.len() as f64
    }

    /// The weighted mean of the means' squared lengths.
    pub(super) fn spread(&self) -> f64 {
        let squares = self.means.iter().map(|m| squared_distance(m, &[0.0; DIMS]));
        squares
            .zip(&self.weights)
            .map(|(square, w)| square * w)
            .sum()
    }
}

fn squared_distance(a: &[f64; DIMS], b: &[f64; DIMS]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two frames far apart, a cluster at each: responsibilities are 0 and 1.
    #[test]
    fn clusters_far_apart_take_the_mean_and_variance_of_their_frames() {
        let at = |x: f64| [x; DIMS];
        let frames = [at(0.0), at(2.0), at(100.0), at(104.0)];
        let numbers = [&[0.5, 0.5, 1.0, 1.0][..], &at(1.0), &at(101.0)].concat();
        let mut mixture = Mixture::from_numbers(&numbers);
        mixture.iterate(&frames);
        assert_eq!(mixture.weights, [0.5, 0.5]);
        assert_eq!(mixture.means, [at(1.0), at(102.0)]);
        assert_eq!(mixture.variances, [1.0, 4.0]);
    }
}
