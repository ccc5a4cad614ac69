use super::{ByteOrder, Storage};

/// Why a C3D file could not be read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum C3dErrorKind {
    /// The second byte of every C3D file is 80.
    #[error("expected the byte 80 that marks a C3D file, found {found}")]
    Mark {
        /// What is there.
        found: u8,
    },
    /// The header takes 512 bytes.
    #[error("expected a header of 512 bytes, found {found}")]
    Header {
        /// Bytes that the file has.
        found: usize,
    },
    /// Neither the parameter section nor the header makes sense in any byte order.
    #[error(
        "expected a processor type of 84, 85 or 86, found {found}, and the header fits none of them"
    )]
    Processor {
        /// What is there.
        found: u8,
    },
    /// The file ends before the data of its first frame do.
    #[error("expected at least one frame of {frame} bytes, found {found}")]
    NoData {
        /// Bytes of a frame.
        frame: usize,
        /// Bytes from the start of the data on.
        found: usize,
    },
    /// More bytes per frame than can be counted.
    #[error("a frame of {points} points and {analog} analog values is too large")]
    FrameSize {
        /// Points of a frame.
        points: u64,
        /// Analog values of a frame.
        analog: u64,
    },
    /// Neither points nor analog values.
    #[error("the file has neither points nor analog values")]
    Empty,
}

/// What is odd in a C3D file, and what was done about it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum C3dWarningKind {
    /// The processor type is none that exists.
    #[error("processor type {found} does not exist; the header fits {order}")]
    Processor {
        /// What is there.
        found: u8,
        /// What was taken.
        order: ByteOrder,
    },
    /// No parameter section where the header says.
    #[error("there is no parameter section; the header alone was used")]
    NoParameters,
    /// The chain of parameters is broken.
    #[error("the parameter section is broken here; the parameters before were kept")]
    BrokenParameters,
    /// A parameter's value reaches past its record.
    #[error("parameter {name} is longer than its record; the rest was left out")]
    CutParameter {
        /// The parameter.
        name: String,
    },
    /// Parameters of a group that the file does not define.
    #[error("parameters of group {id}, which has no name")]
    NamelessGroup {
        /// Number of the group in the file.
        id: u8,
    },
    /// Header and parameters say different things.
    #[error("the header's {what} is {header}, {parameter} is {value}; {used} was used")]
    Disagreement {
        /// What it is about.
        what: &'static str,
        /// What the header says.
        header: f64,
        /// Which parameter differs.
        parameter: &'static str,
        /// What it says.
        value: f64,
        /// What was taken.
        used: f64,
    },
    /// Header, parameters and the size of the data do not agree on the number of frames.
    #[error("the file says {said} frames, {used} were read")]
    FrameCount {
        /// What the parameters, or else the header, say.
        said: u64,
        /// What was read.
        used: usize,
    },
    /// The file ends within its data.
    #[error("the file ends within frame {cut}; {cut} whole frames were kept")]
    Truncated {
        /// The frame that is cut, counted from 0, and so the number of frames kept.
        cut: usize,
    },
    /// A scale factor that is zero or no number.
    #[error("the scale is {found}; 1 was used and the data taken for {storage}")]
    Scale {
        /// What the file says.
        found: f32,
        /// How the data were read.
        storage: Storage,
    },
    /// No frame rate anywhere.
    #[error("the file names no frame rate; {used} Hz was used")]
    NoRate {
        /// What was taken.
        used: f64,
    },
    /// POINT:UNITS is no unit of length.
    #[error("unknown unit {found:?}; it was guessed")]
    Unit {
        /// The unit as written.
        found: String,
    },
    /// Points without a label.
    #[error("{count} points have no label; they are called point{first} and so on")]
    NoLabels {
        /// How many.
        count: usize,
        /// Number of the first, counted from 1.
        first: usize,
    },
    /// Labels that several points have.
    #[error("label {name:?} appears again; such names got a number ({count} in all)")]
    DuplicateLabels {
        /// The first of them.
        name: String,
        /// How many were renamed.
        count: usize,
    },
    /// Points at the origin that nothing measured.
    #[error("{count} marker positions are exactly 0 0 0 and not measured; they count as missing")]
    Zeros {
        /// How many.
        count: usize,
    },
    /// Every point is marked invalid, but there are coordinates.
    #[error("every point is marked invalid although it has coordinates; they were used")]
    AllInvalid,
    /// The file's word on the vertical axis contradicts the motion.
    #[error("POINT:Y_SCREEN says {said}, but the motion says {used} is up; {used} was used")]
    UpAxis {
        /// What the file says.
        said: crate::UpAxis,
        /// What was taken.
        used: crate::UpAxis,
    },
    /// Events without a usable time.
    #[error("{count} events have no usable time; they were left out")]
    Events {
        /// How many.
        count: usize,
    },
}

impl C3dWarningKind {
    /// The stable code.
    pub(crate) fn code(&self) -> &'static str {
        match self {
            Self::Processor { .. } => "C3D001",
            Self::NoParameters => "C3D002",
            Self::BrokenParameters => "C3D003",
            Self::CutParameter { .. } => "C3D004",
            Self::NamelessGroup { .. } => "C3D005",
            Self::Disagreement { .. } => "C3D006",
            Self::FrameCount { .. } => "C3D007",
            Self::Truncated { .. } => "C3D008",
            Self::Scale { .. } => "C3D009",
            Self::NoRate { .. } => "C3D010",
            Self::Unit { .. } => "C3D011",
            Self::NoLabels { .. } => "C3D012",
            Self::DuplicateLabels { .. } => "C3D013",
            Self::Zeros { .. } => "C3D014",
            Self::AllInvalid => "C3D015",
            Self::UpAxis { .. } => "C3D016",
            Self::Events { .. } => "C3D017",
        }
    }
}
