//! The best windows of a long series.

use std::collections::BTreeSet;
use std::ops::Range;

use ndarray::{ArrayView2, s};
use pulp::Arch;

use super::best::{Best, Found, by_cost};
use super::block::{Block, GROUP, Scratch, block_len};
use super::bounds;
use super::groups::{Beyond, Ends};
use super::margin::Margin;
use super::query::Query;
use super::refine::refine;
use crate::{DtwError, Sample, parallel};

/// Windows whose cost is found first, besides those that are needed for a limit.
const SEEDS: usize = 32;

/// All windows of a series that are as long as the query; there is at least one.
pub(super) struct Windows<'a, T> {
    query: &'a Query<T>,
    series: ArrayView2<'a, T>,
    margin: Margin,
    order: Vec<usize>,
}

/// The chosen windows.
pub(super) fn best_windows<T: Sample>(
    query: &Query<T>,
    series: ArrayView2<'_, T>,
    mut best: Best,
) -> Result<Vec<Found>, DtwError> {
    let windows = Windows::new(query, series);
    let by_ends = windows.by_ends();
    let seeds = by_ends.iter().flat_map(|block| &block.seeds).copied();
    let mut seeds: Vec<Found> = seeds.collect();
    seeds.sort_unstable_by(by_cost);
    seeds.truncate(best.wanted().saturating_add(SEEDS));
    let survivor = |scratch: &mut bounds::Scratch, start, limit| {
        let window = series.slice(s![start..start + query.n, ..]);
        let window = query.search.normalised(window);
        query.bound_within(window.view(), limit, scratch)?;
        Some(window)
    };
    refine(query, &seeds, &mut best, survivor)?;
    let done: BTreeSet<usize> = seeds.iter().map(|&(_, start)| start).collect();
    let mut left = windows.by_envelope(&by_ends, best.limit());
    left.retain(|(_, start)| !done.contains(start));
    left.sort_unstable_by(by_cost);
    refine(query, &left, &mut best, survivor)?;
    Ok(best.into_chosen())
}

/// The frames between the layers at the ends, first those in which the query's envelope is far
/// from its mean: most windows pass near that.
fn order<T: Sample>(query: &Query<T>) -> Vec<usize> {
    let layers = query.layers(query.n);
    let mut weights = vec![0.0; query.n];
    let envelope = query
        .envelope
        .lower
        .chunks_exact(query.envelope.len)
        .zip(query.envelope.upper.chunks_exact(query.envelope.len));
    for (points, (lower, upper)) in query.points.chunks_exact(query.n).zip(envelope) {
        let mean = points.iter().sum::<f64>() / query.n as f64;
        for (weight, (lower, upper)) in weights.iter_mut().zip(lower.iter().zip(upper)) {
            let distance = (lower - mean).max(mean - upper).max(0.0);
            *weight += distance * distance;
        }
    }
    let mut order: Vec<usize> = (layers..query.n - layers).collect();
    order.sort_by(|&a: &usize, &b: &usize| weights[b].total_cmp(&weights[a]));
    order
}

/// What is known of a block's windows by their ends.
pub(super) struct ByEnds {
    block: Block,
    /// Without regard to rounding.
    sums: Vec<f64>,
    /// Of each few windows, the one with the least lower bound.
    seeds: Vec<Found>,
}

impl<'a, T: Sample> Windows<'a, T> {
    pub(super) fn new(query: &'a Query<T>, series: ArrayView2<'a, T>) -> Self {
        Self {
            query,
            series,
            margin: query.margin(query.n),
            order: order(query),
        }
    }

    pub(super) fn by_ends(&self) -> Vec<ByEnds> {
        let n_windows = self.series.nrows() - self.query.n + 1;
        let len = block_len(self.query.n);
        let blocks: Vec<Range<usize>> = (0..n_windows)
            .step_by(len)
            .map(|start| start..(start + len).min(n_windows))
            .collect();
        parallel::map(&blocks, Scratch::default, |scratch, starts| {
            self.block_by_ends(starts.clone(), scratch)
        })
    }

    /// Windows that the query's envelope leaves, with their lower bounds.
    pub(super) fn by_envelope(&self, blocks: &[ByEnds], limit: f64) -> Vec<Found> {
        let left = parallel::map(
            blocks,
            || (),
            |(), by_ends| self.block_by_envelope(by_ends, limit),
        );
        left.concat()
    }

    fn block_by_ends(&self, starts: Range<usize>, scratch: &mut Scratch) -> ByEnds {
        let Query { search, n, .. } = self.query;
        let frames = self.series.slice(s![starts.start..starts.end + n - 1, ..]);
        let block = Block::load(search, (frames, starts.start), (*n, &self.margin), scratch);
        let mut sums = vec![0.0; block.width];
        let mut bounds = vec![0.0; block.width];
        Arch::new().dispatch(Ends {
            block: &block,
            query: self.query,
            margin: &self.margin,
            sums: &mut sums,
            bounds: &mut bounds,
        });
        let bounds = &mut bounds[..starts.len()];
        block.close_bounds(bounds);
        let groups = (starts.start..).step_by(GROUP).zip(bounds.chunks(GROUP));
        ByEnds {
            seeds: groups
                .filter_map(|(first, bounds)| seed(first, bounds))
                .collect(),
            block,
            sums,
        }
    }

    fn block_by_envelope(&self, by_ends: &ByEnds, limit: f64) -> Vec<Found> {
        let mut left = Vec::new();
        if by_ends.seeds.iter().all(|&(bound, _)| bound > limit) {
            return left;
        }
        Arch::new().dispatch(Beyond {
            block: &by_ends.block,
            query: self.query,
            margin: &self.margin,
            order: &self.order,
            limit,
            sums: &by_ends.sums,
            left: &mut left,
        });
        left
    }
}

/// The first of the least, unless nothing has a path.
fn seed(first: usize, bounds: &[f64]) -> Option<Found> {
    // Several minima side by side, which a processor's vectors can hold.
    let mut least = [f64::INFINITY; 8];
    let (chunks, rest) = bounds.as_chunks();
    for chunk in chunks {
        for (least, &bound) in least.iter_mut().zip::<&[f64; 8]>(chunk) {
            *least = if bound < *least { bound } else { *least };
        }
    }
    let least = least.into_iter().chain(rest.iter().copied());
    let least = least.fold(f64::INFINITY, f64::min);
    let is_least = |&bound: &f64| bound == least && bound < f64::INFINITY;
    let nth = bounds.iter().position(is_least)?;
    Some((least, first + nth))
}
