//! `motif search --mismatches`.

use segidx::{MismatchError, MismatchQuery, Query};

use crate::args::MismatchArgs;
use crate::failure::Failure;

/// What of a query may be wrong.
#[derive(Clone, Copy, Debug)]
pub struct Mismatches<'a> {
    /// Most segments that differ in a hit.
    pub max: usize,
    /// The segments that may, counted from 1; none for all.
    pub at: &'a [usize],
}

impl MismatchArgs {
    /// What may be wrong, `None` if nothing was said about it.
    #[must_use]
    pub fn mismatches(&self) -> Option<Mismatches<'_>> {
        let max = self.mismatches?;
        Some(Mismatches { max, at: &self.at })
    }
}

impl Mismatches<'_> {
    /// # Errors
    /// [`Failure::Usage`] unless the query has more segments than may differ, and those that may.
    pub(super) fn of(self, query: &Query) -> Result<MismatchQuery, Failure> {
        let n_segments = query.positions().len();
        let usage = |option: &str, expected: String, found: usize| {
            Failure::Usage(format!("--{option}: expected {expected}, found {found}"))
        };
        let too_many = |_: MismatchError| {
            let expected = format!("fewer than the query's segments, {n_segments}");
            usage("mismatches", expected, self.max)
        };
        let tolerant = MismatchQuery::new(query.clone(), self.max).map_err(too_many)?;
        if self.at.is_empty() {
            return Ok(tolerant);
        }
        let is_one = |at: &usize| (1..=n_segments).contains(at);
        if let Some(&found) = self.at.iter().find(|at| !is_one(at)) {
            let expected = format!("a segment of the query, from 1 to {n_segments}");
            return Err(usage("at", expected, found));
        }
        let at = self.at.iter().map(|at| at - 1);
        tolerant.at(at).map_err(|e| Failure::Usage(e.to_string()))
    }
}

/// Segments for people and machines, counted from 1.
pub(super) fn from_one(positions: &[usize]) -> Vec<usize> {
    positions.iter().map(|position| position + 1).collect()
}

/// Segments as `2, 4`.
pub(super) fn list(segments: &[usize]) -> String {
    let segments: Vec<String> = segments.iter().map(usize::to_string).collect();
    segments.join(", ")
}
