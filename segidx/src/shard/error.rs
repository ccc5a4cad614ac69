//! What can be wrong with a shard.

use super::Part;
use crate::envelope::EnvelopeError;

/// Why bytes are not a shard, or not all of it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("byte {at}: {kind}")]
pub struct ShardError {
    /// Where it shows, a 0-based offset in the file. A checksum cannot tell which byte changed: its error points at
    /// the stated checksum of the head, or at the start of the page. A flaw points at the section it shows in.
    pub at: usize,
    /// What is wrong.
    pub kind: ShardErrorKind,
}

/// What is wrong with a shard.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ShardErrorKind {
    /// The header is not that of an intact shard.
    #[error(transparent)]
    Envelope(#[from] EnvelopeError),
    /// The head has another length than its counts and the pages behind it need.
    #[error("expected a head of {expected} bytes, found {found}")]
    Head {
        /// The length needed.
        expected: usize,
        /// The length stated.
        found: usize,
    },
    /// The file is longer or shorter than its sections.
    #[error("expected {expected} bytes behind the head, found {found}")]
    Body {
        /// The length of all sections.
        expected: u64,
        /// The bytes there are.
        found: u64,
    },
    /// A section has another length than its number of entries needs.
    #[error("expected {expected} bytes for the {part} section, found {found}")]
    Section {
        /// The section.
        part: Part,
        /// Its length, or the least it can have.
        expected: u64,
        /// The length stated.
        found: u64,
    },
    /// Every distinct word has a segment, and every segment a word.
    #[error(
        "expected words with at least one segment each, found {n_words} words and {n_segments} segments"
    )]
    Counts {
        /// Distinct words.
        n_words: u32,
        /// Segments.
        n_segments: u32,
    },
    /// A page changed since it was written.
    #[error("expected page checksum {expected:#018x}, found {found:#018x} in the bytes")]
    Page {
        /// The checksum the head states.
        expected: u64,
        /// The checksum of the bytes.
        found: u64,
    },
    /// The sections contradict each other, although their checksums are right.
    #[error("{part} {entry}: expected {expected}, found {found}")]
    Flaw {
        /// Where it shows.
        part: Part,
        /// Which entry of the part, 0-based.
        entry: usize,
        /// What should be there.
        expected: &'static str,
        /// What is there.
        found: u64,
    },
}
