use std::fmt;
use std::mem::{self, Discriminant};

use crate::Position;
use crate::c3d::C3dWarningKind;
use crate::position::Locator;

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
            K::MissingKeyword { .. } => "BVH001",
            K::Comment => "BVH002",
            K::GluedNumbers => "BVH003",
            K::SkippedText { .. } => "BVH004",
            K::Commas { .. } => "BVH005",
            K::NoBreakSpaces => "BVH006",
            K::ChannelCount { .. } => "BVH007",
            K::Repeated { .. } => "BVH008",
            K::NoOffset { .. } => "BVH009",
            K::MissingBraces { .. } => "BVH010",
            K::ExtraBrace => "BVH011",
            K::FrameCount { .. } => "BVH012",
            K::TruncatedRow { .. } => "BVH013",
            K::NoFrameCount => "BVH014",
            K::NoFrameTime { .. } => "BVH015",
            K::FrameTime { .. } => "BVH016",
            K::RowLayout => "BVH017",
            K::ScaleChannels => "BVH018",
            K::DuplicateName { .. } => "BVH019",
            K::NoMotion => "BVH020",
            K::LooseBone { .. } => "ASF001",
            K::UnknownSection { .. } => "ASF002",
            K::NoUnit { .. } => "ASF003",
            K::UnknownAsfKeyword { .. } => "ASF004",
            K::NoLength { .. } => "ASF005",
            K::TruncatedFrame { .. } => "AMC001",
            K::UnmovedBone { .. } => "AMC002",
            K::FrameNumber { .. } => "AMC003",
            K::UnknownAmcKeyword { .. } => "AMC004",
            K::AngleUnit { .. } => "AMC005",
            K::C3d(kind) => kind.code(),
            K::NameCase { .. } => "AMC006",
            K::More { .. } => "TXT001",
        }
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
    /// The line that begins a part is missing, but the part is there.
    #[error("the line {keyword} is missing; what follows was read as if it were there")]
    MissingKeyword {
        /// HIERARCHY or MOTION.
        keyword: &'static str,
    },
    /// Text behind `#` or `//`, which BVH does not have; skipped. Reported where it happens first.
    #[error("BVH has no comments; text behind # or // was skipped")]
    Comment,
    /// Two numbers without a blank between them; read as two.
    #[error("no blank between two numbers; they were read as two")]
    GluedNumbers,
    /// Text that BVH does not have, where skipping it changes no number: before the hierarchy, between
    /// MOTION and the first row, behind the last row. Reported where it happens first.
    #[error("text that BVH does not have was skipped: {found}")]
    SkippedText {
        /// Its start.
        found: String,
    },
    /// Commas in numbers or between them.
    #[error("commas were read as {meaning}")]
    Commas {
        /// What they were taken for.
        meaning: &'static str,
    },
    /// No-break spaces, read as blanks. Reported where they happen first.
    #[error("no-break spaces were read as blanks")]
    NoBreakSpaces,
    /// A joint with more or fewer channels than it says; the list decides. Reported where it happens
    /// first.
    #[error("joint {joint:?} says {} channels and lists {listed}; the list decides", header.as_deref().unwrap_or("no number of"))]
    ChannelCount {
        /// The joint.
        joint: String,
        /// What it says, if anything.
        header: Option<String>,
        /// How many names follow.
        listed: usize,
    },
    /// A keyword that appears twice in one place. Reported where it happens first.
    #[error("{keyword} appears twice; {resolution}")]
    Repeated {
        /// OFFSET, CHANNELS, Frames or Frame Time.
        keyword: &'static str,
        /// What was done about it.
        resolution: &'static str,
    },
    /// A joint or End Site without OFFSET; it is put where its parent is. Reported where it happens
    /// first.
    #[error("joint {joint:?} has no OFFSET; zero was used")]
    NoOffset {
        /// The joint.
        joint: String,
    },
    /// The hierarchy ends with joints open; they were closed.
    #[error("{n} closing braces are missing before MOTION")]
    MissingBraces {
        /// How many.
        n: usize,
    },
    /// A closing brace behind the end of a tree; skipped. Reported where it happens first.
    #[error("a closing brace too many was skipped")]
    ExtraBrace,
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
    /// No `Frames:`, or no number behind it; the rows were counted.
    #[error("the number of frames is not said; the rows were counted")]
    NoFrameCount,
    /// No `Frame Time:`, or no number behind it; a rate was assumed.
    #[error("no frame time; {hz} frames per second were assumed")]
    NoFrameTime {
        /// The rate.
        hz: f64,
    },
    /// A frame time with which nobody records; a rate was assumed.
    #[error("frame time {found} cannot be meant; {hz} frames per second were assumed")]
    FrameTime {
        /// As written.
        found: String,
        /// The rate.
        hz: f64,
    },
    /// Frames that go on over several lines, or lines of several frames. Reported where it happens
    /// first.
    #[error("frames do not stand one to a line; the values were taken in order")]
    RowLayout,
    /// Scale channels, which stretch joints; left out. Reported where it happens first.
    #[error("scale channels were left out")]
    ScaleChannels,
    /// Two joints of one figure with the same name.
    #[error("joint name {name:?} appears twice; the first one is found by name")]
    DuplicateName {
        /// The name.
        name: String,
    },
    /// A file without motion; the skeleton alone was read.
    #[error("the file has no MOTION; the skeleton was read, with no frames")]
    NoMotion,
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
    /// The file does not say one of its units; a default was used.
    #[error("the file does not say its unit of {what}; {assumed} was used")]
    NoUnit {
        /// Length or angle.
        what: &'static str,
        /// The default.
        assumed: &'static str,
    },
    /// A keyword of a bone, the root or the units that the Acclaim format does not have; skipped.
    #[error("unknown keyword {name:?} was skipped")]
    UnknownAsfKeyword {
        /// The keyword.
        name: String,
    },
    /// A bone without `length`; zero was used.
    #[error("bone {name:?} has no length; zero was used")]
    NoLength {
        /// The bone.
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
    /// A bone's name in other letter case than where it is defined; no other bone fits. Reported where
    /// it happens first.
    #[error("bone {found:?} was taken for {name:?}, which differs in letter case")]
    NameCase {
        /// As written here.
        found: String,
        /// As defined.
        name: String,
    },
    /// More warnings than are listed.
    #[error("{n} more warnings are not listed")]
    More {
        /// How many.
        n: usize,
    },
    /// In a C3D file.
    #[error(transparent)]
    C3d(#[from] C3dWarningKind),
}

/// Warnings that are listed; a file that is odd throughout would fill the memory with them.
const MAX_WARNINGS: usize = 1000;

/// Oddities by byte offset, as a reader meets them. Counting lines for each would take quadratic
/// time in a file that is odd throughout, so they are located together.
#[derive(Debug, Default)]
pub(crate) struct Oddities {
    listed: Vec<(usize, WarningKind)>,
    /// Codes of what is reported only where it happens first.
    once: Vec<Discriminant<WarningKind>>,
    n_more: usize,
}

impl Oddities {
    pub(crate) fn push(&mut self, byte: usize, kind: WarningKind) {
        if self.listed.len() < MAX_WARNINGS {
            self.listed.push((byte, kind));
        } else {
            self.n_more += 1;
        }
    }

    /// Unless there is one of this kind already.
    pub(crate) fn push_once(&mut self, byte: usize, kind: WarningKind) {
        let discriminant = mem::discriminant(&kind);
        if !self.once.contains(&discriminant) {
            self.once.push(discriminant);
            self.push(byte, kind);
        }
    }

    /// In file order.
    pub(crate) fn into_warnings(mut self, text: &[u8]) -> Vec<Warning> {
        self.listed.sort_by_key(|&(byte, _)| byte);
        let mut locator = Locator::new(text);
        let located = self.listed.into_iter().map(|(byte, kind)| Warning {
            at: locator.locate(byte),
            kind,
        });
        let mut warnings: Vec<Warning> = located.collect();
        if self.n_more > 0 {
            warnings.push(Warning {
                at: locator.locate(text.len()),
                kind: WarningKind::More { n: self.n_more },
            });
        }
        warnings
    }
}

#[cfg(test)]
mod tests {
    /// All codes that [`super::Warning::code`] can give, from its text.
    fn codes() -> Vec<&'static str> {
        let of = |source: &'static str| {
            let (_, code) = source.split_once(" fn code(").unwrap();
            let (code, _) = code.split_once("\n    }\n").unwrap();
            code.lines()
                .filter_map(|line| line.split_once("=> \"")?.1.split('"').next())
        };
        let of_text = of(include_str!("warning.rs"));
        of_text.chain(of(include_str!("c3d/error.rs"))).collect()
    }

    #[test]
    fn every_code_is_explained_and_listed_and_no_other() {
        let codes = codes();
        assert!(codes.len() > 30, "{codes:?}");
        for code in &codes {
            assert!(crate::explain(code).is_some(), "{code} is not explained");
            let row = format!("| `{code}` | ");
            let is_listed = include_str!("../README.md").contains(&row);
            assert!(is_listed, "{code} is not in the README");
        }
        for explanation in crate::explanations() {
            assert!(codes.contains(&explanation.code), "{}", explanation.code);
        }
    }
}
