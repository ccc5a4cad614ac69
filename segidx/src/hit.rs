//! Where a query was found.

use std::ops::Range;

use crate::DocId;

/// One place that matches a query.
///
/// Searches return hits sorted by `(cost, doc, start)`, where start is the first frame; no two hits of one search
/// share document and start.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Hit {
    /// The document the hit lies in.
    pub doc: DocId,
    /// Σ_ℓ |frames of query position ℓ − frames matched there|, 0 for equal durations (spec j.3, ranking).
    pub cost: u64,
    /// Number of the first segment, 0-based over the whole index: the k of the 2005 paper, less one.
    pub first_segment: usize,
    /// Number of the first segment, 0-based within the document.
    pub first_segment_in_doc: usize,
    /// Per query position the frames that match it, 0-based within the document and end-exclusive. Each range starts
    /// where the one before it ends.
    pub segments: Vec<Range<usize>>,
    /// The query positions whose frames carry another word, 0-based and increasing; empty unless mismatches were
    /// allowed ([`MismatchQuery`](crate::MismatchQuery)).
    pub mismatches: Vec<usize>,
}

impl Hit {
    /// All frames of the hit, 0-based within the document and end-exclusive.
    pub fn span(&self) -> Range<usize> {
        let start = self.segments.first().map_or(0, |range| range.start);
        let end = self.segments.last().map_or(start, |range| range.end);
        start..end
    }

    /// From the last frame of the first position to the first frame of the last one: where the hit takes place, however
    /// long its ends last. `None` with fewer than two positions.
    ///
    /// Source: spec j.3, the core; its hull is [`span`](Self::span).
    pub fn core(&self) -> Option<Range<usize>> {
        let [first, .., last] = &self.segments[..] else {
            return None;
        };
        Some(first.end.saturating_sub(1)..last.start.saturating_add(1))
    }
}
