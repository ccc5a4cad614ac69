//! The one way to the content of a shard: words, documents and frames of segments, for every kind of query.
//!
//! A [`View`] belongs to one call. Its accessors give plain numbers and never fail: what cannot be read, since a page
//! is damaged or the content contradicts itself, reads as zero, and the view remembers the first such error.
//! Whoever uses a view ends with [`View::finish`], which gives the error in place of any result. So loops need no
//! error paths; they only have to end whatever the numbers are, and may look at [`View::failed`] to end sooner.

use std::cell::{Cell, OnceCell};
use std::ops::Range;
use std::sync::OnceLock;

use super::cursors::{Frames, Postings};
use super::error::{ShardError, ShardErrorKind};
use super::layout::{Counts, FIRST_SEGMENT, Layout, Part, ROW};
use super::packed::Unpacker;
use super::pages::{PAGE_LEN, Pages};
use crate::DocId;

/// The distinct words with their places among the postings, in memory because every query looks at all of them.
#[derive(Debug)]
pub(crate) struct Dictionary {
    /// The distinct words, increasing.
    pub(crate) words: Vec<u64>,
    /// List i holds the postings `starts[i]..starts[i + 1]`.
    starts: Vec<u32>,
}

impl Dictionary {
    /// Number of postings of a list.
    pub(crate) fn list_len(&self, list: usize) -> usize {
        (self.starts[list + 1] - self.starts[list]) as usize
    }
}

/// A segment as it is stored.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry {
    /// The number of its word in the [`Dictionary`].
    pub(crate) word: usize,
    /// Whether it is the first of its document.
    pub(crate) is_first: bool,
}

/// A row of the clip table.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row {
    /// The frame at which the document begins, counted through the shard.
    pub(crate) first_frame: u64,
    pub(crate) first_segment: usize,
    pub(crate) name: usize,
    pub(crate) meta: usize,
}

/// What views of one shard share.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Source<'a> {
    pub(super) body: &'a [u8],
    /// Where the body begins in the file.
    pub(super) body_start: usize,
    pub(super) layout: &'a Layout,
    pub(super) pages: &'a Pages,
    pub(super) dictionary: &'a OnceLock<Dictionary>,
}

impl<'a> Source<'a> {
    pub(crate) fn view(self) -> View<'a> {
        let segment_width = self.layout.counts.segment_width();
        View {
            source: self,
            first_segment: self.layout.start_of(Part::Segments),
            segment_width,
            segment_mask: (1 << segment_width) - 1,
            known_segments: Cell::new(&[]),
            error: OnceCell::new(),
        }
    }
}

/// Access to a shard for the time of one call.
#[derive(Debug)]
pub(crate) struct View<'a> {
    source: Source<'a>,
    /// The byte at which the segments begin, and the bits of each.
    first_segment: usize,
    segment_width: u32,
    segment_mask: u64,
    /// The bytes of the segments, once all their pages were found intact.
    known_segments: Cell<&'a [u8]>,
    error: OnceCell<ShardError>,
}

