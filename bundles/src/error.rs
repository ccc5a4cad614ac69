use std::ops::Range;

use thiserror::Error;

/// Why clips cannot be spelt or letters cannot be compared.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum BundlesError {
    /// A clip ends before it starts, starts inside the one before it, or ends past the labels.
    #[error("clip {clip}: expected a range within {allowed:?}, found {found:?}")]
    Clip {
        /// Index of the clip.
        clip: usize,
        /// Frames it may use.
        allowed: Range<usize>,
        /// Frames it names.
        found: Range<usize>,
    },
    /// Means and standard deviations disagree on the number of letters.
    #[error("expected a standard deviation for each of {means} letters, found {sigmas}")]
    Letters {
        /// Number of means.
        means: usize,
        /// Number of standard deviations.
        sigmas: usize,
    },
    /// A mean is not finite.
    #[error("letter {letter}: expected a finite mean, found {found}")]
    Mean {
        /// The letter.
        letter: usize,
        /// The element of its mean.
        found: f64,
    },
    /// A standard deviation is not positive and finite.
    #[error("letter {letter}: expected a positive finite standard deviation, found {found}")]
    Sigma {
        /// The letter.
        letter: usize,
        /// Its standard deviation.
        found: f64,
    },
    /// There is not one weight for each letter.
    #[error("expected a weight for each of {letters} letters, found {weights}")]
    Weights {
        /// Number of letters.
        letters: usize,
        /// Number of weights.
        weights: usize,
    },
    /// A weight is negative or not finite.
    #[error("letter {letter}: expected a finite weight of at least 0, found {found}")]
    Weight {
        /// The letter.
        letter: usize,
        /// Its weight.
        found: f64,
    },
    /// Weights do not add up to anything.
    #[error("expected weights with a positive finite sum, found {found}")]
    WeightSum {
        /// The sum.
        found: f64,
    },
    /// The string uses a letter that has no cluster.
    #[error("expected letters below {n_letters}, found {letter}")]
    UnknownLetter {
        /// The letter.
        letter: u32,
        /// Number of clusters.
        n_letters: usize,
    },
}
