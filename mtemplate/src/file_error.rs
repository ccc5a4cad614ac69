//! What is wrong with the file of a template, and where.

use std::fmt;

use thiserror::Error;

use crate::{ClassError, TemplateError};

/// Why bytes are not a template.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{at}: {kind}")]
pub struct FileError {
    /// Where it shows.
    pub at: Place,
    /// What was expected and what was found.
    pub kind: FileErrorKind,
}

/// A place in the file of a template.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// In the text form.
    Text {
        /// Line, 1-based.
        line: usize,
        /// Column in bytes, 1-based.
        column: usize,
        /// Offset in bytes, 0-based.
        byte: usize,
    },
    /// In the binary form.
    Binary {
        /// Offset in bytes, 0-based.
        byte: usize,
    },
}

impl Place {
    pub(crate) fn in_text(text: &[u8], byte: usize) -> Place {
        let before = &text[..byte.min(text.len())];
        let line_start = before
            .iter()
            .rposition(|&b| b == b'\n')
            .map_or(0, |i| i + 1);
        Place::Text {
            line: before.iter().filter(|&&b| b == b'\n').count() + 1,
            column: before.len() - line_start + 1,
            byte: before.len(),
        }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::Text { line, column, .. } => write!(f, "{line}:{column}"),
            Place::Binary { byte } => write!(f, "byte {byte}"),
        }
    }
}

/// What is wrong with the file of a template.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum FileErrorKind {
    /// The bytes are neither the binary form nor UTF-8.
    #[error("expected a motion template, found bytes that are no text")]
    NoText,
    /// The text is no TOML, or its keys and types are others.
    #[error("{0}")]
    Toml(String),
    /// The file is of another version.
    #[error("expected version {expected} of motion templates, found {found}")]
    Version {
        /// The version that is read.
        expected: u32,
        /// The version of the file.
        found: u32,
    },
    /// A piece of a row is no run.
    #[error("expected a run such as 0x12, 0.25x3, 1 or *, found {found:?}")]
    Run {
        /// The piece.
        found: String,
    },
    /// A piece of the weights is no run.
    #[error("expected a positive weight with or without a count, such as 1x12, found {found:?}")]
    Weight {
        /// The piece.
        found: String,
    },
    /// A row has more or fewer columns than the template; with more, the count at the run that goes
    /// too far.
    #[error("expected {expected} columns, found {found}")]
    Columns {
        /// Columns of the template.
        expected: usize,
        /// Columns of the row.
        found: usize,
    },
    /// A keyframe wants something other than 0 or 1 of a feature.
    #[error("expected 0 or 1, found {found}")]
    Bit {
        /// What it wants.
        found: i64,
    },
    /// The bytes end too early.
    #[error("expected {expected} bytes of {what}, found {found}")]
    Truncated {
        /// The part that is cut off.
        what: &'static str,
        /// Its length.
        expected: u64,
        /// Bytes of it that are there.
        found: u64,
    },
    /// Bytes follow the end.
    #[error("expected the end of the template, found {found} more bytes")]
    Trailing {
        /// How many.
        found: usize,
    },
    /// Header or payload changed since they were written.
    #[error("expected checksum {expected:#018x}, found {found:#018x} in the bytes")]
    Checksum {
        /// The checksum that the header states.
        expected: u64,
        /// The checksum of the bytes.
        found: u64,
    },
    /// The payload has another form.
    #[error("expected the parts of a template, found {0}")]
    Payload(String),
    /// Values or weights break a rule.
    #[error(transparent)]
    Template(#[from] TemplateError),
    /// The parts do not fit each other.
    #[error(transparent)]
    Class(#[from] ClassError),
}
