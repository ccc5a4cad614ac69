//! Exact hits but for a few positions (2005 paper, section 5.2; spec j.2).

use super::pattern::{Kind, Match, Pattern};
use super::plan::Start;
use super::{Answer, Engine, search};
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
    /// The bits of a word by which documents are segmented.
    care: u64,
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
            care: u64::MAX,
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

    /// The same on the segmentation by the bits of `care` alone: the segments of a document are then its maximal runs
    /// of frames whose words agree on these bits, and a segment has the word of its frames with all other bits zero.
    ///
    /// A query for it is [`Query::fuzzy`] with the same bits. Without this, `care` is `u64::MAX`, the full words. What
    /// is found is what an index of the words restricted to `care` gives.
    ///
    /// Source: spec j.2.
    #[must_use]
    pub fn restricted_to(self, care: u64) -> MismatchQuery {
        MismatchQuery { care, ..self }
    }

    /// The bits by which documents are segmented.
    pub fn care(&self) -> u64 {
        self.care
    }

    /// What is asked for.
    pub fn query(&self) -> &Query {
        &self.query
    }

    /// The most mismatches of a hit.
    pub fn max_mismatches(&self) -> usize {
        self.max_mismatches
    }

    pub(super) fn may_mismatch(&self, position: usize) -> bool {
        self.may_mismatch[position]
    }

    /// Where to start from. Every hit matches a position that must not mismatch, and one of any `max_mismatches + 1`.
    pub(super) fn start(&self) -> Start {
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
/// The segments are those of the full words, whatever the sets care about, or with
/// [`MismatchQuery::restricted_to`] those of some features alone.
///
/// Sorted by `(cost, doc, start)`; a position that mismatches adds its difference in duration like the others.
///
/// Cost: as [`search_exact`](crate::search_exact), the candidates being the segments of the rarest position that must
/// not mismatch, or, if all may, of the `m + 1` rarest; O(segments · m) where that is less, times the positions.
/// Source: 2005 paper, section 5.2; spec j.2.
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
    Ok(search_mismatch_with(shard, query, Engine::Auto)?.hits)
}

/// [`search_mismatch`] by a chosen engine, with an account of what it did.
///
/// # Errors
///
/// As [`search_mismatch`].
pub fn search_mismatch_with<B: AsRef<[u8]>>(
    shard: &Shard<B>,
    query: &MismatchQuery,
    engine: Engine,
) -> Result<Answer, ShardError> {
    let positions = query.query.positions();
    search(shard.view(), positions, Kind::Mismatch(query), engine)
}

/// Accepts a candidate only as the first segment of its run of equal words, and only from the first of the positions to
/// start from that matches, so each hit is found once.
pub(super) fn extend(
    query: &MismatchQuery,
    pattern: &Pattern<'_, '_>,
    candidate: usize,
    found: &mut Match,
) -> bool {
    let (pivot, mut entry) = (pattern.pivot, pattern.entry(candidate));
    if !pattern.holds(pivot, entry) || pattern.start_of_word(candidate, entry).0 != candidate {
        return false;
    }
    let Match { bounds, mismatches } = found;
    mismatches.clear();
    let mut accepts = |position, entry| {
        if pattern.holds(position, entry) {
            return !pattern.earlier.contains(&position);
        }
        let may = query.may_mismatch[position] && mismatches.len() < query.max_mismatches;
        mismatches.extend(may.then_some(position));
        may
    };
    bounds[pivot] = candidate;
    let mut end = pattern.end_of_word(candidate, entry);
    for (position, bound) in bounds.iter_mut().enumerate().take(pattern.n_positions) {
        if position <= pivot {
            continue;
        }
        match pattern.next_in_document(end) {
            Some(next) if accepts(position, next) => {
                *bound = end;
                end = pattern.end_of_word(end, next);
            }
            _ => return false,
        }
    }
    bounds[pattern.n_positions] = end;
    let mut start = candidate;
    for position in (0..pivot).rev() {
        if entry.is_first || start == 0 {
            return false;
        }
        let before = pattern.entry(start - 1);
        if !accepts(position, before) {
            return false;
        }
        (start, entry) = pattern.start_of_word(start - 1, before);
        bounds[position] = start;
    }
    mismatches.sort_unstable();
    true
}
