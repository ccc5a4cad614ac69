use ndarray::ArrayView3;

use crate::c3d::C3dErrorKind;
use crate::{Motion, Position};

/// Why a file could not be read, and where.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{at}: {kind}")]
pub struct ParseError {
    /// Where reading stopped.
    pub at: Position,
    /// What was expected and what was found.
    pub kind: ParseErrorKind,
}

/// What went wrong.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ParseErrorKind {
    /// Some other text was needed here.
    #[error("expected {expected}, found {found}")]
    Expected {
        /// What the format asks for.
        expected: &'static str,
        /// The start of what is there.
        found: String,
    },
    /// NaN, an infinity, or a number too large for a double.
    #[error("expected a finite number, found {found}")]
    NotFinite {
        /// The number as written.
        found: String,
    },
    /// A row of motion data with too few or too many values.
    #[error("expected {expected} values for {what}, found {found}")]
    ValueCount {
        /// The frame or the bone the values belong to.
        what: String,
        /// Number of values that the skeleton asks for.
        expected: usize,
        /// Number of values on the line.
        found: usize,
    },
    /// A channel or degree of freedom that the format does not know.
    #[error("unknown {what} {found:?}; known are {known}")]
    UnknownKeyword {
        /// What kind of keyword was expected.
        what: &'static str,
        /// The word as written.
        found: String,
        /// The words that would do.
        known: &'static str,
    },
    /// A bone that the skeleton does not have.
    #[error("unknown bone {name:?}{}", nearest.as_ref().map_or(String::new(), |n| format!("; the nearest name is {n:?}")))]
    UnknownBone {
        /// The name as written.
        name: String,
        /// The closest name of the skeleton, if any is close.
        nearest: Option<String>,
    },
    /// A bone that is defined, or moved within one frame, twice.
    #[error("{what} {name:?} appears twice")]
    Twice {
        /// What is repeated.
        what: &'static str,
        /// Its name.
        name: String,
    },
    /// A frame in the middle of the file that leaves out a bone which the first frame has.
    #[error("frame {frame} has no values for bone {name:?}")]
    MissingBone {
        /// Frame number as written in the file.
        frame: u64,
        /// The bone without values.
        name: String,
    },
    /// A bone that the hierarchy names but never connects to the root.
    #[error("bone {name:?} is not connected to the root")]
    Unconnected {
        /// The bone.
        name: String,
    },
    /// A number outside what the format allows.
    #[error("{what} must be {limit}, found {found}")]
    OutOfRange {
        /// Which number.
        what: &'static str,
        /// What is allowed.
        limit: &'static str,
        /// What is written.
        found: String,
    },
    /// Text in an encoding that no motion-capture software writes.
    #[error("expected UTF-8 or Latin-1 text, found {found}; save the file in one of them")]
    Encoding {
        /// The encoding's name.
        found: &'static str,
    },
    /// More parts than a figure can have.
    #[error("more than {limit} {what}")]
    TooMany {
        /// What is too many.
        what: &'static str,
        /// How many there may be.
        limit: usize,
    },
    /// Frames that move so few bones that the dense rows made of them would fill the memory.
    #[error(
        "{n_bytes} bytes of file would become {n_frames} frames of {n_channels} values, most of them \
         not in the file"
    )]
    TooSparse {
        /// Frames up to here.
        n_frames: usize,
        /// Values of a frame.
        n_channels: usize,
        /// Length of the file.
        n_bytes: usize,
    },
    /// A part without which the file makes no sense.
    #[error("the file has no {what}")]
    Missing {
        /// The missing part.
        what: &'static str,
    },
    /// A C3D file.
    #[error(transparent)]
    C3d(#[from] C3dErrorKind),
}

/// Why a motion cannot be written in a format.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The skeleton stores its offsets the other format's way.
    #[error("expected a skeleton with {expected} offsets; convert it first")]
    Layout {
        /// Which layout the format needs.
        expected: &'static str,
    },
    /// The skeleton has something that the format cannot say.
    #[error("joint {joint:?}: {what}")]
    Unsupported {
        /// The joint.
        joint: String,
        /// What cannot be written.
        what: &'static str,
    },
    /// A channel value or coordinate that is not a finite number.
    #[error("joint {joint:?}, frame {frame}: expected finite values, found {value}")]
    NotFinite {
        /// The joint that the channel moves, or the joint or marker that the coordinate is of.
        joint: String,
        /// 0-based frame.
        frame: usize,
        /// The value.
        value: f64,
    },
    /// Positions that are not three coordinates for each name.
    #[error("expected positions of shape (frames, {n_names}, 3), found {found:?}")]
    Shape {
        /// How many names there are.
        n_names: usize,
        /// The shape of the positions.
        found: [usize; 3],
    },
    /// More than the format can hold.
    #[error("{format} cannot hold {what}")]
    Limit {
        /// The format.
        format: &'static str,
        /// What is too much.
        what: &'static str,
    },
    /// The sink failed.
    #[error(transparent)]
    Io(#[from] std::io::Error),
}

impl WriteError {
    /// The error for the `value` in `column` of `frame`.
    pub(crate) fn not_finite(motion: &Motion, frame: usize, column: usize, value: f64) -> Self {
        let joint = motion.skeleton.joint_of_channel(column);
        WriteError::NotFinite {
            joint: joint.map_or_else(String::new, |j| j.name.clone()),
            frame,
            value,
        }
    }
}

/// Whether there are three coordinates for each name.
pub(crate) fn check_shape(
    names: &[&str],
    positions: ArrayView3<'_, f32>,
) -> Result<(), WriteError> {
    let (n_frames, n_points, n_axes) = positions.dim();
    if (n_points, n_axes) != (names.len(), 3) {
        return Err(WriteError::Shape {
            n_names: names.len(),
            found: [n_frames, n_points, n_axes],
        });
    }
    Ok(())
}
