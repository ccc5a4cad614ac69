//! Isotropic Gaussian mixtures: fitted by expectation maximisation, or about chosen frames, and the
//! labels they give.

use std::num::NonZeroUsize;

use crate::PoseClusters;

mod aligned;
mod em;
mod error;
mod estimate;
mod exemplars;
mod exp;
mod kappa;
mod label;
mod packed;
mod seeding;
mod state;

pub use em::{fit_mixture, fit_mixture_from};
pub use error::MixtureError;
pub use exemplars::exemplars;

/// How many letters there are to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kappa {
    /// So many; fewer where fewer frames are distinct.
    Letters(NonZeroUsize),
    /// The least Bayesian information criterion, with one variance for each letter.
    ///
    /// At most 8,192 evenly spaced frames decide. Candidates are 1, 2, 3, 4, 6, 8, 12, 16 and so on,
    /// up to a quarter of those frames; they are fitted in this order until two in a row are no
    /// better than the best, which the smaller of equals is.
    Auto,
}

/// How a mixture is fitted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EmOptions {
    /// κ.
    pub kappa: Kappa,
    /// Of the k-means++ draws.
    pub seed: u64,
    /// Estimation ends after so many iterations.
    pub max_iterations: usize,
    /// Estimation ends when the log-likelihood has changed by less than this share of itself; at 0
    /// only [`Self::max_iterations`] ends it.
    pub tolerance: f64,
}

impl EmOptions {
    /// Seed 0, at most 100 iterations, tolerance 1e-4.
    pub const fn new(kappa: Kappa) -> Self {
        Self {
            kappa,
            seed: 0,
            max_iterations: 100,
            tolerance: 1e-4,
        }
    }
}

/// Which letter a frame gets.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LabelRule {
    /// The one with the greatest p(x|a), whatever its weight.
    #[default]
    Likelihood,
    /// The one with the greatest w p(x|a).
    Posterior,
}

/// A fitted mixture and how it came about.
#[derive(Debug, Clone, PartialEq)]
pub struct MixtureFit {
    /// The mixture.
    pub clusters: PoseClusters,
    /// For each iteration the natural logarithm of the frames' likelihood before it, for all frames
    /// together.
    pub log_likelihoods: Vec<f64>,
    /// Iterations after which empty clusters were put elsewhere; elsewhere is where frames were
    /// explained worst.
    pub reseeded: Vec<usize>,
    /// Whether the log-likelihood settled before the iterations ran out.
    pub has_converged: bool,
    /// What [`Kappa::Auto`] tried, in order.
    pub candidates: Vec<KappaCandidate>,
}

/// A number of letters and its criterion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KappaCandidate {
    /// Letters.
    pub n_letters: usize,
    /// Bayesian information criterion; less is better.
    pub bic: f64,
}
