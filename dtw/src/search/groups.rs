//! Kim's and Keogh's bounds of the windows of a block, a window to a lane.

use pulp::{Simd, WithSimd};

use super::best::Found;
use super::block::{Block, GROUP};
use super::margin::{Margin, Norm};
use super::query::Query;
use crate::Sample;

/// Vectors that are worked on at once, to hide the latency of an addition.
const VECTORS: usize = 4;

/// Frames between two looks at whether a group is out.
const FRAMES: usize = 8;

type Group<S> = [<S as Simd>::f64s; VECTORS];

/// Sums over the cheapest pair of each layer at the ends, for every window, and lower bounds.
pub(super) struct Ends<'a, T> {
    pub(super) block: &'a Block,
    pub(super) query: &'a Query<T>,
    pub(super) margin: &'a Margin,
    pub(super) sums: &'a mut [f64],
    pub(super) bounds: &'a mut [f64],
}

/// Adds distances from the query's envelope to `sums`, until a group's are all above the limit.
/// The windows that are left are added to `left` with their lower bounds.
pub(super) struct Beyond<'a, T> {
    pub(super) block: &'a Block,
    pub(super) query: &'a Query<T>,
    pub(super) margin: &'a Margin,
    /// Frames of a window in the order in which they are looked at.
    pub(super) order: &'a [usize],
    pub(super) limit: f64,
    pub(super) sums: &'a [f64],
    pub(super) left: &'a mut Vec<Found>,
}

impl<T: Sample> WithSimd for Ends<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self {
            block,
            query,
            margin,
            sums,
            bounds,
        } = self;
        let last = query.n.saturating_sub(1);
        let infinite = simd.splat_f64s(f64::INFINITY);
        let groups = sums.chunks_exact_mut(VECTORS * S::F64_LANES);
        for (nth, sums) in groups.enumerate() {
            let lanes = Lanes {
                simd,
                block,
                first: nth * VECTORS * S::F64_LANES,
            };
            let mut all = [simd.splat_f64s(0.0); VECTORS];
            for layer in 0..query.layers(query.n) {
                let (mut front, mut back) = ([infinite; VECTORS], [infinite; VECTORS]);
                for (i, j) in query.layer(layer, query.n) {
                    let cost = lanes.pair(query, margin.norm, (i, j));
                    lanes.minima(&mut front, cost);
                    let cost = lanes.pair(query, margin.norm, (last - i, last - j));
                    lanes.minima(&mut back, cost);
                }
                lanes.add(&mut all, front);
                lanes.add(&mut all, back);
            }
            store::<S>(sums, all);
        }
        for (bound, (&sum, &error)) in bounds.iter_mut().zip(sums.iter().zip(&block.errors)) {
            *bound = margin.lower_bound(sum, error);
        }
    }
}

impl<T: Sample> WithSimd for Beyond<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self {
            block,
            query,
            margin,
            order,
            limit,
            sums,
            left,
        } = self;
        let len = VECTORS * S::F64_LANES;
        for (nth, sums) in sums.chunks_exact(len).enumerate() {
            let lanes = Lanes {
                simd,
                block,
                first: nth * len,
            };
            let mut cuts = [0.0; GROUP];
            let cuts = &mut cuts[..len];
            for (cut, &error) in cuts.iter_mut().zip(&block.errors[lanes.first..]) {
                *cut = margin.cut(limit, error);
            }
            let cuts = group::<S>(cuts);
            let mut all = group::<S>(sums);
            for frames in order.chunks(FRAMES) {
                if lanes.are_above(&all, &cuts) {
                    break;
                }
                for &frame in frames {
                    let cost = lanes.beyond(query, margin.norm, frame);
                    lanes.add(&mut all, cost);
                }
            }
            if lanes.are_above(&all, &cuts) {
                continue;
            }
            let sums = pulp::bytemuck::cast_slice::<_, f64>(&all);
            for (window, &sum) in (lanes.first..block.starts.len()).zip(sums) {
                let bound = margin.lower_bound(sum, block.errors[window]);
                if bound <= limit && !block.is_closed(window) {
                    left.push((bound, block.starts.start + window));
                }
            }
        }
    }
}

/// A group of a block's windows.
struct Lanes<'a, S> {
    simd: S,
    block: &'a Block,
    first: usize,
}

