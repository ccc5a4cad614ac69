use thiserror::Error;

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
    /// The memory for the sequences' lengths cannot be had; a narrower band may fit.
    #[error("no memory for {rows} x {columns} cells")]
    TooLarge {
        /// Frames of the first sequence.
        rows: usize,
        /// Cells kept for each of them.
        columns: usize,
    },
}
