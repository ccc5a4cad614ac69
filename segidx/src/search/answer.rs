//! What a search gives besides its hits.

use super::Engine;
use crate::Hit;

/// The hits of a search, and how they were found.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Answer {
    /// The hits, as the plain form of the search gives them.
    pub hits: Vec<Hit>,
    /// What was done; `None` if there was nothing to do, for a query without positions or a shard without segments.
    pub plan: Option<SearchPlan>,
}

/// What a search did, for those who wonder at its speed. The same shard, query and engine give the same plan.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SearchPlan {
    /// The engine that ran, never [`Engine::Auto`].
    pub engine: Engine,
    /// The positions candidates came from, 0-based, the rarest first; empty for [`Engine::Lists`].
    pub pivots: Vec<usize>,
    /// What each engine was expected to cost.
    pub estimated: EngineCosts,
    /// Inverted lists read.
    pub n_lists: usize,
    /// Segment numbers read from them.
    pub n_postings: usize,
    /// Segments whose word was read, each as often as it was. The sample that the estimates rest on is not counted.
    pub n_segments: usize,
    /// Places where a hit was looked for: candidates checked, or for [`Engine::Lists`] the runs of all positions that
    /// were joined.
    pub n_candidates: usize,
}

/// Estimated costs in units of one segment read in order, some two nanoseconds.
///
/// They are made from the lengths of the lists, for sets of many words in a large dictionary from a sample of 512
/// segments and 512 distinct words.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EngineCosts {
    /// Of [`Engine::Lists`].
    pub lists: u64,
    /// Of [`Engine::Pivot`].
    pub pivot: u64,
    /// Of [`Engine::Scan`].
    pub scan: u64,
}

impl EngineCosts {
    /// Of the engine that [`Engine::Auto`] is.
    pub fn least(&self) -> u64 {
        self.lists.min(self.pivot).min(self.scan)
    }
}
