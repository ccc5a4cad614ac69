//! What candidates are checked against, whatever the kind of search.

use std::cell::Cell;

use super::plan::Start;
use super::sets::Sets;
use super::{MismatchQuery, adaptive, exact, mismatch};
use crate::shard::{Entry, View};

/// The kind of hits.
#[derive(Clone, Copy)]
pub(super) enum Kind<'q> {
    Exact,
    Adaptive,
    Mismatch(&'q MismatchQuery),
}

impl Kind<'_> {
    /// The bits of a word that are looked at.
    pub(super) fn care(self) -> u64 {
        match self {
            Kind::Exact | Kind::Adaptive => u64::MAX,
            Kind::Mismatch(query) => query.care(),
        }
    }

    /// The positions to start from.
    pub(super) fn start(self, n_positions: usize) -> Start {
        match self {
            Kind::Exact | Kind::Adaptive => Start::at(1, (0..n_positions).collect()),
            Kind::Mismatch(query) => query.start(),
        }
    }

    /// The most mismatches of a hit.
    pub(super) fn max_mismatches(self) -> usize {
        match self {
            Kind::Exact | Kind::Adaptive => 0,
            Kind::Mismatch(query) => query.max_mismatches(),
        }
    }

    pub(super) fn may_mismatch(self, position: usize) -> bool {
        match self {
            Kind::Exact | Kind::Adaptive => false,
            Kind::Mismatch(query) => query.may_mismatch(position),
        }
    }

    /// Whether [`extend`](Self::extend) is worth a try.
    #[inline]
    pub(super) fn may_extend(self, pattern: &Pattern<'_, '_>, candidate: usize) -> bool {
        match self {
            Kind::Exact => exact::may_extend(pattern, candidate),
            Kind::Adaptive | Kind::Mismatch(_) => true,
        }
    }

    /// Fills `found` with the hit in which `candidate` is the first segment at the pivot; false if there is none. At
    /// most one candidate of all pivots is accepted per hit.
    pub(super) fn extend(
        self,
        pattern: &Pattern<'_, '_>,
        candidate: usize,
        found: &mut Match,
    ) -> bool {
        match self {
            Kind::Exact => exact::extend(pattern, candidate, &mut found.bounds),
            Kind::Adaptive => adaptive::extend(pattern, candidate, &mut found.bounds),
            Kind::Mismatch(query) => mismatch::extend(query, pattern, candidate, found),
        }
    }
}

/// What a candidate is checked against.
pub(super) struct Pattern<'p, 'a> {
    pub(super) view: &'p View<'a>,
    pub(super) sets: &'p Sets<'p>,
    pub(super) n_positions: usize,
    /// The position candidates belong to.
    pub(super) pivot: usize,
    /// The rarest position besides the pivot, to look at first.
    pub(super) probe: Option<usize>,
    /// The positions whose candidates are looked at before these.
    pub(super) earlier: &'p [usize],
    /// Segments read so far.
    pub(super) n_read: &'p Cell<usize>,
}

/// Where a pattern fits.
pub(super) struct Match {
    /// The segment numbers s_1..s_L and one past the last.
    pub(super) bounds: Vec<usize>,
    /// The positions whose segment does not belong to them, increasing.
    pub(super) mismatches: Vec<usize>,
}

impl Match {
    pub(super) fn new(n_positions: usize) -> Match {
        Match {
            bounds: vec![0; n_positions + 1],
            mismatches: Vec::new(),
        }
    }
}

impl Pattern<'_, '_> {
    #[inline]
    pub(super) fn entry(&self, segment: usize) -> Entry {
        self.n_read.set(self.n_read.get() + 1);
        self.view.entry(segment)
    }

    /// Whether the word of `segment` belongs to a position.
    #[inline]
    pub(super) fn holds(&self, position: usize, segment: Entry) -> bool {
        self.sets.holds(position, segment.word)
    }

    /// The segment, if it exists and lies in the same document as the one before it.
    #[inline]
    pub(super) fn next_in_document(&self, segment: usize) -> Option<Entry> {
        if segment >= self.view.n_segments() {
            return None;
        }
        Some(self.entry(segment)).filter(|entry| !entry.is_first)
    }

    /// Whether a run of equal words, of the bits looked at, begins with `segment`.
    #[inline]
    pub(super) fn begins_word(&self, segment: usize, entry: Entry) -> bool {
        if !self.sets.is_restricted() || entry.is_first || segment == 0 {
            return true;
        }
        !self.sets.agree(self.entry(segment - 1).word, entry.word)
    }

    /// The end of the run of equal words that holds `segment`, of the bits looked at.
    #[inline]
    pub(super) fn end_of_word(&self, segment: usize, entry: Entry) -> usize {
        let mut end = segment + 1;
        if self.sets.is_restricted() {
            while let Some(next) = self.next_in_document(end)
                && self.sets.agree(entry.word, next.word)
            {
                end += 1;
            }
        }
        end
    }

    /// The beginning of that run, with the segment there.
    #[inline]
    pub(super) fn start_of_word(&self, segment: usize, entry: Entry) -> (usize, Entry) {
        let (mut start, mut first) = (segment, entry);
        if self.sets.is_restricted() {
            while !first.is_first && start > 0 {
                let before = self.entry(start - 1);
                if !self.sets.agree(entry.word, before.word) {
                    break;
                }
                (start, first) = (start - 1, before);
            }
        }
        (start, first)
    }
}
