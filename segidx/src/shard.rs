//! The persisted form of an index, which is also the form it is searched in.

mod cursors;
mod error;
mod layout;
mod packed;
mod pages;
mod restriction;
mod verify;
mod view;
mod write;

use std::fmt;
use std::sync::OnceLock;

pub(crate) use self::cursors::Frames;
pub use self::error::{ShardError, ShardErrorKind};
use self::layout::Layout;
pub use self::layout::Part;
use self::pages::Pages;
pub use self::restriction::RestrictionError;
pub(crate) use self::view::{Dictionary, Entry, Source, View};
pub(crate) use self::write::{Collected, write};
use crate::envelope::{Envelope, HEADER_LEN, stated_checksum};
use crate::{DocId, Document, InvertedList};

const SHARD: Envelope = Envelope {
    what: "shard",
    magic: "MOTIFSHD",
    version: 2,
};

/// A shard in memory, as [`IndexBuilder`](crate::IndexBuilder) makes it.
pub type Index = Shard<Vec<u8>>;

/// Documents, their segments in one global numbering, and the inverted lists over them, read from the bytes of a
/// shard wherever they are: a vector, a slice, a memory map.
///
/// Opening reads the head alone, which has a checksum for every 64 KiB page behind it; a page is checked when it is
/// first touched. Whatever meets a damaged page is an error with the offset of the page in the file, and never an
/// answer. [`verify`](Self::verify) checks everything.
///
/// The bytes must not change while the shard is open. A shard is safe to share between threads.
///
/// Memory: the bytes, and after the first search 12 bytes per distinct word.
pub struct Shard<B> {
    bytes: B,
    /// Length of the head; the body follows.
    body_start: usize,
    layout: Layout,
    pages: Pages,
    dictionary: OnceLock<Dictionary>,
}

