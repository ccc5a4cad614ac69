//! Adaptive hits around given places.

use std::cell::Cell;
use std::collections::BTreeSet;
use std::ops::Range;

use super::Hits;
use super::pattern::{Kind, Match, Pattern};
use super::sets::Sets;
use crate::shard::{Frames, View};
use crate::{DocId, Hit, Query, Shard, ShardError};

/// The hits of [`search_adaptive`](crate::search_adaptive) that contain one of the given places, each once: a document
/// and frames in it.
///
/// With the spans of [`combine`](crate::combine) this keeps of the combined hits of several feature sets those that a
/// query with all features has, and gives all hits of that query. A place that does not exist, or has no frames, is in
/// no hit. Sorted by `(cost, doc, start)`.
///
/// Cost: per place O(log segments of its document + positions + segments of the runs around it).
///
/// # Errors
///
/// [`ShardError`] if a page that the search needs is damaged.
pub fn search_adaptive_around<B: AsRef<[u8]>>(
    shard: &Shard<B>,
    query: &Query,
    places: impl IntoIterator<Item = (DocId, Range<usize>)>,
) -> Result<Vec<Hit>, ShardError> {
    let view = shard.view();
    let query = query.conjoined();
    let positions = query.positions();
    let Some(dictionary) = view.dictionary() else {
        return view.finish(Vec::new());
    };
    let sets = Sets::new(dictionary, positions, Kind::Adaptive.care());
    let n_read = Cell::new(0);
    let mut pattern = Pattern {
        view: &view,
        sets: &sets,
        n_positions: positions.len(),
        pivot: 0,
        probe: None,
        earlier: &[],
        n_read: &n_read,
    };
    let mut places: Vec<_> = places
        .into_iter()
        .map(|(doc, frames)| (doc, frames.start, frames.end))
        .collect();
    places.sort_unstable();
    places.dedup();
    let mut frames = view.frames();
    let mut hits = Hits::new(&view, positions);
    let mut found = Match::new(positions.len());
    // The runs that hits were found from, by first segment and position.
    let mut known = BTreeSet::new();
    for (doc, start, end) in places {
        let Some((segment, place)) = locate(&view, &mut frames, doc, start..end) else {
            continue;
        };
        for pivot in 0..positions.len() {
            pattern.pivot = pivot;
            let Some(first) = start_of_run(&pattern, segment) else {
                continue;
            };
            if known.contains(&(first, pivot))
                || !Kind::Adaptive.extend(&pattern, first, &mut found)
            {
                continue;
            }
            let (first_segment, end_segment) = (found.bounds[0], found.bounds[positions.len()]);
            if frames.start_of(first_segment) <= place.start
                && place.end <= frames.start_of(end_segment)
            {
                known.insert((first, pivot));
                hits.push(&found);
            }
        }
        if view.failed() {
            break;
        }
    }
    // A hit may be known by several of its runs.
    let mut hits = hits.ranked();
    hits.dedup_by_key(|hit| hit.first_segment);
    view.finish(hits)
}

/// The segment of the first of some frames of a document, and the frames counted through the shard; `None` if the
/// document has no such frames.
fn locate(
    view: &View<'_>,
    frames: &mut Frames<'_, '_>,
    doc: DocId,
    place: Range<usize>,
) -> Option<(usize, Range<u64>)> {
    if place.is_empty() || doc.index() >= view.counts().n_documents as usize {
        return None;
    }
    let (row, next) = (view.row(doc.index()), view.row(doc.index() + 1));
    let start = row.first_frame.checked_add(place.start as u64)?;
    let end = row.first_frame.checked_add(place.end as u64)?;
    let (mut low, mut high) = (row.first_segment, next.first_segment.min(view.n_segments()));
    if end > next.first_frame || low >= high {
        return None;
    }
    // Invariant: `low` begins at or before `start`, `high` after it or is the end.
    while high - low > 1 {
        let middle = low + (high - low) / 2;
        if frames.start_of(middle) <= start {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some((low, start..end))
}

/// The first segment of the pivot's run around `segment`, if it belongs to the pivot.
fn start_of_run(pattern: &Pattern<'_, '_>, segment: usize) -> Option<usize> {
    let (mut first, mut entry) = (segment, pattern.entry(segment));
    if !pattern.holds(pattern.pivot, entry) {
        return None;
    }
    while !entry.is_first && first > 0 {
        let before = pattern.entry(first - 1);
        if !pattern.holds(pattern.pivot, before) {
            break;
        }
        (first, entry) = (first - 1, before);
    }
    Some(first)
}
