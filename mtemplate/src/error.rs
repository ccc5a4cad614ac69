use thiserror::Error;

use crate::{MAX_ALIGNED_COLUMNS, MAX_FEATURES};

/// Why there is no such template.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum TemplateError {
    /// The number of features does not fit a word.
    #[error("expected 1 to {MAX_FEATURES} features, found {found}")]
    Features {
        /// Number of features asked for.
        found: usize,
    },
    /// A word sets a bit that is no feature.
    #[error("frame {frame}: expected bits below {n_features}, found {word:#x}")]
    StrayBit {
        /// Frame of the word.
        frame: usize,
        /// The word.
        word: u64,
        /// Number of features.
        n_features: usize,
    },
    /// A value is no share between 0 and 1.
    #[error("column {column}, feature {feature}: expected a value in [0, 1], found {value}")]
    Value {
        /// Template column of the value.
        column: usize,
        /// Feature of the value.
        feature: usize,
        /// The value.
        value: f64,
    },
    /// A weight is not positive and finite.
    #[error("column {column}: expected a positive finite weight, found {weight}")]
    Weight {
        /// Template column of the weight.
        column: usize,
        /// The weight.
        weight: f64,
    },
    /// Values and weights disagree on the number of columns.
    #[error("expected a weight for each of {columns} columns, found {weights}")]
    Columns {
        /// Columns of the values.
        columns: usize,
        /// Number of weights.
        weights: usize,
    },
    /// The quantisation threshold leaves 0 and 1 no room of their own.
    #[error("expected a threshold in [0, 0.5), found {found}")]
    Threshold {
        /// The threshold.
        found: f64,
    },
    /// Something other than a permutation of the template's features.
    #[error("expected each of {n_features} features once, found no permutation of them")]
    Permutation {
        /// Number of features.
        n_features: usize,
    },
    /// There is nothing to learn from.
    #[error("expected one motion or more, found none")]
    NoMotions,
    /// A motion to learn from has no columns.
    #[error("motion {motion}: expected one frame or more, found none")]
    EmptyMotion {
        /// Index of the motion.
        motion: usize,
    },
    /// A motion to learn from or to align is longer than [`MAX_ALIGNED_COLUMNS`].
    #[error(
        "motion {motion}: expected at most {MAX_ALIGNED_COLUMNS} columns and as much total weight, found {found}"
    )]
    TooLong {
        /// Index of the motion.
        motion: usize,
        /// Its columns or its total weight, whichever is more.
        found: f64,
    },
    /// Motions to learn from disagree on the number of features.
    #[error("motion {motion}: expected {expected} features, found {found}")]
    FeatureCounts {
        /// Index of the motion.
        motion: usize,
        /// Features of the first motion.
        expected: usize,
        /// Features of this one.
        found: usize,
    },
}
