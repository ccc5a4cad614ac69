//! The textbook twin of the searches: one pass over the segments of every document, without an index.

use std::ops::Range;

use segidx::{DocId, Segment};

/// A place that matches: what a [`Hit`](segidx::Hit) says, in its order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Place {
    pub(crate) cost: u64,
    pub(crate) doc: DocId,
    /// Frames of each query position.
    pub(crate) segments: Vec<Range<usize>>,
}

/// The segmentation by the features of `care` alone (2005 paper, section 5.2).
pub(crate) fn coarsen(segments: &[Segment], care: u64) -> Vec<Segment> {
    let mut coarse: Vec<Segment> = Vec::with_capacity(segments.len());
    for segment in segments {
        let word = segment.word & care;
        match coarse.last_mut() {
            Some(last) if last.word == word => last.len += segment.len,
            _ => coarse.push(Segment { word, ..*segment }),
        }
    }
    coarse
}

/// Every place where the words of `query` follow each other in the segmentation by `care`: the exact
/// hits if it has all bits, else the adaptive fuzzy ones (spec j.1).
pub(crate) fn scan(documents: &[Vec<Segment>], query: &[Segment], care: u64) -> Vec<Place> {
    let mut places = Vec::new();
    if query.is_empty() {
        return places;
    }
    for (doc, segments) in (0..).map(DocId::from_number).zip(documents) {
        for window in coarsen(segments, care).windows(query.len()) {
            let pairs = || window.iter().zip(query);
            if pairs().all(|(a, b)| a.word == b.word) {
                places.push(Place {
                    cost: pairs().map(|(a, b)| a.len.abs_diff(b.len) as u64).sum(),
                    doc,
                    segments: window.iter().map(Segment::span).collect(),
                });
            }
        }
    }
    // Two places of one document never begin at the same frame.
    places.sort_by_key(|place| (place.cost, place.doc, place.segments[0].start));
    places
}

#[cfg(test)]
mod tests {
    use super::*;
    use segidx::segment;

    /// The feature sequence of the 2005 paper, eq. 3, which its section 5 searches by hand: bit 0 is
    /// its upper component, every segment one frame. Numbers are less by one.
    const WALK: [u64; 10] = [3, 2, 3, 1, 3, 2, 3, 1, 3, 2];

    #[track_caller]
    fn check(query: &[u64], care: u64, expected: &[usize]) {
        let documents = [segment(&WALK)];
        let query: Vec<u64> = query.iter().map(|word| word & care).collect();
        let found = scan(&documents, &segment(&query), care);
        let starts: Vec<usize> = found.iter().map(|place| place.segments[0].start).collect();
        assert_eq!(starts, expected);
    }

    #[test]
    fn exact_hits_are_those_of_the_papers_example() {
        check(&[1, 3, 2], u64::MAX, &[3, 7]);
        check(&[1, 2], u64::MAX, &[]);
        check(&[], u64::MAX, &[]);
    }

    #[test]
    fn adaptive_hits_are_those_of_the_papers_example() {
        // Eq. 11 ff.: V_1 = V_3 has the upper component off, V_2 on. Both cost as much as they differ.
        check(&[2, 3, 2], 1, &[1, 5]);
    }
}
