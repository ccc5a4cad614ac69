//! What a search would cost.

use super::pattern::Kind;
use super::plan::Plan;
use super::sets::Sets;
use super::{Engine, EngineCosts};
use crate::{Query, Shard, ShardError};

/// What [`search_adaptive`](crate::search_adaptive) would cost by each engine, without searching: to choose between
/// shards that would give the same hits. All zero for a query without positions or a shard without segments.
///
/// Cost: O(positions · masks), times up to 2,048 distinct words; the first call in a shard O(distinct words).
///
/// # Errors
///
/// [`ShardError`] if a page that it needs is damaged.
pub fn estimate_adaptive<B: AsRef<[u8]>>(
    shard: &Shard<B>,
    query: &Query,
) -> Result<EngineCosts, ShardError> {
    let view = shard.view();
    let query = query.conjoined();
    let positions = query.positions();
    let dictionary = if positions.is_empty() || view.n_segments() == 0 {
        None
    } else {
        view.dictionary()
    };
    let Some(dictionary) = dictionary else {
        return view.finish(EngineCosts::default());
    };
    let sets = Sets::new(dictionary, positions, Kind::Adaptive.care());
    let plan = Plan::new(
        (&view, dictionary),
        &sets,
        positions,
        (Engine::Auto, Kind::Adaptive),
    );
    view.finish(plan.done.estimated)
}
