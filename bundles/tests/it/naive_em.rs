//! k-means++ and expectation maximisation, number by number.

use std::f64::consts::TAU;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

const VARIANCE_FLOOR: f64 = 1e-6;

/// A mixture, about the mean of its frames.
#[derive(Debug, Clone)]
pub(crate) struct Mixture {
    pub(crate) weights: Vec<f64>,
    pub(crate) means: Vec<Vec<f64>>,
    pub(crate) variances: Vec<f64>,
}

pub(crate) fn mean_of(frames: &[Vec<f64>]) -> Vec<f64> {
    let n = frames.len() as f64;
    let of_dim = |dim: usize| {
        let first = frames[0][dim];
        first + frames.iter().map(|x| x[dim] - first).sum::<f64>() / n
    };
    (0..frames[0].len()).map(of_dim).collect()
}

/// Frames less their mean.
pub(crate) fn centred(frames: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mean = mean_of(frames);
    let less = |x: &Vec<f64>| x.iter().zip(&mean).map(|(x, mean)| x - mean).collect();
    frames.iter().map(less).collect()
}

pub(crate) fn squared_distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum()
}

/// Mean over the dimensions of the variance of centred frames.
pub(crate) fn mean_variance(frames: &[Vec<f64>]) -> f64 {
    let squares = frames.iter().map(|x| x.iter().map(|x| x * x).sum::<f64>());
    squares.sum::<f64>() / (frames.len() * frames[0].len().max(1)) as f64
}

fn floor(frames: &[Vec<f64>]) -> f64 {
    (VARIANCE_FLOOR * mean_variance(frames)).max(f64::MIN_POSITIVE)
}

/// Draws centres by an exponential race whose speeds are squared distances, and gives each frame to the nearest.
pub(crate) fn seed(frames: &[Vec<f64>], kappa: usize, seed: u64) -> Mixture {
    let mut dice = ChaCha8Rng::seed_from_u64(seed);
    let mut uniform = || (dice.next_u64() >> 11) as f64 / 2.0_f64.powi(53);
    let mut ways: Vec<f64> = frames.iter().map(|_| -(1.0 - uniform()).ln()).collect();
    let mut speeds = vec![1.0; frames.len()];
    let mut centres: Vec<Vec<f64>> = Vec::new();
    while centres.len() < kappa {
        // The smaller index of those that arrive at once; nobody who stands still.
        let times = (0..frames.len()).filter(|&i| speeds[i] > 0.0);
        let times = times.map(|i| (ways[i] / speeds[i], i));
        let Some((time, first)) = times.min_by(|a, b| a.partial_cmp(b).unwrap()) else {
            break;
        };
        for (way, speed) in ways.iter_mut().zip(&speeds) {
            *way = (*way - time * speed).max(0.0);
        }
        centres.push(frames[first].clone());
        let nearest = |x: &Vec<f64>| {
            let squares = centres.iter().map(|centre| squared_distance(x, centre));
            squares.fold(f64::INFINITY, f64::min)
        };
        speeds = frames.iter().map(nearest).collect();
    }
    let mut shares = vec![vec![0.0; centres.len()]; frames.len()];
    for (x, shares) in frames.iter().zip(&mut shares) {
        let mut nearest = 0;
        for (letter, centre) in centres.iter().enumerate() {
            if squared_distance(x, centre) < squared_distance(x, &centres[nearest]) {
                nearest = letter;
            }
        }
        shares[nearest] = 1.0;
    }
    maximise(frames, &shares)
}

/// ln w p(x|a) of every letter.
pub(crate) fn log_joint(x: &[f64], mixture: &Mixture) -> Vec<f64> {
    let of_letter = |letter: usize| {
        let variance = mixture.variances[letter];
        let square = squared_distance(x, &mixture.means[letter]);
        mixture.weights[letter].ln()
            - x.len() as f64 / 2.0 * (TAU.ln() + variance.ln())
            - square / (2.0 * variance)
    };
    (0..mixture.weights.len()).map(of_letter).collect()
}

/// Responsibilities and the log-likelihood.
fn expect(frames: &[Vec<f64>], mixture: &Mixture) -> (Vec<Vec<f64>>, f64) {
    let mut log_likelihood = 0.0;
    let mut of_frame = |x: &Vec<f64>| {
        let exponents = log_joint(x, mixture);
        let largest = exponents.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let exponentials: Vec<f64> = exponents.iter().map(|e| (e - largest).exp()).collect();
        let total: f64 = exponentials.iter().sum();
        log_likelihood += largest + total.ln();
        exponentials.iter().map(|e| e / total).collect()
    };
    let shares = frames.iter().map(&mut of_frame).collect();
    (shares, log_likelihood)
}

fn maximise(frames: &[Vec<f64>], shares: &[Vec<f64>]) -> Mixture {
    let dims = frames[0].len();
    let mut mixture = Mixture {
        weights: Vec::new(),
        means: Vec::new(),
        variances: Vec::new(),
    };
    for letter in 0..shares[0].len() {
        let amount: f64 = shares.iter().map(|shares| shares[letter]).sum();
        let weighted = |of: &dyn Fn(&[f64]) -> f64| {
            let terms = frames.iter().zip(shares).map(|(x, s)| s[letter] * of(x));
            terms.sum::<f64>() / amount
        };
        let mean: Vec<f64> = (0..dims).map(|dim| weighted(&|x| x[dim])).collect();
        let square = weighted(&|x| squared_distance(x, &mean));
        mixture.weights.push(amount / frames.len() as f64);
        let variance = square / dims.max(1) as f64;
        mixture.variances.push(variance.max(floor(frames)));
        mixture.means.push(mean);
    }
    mixture
}

/// `iterations` times both steps, and the log-likelihood before each.
pub(crate) fn iterate(
    frames: &[Vec<f64>],
    start: &Mixture,
    iterations: usize,
) -> (Mixture, Vec<f64>) {
    let mut mixture = start.clone();
    for variance in &mut mixture.variances {
        *variance = variance.max(floor(frames));
    }
    let mut log_likelihoods = Vec::new();
    for _ in 0..iterations {
        let (shares, log_likelihood) = expect(frames, &mixture);
        log_likelihoods.push(log_likelihood);
        mixture = maximise(frames, &shares);
    }
    (mixture, log_likelihoods)
}
