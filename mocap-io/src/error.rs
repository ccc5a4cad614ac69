use std::fmt;

use crate::c3d::{C3dErrorKind, C3dWarningKind};
use crate::position::Locator;
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
    /// A frame time that is zero, negative or not finite.
    #[error("frame time must be positive and finite, found {found}")]
    FrameTime {
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

/// Something odd in a file that could still be read.
#[derive(Clone, Debug, PartialEq)]
pub struct Warning {
    /// Where.
    pub at: Position,
    /// What is odd, and what was done about it.
    pub kind: WarningKind,
}

impl Warning {
    /// A stable code, such as `BVH012`, for scripts.
    #[must_use]
    pub fn code(&self) -> &'static str {
        use WarningKind as K;
        match &self.kind {
            K::GluedNumbers => "BVH003",
            K::FrameCount { .. } => "BVH012",
            K::TruncatedRow { .. } => "BVH013",
            K::LooseBone { .. } => "ASF001",
            K::UnknownSection { .. } => "ASF002",
            K::TruncatedFrame { .. } => "AMC001",
            K::UnmovedBone { .. } => "AMC002",
            K::FrameNumber { .. } => "AMC003",
            K::UnknownAmcKeyword { .. } => "AMC004",
            K::AngleUnit { .. } => "AMC005",
            K::C3d(kind) => kind.code(),
        }
    }
}

/// Oddities by byte offset, as a reader meets them. Counting lines for each would take quadratic
/// time in a file that is odd throughout, so they are located together.
#[derive(Debug, Default)]
pub(crate) struct Oddities(Vec<(usize, WarningKind)>);

impl Oddities {
    pub(crate) fn push(&mut self, byte: usize, kind: WarningKind) {
        self.0.push((byte, kind));
    }

    /// In file order.
    pub(crate) fn into_warnings(mut self, text: &[u8]) -> Vec<Warning> {
        self.0.sort_by_key(|&(byte, _)| byte);
        let mut locator = Locator::new(text);
        let located = self.0.into_iter().map(|(byte, kind)| Warning {
            at: locator.locate(byte),
            kind,
        });
        located.collect()
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}: {}", self.at, self.code(), self.kind)
    }
}

/// What is odd, and what was done about it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WarningKind {
    /// Two numbers without a blank between them; read as two.
    #[error("no blank between two numbers; they were read as two")]
    GluedNumbers,
    /// The header's frame count is wrong; the rows decide.
    #[error("header says {header} frames, {found} found")]
    FrameCount {
        /// What the header says.
        header: u64,
        /// Number of whole rows.
        found: usize,
    },
    /// The file ends within its last row, which was dropped.
    #[error("the last row has {found} of {expected} values; it was dropped")]
    TruncatedRow {
        /// Values a row has.
        expected: usize,
        /// Values on the last row.
        found: usize,
    },
    /// A bone that the hierarchy does not name; left out.
    #[error("bone {name:?} is not in the hierarchy; it was left out")]
    LooseBone {
        /// The bone.
        name: String,
    },
    /// A section that the Acclaim format does not have; skipped.
    #[error("unknown section {name:?} was skipped")]
    UnknownSection {
        /// Its name.
        name: String,
    },
    /// The file ends within its last frame, which was dropped.
    #[error("the file is cut off within frame {frame}; {kept} whole frames were kept")]
    TruncatedFrame {
        /// Number of the cut frame as written in the file.
        frame: u64,
        /// Whole frames before it.
        kept: usize,
    },
    /// A bone with degrees of freedom that the motion never moves; it stays in its rest pose.
    #[error("bone {name:?} has no values in any frame; it keeps its rest pose")]
    UnmovedBone {
        /// The bone.
        name: String,
    },
    /// Frame numbers that do not count up by one; the order in the file decides. Reported where it
    /// happens first.
    #[error("expected frame {expected}, found frame {found}; frames were taken in file order")]
    FrameNumber {
        /// The number that would have continued the count.
        expected: u64,
        /// The number in the file.
        found: u64,
    },
    /// A keyword that the AMC format does not have; skipped.
    #[error("unknown keyword {name:?} was skipped")]
    UnknownAmcKeyword {
        /// The keyword.
        name: String,
    },
    /// Skeleton and motion name different angle units; the motion's own word is used.
    #[error("the skeleton says {skeleton}, the motion says {motion}; the motion's word was used")]
    AngleUnit {
        /// What the skeleton says.
        skeleton: &'static str,
        /// What the motion says.
        motion: &'static str,
    },
    /// In a C3D file.
    #[error(transparent)]
    C3d(#[from] C3dWarningKind),
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
    /// A channel value that is not a finite number.
    #[error("joint {joint:?}, frame {frame}: expected finite values, found {value}")]
    NotFinite {
        /// The joint that the channel moves.
        joint: String,
        /// 0-based frame.
        frame: usize,
        /// The value.
        value: f64,
    },
    /// The sink failed.
    #[error(transparent)]
    Io(#[from] std::io::Error),
}
