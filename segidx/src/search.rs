//! Exact and adaptive search, and the choice of where candidates come from.

mod adaptive;
mod exact;
mod plan;

use self::plan::{Plan, Source};
use crate::{FuzzySet, Hit, Index, Query, QueryPosition};

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
/// Cost: O(lists + candidates · positions), candidates being the segments of the rarest position; O(segments) where
/// that is less. Source: 2005 paper, eq. 5 and 10.
pub fn search_exact(index: &Index, query: &Query) -> Vec<Hit> {
    search_exact_with(index, query, Engine::Auto)
}

/// [`search_exact`] by a chosen engine.
pub fn search_exact_with(index: &Index, query: &Query, engine: Engine) -> Vec<Hit> {
    search(index, query, engine, exact::extend)
}

/// All adaptive fuzzy hits: sequences of maximal runs [s_ℓ, e_ℓ] of segments with words of V_ℓ, such that
/// s_{ℓ+1} = e_ℓ + 1, inside one document. The first and the last run are maximal too.
///
/// A query whose neighbouring sets share words is conjoined first ([`Query::conjoined`]); the positions of the hits
/// are those of the conjoined query. Sorted by `(cost, doc, start)`. A query without positions has no hits.
///
/// Cost: O(lists + candidates + segments in the runs around them), at most O(segments · positions).
/// Source: 2005 paper, section 5.2; spec j.1.
pub fn search_adaptive(index: &Index, query: &Query) -> Vec<Hit> {
    search_adaptive_with(index, query, Engine::Auto)
}

/// [`search_adaptive`] by a chosen engine.
pub fn search_adaptive_with(index: &Index, query: &Query, engine: Engine) -> Vec<Hit> {
    search(index, &query.conjoined(), engine, adaptive::extend)
}

/// What a candidate is checked against.
struct Pattern<'a> {
    words: &'a [u64],
    starts: &'a [u32],
    sets: Vec<&'a FuzzySet>,
    /// The position candidates belong to.
    pivot: usize,
}

impl Pattern<'_> {
    /// Whether `segment` exists and lies in the same document as the one before it.
    fn continues(&self, segment: usize) -> bool {
        self.starts.get(segment).is_some_and(|&start| start != 0)
    }
}

/// Collects the hits around every candidate. `extend` fills the segment numbers s_1..s_L and one past the last, or
/// says that there is no hit; it accepts at most one candidate per hit.
fn search(
    index: &Index,
    query: &Query,
    engine: Engine,
    extend: impl Fn(&Pattern<'_>, usize, &mut [usize]) -> bool,
) -> Vec<Hit> {
    let positions = query.positions();
    if positions.is_empty() || index.words.is_empty() {
        return Vec::new();
    }
    let plan = Plan::new(index, positions, engine);
    let pattern = Pattern {
        words: &index.words,
        starts: &index.starts,
        sets: positions.iter().map(|position| &position.set).collect(),
        pivot: plan.pivot,
    };
    let mut bounds = vec![0; positions.len() + 1];
    let mut hits = Vec::new();
    let mut check = |candidate| {
        if extend(&pattern, candidate, &mut bounds) {
            hits.push(hit_at(index, positions, &bounds));
        }
    };
    match plan.source {
        Source::Lists(lists) => {
            for list in lists {
                for &segment in index.postings_of(list) {
                    check(segment as usize);
                }
            }
        }
        Source::Scan => {
            let set = pattern.sets[pattern.pivot];
            for (segment, &word) in index.words.iter().enumerate() {
                if set.matches(word) {
                    check(segment);
                }
            }
        }
    }
    hits.sort_unstable_by_key(|hit| (hit.cost, hit.doc, hit.first_segment));
    hits
}

fn hit_at(index: &Index, positions: &[QueryPosition], bounds: &[usize]) -> Hit {
    let first = bounds[0];
    let doc = index.doc_of(first);
    let first_of_doc = index.offsets[doc.index()] as usize;
    let end_of_doc = index.offsets[doc.index() + 1] as usize;
    let frame = |segment: usize| {
        if segment < end_of_doc {
            index.starts[segment] as usize
        } else {
            index.rows[doc.index()].n_frames as usize
        }
    };
    let mut start = frame(first);
    let mut cost = 0u64;
    let mut segments = Vec::with_capacity(positions.len());
    for (position, &end) in positions.iter().zip(&bounds[1..]) {
        let end = frame(end);
        if let Some(n_frames) = position.n_frames {
            cost = cost.saturating_add(n_frames.abs_diff(end - start) as u64);
        }
        segments.push(start..end);
        start = end;
    }
    Hit {
        doc,
        cost,
        first_segment: first,
        first_segment_in_doc: first - first_of_doc,
        segments,
    }
}

#[cfg(test)]
mod tests;
