//! Expectation maximisation, from a start to its end.

use ndarray::ArrayView2;
use pulp::Arch;

use super::estimate::{Coefficients, Pass};
use super::packed::Packed;
use super::state::State;
use super::{EmOptions, Kappa, MixtureError, MixtureFit, kappa, seeding};
use crate::{PoseClusters, parallel};

/// Fits isotropic Gaussians to `frames`, of shape `(frames, dims)`.
///
/// Starts from k-means++ with the frames' nearest centres for the first M step; one number drawn for
/// each frame decides all centres, so that a little noise on the poses, or frames added at the end,
/// leave most of them where they are. There are as many
/// letters as asked for, unless fewer frames are distinct: then there are that many.
///
/// # Errors
///
/// When there are no frames, a number is not finite, or frames are too far apart for sums of
/// squares.
pub fn fit_mixture(
    frames: ArrayView2<'_, f64>,
    options: &EmOptions,
) -> Result<MixtureFit, MixtureError> {
    let packed = Packed::new(frames)?;
    let (n_letters, candidates) = match options.kappa {
        Kappa::Letters(n_letters) => (n_letters.get(), Vec::new()),
        Kappa::Auto => kappa::choose(frames, options)?,
    };
    let start = seeding::seed(&packed, n_letters, options.seed);
    let mut fit = run(&packed, start, options).into_fit(&packed)?;
    fit.candidates = candidates;
    Ok(fit)
}

/// Fits isotropic Gaussians to `frames`, starting from `start`; κ and the seed play no part.
///
/// Standard deviations below the floor are raised to it at once.
///
/// # Errors
///
/// As [`fit_mixture`]; and when `start` has no letters or other dimensions than the frames.
pub fn fit_mixture_from(
    frames: ArrayView2<'_, f64>,
    start: &PoseClusters,
    options: &EmOptions,
) -> Result<MixtureFit, MixtureError> {
    start.check_frames(frames)?;
    let packed = Packed::new(frames)?;
    let start = State::of_clusters(start, &packed);
    run(&packed, start, options).into_fit(&packed)
}

/// How estimation went.
pub(super) struct Run {
    pub(super) state: State,
    log_likelihoods: Vec<f64>,
    reseeded: Vec<usize>,
    has_converged: bool,
}

impl Run {
    fn into_fit(self, packed: &Packed) -> Result<MixtureFit, MixtureError> {
        Ok(MixtureFit {
            clusters: self.state.to_clusters(packed)?,
            log_likelihoods: self.log_likelihoods,
            reseeded: self.reseeded,
            has_converged: self.has_converged,
            candidates: Vec::new(),
        })
    }
}

pub(super) fn run(packed: &Packed, start: State, options: &EmOptions) -> Run {
    let mut run = Run {
        state: start,
        log_likelihoods: Vec::new(),
        reseeded: Vec::new(),
        has_converged: false,
    };
    for iteration in 0..options.max_iterations {
        let total = Total::of(packed, &run.state);
        let (mut state, empty) = State::of_sums(&total.sums, run.state.n_letters(), packed);
        if !empty.is_empty() {
            state.reseed(&empty, &total.log_densities, packed);
        }
        run.state = state;
        let before = run.log_likelihoods.last().copied();
        run.log_likelihoods.push(total.log_likelihood);
        // After re-seeding the likelihood may fall: such a step says nothing about convergence.
        let is_settled = empty.is_empty() && !run.reseeded.ends_with(&[iteration.wrapping_sub(1)]);
        if !empty.is_empty() {
            run.reseeded.push(iteration);
        }
        let is_close = |before: f64| {
            let change = (total.log_likelihood - before).abs();
            change < options.tolerance * before.abs() || change == 0.0 && options.tolerance > 0.0
        };
        if is_settled && before.is_some_and(is_close) {
            run.has_converged = true;
            break;
        }
    }
    run
}

/// The log-likelihood of the frames.
pub(super) fn log_likelihood(packed: &Packed, state: &State) -> f64 {
    Total::of(packed, state).log_likelihood
}

/// What all frames add up to.
struct Total {
    sums: Vec<f64>,
    log_densities: Vec<f64>,
    log_likelihood: f64,
}

impl Total {
    /// Chunks are summed each for itself and then in their order, whichever thread was first.
    fn of(packed: &Packed, state: &State) -> Self {
        let coefficients = Coefficients::new(state);
        let arch = Arch::new();
        let partials = parallel::map(&packed.chunks(), |_, chunk| {
            arch.dispatch(Pass {
                packed,
                coefficients: &coefficients,
                chunk,
            })
        });
        let mut total = Self {
            sums: vec![0.0; state.n_letters() * packed.width],
            log_densities: Vec::with_capacity(packed.n_frames),
            log_likelihood: 0.0,
        };
        for partial in partials {
            let both = total.sums.iter_mut().zip(&*partial.sums);
            both.for_each(|(sum, part)| *sum += part);
            total.log_likelihood += partial.log_densities.iter().sum::<f64>();
            total.log_densities.extend(partial.log_densities);
        }
        total
    }
}
