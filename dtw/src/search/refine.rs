//! From lower bounds to costs.

use ndarray::Array2;

use super::best::{Best, Found, by_cost};
use super::bounds::Scratch;
use super::query::{Query, points_of};
use super::together::CANDIDATES;
use crate::{DtwError, Sample, parallel};

/// Candidates between two updates of the limit: few at first, when it falls fast.
const FIRST_BATCH: usize = CANDIDATES;
const LAST_BATCH: usize = 1024;

/// With more dimensions, [`crate::Dtw`]'s own kernel is about as fast for one candidate as the one
/// for several at once, which then saves nothing.
const MAX_DIMS: usize = 8;

/// Frames as they are compared, if a candidate may cost no more than a limit.
pub(super) trait Survivor<T>:
    Fn(&mut Scratch, usize, f64) -> Option<Array2<T>> + Sync + Send
{
}

impl<T, F: Fn(&mut Scratch, usize, f64) -> Option<Array2<T>> + Sync + Send> Survivor<T> for F {}

/// A candidate that no bound has ruled out.
struct Candidate<T> {
    index: usize,
    bound: f64,
    frames: Array2<T>,
    points: Vec<f64>,
}

/// Finds the costs of what may be among the best, in order of lower bounds.
pub(super) fn refine<T: Sample>(
    query: &Query<T>,
    bounds: &[Found],
    best: &mut Best,
    survivor: impl Survivor<T>,
) -> Result<(), DtwError> {
    let mut left = bounds;
    let mut len = FIRST_BATCH;
    while !left.is_empty() {
        let limit = best.limit();
        let (batch, rest) = left.split_at(len.min(left.len()));
        left = rest;
        len = (2 * len).min(LAST_BATCH);
        let batch = &batch[..batch.partition_point(|(bound, _)| *bound <= limit)];
        if batch.is_empty() {
            break;
        }
        let candidates = parallel::map(batch, Scratch::default, |scratch, &(bound, index)| {
            let frames = survivor(scratch, index, limit)?;
            let mut points = Vec::new();
            points_of(query.search.local, frames.view(), &mut points);
            Some(Candidate {
                index,
                bound,
                frames,
                points,
            })
        });
        let candidates = candidates.into_iter().flatten().collect();
        exactly(query, candidates, best)?;
    }
    Ok(())
}

/// Adds the costs of the candidates, in order of the best bounds there are.
fn exactly<T: Sample>(
    query: &Query<T>,
    mut candidates: Vec<Candidate<T>>,
    best: &mut Best,
) -> Result<(), DtwError> {
    if query.dims <= MAX_DIMS {
        warp_together(query, &mut candidates, best.limit());
    }
    let found = |candidate: &'_ Candidate<T>| (candidate.bound, candidate.index);
    candidates.sort_unstable_by(|a, b| by_cost(&found(a), &found(b)));
    for batch in candidates.chunks(best.wanted().clamp(1, LAST_BATCH)) {
        let limit = best.limit();
        let batch = &batch[..batch.partition_point(|candidate| candidate.bound <= limit)];
        if batch.is_empty() {
            break;
        }
        let costs = parallel::map(
            batch,
            || (),
            |(), candidate| {
                let cost = query.distance_within(candidate.frames.view(), limit)?;
                Ok(cost.map(|cost| (cost, candidate.index)))
            },
        );
        let costs: Vec<Option<Found>> = costs.into_iter().collect::<Result<_, _>>()?;
        best.extend(costs.into_iter().flatten());
    }
    Ok(())
}

/// Raises bounds to costs but for rounding; those above the limit to infinity.
fn warp_together<T: Sample>(query: &Query<T>, candidates: &mut [Candidate<T>], limit: f64) {
    candidates.sort_by_key(|candidate| candidate.frames.nrows());
    let groups: Vec<&[Candidate<T>]> = candidates
        .chunk_by(|a, b| a.frames.nrows() == b.frames.nrows())
        .flat_map(|of_length| of_length.chunks(CANDIDATES))
        .collect();
    let bounds = parallel::map(
        &groups,
        || (),
        |(), group| {
            let points: Vec<&[f64]> = group.iter().map(|one| &one.points[..]).collect();
            query.costs_but_for_rounding(group[0].frames.nrows(), &points, limit)
        },
    );
    for (candidate, bound) in candidates.iter_mut().zip(bounds.into_iter().flatten()) {
        candidate.bound = bound.unwrap_or(f64::INFINITY);
    }
}