// Loops instead of closures: those would be compiled without the vectors' instructions.
impl<S: Simd> Lanes<'_, S> {
    /// Frame `frame` of each window in one dimension.
    #[inline(always)]
    fn points(&self, dim: usize, frame: usize) -> Group<S> {
        let Block {
            stride,
            width,
            samples,
            factors,
            shifts,
            ..
        } = self.block;
        let mut points = group::<S>(&samples[dim * stride + self.first + frame..]);
        let factors = group::<S>(&factors[dim * width + self.first..]);
        let shifts = group::<S>(&shifts[dim * width + self.first..]);
        for (point, (factor, shift)) in points.iter_mut().zip(factors.into_iter().zip(shifts)) {
            let scaled = self.simd.mul_f64s(*point, factor);
            *point = self.simd.sub_f64s(scaled, shift);
        }
        points
    }

    /// Local costs of frame i of the query and frame j of each window.
    #[inline(always)]
    fn pair<T>(&self, query: &Query<T>, norm: Norm, (i, j): (usize, usize)) -> Group<S> {
        let mut sums = [self.simd.splat_f64s(0.0); VECTORS];
        for dim in 0..query.dims {
            let x = self.simd.splat_f64s(query.points[dim * query.n + i]);
            let mut differences = self.points(dim, j);
            for y in &mut differences {
                *y = self.simd.abs_f64s(self.simd.sub_f64s(*y, x));
            }
            self.add_terms(&mut sums, norm, differences);
        }
        self.finish(norm, sums)
    }

    /// Distances of a frame of each window from the query's envelope.
    #[inline(always)]
    fn beyond<T>(&self, query: &Query<T>, norm: Norm, frame: usize) -> Group<S> {
        let simd = self.simd;
        let zero = simd.splat_f64s(0.0);
        let envelope = &query.envelope;
        let mut sums = [zero; VECTORS];
        for dim in 0..query.dims {
            let at = dim * envelope.len + frame;
            let lower = simd.splat_f64s(envelope.lower[at]);
            let upper = simd.splat_f64s(envelope.upper[at]);
            let mut differences = self.points(dim, frame);
            for x in &mut differences {
                let (above, below) = (simd.sub_f64s(*x, upper), simd.sub_f64s(lower, *x));
                *x = simd.max_f64s(simd.max_f64s(above, below), zero);
            }
            self.add_terms(&mut sums, norm, differences);
        }
        self.finish(norm, sums)
    }

    #[inline(always)]
    fn add_terms(&self, sums: &mut Group<S>, norm: Norm, differences: Group<S>) {
        for (sum, x) in sums.iter_mut().zip(differences) {
            let term = match norm {
                Norm::Absolutes => x,
                Norm::Squares | Norm::Root => self.simd.mul_f64s(x, x),
            };
            *sum = self.simd.add_f64s(*sum, term);
        }
    }

    #[inline(always)]
    fn finish(&self, norm: Norm, mut sums: Group<S>) -> Group<S> {
        if norm == Norm::Root {
            for sum in &mut sums {
                *sum = self.simd.sqrt_f64s(*sum);
            }
        }
        sums
    }

    #[inline(always)]
    fn add(&self, sums: &mut Group<S>, more: Group<S>) {
        for (sum, more) in sums.iter_mut().zip(more) {
            *sum = self.simd.add_f64s(*sum, more);
        }
    }

    #[inline(always)]
    fn minima(&self, least: &mut Group<S>, other: Group<S>) {
        for (least, other) in least.iter_mut().zip(other) {
            *least = self.simd.min_f64s(*least, other);
        }
    }

    #[inline(always)]
    fn are_above(&self, sums: &Group<S>, cuts: &Group<S>) -> bool {
        let simd = self.simd;
        for (&sum, &cut) in sums.iter().zip(cuts) {
            let is_in = simd.not_m64s(simd.greater_than_f64s(sum, cut));
            if simd.first_true_m64s(is_in) < S::F64_LANES {
                return false;
            }
        }
        true
    }
}

/// The first vectors of a slice that is long enough.
#[inline(always)]
fn group<S: Simd>(samples: &[f64]) -> Group<S> {
    let samples = &samples[..VECTORS * S::F64_LANES];
    let vectors = pulp::bytemuck::cast_slice::<f64, S::f64s>(samples);
    [vectors[0], vectors[1], vectors[2], vectors[3]]
}

#[inline(always)]
fn store<S: Simd>(samples: &mut [f64], group: Group<S>) {
    let vectors = pulp::bytemuck::cast_slice_mut::<f64, S::f64s>(samples);
    for (vector, new) in vectors.iter_mut().zip(group) {
        *vector = new;
    }
}
