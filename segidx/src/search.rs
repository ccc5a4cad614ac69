//! Exact, adaptive and m-mismatch search, and the choice of the engine.

mod adaptive;
mod answer;
mod combine;
mod estimate;
mod exact;
mod join;
mod mismatch;
mod pattern;
mod plan;
mod sets;
mod within;

use std::cell::Cell;

pub use self::answer::{Answer, EngineCosts, SearchPlan};
pub use self::combine::{CombinedHit, combine};
pub use self::estimate::estimate_adaptive;
pub use self::mismatch::{MismatchError, MismatchQuery, search_mismatch, search_mismatch_with};
use self::pattern::{Kind, Match, Pattern};
use self::plan::Plan;
use self::sets::Sets;
pub use self::within::search_adaptive_around;
use crate::shard::{Dictionary, Frames, View};
use crate::{Hit, Query, QueryPosition, Shard, ShardError};

/// How hits are found. Every engine gives the same hits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Engine {
    /// The one whose estimated cost is lowest.
    #[default]
    Auto,
    /// The inverted lists of every position, united, coalesced into runs and joined where one run ends and the next
    /// begins (spec j.1, algorithm A; 2005 paper, eq. 5). With mismatches, the recurrence of spec j.2.
    Lists,
    /// The inverted lists of the rarest position give candidates, which are checked on the stored words (spec j.1,
    /// algorithm B). With mismatches, those of as many positions as needed.
    Pivot,
    /// One pass over the segment words gives the candidates (spec j.1, algorithm C).
    Scan,
}

/// All exact hits: segment k+ℓ−1 carries a word of V_ℓ for every position ℓ, inside one document.
///
/// Sorted by `(cost, doc, start)`. A query without positions has no hits.
///
/// Cost: O(distinct words · distinct sets + candidates · positions), candidates being the segments of the rarest
/// position; O(segments) where that is less. Source: 2005 paper, eq. 5 and 10.
///
/// # Errors
///
/// [`ShardError`] if a page that the search needs is damaged.
pub fn search_exact<B: AsRef<[u8]>>(
    shard: &Shard<B>,
    query: &Query,
) -> Result<Vec<Hit>, ShardError> {
    Ok(search_exact_with(shard, query, Engine::Auto)?.hits)
}

/// [`search_exact`] by a chosen engine, with an account of what it did.
///
/// # Errors
///
/// As [`search_exact`].
pub fn search_exact_with<B: AsRef<[u8]>>(
    shard: &Shard<B>,
    query: &Query,
    engine: Engine,
) -> Result<Answer, ShardError> {
    search(shard.view(), query.positions(), Kind::Exact, engine)
}

/// All adaptive fuzzy hits: sequences of maximal runs [s_ℓ, e_ℓ] of segments with words of V_ℓ, such that
/// s_{ℓ+1} = e_ℓ + 1, inside one document. The first and the last run are maximal too.
///
/// A query whose neighbouring sets share words is conjoined first ([`Query::conjoined`]); the positions of the hits
/// are those of the conjoined query. Sorted by `(cost, doc, start)`. A query without positions has no hits.
///
/// Cost: O(distinct words · distinct sets + candidates + segments in the runs around them), at most
/// O(segments · positions). Source: 2005 paper, section 5.2; spec j.1.
///
/// # Errors
///
/// [`ShardError`] if a page that the search needs is damaged.
pub fn search_adaptive<B: AsRef<[u8]>>(
    shard: &Shard<B>,
    query: &Query,
) -> Result<Vec<Hit>, ShardError> {
    Ok(search_adaptive_with(shard, query, Engine::Auto)?.hits)
}

/// [`search_adaptive`] by a chosen engine, with an account of what it did. Positions in the account are those of the
/// conjoined query too.
///
/// # Errors
///
/// As [`search_adaptive`].
pub fn search_adaptive_with<B: AsRef<[u8]>>(
    shard: &Shard<B>,
    query: &Query,
    engine: Engine,
) -> Result<Answer, ShardError> {
    let query = query.conjoined();
    search(shard.view(), query.positions(), Kind::Adaptive, engine)
}

/// Candidates that are looked at before any of them is followed up, so that the processor can wait for their segments
/// together.
const BATCH: usize = 32;

/// One candidate among this many segments is as good as all of them, as far as pages are concerned.
const MANY: usize = 64;

/// Plans, runs the engine and ranks what it finds.
fn search(
    view: View<'_>,
    positions: &[QueryPosition],
    kind: Kind<'_>,
    engine: Engine,
) -> Result<Answer, ShardError> {
    if positions.is_empty() || view.n_segments() == 0 {
        return view.finish(Answer::default());
    }
    let Some(dictionary) = view.dictionary() else {
        return view.finish(Answer::default());
    };
    let mut sets = Sets::new(dictionary, positions, kind.care());
    let Plan {
        mut done,
        probe,
        tabulates,
        n_segments,
    } = Plan::new((&view, dictionary), &sets, positions, (engine, kind));
    if tabulates {
        sets.tabulate();
    }
    if n_segments > view.n_segments() / MANY {
        view.know_segments();
    }
    let n_read = Cell::new(0);
    let mut pattern = Pattern {
        view: &view,
        sets: &sets,
        n_positions: positions.len(),
        pivot: 0,
        probe,
        earlier: &[],
        n_read: &n_read,
    };
    let mut hits = Hits::new(&view, positions);
    match done.engine {
        Engine::Lists => join::run(&pattern, kind, dictionary, (&mut done, &mut hits)),
        Engine::Scan => scan(&pattern, kind, (&mut done, &mut hits)),
        Engine::Pivot | Engine::Auto => {
            let pivots = std::mem::take(&mut done.pivots);
            for (nth, &pivot) in pivots.iter().enumerate() {
                (pattern.pivot, pattern.earlier) = (pivot, &pivots[..nth]);
                from_pivot(&pattern, kind, dictionary, (&mut done, &mut hits));
            }
            done.pivots = pivots;
        }
    }
    done.n_segments = n_read.get();
    let hits = hits.ranked();
    let plan = Some(done);
    view.finish(Answer { hits, plan })
}

