use thiserror::Error;

use crate::BundlesError;

/// Why no mixture fits frames, or frames cannot be labelled by one.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum MixtureError {
    /// There is nothing to fit a mixture to.
    #[error("expected at least one frame, found none")]
    NoFrames,
    /// A number of a frame is infinite or NaN.
    #[error("frame {frame}, dimension {dim}: expected a finite number, found {found}")]
    NotFinite {
        /// The frame.
        frame: usize,
        /// The dimension.
        dim: usize,
        /// The number.
        found: f64,
    },
    /// A frame is so far from the mean of all that sums of squares overflow.
    #[error("frame {frame}: expected a distance from the mean whose square can be summed")]
    Magnitude {
        /// The frame.
        frame: usize,
    },
    /// Frames and clusters disagree on the number of dimensions.
    #[error("expected frames of {expected} dimensions, found {found}")]
    Dimensions {
        /// Dimensions of the clusters.
        expected: usize,
        /// Dimensions of the frames.
        found: usize,
    },
    /// There is no letter to start from or to label frames with.
    #[error("expected at least one letter, found none")]
    NoLetters,
    /// The estimate is no mixture.
    #[error(transparent)]
    Clusters(#[from] BundlesError),
}
