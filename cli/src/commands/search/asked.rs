//! What an example asks of the shards of a library.

use segidx::{Hit, MismatchQuery, Query, search_adaptive, search_exact, search_mismatch};

use super::What;
use super::example::Example;
use crate::args::Mode;
use crate::failure::Failure;
use crate::library::{ClipId, Library};

/// A query, and what counts as a hit.
#[derive(Debug)]
pub(super) enum Asked {
    /// A segment of all features per position.
    Exact(Query),
    /// A run of segments per position.
    Adaptive(Query),
    /// A segment per position, but for some.
    Mismatch(MismatchQuery),
}

impl Asked {
    pub(super) fn new(example: &Example, what: &What<'_>) -> Result<Asked, Failure> {
        if let Some(mismatches) = what.mismatches {
            mismatches.check(what.mode)?;
        }
        let words = &example.clip.words;
        let query = match what.mode {
            Mode::Exact => Query::exact(words, example.care),
            Mode::Fuzzy | Mode::Adaptive => Query::fuzzy(words, example.care),
        };
        Ok(match (what.mismatches, what.mode) {
            (Some(mismatches), _) => Asked::Mismatch(mismatches.of(&query)?),
            (None, Mode::Exact | Mode::Fuzzy) => Asked::Exact(query),
            (None, Mode::Adaptive) => Asked::Adaptive(query),
        })
    }

    pub(super) fn query(&self) -> &Query {
        match self {
            Asked::Exact(query) | Asked::Adaptive(query) => query,
            Asked::Mismatch(query) => query.query(),
        }
    }

    /// The hits of all clips that count.
    pub(super) fn find(&self, library: &Library) -> Result<Vec<(ClipId, Hit)>, Failure> {
        library.search(|shard| match self {
            Asked::Exact(query) => search_exact(shard, query),
            Asked::Adaptive(query) => search_adaptive(shard, query),
            Asked::Mismatch(query) => search_mismatch(shard, query),
        })
    }
}