impl<'a> View<'a> {
    pub(crate) fn source(&self) -> Source<'a> {
        self.source
    }

    pub(crate) fn counts(&self) -> &'a Counts {
        &self.source.layout.counts
    }

    pub(crate) fn n_segments(&self) -> usize {
        self.source.layout.counts.n_segments as usize
    }

    /// The segment of global number `segment`.
    #[inline]
    pub(crate) fn entry(&self, segment: usize) -> Entry {
        // At most 33 bits, which eight bytes hold wherever they begin.
        let at = segment as u64 * u64::from(self.segment_width);
        let byte = (at / 8) as usize;
        let known = self.known_segments.get().get(byte..byte + 8);
        let bits = match known.and_then(|bytes| bytes.first_chunk()) {
            Some(&bytes) => u64::from_le_bytes(bytes),
            None => self.u64_at(self.first_segment + byte),
        };
        let bits = bits >> (at % 8) & self.segment_mask;
        let word = (bits >> 1) as usize;
        if word >= self.source.layout.counts.n_words as usize {
            return self.not_a_word(segment, word);
        }
        Entry {
            word,
            is_first: bits & 1 == 1,
        }
    }

    /// Checks the pages of all segments now, for whoever will read many of them: each is read faster then.
    pub(crate) fn know_segments(&self) {
        let start = self.first_segment;
        // Up to eight bytes behind the last segment are read with it.
        let bytes = start..start + self.source.layout.len_of(Part::Segments) + 8;
        if self.is_readable(bytes.clone()) {
            self.known_segments
                .set(self.source.body.get(bytes).unwrap_or_default());
        }
    }

    #[cold]
    fn not_a_word(&self, segment: usize, word: usize) -> Entry {
        let expected = "the number of a word";
        self.flaw(Part::Segments, segment, expected, word as u64);
        Entry {
            word: 0,
            is_first: true,
        }
    }

    /// The distinct words; read once and kept, unless the view fails first.
    pub(crate) fn dictionary(&self) -> Option<&'a Dictionary> {
        if let Some(dictionary) = self.source.dictionary.get() {
            return Some(dictionary);
        }
        let dictionary = self.read_dictionary();
        (!self.failed()).then(|| self.source.dictionary.get_or_init(|| dictionary))
    }

    fn read_dictionary(&self) -> Dictionary {
        let n = self.counts().n_words as usize;
        let mut gaps = Unpacker::new(self, Part::Words, n, 0);
        let mut words = Vec::with_capacity(n);
        let mut counts = Unpacker::new(self, Part::Lists, n, 0);
        let mut starts = Vec::with_capacity(n + 1);
        let mut end = 0u64;
        starts.push(0);
        for i in 0..n {
            let gap = gaps.next();
            let word = match words.last() {
                None => Some(gap),
                Some(&before) => gap.checked_add(1).and_then(|gap| gap.checked_add(before)),
            };
            end = end.saturating_add(counts.next()).saturating_add(1);
            if word.is_none() {
                self.flaw(Part::Words, i, "a word of 64 bits", gap);
            }
            if end > self.n_segments() as u64 {
                self.flaw(
                    Part::Lists,
                    i,
                    "lists of as many segments as there are",
                    end,
                );
            }
            if self.failed() {
                break;
            }
            words.push(word.unwrap_or_default());
            starts.push(end as u32);
        }
        if end != self.n_segments() as u64 {
            self.flaw(
                Part::Lists,
                n,
                "lists of as many segments as there are",
                end,
            );
        }
        Dictionary { words, starts }
    }

    /// The segments that carry word number `list`, increasing.
    pub(crate) fn postings(&self, dictionary: &Dictionary, list: usize) -> Postings<'_, 'a> {
        let start = dictionary.starts[list] as usize;
        let len = dictionary.starts[list + 1] as usize - start;
        Postings::new(self, start, len)
    }

    /// The documents' rows; that of number `n_documents` marks the end.
    pub(crate) fn row(&self, document: usize) -> Row {
        let at = self.start_of(Part::Documents) + document * ROW;
        let (b, c) = (
            self.u64_at(at + FIRST_SEGMENT),
            self.u64_at(at + FIRST_SEGMENT + 4),
        );
        Row {
            first_frame: self.u64_at(at),
            first_segment: (b & 0xffff_ffff) as usize,
            name: (c & 0xffff_ffff) as usize,
            meta: (c >> 32) as usize,
        }
    }

    /// The document that owns `segment`.
    ///
    /// Documents are much of a size, so it is sought from where it would be if they were all alike.
    pub(crate) fn document_of(&self, segment: usize) -> DocId {
        let n_documents = self.counts().n_documents;
        let begins_by = |document: u32| {
            let row = self.start_of(Part::Documents) + document as usize * ROW;
            self.u64_at(row + FIRST_SEGMENT) & 0xffff_ffff <= segment as u64
        };
        let share = segment as u64 * u64::from(n_documents) / self.n_segments().max(1) as u64;
        let guess = share.min(u64::from(n_documents.saturating_sub(1))) as u32;
        let (mut low, mut high, mut step) = (guess, guess, 1u32);
        if begins_by(guess) {
            high = low.saturating_add(step).min(n_documents);
            while high < n_documents && begins_by(high) {
                step = step.saturating_mul(2);
                low = high;
                high = low.saturating_add(step).min(n_documents);
            }
        } else {
            while low > 0 && !begins_by(low) {
                high = low;
                low = low.saturating_sub(step);
                step = step.saturating_mul(2);
            }
        }
        // Invariant: `low` begins at or before the segment, or is 0; `high` begins after it, or is the end.
        while high.saturating_sub(low) > 1 {
            let middle = low + (high - low) / 2;
            if begins_by(middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        DocId::from_number(low)
    }

    /// Reads where segments begin.
    pub(crate) fn frames(&self) -> Frames<'_, 'a> {
        Frames::new(self)
    }

    /// Bytes of the text section.
    pub(crate) fn text(&self, range: Range<usize>) -> &'a [u8] {
        let (start, len) = (
            self.start_of(Part::Text),
            self.source.layout.len_of(Part::Text),
        );
        if range.start > range.end || range.end > len {
            let expected = "a place within the text";
            self.flaw(Part::Text, range.start, expected, range.end as u64);
            return &[];
        }
        let bytes = start + range.start..start + range.end;
        if bytes.is_empty() || !self.is_readable(bytes.clone()) {
            return &[];
        }
        self.source.body.get(bytes).unwrap_or_default()
    }

    pub(super) fn start_of(&self, part: Part) -> usize {
        self.source.layout.start_of(part)
    }

    /// `width` bits, at most 64, from bit `at` of the body.
    #[inline]
    pub(super) fn bits(&self, at: u64, width: u32) -> u64 {
        if width == 0 {
            return 0;
        }
        let (byte, shift) = ((at / 8) as usize, (at % 8) as u32);
        let mut bits = self.u64_at(byte) >> shift;
        if shift + width > u64::BITS {
            bits |= self.u64_at(byte + 8) << (u64::BITS - shift);
        }
        bits & (u64::MAX >> (u64::BITS - width))
    }

    /// Eight bytes of the body, least significant first.
    #[inline]
    pub(super) fn u64_at(&self, at: usize) -> u64 {
        let bytes = self.source.body.get(at..at.wrapping_add(8));
        match bytes.and_then(|bytes| bytes.first_chunk()) {
            Some(&bytes) if self.is_known(at, at + 7) => u64::from_le_bytes(bytes),
            bytes => self.first_u64_at(at, bytes),
        }
    }

    /// Whether the pages of two bytes that are less than a page apart were found intact before.
    #[inline]
    fn is_known(&self, first: usize, last: usize) -> bool {
        let pages = self.source.pages;
        pages.is_good(first) && (first / PAGE_LEN == last / PAGE_LEN || pages.is_good(last))
    }

    #[cold]
    fn first_u64_at(&self, at: usize, bytes: Option<&[u8; 8]>) -> u64 {
        match bytes {
            None => self.outside(at),
            Some(&bytes) if self.is_readable(at..at + 8) => u64::from_le_bytes(bytes),
            Some(_) => 0,
        }
    }

    fn outside(&self, at: usize) -> u64 {
        let kind = ShardErrorKind::Body {
            expected: (at as u64).saturating_add(8),
            found: self.source.body.len() as u64,
        };
        let at = self.source.body_start;
        self.fail(ShardError { at, kind });
        0
    }

    /// Whether the pages of these bytes are intact.
    fn is_readable(&self, bytes: Range<usize>) -> bool {
        self.source
            .pages
            .starts()
            .skip(bytes.start / PAGE_LEN)
            .take_while(|&start| start < bytes.end)
            .all(|start| self.source.pages.is_good(start) || self.check_page(start))
    }

    /// Whether the page that starts at `start` is intact; if not, the view fails.
    pub(super) fn check_page(&self, start: usize) -> bool {
        match self.source.pages.check(self.source.body, start) {
            Ok(()) => true,
            Err((expected, found)) => {
                let kind = ShardErrorKind::Page { expected, found };
                let at = self.source.body_start + start;
                self.fail(ShardError { at, kind });
                false
            }
        }
    }

    /// Remembers that the content contradicts itself.
    #[cold]
    pub(crate) fn flaw(&self, part: Part, entry: usize, expected: &'static str, found: u64) {
        let kind = ShardErrorKind::Flaw {
            part,
            entry,
            expected,
            found,
        };
        let at = self.source.body_start + self.start_of(part);
        self.fail(ShardError { at, kind });
    }

    /// Remembers an error. The first one stays: later ones may follow from it.
    pub(super) fn fail(&self, error: ShardError) {
        let _ = self.error.set(error);
    }

    /// Whether something could not be read.
    pub(crate) fn failed(&self) -> bool {
        self.error.get().is_some()
    }

    /// The result of the call, or why there is none.
    pub(crate) fn finish<T>(self, result: T) -> Result<T, ShardError> {
        match self.error.into_inner() {
            None => Ok(result),
            Some(error) => Err(error),
        }
    }
}
