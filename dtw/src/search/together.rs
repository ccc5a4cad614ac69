//! Warping of several candidates at once, a candidate to a lane.

use pulp::{Simd, WithSimd};

use super::margin::{Margin, Norm};
use super::query::Query;
use crate::Sample;

/// Vectors that are worked on at once, to hide the latency from one column to the next.
const VECTORS: usize = 2;

/// Candidates that fill the widest vectors.
pub(super) const CANDIDATES: usize = 16;

type Group<S> = [<S as Simd>::f64s; VECTORS];

/// Lower bounds of the costs of candidates of `m` frames that are no more than rounding away from
/// them, or `None` for those above `limit`.
///
/// Rows are given up when in every lane the cheapest cell, together with Keogh's bound of the
/// columns to come, is above the limit.
pub(super) struct Together<'a, T> {
    pub(super) query: &'a Query<T>,
    pub(super) m: usize,
    pub(super) margin: Margin,
    /// Each dimension after dimension.
    pub(super) candidates: &'a [&'a [f64]],
    pub(super) limit: f64,
}

impl<T: Sample> WithSimd for Together<'_, T> {
    type Output = Vec<Option<f64>>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let lanes = VECTORS * S::F64_LANES;
        let mut bounds = Vec::with_capacity(self.candidates.len());
        let mut points = Vec::new();
        for candidates in self.candidates.chunks(lanes) {
            interleave(candidates, lanes, &mut points);
            let sums = self.sums(simd, pulp::bytemuck::cast_slice(&points));
            let sums = pulp::bytemuck::cast_slice::<_, f64>(&sums);
            bounds.extend(sums.iter().take(candidates.len()).map(|&sum| {
                let bound = self.margin.lower_bound(sum, self.margin.directions);
                (bound <= self.limit).then_some(bound)
            }));
        }
        bounds
    }
}

/// Sample after sample of all candidates; lanes without one repeat the first.
fn interleave(candidates: &[&[f64]], lanes: usize, points: &mut Vec<f64>) {
    let len = candidates.first().map_or(0, |points| points.len());
    points.clear();
    points.resize(len * lanes, 0.0);
    for (nth, points) in points.chunks_exact_mut(lanes).enumerate() {
        for (lane, point) in points.iter_mut().enumerate() {
            *point = candidates.get(lane).unwrap_or(&candidates[0])[nth];
        }
    }
}

impl<T: Sample> Together<'_, T> {
    /// Accumulated costs of the last pair, infinite for those that were given up.
    #[inline(always)]
    fn sums<S: Simd>(&self, simd: S, points: &[S::f64s]) -> Group<S> {
        let (n, m) = (self.query.n, self.m);
        let radius = self.query.search.radius.radius();
        let infinite = [simd.splat_f64s(f64::INFINITY); VECTORS];
        let cut = self.margin.cut(self.limit, self.margin.directions);
        let cut = simd.splat_f64s(cut);
        let left = self.columns_left(simd, points);
        // Costs of the row above, from column -1 on; those of this row up to the present column.
        let mut row = vec![infinite; m + 1];
        row[0] = [simd.splat_f64s(0.0); VECTORS];
        for i in 0..n {
            let (first, last) = (
                i.saturating_sub(radius),
                i.saturating_add(radius).min(m - 1),
            );
            let (mut diagonal, mut before, mut cheapest) = (row[first], infinite, infinite);
            if i == 0 {
                row[0] = infinite;
            }
            for j in first..=last {
                let cost = self.pair(simd, points, (i, j));
                let above = row[j + 1];
                for v in 0..VECTORS {
                    let from = simd.min_f64s(diagonal[v], above[v]);
                    before[v] = simd.add_f64s(simd.min_f64s(from, before[v]), cost[v]);
                    cheapest[v] = simd.min_f64s(cheapest[v], before[v]);
                }
                row[j + 1] = before;
                diagonal = above;
            }
            let mut is_out = true;
            for v in 0..VECTORS {
                let least = simd.add_f64s(cheapest[v], left[last + 1][v]);
                let is_in = simd.not_m64s(simd.greater_than_f64s(least, cut));
                is_out &= simd.first_true_m64s(is_in) >= S::F64_LANES;
            }
            if is_out {
                return infinite;
            }
        }
        row[m]
    }

    /// For each column, Keogh's bound of it and all after it; none at the end.
    #[inline(always)]
    fn columns_left<S: Simd>(&self, simd: S, points: &[S::f64s]) -> Vec<Group<S>> {
        let zero = simd.splat_f64s(0.0);
        let envelope = &self.query.envelope;
        let mut left = vec![[zero; VECTORS]; self.m + 1];
        for j in (0..self.m).rev() {
            let mut sums = [zero; VECTORS];
            for dim in 0..self.query.dims {
                let at = dim * envelope.len + j;
                let lower = simd.splat_f64s(envelope.lower[at]);
                let upper = simd.splat_f64s(envelope.upper[at]);
                let x = &points[VECTORS * (dim * self.m + j)..];
                for v in 0..VECTORS {
                    let above = simd.sub_f64s(x[v], upper);
                    let below = simd.sub_f64s(lower, x[v]);
                    let beyond = simd.max_f64s(simd.max_f64s(above, below), zero);
                    sums[v] = simd.add_f64s(sums[v], self.term(simd, beyond));
                }
            }
            for v in 0..VECTORS {
                left[j][v] = simd.add_f64s(left[j + 1][v], self.finish(simd, sums[v]));
            }
        }
        left
    }

    #[inline(always)]
    fn pair<S: Simd>(&self, simd: S, points: &[S::f64s], (i, j): (usize, usize)) -> Group<S> {
        let mut sums = [simd.splat_f64s(0.0); VECTORS];
        for dim in 0..self.query.dims {
            let a = simd.splat_f64s(self.query.points[dim * self.query.n + i]);
            let b = &points[VECTORS * (dim * self.m + j)..];
            for v in 0..VECTORS {
                let difference = simd.abs_f64s(simd.sub_f64s(a, b[v]));
                sums[v] = simd.add_f64s(sums[v], self.term(simd, difference));
            }
        }
        for sum in &mut sums {
            *sum = self.finish(simd, *sum);
        }
        sums
    }

    #[inline(always)]
    fn term<S: Simd>(&self, simd: S, difference: S::f64s) -> S::f64s {
        match self.margin.norm {
            Norm::Absolutes => difference,
            Norm::Squares | Norm::Root => simd.mul_f64s(difference, difference),
        }
    }

    #[inline(always)]
    fn finish<S: Simd>(&self, simd: S, sum: S::f64s) -> S::f64s {
        if self.margin.norm == Norm::Root {
            simd.sqrt_f64s(sum)
        } else {
            sum
        }
    }
}
