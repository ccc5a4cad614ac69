//! Lower bounds for one candidate, cheapest first.

use pulp::{Simd, WithSimd};

use super::envelope::Envelope;
use super::margin::{Margin, Norm};
use super::query::Query;
use crate::Sample;

/// Memory for one candidate after the other.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    /// The candidate, dimension after dimension.
    pub(super) points: Vec<f64>,
    /// The points, moved to the nearest within the query's envelope.
    projection: Vec<f64>,
    envelope: Envelope,
    sums: Vec<f64>,
}

/// The greatest of the bounds for the candidate of `m` frames in `scratch`; `None` once one of
/// them is above `limit`.
pub(super) struct Cascade<'a, T> {
    pub(super) query: &'a Query<T>,
    pub(super) m: usize,
    pub(super) margin: Margin,
    pub(super) limit: f64,
    pub(super) scratch: &'a mut Scratch,
}

impl<T: Sample> WithSimd for Cascade<'_, T> {
    type Output = Option<f64>;

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, _: S) -> Option<f64> {
        let ends = self.ends();
        let by_query = self.by_query();
        let mut bound = self.bound(ends + by_query);
        if bound > self.limit {
            return None;
        }
        let by_candidate = self.by_candidate();
        bound = bound.max(self.bound(ends + by_candidate));
        if bound > self.limit {
            return None;
        }
        // A root of sums over several dimensions is less than the sum of the roots of its parts.
        if self.margin.norm != Norm::Root || self.query.dims == 1 {
            let by_projection = self.by_projection();
            bound = bound.max(self.bound(ends + by_query + by_projection));
        }
        (bound <= self.limit).then_some(bound)
    }
}

impl<T: Sample> Cascade<'_, T> {
    pub(super) fn bound(&self, sum: f64) -> f64 {
        self.margin.lower_bound(sum, self.margin.directions)
    }

    /// Kim's bound: the cheapest pair of each layer at the ends.
    pub(super) fn ends(&self) -> f64 {
        let (last, end) = (self.query.n - 1, self.m - 1);
        let mut sum = 0.0;
        for layer in 0..self.query.layers(self.m) {
            let (mut front, mut back) = (f64::INFINITY, f64::INFINITY);
            for (i, j) in self.query.layer(layer, self.m) {
                front = least(front, self.pair(i, j));
                back = least(back, self.pair(last - i, end - j));
            }
            sum += front + back;
        }
        sum
    }

    fn pair(&self, i: usize, j: usize) -> f64 {
        let of_query = self.query.points.chunks_exact(self.query.n);
        let of_candidate = self.scratch.points.chunks_exact(self.m);
        let mut sum = 0.0;
        for (a, b) in of_query.zip(of_candidate) {
            let difference = a[i] - b[j];
            sum += match self.margin.norm {
                Norm::Absolutes => difference.abs(),
                Norm::Squares | Norm::Root => difference * difference,
            };
        }
        if self.margin.norm == Norm::Root {
            sum.sqrt()
        } else {
            sum
        }
    }

    /// Keogh's bound: distances of the candidate's frames, but those at the ends, from the query's
    /// envelope.
    #[inline(always)]
    pub(super) fn by_query(&mut self) -> f64 {
        let Scratch { points, sums, .. } = &mut *self.scratch;
        let norm = self.margin.norm;
        deviations(norm, (points, self.m), &self.query.envelope, sums);
        let layers = self.query.layers(self.m);
        total(&sums[layers..self.m - layers])
    }

    /// The same of the query's frames from the candidate's envelope.
    #[inline(always)]
    pub(super) fn by_candidate(&mut self) -> f64 {
        let Scratch {
            points, envelope, ..
        } = &mut *self.scratch;
        envelope.set(
            points,
            self.m,
            self.query.n,
            self.query.search.radius.radius(),
        );
        self.beyond_envelope()
    }

    /// What Lemire's bound adds to Keogh's by the query's envelope: distances of the query's
    /// frames from the envelope of the candidate's projection onto the query's envelope.
    #[inline(always)]
    pub(super) fn by_projection(&mut self) -> f64 {
        let Scratch {
            points,
            envelope,
            projection,
            ..
        } = &mut *self.scratch;
        let Envelope {
            lower, upper, len, ..
        } = &self.query.envelope;
        projection.clear();
        let bounds = lower.chunks_exact(*len).zip(upper.chunks_exact(*len));
        for (points, (lower, upper)) in points.chunks_exact(self.m).zip(bounds) {
            let moved = points.iter().zip(lower.iter().zip(upper));
            projection.extend(moved.map(|(&x, (&lower, &upper))| least(greatest(x, lower), upper)));
        }
        envelope.set(
            projection,
            self.m,
            self.query.n,
            self.query.search.radius.radius(),
        );
        self.beyond_envelope()
    }

    #[inline(always)]
    fn beyond_envelope(&mut self) -> f64 {
        let n = self.query.n;
        let Scratch { envelope, sums, .. } = &mut *self.scratch;
        deviations(self.margin.norm, (&self.query.points, n), envelope, sums);
        let layers = self.query.layers(self.m);
        total(&sums[layers..n - layers])
    }
}

/// Distance of each frame from the envelope.
#[inline(always)]
fn deviations(norm: Norm, (points, n): (&[f64], usize), envelope: &Envelope, sums: &mut Vec<f64>) {
    match norm {
        Norm::Absolutes => deviations_of(|x| x, (points, n), envelope, sums),
        Norm::Squares | Norm::Root => deviations_of(|x| x * x, (points, n), envelope, sums),
    }
    if norm == Norm::Root {
        for sum in sums {
            *sum = sum.sqrt();
        }
    }
}

#[inline(always)]
fn deviations_of(
    term: impl Fn(f64) -> f64,
    (points, n): (&[f64], usize),
    envelope: &Envelope,
    sums: &mut Vec<f64>,
) {
    sums.clear();
    sums.resize(n, 0.0);
    let (lower, upper) = (&envelope.lower, &envelope.upper);
    let bounds = lower
        .chunks_exact(envelope.len)
        .zip(upper.chunks_exact(envelope.len));
    for (points, (lower, upper)) in points.chunks_exact(n).zip(bounds) {
        let points = points.iter().zip(lower.iter().zip(upper));
        for (sum, (&x, (&lower, &upper))) in sums.iter_mut().zip(points) {
            *sum += term(greatest(greatest(x - upper, lower - x), 0.0));
        }
    }
}

/// Neither is NaN, which `f64::max` would look for.
#[inline(always)]
fn greatest(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

#[inline(always)]
fn least(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// Sum in eight parts, as the order does not matter within the margin.
#[inline(always)]
fn total(terms: &[f64]) -> f64 {
    let mut parts = [0.0; 8];
    let chunks = terms.chunks_exact(8);
    let rest: f64 = chunks.remainder().iter().sum();
    for chunk in chunks {
        for (part, &term) in parts.iter_mut().zip(chunk) {
            *part += term;
        }
    }
    parts.iter().sum::<f64>() + rest
}
