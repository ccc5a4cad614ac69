//! One line of a scene: a query whose ends may be left open.

use std::ops::Range;

use super::SceneError;
use crate::{FuzzySet, Hit, Query};

/// What one aspect of a motion goes through: a set of words per position, or nothing specified.
///
/// Positions with a set are an adaptive query without durations; neighbours that share a word are conjoined, and
/// have one run. Unspecified positions are allowed at both ends: their run is all of the document before the first
/// set, or after the last one, and may be empty. They ask for nothing, but relations may refer to them, and they make
/// the hull of the line reach to the edge of the document.
///
/// Deviation from spec j.1: as a set of all words, an unspecified position would share words with its neighbours,
/// and conjoining would leave one run of the whole document. This is why it is no set here, and why it cannot stand
/// between sets; two lines and [`Relation::Before`](super::Relation::Before) say that something unspecified lies
/// between two progressions.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Progression {
    query: Query,
    n_before: usize,
    n_specified: usize,
    n_after: usize,
}

impl Progression {
    /// The positions in order; `None` is unspecified.
    ///
    /// Cost: as [`Query::from_sets`].
    ///
    /// # Errors
    ///
    /// [`SceneError::Unspecified`] without a set, [`SceneError::Gap`] for an unspecified position between sets.
    pub fn new(
        positions: impl IntoIterator<Item = Option<FuzzySet>>,
    ) -> Result<Progression, SceneError> {
        let positions: Vec<Option<FuzzySet>> = positions.into_iter().collect();
        let first = positions.iter().position(Option::is_some);
        let last = positions.iter().rposition(Option::is_some);
        let (Some(first), Some(last)) = (first, last) else {
            let found = positions.len();
            return Err(SceneError::Unspecified { found });
        };
        let n_after = positions.len() - 1 - last;
        let mut sets = Vec::with_capacity(last + 1 - first);
        for (position, set) in positions.into_iter().enumerate().take(last + 1).skip(first) {
            sets.push((set.ok_or(SceneError::Gap { position })?, None));
        }
        Ok(Progression {
            n_before: first,
            n_specified: sets.len(),
            n_after,
            query: Query::from_sets(sets),
        })
    }

    /// Positions as given, unspecified ones included.
    pub fn n_positions(&self) -> usize {
        self.n_before + self.n_specified + self.n_after
    }

    /// The query of the positions with a set, conjoined.
    pub fn query(&self) -> &Query {
        &self.query
    }

    /// Number of runs: of the query, and one for each open end.
    pub fn n_runs(&self) -> usize {
        self.specified().end + usize::from(self.n_after > 0)
    }

    /// The run of a position, both 0-based; `None` past the last position. Conjoined positions have one run.
    pub fn run_of(&self, position: usize) -> Option<usize> {
        if position >= self.n_positions() {
            None
        } else if position < self.n_before {
            Some(0)
        } else {
            let specified = self.specified();
            let run = self.query.position_of(position - self.n_before);
            Some(run.map_or(specified.end, |run| specified.start + run))
        }
    }

    /// The runs that the query asks for.
    pub(super) fn specified(&self) -> Range<usize> {
        let start = usize::from(self.n_before > 0);
        start..start + self.query.positions().len()
    }

    /// The runs of a hit of the query in a document of `n_frames`.
    pub(super) fn runs(&self, hit: &Hit, n_frames: usize) -> Vec<Range<usize>> {
        let span = hit.span();
        let before = (self.n_before > 0).then_some(0..span.start);
        let after = (self.n_after > 0).then_some(span.end..n_frames);
        let specified = hit.segments.iter().cloned();
        before.into_iter().chain(specified).chain(after).collect()
    }
}
