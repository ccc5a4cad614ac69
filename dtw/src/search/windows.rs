//! The best windows of a long series.

use std::collections::BTreeSet;
use std::ops::Range;

use ndarray::{ArrayView2, s};
use pulp::Arch;

use super::best::{Best, Found, by_cost};
use super::block::{Block, GROUP, block_len};
use super::bounds;
use super::groups::{Beyond, Ends};
use super::margin::{Margin, Norm};
use super::query::Query;
use super::refine::refine;
use crate::{DtwError, Sample, parallel};

/// Windows whose cost is found first, besides those that are needed for a limit.
const SEEDS: usize = 32;

struct Windows<'a, T> {
    query: &'a Query<T>,
    series: ArrayView2<'a, T>,
    margin: Margin,
    order: Vec<usize>,
}

/// The chosen windows of as many frames as the query; there is at least one window.
pub(super) fn best_windows<T: Sample>(
    query: &Query<T>,
    series: ArrayView2<'_, T>,
    mut best: Best,
) -> Result<Vec<Found>, DtwError> {
    let n_windows = series.nrows() - query.n + 1;
    let len = block_len(query.n);
    let blocks: Vec<Range<usize>> = (0..n_windows)
        .step_by(len)
        .map(|start| start..(start + len).min(n_windows))
        .collect();
    let windows = Windows {
        query,
        series: series.view(),
        margin: query.margin(query.n),
        order: order(query),
    };
    let bounds = parallel::map(&blocks, Scratch::default, |scratch, starts| {
        windows.by_ends(starts.clone(), scratch)
    });
    let bounds: Vec<f64> = bounds.concat();
    let survivor = |scratch: &mut bounds::Scratch, start, limit| {
        let window = series.slice(s![start..start + query.n, ..]);
        let window = query.search.normalised(window);
        query.bound_within(window.view(), limit, scratch)?;
        Some(window)
    };
    let seeds = seeds(&bounds, best.wanted());
    refine(query, &seeds, &mut best, survivor)?;
    let done: BTreeSet<usize> = seeds.iter().map(|&(_, start)| start).collect();
    let limit = best.limit();
    let left = parallel::map(&blocks, Scratch::default, |scratch, starts| {
        windows.by_envelope(starts.clone(), &bounds, limit, scratch)
    });
    let mut left = left.concat();
    left.retain(|(_, start)| !done.contains(start));
    left.sort_unstable_by(by_cost);
    refine(query, &left, &mut best, survivor)?;
    Ok(best.into_chosen())
}

/// The least bounds among those of every few windows, of which neighbours are alike.
fn seeds(bounds: &[f64], wanted: usize) -> Vec<Found> {
    let mut seeds: Vec<Found> = bounds
        .chunks(GROUP)
        .enumerate()
        .filter_map(|(nth, bounds)| {
            let starts = (nth * GROUP..).zip(bounds);
            starts.map(|(start, &bound)| (bound, start)).min_by(by_cost)
        })
        .filter(|(bound, _)| *bound < f64::INFINITY)
        .collect();
    seeds.sort_unstable_by(by_cost);
    seeds.truncate(wanted.saturating_add(SEEDS));
    seeds
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

#[derive(Default)]
struct Scratch {
    block: Block,
    sums: Vec<f64>,
}

impl<T: Sample> Windows<'_, T> {
    /// Lower bounds by the pairs at the ends; infinite for windows without a path.
    fn by_ends(&self, starts: Range<usize>, scratch: &mut Scratch) -> Vec<f64> {
        let n_windows = starts.len();
        let Scratch { block, sums } = scratch;
        self.sum_ends(starts, block, sums);
        let bounds = sums.iter().zip(&block.errors).enumerate();
        bounds
            .take(n_windows)
            .map(|(window, (&sum, &error))| {
                if block.is_closed(window) {
                    f64::INFINITY
                } else {
                    self.margin.lower_bound(sum, error)
                }
            })
            .collect()
    }

    /// Windows that the query's envelope leaves, with their lower bounds.
    fn by_envelope(
        &self,
        starts: Range<usize>,
        bounds: &[f64],
        limit: f64,
        scratch: &mut Scratch,
    ) -> Vec<Found> {
        let bounds = &bounds[starts.clone()];
        if bounds.iter().all(|&bound| bound > limit) {
            return Vec::new();
        }
        let Scratch { block, sums } = scratch;
        self.sum_ends(starts.clone(), block, sums);
        Arch::new().dispatch(Beyond {
            block: &*block,
            query: self.query,
            margin: &self.margin,
            order: &self.order,
            limit,
            sums,
        });
        let bounds = sums.iter().zip(&block.errors).zip(starts).enumerate();
        bounds
            .filter(|(window, _)| !block.is_closed(*window))
            .map(|(_, ((&sum, &error), start))| (self.margin.lower_bound(sum, error), start))
            .filter(|(bound, _)| *bound <= limit)
            .collect()
    }

    fn sum_ends(&self, starts: Range<usize>, block: &mut Block, sums: &mut Vec<f64>) {
        let Query { search, n, .. } = self.query;
        block.load(search, self.series, starts, (*n, &self.margin));
        Arch::new().dispatch(Ends {
            block: &*block,
            query: self.query,
            norm: Norm::of(search.local),
            sums,
        });
    }
}