impl<B: AsRef<[u8]>> Shard<B> {
    /// Opens a shard; `bytes` is the whole file.
    ///
    /// A shard begins with a head: `MOTIFSHD`, the format version (u32), the length of the rest of the head (u64) and
    /// an xxh3-64 checksum of all other bytes of the head (u64); then the numbers of documents, segments and distinct
    /// words and the length of the beginning that all names share (u32 each), the number of frames (u64), the lengths
    /// of the eight sections (u64 each), and the xxh3-64 checksum of every 64 KiB page behind the head (u64 each).
    /// Numbers are little-endian. The README describes the sections.
    ///
    /// Cost: O(pages) time and memory: 9 bytes per page, whatever the content.
    ///
    /// # Errors
    ///
    /// [`ShardError`] with the byte offset: another kind or version of file, a changed bit in the head, missing or
    /// surplus bytes.
    ///
    /// ```
    /// let mut builder = segidx::IndexBuilder::new();
    /// builder.push("clip", [], &[1, 1, 2])?;
    /// let mut bytes = builder.build().as_bytes().to_vec();
    /// assert_eq!(segidx::Shard::open(bytes.as_slice())?.n_segments(), 2);
    /// bytes[8] = 7;
    /// let error = segidx::Shard::open(bytes).unwrap_err();
    /// assert_eq!(error.to_string(), "byte 8: expected shard version 2, found 7");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn open(bytes: B) -> Result<Shard<B>, ShardError> {
        let (payload, body) = SHARD
            .split(bytes.as_ref())
            .map_err(|(at, error)| ShardError {
                at,
                kind: error.into(),
            })?;
        let (layout, sums) = Layout::parse(payload, body.len()).map_err(|kind| ShardError {
            at: HEADER_LEN,
            kind,
        })?;
        Ok(Shard {
            body_start: HEADER_LEN + payload.len(),
            bytes,
            layout,
            pages: Pages::new(sums),
            dictionary: OnceLock::new(),
        })
    }

    /// The whole file. The same documents in the same order give the same bytes.
    pub fn as_bytes(&self) -> &[u8] {
        self.bytes.as_ref()
    }

    /// The checksum the head states. It covers the checksums of all pages, so it stands for every byte of the file.
    pub fn checksum(&self) -> u64 {
        stated_checksum(self.as_bytes())
    }

    /// Number of documents.
    pub fn n_documents(&self) -> usize {
        self.layout.counts.n_documents as usize
    }

    /// Number of segments of all documents.
    pub fn n_segments(&self) -> usize {
        self.layout.counts.n_segments as usize
    }

    /// Number of frames of all documents.
    pub fn n_frames(&self) -> u64 {
        self.layout.counts.n_frames
    }

    /// Number of inverted lists, which is the number of distinct words.
    pub fn n_lists(&self) -> usize {
        self.layout.counts.n_words as usize
    }

    /// The document, `None` if there is no such number.
    ///
    /// # Errors
    ///
    /// [`ShardError`] where the shard is damaged.
    pub fn document(&self, doc: DocId) -> Result<Option<Document<'_>>, ShardError> {
        if doc.index() >= self.n_documents() {
            return Ok(None);
        }
        Document::read(self.source(), doc).map(Some)
    }

    /// The documents in order, each an error where the shard is damaged.
    pub fn documents(&self) -> impl ExactSizeIterator<Item = Result<Document<'_>, ShardError>> {
        (0..self.n_documents())
            .map(|number| Document::read(self.source(), DocId::from_number(number as u32)))
    }

    /// The global numbers of the segments that carry `word`, 0-based and increasing; empty if there are none.
    ///
    /// Cost: O(log lists + list), the first call O(lists). Source: 2005 paper, eq. 6.
    ///
    /// # Errors
    ///
    /// [`ShardError`] where the shard is damaged.
    pub fn list(&self, word: u64) -> Result<Vec<u32>, ShardError> {
        let view = self.view();
        let mut segments = Vec::new();
        if let Some(dictionary) = view.dictionary()
            && let Ok(number) = dictionary.words.binary_search(&word)
        {
            segments.extend(view.postings(dictionary, number).map(|k| k as u32));
        }
        view.finish(segments)
    }

    /// The inverted lists by increasing word.
    ///
    /// # Errors
    ///
    /// [`ShardError`] where the shard is damaged.
    pub fn lists(&self) -> Result<Vec<InvertedList>, ShardError> {
        let view = self.view();
        let mut lists = Vec::new();
        if let Some(dictionary) = view.dictionary() {
            for (number, &word) in dictionary.words.iter().enumerate() {
                let segments = view
                    .postings(dictionary, number)
                    .map(|k| k as u32)
                    .collect();
                lists.push(InvertedList { word, segments });
            }
        }
        view.finish(lists)
    }

    /// The distinct words, increasing, each with the number of segments that carry it.
    ///
    /// Cost: O(lists), without reading any list.
    ///
    /// # Errors
    ///
    /// [`ShardError`] where the shard is damaged.
    pub fn list_lengths(&self) -> Result<Vec<(u64, usize)>, ShardError> {
        let view = self.view();
        let mut lengths = Vec::new();
        if let Some(dictionary) = view.dictionary() {
            let words = dictionary.words.iter().enumerate();
            lengths.extend(words.map(|(list, &word)| (word, dictionary.list_len(list))));
        }
        view.finish(lengths)
    }

    /// The document of a global segment number and the segment's number there, both 0-based; `None` past the last
    /// segment. Cost: O(log documents).
    ///
    /// # Errors
    ///
    /// [`ShardError`] where the shard is damaged.
    pub fn locate(&self, segment: usize) -> Result<Option<(DocId, usize)>, ShardError> {
        if segment >= self.n_segments() {
            return Ok(None);
        }
        let view = self.view();
        let doc = view.document_of(segment);
        let in_doc = segment.saturating_sub(view.row(doc.index()).first_segment);
        view.finish(Some((doc, in_doc)))
    }

    /// Checks every byte, and that the sections do not contradict each other.
    ///
    /// Cost: O(bytes + segments) time.
    ///
    /// # Errors
    ///
    /// [`ShardError`]: the first damaged page, else the first flaw. A shard of this crate's making has none.
    pub fn verify(&self) -> Result<(), ShardError> {
        verify::verify(self.view())
    }

    pub(crate) fn view(&self) -> View<'_> {
        self.source().view()
    }

    fn source(&self) -> Source<'_> {
        Source {
            body: self.as_bytes().get(self.body_start..).unwrap_or_default(),
            body_start: self.body_start,
            layout: &self.layout,
            pages: &self.pages,
            dictionary: &self.dictionary,
        }
    }
}

impl Index {
    /// The shard in bytes that this crate has just written.
    pub(crate) fn from_trusted(bytes: Vec<u8>) -> Index {
        Shard::open(bytes).expect("the head was written for these very bytes")
    }
}

/// Shards are equal if their bytes are.
impl<A: AsRef<[u8]>, B: AsRef<[u8]>> PartialEq<Shard<B>> for Shard<A> {
    fn eq(&self, other: &Shard<B>) -> bool {
        self.as_bytes() == other.as_bytes()
    }
}

impl<B> fmt::Debug for Shard<B> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Shard").field(&self.layout.counts).finish()
    }
}

#[cfg(test)]
mod tests;
