//! The index: documents, their segments, and one inverted list per word.

mod validate;

use std::fmt;

use serde::{Deserialize, Serialize};

pub use self::validate::{Flaw, Part};
use crate::Segment;

/// Number of a document in its index, 0-based in order of insertion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(transparent)]
pub struct DocId(u32);

impl DocId {
    /// The document with this 0-based number.
    pub fn from_number(number: u32) -> DocId {
        DocId(number)
    }

    /// The 0-based number, for indexing.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

impl fmt::Display for DocId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// The segments of one index that carry one word.
///
/// Source: 2005 paper, eq. 6; 0-based here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InvertedList<'a> {
    /// The word.
    pub word: u64,
    /// Global segment numbers, 0-based and increasing, never empty.
    pub segments: &'a [u32],
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Row {
    pub(crate) name: String,
    pub(crate) meta: Vec<u8>,
    pub(crate) n_frames: u32,
}

/// Documents, their segments in one global numbering, and the inverted lists over them.
///
/// Build one with [`IndexBuilder`](crate::IndexBuilder) or read one with
/// [`from_shard_bytes`](Self::from_shard_bytes). It does not change afterwards.
///
/// Memory: 16 bytes per segment, 12 per distinct word, and the names and metadata.
#[derive(Clone, PartialEq, Eq)]
pub struct Index {
    pub(crate) rows: Vec<Row>,
    /// Document d owns segments `offsets[d]..offsets[d + 1]`.
    pub(crate) offsets: Vec<u32>,
    /// Per segment: its word.
    pub(crate) words: Vec<u64>,
    /// Per segment: its first frame in its document. Zero marks the first segment of a document, since segments are
    /// never empty; the searches rely on this to stay inside one document.
    pub(crate) starts: Vec<u32>,
    /// The distinct words, increasing; list i holds `postings[list_offsets[i]..list_offsets[i + 1]]`.
    pub(crate) list_words: Vec<u64>,
    pub(crate) list_offsets: Vec<u32>,
    pub(crate) postings: Vec<u32>,
}

impl Index {
    /// Number of documents.
    pub fn n_documents(&self) -> usize {
        self.rows.len()
    }

    /// Number of segments of all documents.
    pub fn n_segments(&self) -> usize {
        self.words.len()
    }

    /// Number of frames of all documents. Cost: O(documents).
    pub fn n_frames(&self) -> u64 {
        self.rows.iter().map(|row| u64::from(row.n_frames)).sum()
    }

    /// Number of inverted lists, which is the number of distinct words.
    pub fn n_lists(&self) -> usize {
        self.list_words.len()
    }

    /// The document, `None` if this index has no such number.
    pub fn document(&self, doc: DocId) -> Option<Document<'_>> {
        (doc.index() < self.rows.len()).then_some(Document { index: self, doc })
    }

    /// The documents in order.
    pub fn documents(&self) -> impl ExactSizeIterator<Item = Document<'_>> {
        (0..self.rows.len()).map(|i| Document {
            index: self,
            doc: DocId(i as u32),
        })
    }

    /// The global numbers of the segments that carry `word`, 0-based and increasing; empty if there are none.
    ///
    /// Cost: O(log lists). Source: 2005 paper, eq. 6.
    pub fn list(&self, word: u64) -> &[u32] {
        match self.list_words.binary_search(&word) {
            Ok(list) => self.postings_of(list),
            Err(_) => &[],
        }
    }

    /// The inverted lists by increasing word.
    pub fn lists(&self) -> impl ExactSizeIterator<Item = InvertedList<'_>> {
        self.list_words
            .iter()
            .enumerate()
            .map(|(list, &word)| InvertedList {
                word,
                segments: self.postings_of(list),
            })
    }

    /// The document of a global segment number and the segment's number there, both 0-based; `None` past the last
    /// segment. Cost: O(log documents).
    pub fn locate(&self, segment: usize) -> Option<(DocId, usize)> {
        (segment < self.words.len()).then(|| {
            let doc = self.doc_of(segment);
            (doc, segment - self.offsets[doc.index()] as usize)
        })
    }

    /// Checks every invariant of the index, for tests and after reading foreign bytes.
    ///
    /// Cost: O(segments + documents).
    ///
    /// # Errors
    ///
    /// The first invariant that does not hold. An index from this crate's public functions has none.
    pub fn debug_validate(&self) -> Result<(), Flaw> {
        validate::check(self)
    }

    pub(crate) fn postings_of(&self, list: usize) -> &[u32] {
        &self.postings[self.list_offsets[list] as usize..self.list_offsets[list + 1] as usize]
    }

    /// The document that owns `segment`, which must exist.
    pub(crate) fn doc_of(&self, segment: usize) -> DocId {
        let after = self
            .offsets
            .partition_point(|&offset| offset as usize <= segment);
        DocId(after as u32 - 1)
    }
}

impl fmt::Debug for Index {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Index")
            .field("n_documents", &self.n_documents())
            .field("n_segments", &self.n_segments())
            .field("n_frames", &self.n_frames())
            .field("n_lists", &self.n_lists())
            .finish()
    }
}

/// A view of one document of an [`Index`].
#[derive(Clone, Copy, Debug)]
pub struct Document<'a> {
    index: &'a Index,
    doc: DocId,
}

impl<'a> Document<'a> {
    /// The number of the document.
    pub fn id(&self) -> DocId {
        self.doc
    }

    /// The name it was inserted under; names need not differ.
    pub fn name(&self) -> &'a str {
        &self.row().name
    }

    /// The bytes the caller stored with it, unread by this crate.
    pub fn meta(&self) -> &'a [u8] {
        &self.row().meta
    }

    /// Number of frames.
    pub fn n_frames(&self) -> usize {
        self.row().n_frames as usize
    }

    /// Number of segments.
    pub fn n_segments(&self) -> usize {
        self.segment_range().len()
    }

    /// Global number of its first segment, 0-based; for an empty document the number the next segment has.
    pub fn first_segment(&self) -> usize {
        self.segment_range().start
    }

    /// The segments in order; they tile the document.
    pub fn segments(&self) -> impl ExactSizeIterator<Item = Segment> + use<'a> {
        let (index, range, n_frames) = (self.index, self.segment_range(), self.n_frames());
        let last = range.end;
        range.map(move |k| {
            let start = index.starts[k] as usize;
            let end = if k + 1 < last {
                index.starts[k + 1] as usize
            } else {
                n_frames
            };
            Segment {
                word: index.words[k],
                start,
                len: end - start,
            }
        })
    }

    /// The feature words, one per frame, unrolled from the segments.
    pub fn words(&self) -> impl Iterator<Item = u64> + use<'a> {
        self.segments()
            .flat_map(|segment| std::iter::repeat_n(segment.word, segment.len))
    }

    /// The feature words as a vector of [`n_frames`](Self::n_frames) entries.
    ///
    /// A shard states its frame counts freely, since a segment of any length takes the same bytes: before unrolling
    /// one from an unknown source, look at [`n_frames`](Self::n_frames).
    pub fn to_words(&self) -> Vec<u64> {
        self.words().collect()
    }

    fn row(&self) -> &'a Row {
        &self.index.rows[self.doc.index()]
    }

    fn segment_range(&self) -> std::ops::Range<usize> {
        let doc = self.doc.index();
        self.index.offsets[doc] as usize..self.index.offsets[doc + 1] as usize
    }
}

#[cfg(test)]
mod tests;
