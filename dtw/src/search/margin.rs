//! From sums of deviations in `f64` to what no computed cost can be below.

use crate::{LocalCost, Sample};

/// What is summed for a pair of frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Norm {
    /// Sum of squared differences.
    Squares,
    /// Root of that.
    Root,
    /// Sum of absolute differences.
    Absolutes,
}

impl Norm {
    pub(super) fn of(local: LocalCost) -> Self {
        match local {
            LocalCost::Euclidean => Self::Root,
            LocalCost::Manhattan => Self::Absolutes,
            // Of directions: the cost is half of it.
            LocalCost::SquaredEuclidean | LocalCost::Cosine => Self::Squares,
        }
    }
}

/// Frames of both sequences and their dimensions.
#[derive(Debug, Clone, Copy)]
pub(super) struct Size {
    pub(super) frames: usize,
    pub(super) dims: usize,
}

/// The rounding that lies between a lower bound and the cost that is to be bounded.
#[derive(Debug, Clone, Copy)]
pub(super) struct Margin {
    pub(super) norm: Norm,
    /// Cost per unit of the sums.
    scale: f64,
    /// Share of a sum that is certain.
    certain: f64,
    /// What a cost may lose below the smallest normal number.
    underflow: f64,
    /// Uncertainty of a sum's points, as [`Self::lower_bound`] takes it.
    pub(super) directions: f64,
}

impl Margin {
    /// A path has fewer than `frames` pairs, and a local cost of `T` has a relative error below
    /// 8 (dims + 4) ε: that of single precision's expanded form, the largest there is. With one
    /// rounding for each addition along the path and less than as much for the bound itself,
    /// (8 (dims + 4) + frames) ε is enough; twice that also covers products of errors.
    ///
    /// Squares below the smallest normal number η may vanish: up to 8 (dims + 1) of them in the
    /// sums of each pair.
    ///
    /// A direction is rounded by at most (dims + 4) ε, that of either frame.
    pub(super) fn new<T: Sample>(local: LocalCost, size: Size) -> Self {
        let (epsilon, least): (f64, f64) = (T::epsilon().into(), T::min_positive_value().into());
        let (frames, dims) = (size.frames as f64, size.dims as f64);
        let norm = Norm::of(local);
        let lost = 8.0 * (dims + 1.0) * least;
        let lost = if norm == Norm::Root {
            lost.sqrt()
        } else {
            lost
        };
        let is_cosine = local == LocalCost::Cosine;
        let direction = if is_cosine {
            2.0 * (dims + 4.0) * epsilon
        } else {
            0.0
        };
        Self {
            norm,
            scale: if is_cosine { 0.5 } else { 1.0 },
            certain: (1.0 - 2.0 * (8.0 * (dims + 4.0) + frames) * epsilon).max(0.0),
            underflow: frames * lost,
            directions: direction * frames.sqrt(),
        }
    }

    /// At most the cost that [`crate::Dtw`] finds, if every sum of deviations is `sum` for points
    /// that are off by up to `error`: for [`Norm::Squares`] in the length of the vector of all
    /// deviations, else in the sum of the deviations of frames. Zero for an error without bound.
    #[inline(always)]
    pub(super) fn lower_bound(&self, sum: f64, error: f64) -> f64 {
        let sum = match self.norm {
            Norm::Squares => {
                let length = (sum.sqrt() - error).max(0.0);
                self.scale * length * length
            }
            Norm::Root | Norm::Absolutes => (sum - error).max(0.0),
        };
        sum * self.certain - self.underflow
    }

    /// [`Self::lower_bound`]'s error, when each of `n_terms` frames is off by up to `error` in its
    /// norm.
    #[inline(always)]
    pub(super) fn error_of_frames(&self, n_terms: f64, error: f64) -> f64 {
        match self.norm {
            Norm::Squares => n_terms.sqrt() * error,
            Norm::Root | Norm::Absolutes => n_terms * error,
        }
    }

    /// A sum above this has a lower bound above `limit`.
    #[inline(always)]
    pub(super) fn cut(&self, limit: f64, error: f64) -> f64 {
        let sum = (limit + self.underflow) / (self.certain * self.scale);
        let sum = match self.norm {
            Norm::Squares => {
                let length = sum.sqrt() + error;
                length * length
            }
            Norm::Root | Norm::Absolutes => sum + error,
        };
        // Far more than the few roundings here and there.
        sum * (1.0 + 64.0 * f64::EPSILON)
    }
}
