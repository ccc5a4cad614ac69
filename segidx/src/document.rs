//! Documents and inverted lists as a shard gives them.

use std::fmt;
use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::Segment;
use crate::shard::{Part, ShardError, Source, View};

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
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InvertedList {
    /// The word.
    pub word: u64,
    /// Global segment numbers, 0-based and increasing, never empty.
    pub segments: Vec<u32>,
}

/// One document of a [`Shard`](crate::Shard).
#[derive(Clone, Debug)]
pub struct Document<'a> {
    source: Source<'a>,
    id: DocId,
    name: String,
    meta: &'a [u8],
    first_frame: u64,
    n_frames: usize,
    segments: Range<usize>,
}

impl<'a> Document<'a> {
    /// Reads the row of a document that exists.
    pub(crate) fn read(source: Source<'a>, id: DocId) -> Result<Document<'a>, ShardError> {
        let view = source.view();
        let (row, next) = (view.row(id.index()), view.row(id.index() + 1));
        let mut name = view.text(0..view.counts().prefix_len as usize).to_vec();
        name.extend(view.text(row.name..row.meta));
        let name = String::from_utf8(name).unwrap_or_else(|error| {
            let found = error.utf8_error().valid_up_to() as u64;
            view.flaw(Part::Text, id.index(), "a name in UTF-8", found);
            String::new()
        });
        let meta = view.text(row.meta..next.name);
        let segments = row.first_segment..next.first_segment;
        if segments.start > segments.end || segments.end > view.n_segments() {
            let (expected, found) = ("a later end of its segments", segments.end as u64);
            view.flaw(Part::Documents, id.index(), expected, found);
        }
        let n_frames = u32::try_from(next.first_frame.wrapping_sub(row.first_frame));
        let n_frames = n_frames.unwrap_or_else(|_| {
            let (expected, found) = ("an end after at most 4294967295 frames", next.first_frame);
            view.flaw(Part::Documents, id.index(), expected, found);
            0
        });
        view.finish(Document {
            source,
            id,
            name,
            meta,
            first_frame: row.first_frame,
            n_frames: n_frames as usize,
            segments,
        })
    }

    /// The number of the document.
    pub fn id(&self) -> DocId {
        self.id
    }

    /// The name it was inserted under; names need not differ.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The bytes the caller stored with it, unread by this crate.
    pub fn meta(&self) -> &'a [u8] {
        self.meta
    }

    /// Number of frames.
    pub fn n_frames(&self) -> usize {
        self.n_frames
    }

    /// Number of segments.
    pub fn n_segments(&self) -> usize {
        self.segments.len()
    }

    /// Global number of its first segment, 0-based; for an empty document the number the next segment has.
    pub fn first_segment(&self) -> usize {
        self.segments.start
    }

    /// The segments in order; they tile the document.
    ///
    /// # Errors
    ///
    /// [`ShardError`] where the shard is damaged.
    pub fn segments(&self) -> Result<Vec<Segment>, ShardError> {
        let view = self.source.view();
        let mut segments = Vec::new();
        if let Some(dictionary) = view.dictionary() {
            let mut frames = view.frames();
            let mut start = 0;
            for k in self.segments.clone() {
                let end = frames.start_of(k + 1).wrapping_sub(self.first_frame);
                let Some(end) = self.end_of_segment(&view, k, start, end) else {
                    break;
                };
                let word = dictionary.words[view.entry(k).word];
                let len = end - start;
                segments.push(Segment { word, start, len });
                start = end;
            }
        }
        view.finish(segments)
    }

    /// The end of segment `k` as an index into the document, `None` if there can be no such segment.
    fn end_of_segment(&self, view: &View<'_>, k: usize, start: usize, end: u64) -> Option<usize> {
        let end_in_doc = usize::try_from(end).ok().filter(|&end| {
            let is_last = k + 1 == self.segments.end;
            start < end && end <= self.n_frames && is_last == (end == self.n_frames)
        });
        if end_in_doc.is_none() {
            view.flaw(Part::Lengths, k, "segments that tile their document", end);
        }
        end_in_doc.filter(|_| !view.failed())
    }

    /// The feature words, one per frame, unrolled from the segments: [`n_frames`](Self::n_frames) entries.
    ///
    /// A shard states its frame counts freely, since a segment of any length takes about the same bytes: before
    /// unrolling one from an unknown source, look at [`n_frames`](Self::n_frames).
    ///
    /// # Errors
    ///
    /// [`ShardError`] where the shard is damaged.
    pub fn to_words(&self) -> Result<Vec<u64>, ShardError> {
        let segments = self.segments()?.into_iter();
        let words = segments.flat_map(|segment| std::iter::repeat_n(segment.word, segment.len));
        Ok(words.collect())
    }
}
