//! Exact hits but for a few positions (2005 paper, section 5.2; spec j.2).

use super::plan::Start;
use super::{Engine, Match, Pattern, search};
use crate::{Hit, Query, Shard, ShardError};

/// A [`Query`] with positions that may be wrong: at most some number of them, anywhere or at chosen positions.
///
/// Nothing is conjoined beyond what the query already is, for the order of segments must match exactly.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct MismatchQuery {
    query: Query,
    max_mismatches: usize,
    /// Per position whether it may mismatch.
    may_mismatch: Vec<bool>,
}

/// Why a query has no m-mismatch hits.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MismatchError {
    /// Every position may mismatch, so that anything would be a hit.
    #[error("expected fewer mismatches than the query has positions, {n_positions}, found {found}")]
    TooMany {
        /// Positions of the query.
        n_positions: usize,
        /// Mismatches asked for.
        found: usize,
    },
    /// A mismatch is allowed at a position that does not exist.
    #[error("expected a position below {n_positions}, found {found}")]
    Position {
        /// Positions of the query.
        n_positions: usize,
        /// The position, 0-based.
        found: usize,
    },
}

impl MismatchQuery {
    /// `query` with at most `max_mismatches` mismatches, at any position.
    ///
    /// # Errors
    ///
    /// [`MismatchError::TooMany`] unless there are fewer mismatches than positions. So a query without positions is
    /// always an error.
    pub fn new(query: Query, max_mismatches: usize) -> Result<MismatchQuery, MismatchError> {
        let n_positions = query.positions().len();
        if max_mismatches >= n_positions {
            let found = max_mismatches;
            return Err(MismatchError::TooMany { n_positions, found });
        }
        Ok(MismatchQuery {
            query,
            max_mismatches,
            may_mismatch: vec![true; n_positions],
        })
    }

    /// The same with mismatches at these positions alone, 0-based, in any order. Without any, the hits are the exact
    /// ones.
    ///
    /// # Errors
    ///
    /// [`MismatchError::Position`] for a position that the query does not have.
    pub fn at(
        self,
        positions: impl IntoIterator<Item = usize>,
    ) -> Result<MismatchQuery, MismatchError> {
        let n_positions = self.may_mismatch.len();
        let mut may_mismatch = vec![false; n_positions];
        for found in positions {
            match may_mismatch.get_mut(found) {
                Some(may) => *may = true,
                None => return Err(MismatchError::Position { n_positions, found }),
            }
        }
        Ok(MismatchQuery {
            may_mismatch,
            ..self
        })
    }

    /// What is asked for.
    pub fn query(&self) -> &Query {
        &self.query
    }

    /// The most mismatches of a hit.
    pub fn max_mismatches(&self) -> usize {
        self.max_mismatches
    }

    /// Where to start from. Every hit matches a position that must not mismatch, and one of any `max_mismatches + 1`.
    fn start(&self) -> Start {
        let n_positions = self.may_mismatch.len();
        let fixed: Vec<usize> = (0..n_positions)
            .filter(|&position| !self.may_mismatch[position])
            .collect();
        if fixed.is_empty() {
            let n = self.max_mismatches + 1;
            return Start::at(n, (0..n_positions).collect());
        }
        Start::at(1, fixed)
    }
}

/// All m-mismatch hits: consecutive segments of one document, one per position, of which at most
/// [`MismatchQuery::max_mismatches`] carry a word outside their position's set, all of them at positions that may
/// mismatch. [`Hit::mismatches`] names them.
///
/// The segments are those of the full words, whatever the sets care about. For mismatches in the segmentation by some
/// features alone, index the words restricted to these.
///
/// Sorted by `(cost, doc, start)`; a position that mismatches adds its difference in duration like the others.
///
/// Cost: as [`search_exact`](crate::search_exact), the candidates being the segments of the rarest position that must
/// not mismatch, or, if all may, of the `m + 1` rarest; O(segments · m) where that is less, times the positions.
/// Source: 2005 paper, section 5.2; spec j.2. Against the dynamic programming that the paper refers to, candidates
/// are checked one by one.
///
/// # Errors
///
/// [`ShardError`] if a page that the search needs is damaged.
///
/// ```
/// use segidx::{IndexBuilder, MismatchQuery, Query, search_mismatch};
///
/// let mut builder = IndexBuilder::new();
/// builder.push("clip", [], &[1, 1, 2, 3, 3, 1, 4, 3])?;
/// let index = builder.build();
///
/// let query = MismatchQuery::new(Query::exact(&[1, 2, 3], u64::MAX), 1)?;
/// let hits = search_mismatch(&index, &query)?;
/// assert_eq!(hits.len(), 2);
/// assert_eq!((hits[0].span(), &hits[0].mismatches[..]), (5..8, &[1][..]));
/// assert_eq!((hits[1].span(), &hits[1].mismatches[..]), (0..5, &[][..]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn search_mismatch<B: AsRef<[u8]>>(
    shard: &Shard<B>,
    query: &MismatchQuery,
) -> Result<Vec<Hit>, ShardError> {
    search_mismatch_with(shard, query, Engine::Auto)
}

/// [`search_mismatch`] by a chosen engine.
///
/// # Errors
///
/// As [`search_mismatch`].
pub fn search_mismatch_with<B: AsRef<[u8]>>(
    shard: &Shard<B>,
    query: &MismatchQuery,
    engine: Engine,
) -> Result<Vec<Hit>, ShardError> {
    let positions = query.query.positions();
    search(
        shard.view(),
        positions,
        (engine, query.start()),
        |pattern, candidate, found| extend(query, pattern, candidate, found),
    )
}

/// Accepts a candidate only from the first of the positions to start from that matches, so each hit is found once.
fn extend(
    query: &MismatchQuery,
    pattern: &Pattern<'_, '_>,
    candidate: usize,
    found: &mut Match,
) -> bool {
    let Some(first) = candidate.checked_sub(pattern.pivot) else {
        return false;
    };
    found.mismatches.clear();
    for position in 0..pattern.n_positions {
        let segment = first + position;
        let entry = match position {
            0 => Some(pattern.view.entry(segment)),
            _ => pattern.next_in_document(segment),
        };
        let Some(entry) = entry else {
            return false;
        };
        if pattern.holds(position, entry) {
            if pattern.earlier.contains(&position) {
                return false;
            }
        } else {
            // The pivot matches wherever the bytes are in order.
            if position == pattern.pivot
                || !query.may_mismatch[position]
                || found.mismatches.len() == query.max_mismatches
            {
                return false;
            }
            found.mismatches.push(position);
        }
        found.bounds[position] = segment;
    }
    found.bounds[pattern.n_positions] = first + pattern.n_positions;
    true
}
