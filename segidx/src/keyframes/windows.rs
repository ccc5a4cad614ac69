//! The parts of documents that can have a chain, and the runs of each mask there.

use std::ops::Range;

use crate::shard::{Dictionary, Frames, View};
use crate::{DocId, KeyframeQuery};

/// Segments of one document that follow each other.
pub(super) struct Window {
    pub(super) doc: DocId,
    /// The document's first frame, counted through the shard.
    first_frame: u64,
    pub(super) segments: Range<usize>,
}

/// In order, none touching another of the same document.
pub(super) struct Windows(pub(super) Vec<Window>);

/// A document as far as windows need it.
struct Place {
    doc: DocId,
    first_frame: u64,
    end_frame: u64,
    segments: Range<usize>,
}

impl Place {
    fn of(view: &View<'_>, doc: DocId) -> Place {
        let (row, next) = (view.row(doc.index()), view.row(doc.index() + 1));
        Place {
            doc,
            first_frame: row.first_frame,
            end_frame: next.first_frame,
            segments: row.first_segment..next.first_segment.min(view.n_segments()),
        }
    }

    fn window(&self, segments: Range<usize>) -> Window {
        Window {
            doc: self.doc,
            first_frame: self.first_frame,
            segments,
        }
    }
}

impl Windows {
    /// All documents whole.
    pub(super) fn all(view: &View<'_>) -> Windows {
        let documents = (0..view.counts().n_documents).map(|number| {
            let place = Place::of(view, DocId::from_number(number));
            place.window(place.segments.clone())
        });
        Windows(documents.collect())
    }

    /// All frames up to `reach[0]` before and `reach[1]` after these segments, which are increasing; their whole documents
    /// without a reach.
    pub(super) fn around(
        view: &View<'_>,
        segments: &[usize],
        reach: Option<[usize; 2]>,
    ) -> Windows {
        let mut windows: Vec<Window> = Vec::new();
        let mut frames = view.frames();
        let mut ends = view.frames();
        let mut place: Option<Place> = None;
        for &segment in segments {
            if view.failed() {
                break;
            }
            let place = match place {
                Some(ref place) if place.segments.contains(&segment) => place,
                _ => place.insert(Place::of(view, view.document_of(segment))),
            };
            let around = match reach {
                None => place.segments.clone(),
                Some([before, after]) => {
                    let start = frames.start_of(segment).saturating_sub(before as u64);
                    let end = frames.start_of(segment + 1).saturating_add(after as u64);
                    let end = end.min(place.end_frame).saturating_sub(1);
                    let first = segment_at(&mut ends, &place.segments, start);
                    first..segment_at(&mut ends, &place.segments, end) + 1
                }
            };
            match windows.last_mut() {
                Some(last) if last.doc == place.doc && around.start <= last.segments.end => {
                    last.segments.end = last.segments.end.max(around.end);
                }
                _ => windows.push(place.window(around)),
            }
        }
        Windows(windows)
    }
}

/// The segment of a frame, of some that follow each other; the nearest of them if it lies outside.
fn segment_at(frames: &mut Frames<'_, '_>, segments: &Range<usize>, frame: u64) -> usize {
    let (mut low, mut high) = (segments.start, segments.end);
    // Invariant: `low` begins at or before the frame or is the first, `high` begins after it or is the end.
    while high.saturating_sub(low) > 1 {
        let middle = low + (high - low) / 2;
        if frames.start_of(middle) <= frame {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

impl Window {
    /// The runs of each mask: frames of the document, increasing, none touching the next unless segments keep them apart.
    pub(super) fn read_runs(
        &self,
        (view, dictionary): (&View<'_>, &Dictionary),
        frames: &mut Frames<'_, '_>,
        query: &KeyframeQuery,
        runs: &mut [Vec<Range<usize>>],
    ) {
        runs.iter_mut().for_each(Vec::clear);
        let apart = query.segmented_by();
        let mut frame = |segment| {
            let frame = frames.start_of(segment);
            frame.saturating_sub(self.first_frame) as usize
        };
        let mut start = frame(self.segments.start);
        let mut before = None;
        for segment in self.segments.clone() {
            let end = frame(segment + 1);
            let word = dictionary.words[view.entry(segment).word];
            let changed = before.map_or(0, |before| before ^ word);
            // What is not in order is noticed by `verify`; here it only must do no harm.
            if start < end {
                for (i, (runs, mask)) in runs.iter_mut().zip(query.masks()).enumerate() {
                    if !mask.matches(word) {
                        continue;
                    }
                    let goes_on = apart.is_none_or(|bits| changed & bits[i] == 0);
                    match runs.last_mut() {
                        Some(run) if run.end == start && goes_on => run.end = end,
                        Some(run) if run.end > start => {}
                        _ => runs.push(start..end),
                    }
                }
                before = Some(word);
            }
            start = end;
        }
    }
}
