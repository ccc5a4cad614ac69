//! What the head of a shard states: how many of everything there are, and where the sections lie.

use std::fmt;

use super::ShardErrorKind;
use super::packed::{directory_len, width_of};
use super::pages::PAGE_LEN;
use crate::envelope::little_endian;

/// A section of a shard. Sections follow each other in this order, each padded with zeros to a multiple of 8 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Part {
    /// The clip table: 20 bytes per document, and one more row that marks the end.
    Documents,
    /// The beginning that all names share, then per document the rest of its name and its metadata.
    Text,
    /// Packed: per distinct word the gap to the word before it less one, the first word itself.
    Words,
    /// Packed: per distinct word the number of its segments less one.
    Lists,
    /// Per segment, at one bit width: twice the number of its word, plus one if it begins a document.
    Segments,
    /// Per block of 128 segments the frame at which it begins (u64), counted through the shard.
    Frames,
    /// Packed: per segment its length less one.
    Lengths,
    /// Packed: list by list the first segment number, then the gaps less one.
    Postings,
}

impl Part {
    pub(crate) const ALL: [Part; 8] = [
        Part::Documents,
        Part::Text,
        Part::Words,
        Part::Lists,
        Part::Segments,
        Part::Frames,
        Part::Lengths,
        Part::Postings,
    ];
}

/// Bytes of a row of the clip table: first frame (u64), first segment, start of the name, start of the metadata
/// (u32 each). Frames and segments count through the shard, starts from the beginning of the text.
pub(crate) const ROW: usize = 20;

/// Where in its row a document's first segment stands.
pub(crate) const FIRST_SEGMENT: usize = 8;

/// Zeros behind the last section, so that the widest number can be read at the last bit.
pub(crate) const GUARD: usize = 16;

/// Bytes of the head's payload before the checksums of the pages.
const FIXED: usize = 4 * 4 + 8 + 8 * Part::ALL.len();

/// How many of everything there are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Counts {
    pub(crate) n_documents: u32,
    pub(crate) n_segments: u32,
    pub(crate) n_words: u32,
    /// Bytes that all names begin with.
    pub(crate) prefix_len: u32,
    pub(crate) n_frames: u64,
}

impl Counts {
    /// Bits per segment in [`Part::Segments`].
    pub(crate) fn segment_width(&self) -> u32 {
        width_of(u64::from(self.n_words.saturating_sub(1))) + 1
    }

    /// The length a section must have, or the least it can have.
    fn expected_len(&self, section: Part) -> (u64, bool) {
        let (n_words, n_segments) = (u64::from(self.n_words), u64::from(self.n_segments));
        match section {
            Part::Documents => ((u64::from(self.n_documents) + 1) * ROW as u64, true),
            Part::Text => (u64::from(self.prefix_len), false),
            Part::Words | Part::Lists => (directory_len(n_words), false),
            Part::Segments => {
                let bits = n_segments * u64::from(self.segment_width());
                (bits.div_ceil(8), true)
            }
            Part::Frames => (directory_len(n_segments) / 2, true),
            Part::Lengths | Part::Postings => (directory_len(n_segments), false),
        }
    }
}

/// Counts and places.
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    pub(crate) counts: Counts,
    /// Start and length of each section in the body.
    sections: [(usize, usize); Part::ALL.len()],
}

impl Layout {
    pub(crate) fn start_of(&self, section: Part) -> usize {
        self.sections[section as usize].0
    }

    pub(crate) fn len_of(&self, section: Part) -> usize {
        self.sections[section as usize].1
    }

    /// Reads the payload of a head, with the checksums of the pages; `body_len` is what the file has behind it.
    pub(crate) fn parse(
        payload: &[u8],
        body_len: usize,
    ) -> Result<(Layout, Vec<u64>), ShardErrorKind> {
        let Some((fixed, sums)) = payload.split_at_checked(FIXED) else {
            let (expected, found) = (FIXED, payload.len());
            return Err(ShardErrorKind::Head { expected, found });
        };
        let (n, rest) = fixed.split_at(16);
        let (n_frames, lens) = rest.split_at(8);
        let n = |i: usize| little_endian(&n[4 * i..4 * i + 4]) as u32;
        let counts = Counts {
            n_documents: n(0),
            n_segments: n(1),
            n_words: n(2),
            prefix_len: n(3),
            n_frames: little_endian(n_frames),
        };
        let mut sections = [(0, 0); Part::ALL.len()];
        let mut end = 0u64;
        for (section, len) in Part::ALL.into_iter().zip(lens.chunks(8)) {
            let len = little_endian(len);
            let (expected, is_exact) = counts.expected_len(section);
            if len < expected || is_exact && len != expected {
                let (part, found) = (section, len);
                return Err(ShardErrorKind::Section {
                    part,
                    expected,
                    found,
                });
            }
            // A length that no file has makes an end that this file does not have.
            sections[section as usize] = (end as usize, len as usize);
            end = len
                .checked_next_multiple_of(8)
                .map_or(u64::MAX, |len| end.saturating_add(len));
        }
        let expected = end.saturating_add(GUARD as u64);
        if expected != body_len as u64 {
            let found = body_len as u64;
            return Err(ShardErrorKind::Body { expected, found });
        }
        if (counts.n_words == 0) != (counts.n_segments == 0) || counts.n_words > counts.n_segments {
            return Err(ShardErrorKind::Counts {
                n_words: counts.n_words,
                n_segments: counts.n_segments,
            });
        }
        let expected = FIXED + 8 * body_len.div_ceil(PAGE_LEN);
        if payload.len() != expected {
            let found = payload.len();
            return Err(ShardErrorKind::Head { expected, found });
        }
        let sums = sums.chunks(8).map(little_endian).collect();
        Ok((Layout { counts, sections }, sums))
    }

    /// The payload of the head, still without checksums of pages, and the body of these sections, in order.
    pub(crate) fn assemble(
        counts: &Counts,
        sections: [(Part, Vec<u8>); Part::ALL.len()],
    ) -> (Vec<u8>, Vec<u8>) {
        let mut payload = Vec::with_capacity(FIXED);
        for n in [
            counts.n_documents,
            counts.n_segments,
            counts.n_words,
            counts.prefix_len,
        ] {
            payload.extend(n.to_le_bytes());
        }
        payload.extend(counts.n_frames.to_le_bytes());
        let mut body = Vec::new();
        for ((part, section), expected) in sections.into_iter().zip(Part::ALL) {
            debug_assert_eq!(part, expected);
            payload.extend((section.len() as u64).to_le_bytes());
            body.extend(section);
            body.resize(body.len().next_multiple_of(8), 0);
        }
        body.resize(body.len() + GUARD, 0);
        (payload, body)
    }
}

impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Part::Documents => "document",
            Part::Text => "text",
            Part::Words => "word",
            Part::Lists => "list",
            Part::Segments => "segment",
            Part::Frames => "frame block",
            Part::Lengths => "length",
            Part::Postings => "posting",
        })
    }
}
