use thiserror::Error;

use crate::StepPattern;

/// Why two sequences cannot be compared at all.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum DtwError {
    /// The sequences have different numbers of dimensions.
    #[error("expected sequences of equal dimension, found {a} and {b}")]
    Dimensions {
        /// Dimensions of the first sequence.
        a: usize,
        /// Dimensions of the second sequence.
        b: usize,
    },
    /// A band states another number of rows than the first sequence has frames.
    #[error(
        "expected a band of {expected} rows, one for each frame of the first sequence, found {found}"
    )]
    BandRows {
        /// Frames of the first sequence.
        expected: usize,
        /// Rows of the band.
        found: usize,
    },
    /// A step pattern that is none.
    #[error(
        "expected 1 to {} steps that advance by 1 to {} frames with finite weights of at least 0",
        StepPattern::MAX_STEPS,
        StepPattern::MAX_ADVANCE
    )]
    StepPattern,
    /// The memory for the sequences' lengths cannot be had; a narrower band may fit.
    #[error("no memory for {rows} x {columns} cells")]
    TooLarge {
        /// Frames of the first sequence.
        rows: usize,
        /// Cells kept for each of them.
        columns: usize,
    },
}