/// Checks every segment in the lists of the pivot.
fn from_pivot(
    pattern: &Pattern<'_, '_>,
    kind: Kind<'_>,
    dictionary: &Dictionary,
    (done, hits): (&mut SearchPlan, &mut Hits<'_, '_>),
) {
    let mut found = Match::new(pattern.n_positions);
    let mut likely = [0; BATCH];
    // Every segment stands in one list, so none is given twice.
    for list in pattern.sets.numbers(pattern.pivot) {
        done.n_lists += 1;
        let mut postings = pattern.view.postings(dictionary, list);
        loop {
            let (mut n_read, mut n_likely) = (0, 0);
            for candidate in postings.by_ref().take(BATCH) {
                n_read += 1;
                likely[n_likely] = candidate;
                n_likely += usize::from(kind.may_extend(pattern, candidate));
            }
            for &candidate in &likely[..n_likely] {
                if kind.extend(pattern, candidate, &mut found) {
                    hits.push(&found);
                }
            }
            done.n_postings += n_read;
            if n_read < BATCH {
                break;
            }
        }
        if pattern.view.failed() {
            return;
        }
    }
    done.n_candidates = done.n_postings;
}

/// Checks every segment that belongs to a pivot.
fn scan(
    pattern: &Pattern<'_, '_>,
    kind: Kind<'_>,
    (done, hits): (&mut SearchPlan, &mut Hits<'_, '_>),
) {
    let mut found = Match::new(pattern.n_positions);
    let pivots = done.pivots.iter().enumerate();
    let patterns: Vec<Pattern<'_, '_>> = pivots
        .map(|(nth, &pivot)| Pattern {
            pivot,
            earlier: &done.pivots[..nth],
            ..*pattern
        })
        .collect();
    for segment in 0..pattern.view.n_segments() {
        let entry = pattern.view.entry(segment);
        for pattern in &patterns {
            if pattern.holds(pattern.pivot, entry) {
                done.n_candidates += 1;
                if kind.may_extend(pattern, segment) && kind.extend(pattern, segment, &mut found) {
                    hits.push(&found);
                }
            }
        }
        if pattern.view.failed() {
            return;
        }
    }
    let n_read = pattern.n_read;
    n_read.set(n_read.get() + pattern.view.n_segments());
}

/// Hits as they are found.
struct Hits<'v, 'a> {
    view: &'v View<'a>,
    positions: &'v [QueryPosition],
    /// The bounds of each [`Match`], one after the other.
    bounds: Vec<usize>,
    mismatches: Vec<Vec<usize>>,
}

impl<'v, 'a> Hits<'v, 'a> {
    fn new(view: &'v View<'a>, positions: &'v [QueryPosition]) -> Hits<'v, 'a> {
        Hits {
            view,
            positions,
            bounds: Vec::new(),
            mismatches: Vec::new(),
        }
    }

    fn push(&mut self, found: &Match) {
        self.bounds.extend_from_slice(&found.bounds);
        self.mismatches.push(found.mismatches.clone());
    }

    fn ranked(mut self) -> Vec<Hit> {
        // In order of segments their frames and documents are cheap to find, whatever order they were found in.
        let bounds = self.bounds.chunks_exact(self.positions.len() + 1);
        let mut found: Vec<_> = bounds.zip(std::mem::take(&mut self.mismatches)).collect();
        found.sort_unstable_by_key(|(bounds, _)| bounds[0]);
        let mut frames = self.view.frames();
        let hits = found.into_iter();
        let mut hits: Vec<Hit> = hits
            .map(|(bounds, mismatches)| self.hit(&mut frames, bounds, mismatches))
            .collect();
        // They are in order of document and segment, which a stable sort keeps.
        hits.sort_by_key(|hit| hit.cost);
        hits
    }

    fn hit(&self, frames: &mut Frames<'_, '_>, bounds: &[usize], mismatches: Vec<usize>) -> Hit {
        let first = bounds[0];
        let doc = self.view.document_of(first);
        let row = self.view.row(doc.index());
        // What is not in order is noticed by `verify`; here it only must not overflow.
        let mut frame = |segment| frames.start_of(segment).saturating_sub(row.first_frame) as usize;
        let mut start = frame(first);
        let mut cost = 0u64;
        let mut segments = Vec::with_capacity(self.positions.len());
        for (position, &end) in self.positions.iter().zip(&bounds[1..]) {
            let end = frame(end);
            if let Some(n_frames) = position.n_frames {
                cost = cost.saturating_add(n_frames.abs_diff(end.saturating_sub(start)) as u64);
            }
            segments.push(start..end);
            start = end;
        }
        Hit {
            doc,
            cost,
            first_segment: first,
            first_segment_in_doc: first.saturating_sub(row.first_segment),
            segments,
            mismatches,
        }
    }
}

#[cfg(test)]
mod tests;
