//! Exact, adaptive and m-mismatch search, and the choice of where candidates come from.

mod adaptive;
mod exact;
mod mismatch;
mod plan;
mod sets;

pub use self::mismatch::{MismatchError, MismatchQuery, search_mismatch, search_mismatch_with};
use self::plan::{Plan, Source, Start};
use self::sets::Sets;
use crate::shard::{Entry, Frames, View};
use crate::{Hit, Query, QueryPosition, Shard, ShardError};

/// Where candidate segments come from. Every engine gives the same hits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Engine {
    /// The one whose estimated cost is lower.
    #[default]
    Auto,
    /// The inverted lists of the rarest position (spec j.1, algorithm B).
    Lists,
    /// One pass over the segment words (spec j.1, algorithm C).
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
    search_exact_with(shard, query, Engine::Auto)
}

/// [`search_exact`] by a chosen engine.
///
/// # Errors
///
/// As [`search_exact`].
pub fn search_exact_with<B: AsRef<[u8]>>(
    shard: &Shard<B>,
    query: &Query,
    engine: Engine,
) -> Result<Vec<Hit>, ShardError> {
    let positions = query.positions();
    let start = Start::anywhere(positions);
    search(
        shard.view(),
        positions,
        (engine, start),
        |pattern, candidate, found| exact::extend(pattern, candidate, &mut found.bounds),
    )
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
    search_adaptive_with(shard, query, Engine::Auto)
}

/// [`search_adaptive`] by a chosen engine.
///
/// # Errors
///
/// As [`search_adaptive`].
pub fn search_adaptive_with<B: AsRef<[u8]>>(
    shard: &Shard<B>,
    query: &Query,
    engine: Engine,
) -> Result<Vec<Hit>, ShardError> {
    let query = query.conjoined();
    let positions = query.positions();
    let start = Start::anywhere(positions);
    search(
        shard.view(),
        positions,
        (engine, start),
        |pattern, candidate, found| adaptive::extend(pattern, candidate, &mut found.bounds),
    )
}

/// One candidate among this many segments is as good as all of them, as far as pages are concerned.
const MANY: usize = 64;

/// What a candidate is checked against.
struct Pattern<'p, 'a> {
    view: &'p View<'a>,
    sets: &'p Sets<'p>,
    n_positions: usize,
    /// The position candidates belong to.
    pivot: usize,
    /// The positions whose candidates have been looked at already.
    earlier: &'p [usize],
}

/// Where a pattern fits.
struct Match {
    /// The segment numbers s_1..s_L and one past the last.
    bounds: Vec<usize>,
    /// The positions whose segment does not belong to them, increasing.
    mismatches: Vec<usize>,
}

impl Pattern<'_, '_> {
    /// Whether the word of `segment` belongs to a position.
    #[inline]
    fn holds(&self, position: usize, segment: Entry) -> bool {
        self.sets.holds(position, segment.word)
    }

    /// The segment, if it exists and lies in the same document as the one before it.
    #[inline]
    fn next_in_document(&self, segment: usize) -> Option<Entry> {
        if segment >= self.view.n_segments() {
            return None;
        }
        Some(self.view.entry(segment)).filter(|entry| !entry.is_first)
    }
}

/// Collects the hits around every candidate. `extend` fills the [`Match`], or says that there is no hit; it accepts at
/// most one candidate per hit.
fn search(
    view: View<'_>,
    positions: &[QueryPosition],
    plan: (Engine, Start),
    extend: impl Fn(&Pattern<'_, '_>, usize, &mut Match) -> bool,
) -> Result<Vec<Hit>, ShardError> {
    let mut hits = Vec::new();
    if positions.is_empty() || view.n_segments() == 0 {
        return view.finish(hits);
    }
    let Some(dictionary) = view.dictionary() else {
        return view.finish(hits);
    };
    let mut sets = Sets::new(dictionary, positions);
    let plan = Plan::new(&view, &sets, positions, plan);
    // A scan asks about every segment, and there are no more words than segments.
    if plan.source == Source::Scan || plan.n_candidates > dictionary.words.len() {
        sets.tabulate();
    }
    if plan.n_candidates > view.n_segments() / MANY {
        view.know_segments();
    }
    let mut found = Match {
        bounds: vec![0; positions.len() + 1],
        mismatches: Vec::new(),
    };
    let mut frames = view.frames();
    for (nth, &pivot) in plan.pivots.iter().enumerate() {
        let pattern = Pattern {
            view: &view,
            sets: &sets,
            n_positions: positions.len(),
            pivot,
            earlier: &plan.pivots[..nth],
        };
        let mut check = |candidate| {
            if extend(&pattern, candidate, &mut found) {
                hits.push(hit_at(&view, &mut frames, positions, &found));
            }
            !view.failed()
        };
        // Every segment stands in one list, so neither source gives a segment twice, whatever the bytes.
        let is_done = match plan.source {
            Source::Lists => {
                let mut lists = sets.numbers(pivot).into_iter();
                lists.all(|list| view.postings(dictionary, list).all(&mut check))
            }
            Source::Scan => {
                let mut segments = 0..view.n_segments();
                segments.all(|segment| !pattern.holds(pivot, view.entry(segment)) || check(segment))
            }
        };
        if !is_done {
            break;
        }
    }
    hits.sort_unstable_by_key(|hit| (hit.cost, hit.doc, hit.first_segment));
    view.finish(hits)
}

fn hit_at(
    view: &View<'_>,
    frames: &mut Frames<'_, '_>,
    positions: &[QueryPosition],
    found: &Match,
) -> Hit {
    let bounds = &found.bounds;
    let first = bounds[0];
    let doc = view.document_of(first);
    let row = view.row(doc.index());
    // What is not in order is noticed by `verify`; here it only must not overflow.
    let mut frame = |segment| frames.start_of(segment).saturating_sub(row.first_frame) as usize;
    let mut start = frame(first);
    let mut cost = 0u64;
    let mut segments = Vec::with_capacity(positions.len());
    for (position, &end) in positions.iter().zip(&bounds[1..]) {
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
        mismatches: found.mismatches.clone(),
    }
}

#[cfg(test)]
mod tests;
