//! A query, made ready, and the bounds for one candidate.

use ndarray::{Array2, ArrayView2, Axis};
use pulp::Arch;

use super::Search;
use super::bounds::{Cascade, Scratch};
use super::envelope::Envelope;
use super::margin::{Margin, Size};
use super::normal::z_normalised;
use super::together::Together;
use crate::{Dtw, DtwError, LocalCost, Sample};

/// Pairs at either end of a path that are bounded by themselves.
const MAX_LAYERS: usize = 3;

/// A query as it is compared.
#[derive(Debug)]
pub(super) struct Query<T> {
    pub(super) search: Search,
    dtw: Dtw,
    arch: Arch,
    frames: Array2<T>,
    pub(super) n: usize,
    pub(super) dims: usize,
    /// Dimension after dimension.
    pub(super) points: Vec<f64>,
    /// For every frame that a candidate can have.
    pub(super) envelope: Envelope,
}

impl<T: Sample> Query<T> {
    /// For candidates of up to `longest` frames; `None` when nothing has a path to the query.
    pub(super) fn new(search: &Search, frames: ArrayView2<'_, T>, longest: usize) -> Option<Self> {
        let (n, dims) = frames.dim();
        let frames = search.normalised(frames);
        let mut points = Vec::new();
        points_of(search.local, frames.view(), &mut points);
        if n == 0 || !are_finite(&points) {
            return None;
        }
        let radius = search.radius.radius();
        let mut envelope = Envelope::default();
        envelope.set(&points, n, longest.min(n.saturating_add(radius)), radius);
        Some(Self {
            search: *search,
            dtw: Dtw::new(search.radius).with_local_cost(search.local),
            arch: Arch::new(),
            frames,
            n,
            dims,
            points,
            envelope,
        })
    }

    pub(super) fn margin(&self, m: usize) -> Margin {
        let size = Size {
            frames: self.n + m,
            dims: self.dims,
        };
        Margin::new::<T>(self.search.local, size)
    }

    /// [`MAX_LAYERS`], or fewer where those of both ends would meet.
    pub(super) fn layers(&self, m: usize) -> usize {
        MAX_LAYERS.min(self.n.min(m) / 2)
    }

    /// The pairs (i, j), counted from either end, through one of which a path to a candidate of `m`
    /// frames enters layer `layer`: those with max(i, j) = layer, as a step raises that by one at
    /// most. Counted from the last frames, i and j may differ by as much more as the lengths do.
    pub(super) fn layer(
        &self,
        layer: usize,
        m: usize,
    ) -> impl Iterator<Item = (usize, usize)> + use<T> {
        let apart = self
            .search
            .radius
            .radius()
            .saturating_add(self.n.abs_diff(m));
        let first = layer.saturating_sub(apart);
        (first..=layer)
            .map(move |i| (i, layer))
            .chain((first..layer).map(move |j| (layer, j)))
    }

    /// A lower bound of the cost, unless there is no path or the bound is above `limit`.
    pub(super) fn bound_within(
        &self,
        frames: ArrayView2<'_, T>,
        limit: f64,
        scratch: &mut Scratch,
    ) -> Option<f64> {
        let m = frames.nrows();
        if m == 0 || self.n.abs_diff(m) > self.search.radius.radius() {
            return None;
        }
        points_of(self.search.local, frames, &mut scratch.points);
        if !are_finite(&scratch.points) {
            return None;
        }
        self.arch.dispatch(Cascade {
            query: self,
            m,
            margin: self.margin(m),
            limit,
            scratch,
        })
    }

    /// Lower bounds of the costs of candidates of `m` frames that differ from them by rounding
    /// alone, or `None` for those above `limit`.
    pub(super) fn costs_but_for_rounding(
        &self,
        m: usize,
        candidates: &[&[f64]],
        limit: f64,
    ) -> Vec<Option<f64>> {
        self.arch.dispatch(Together {
            query: self,
            m,
            margin: self.margin(m),
            candidates,
            limit,
        })
    }

    /// The cost, if there is a path that costs at most `limit`.
    ///
    /// # Errors
    ///
    /// As [`Dtw::distance`].
    pub(super) fn distance_within(
        &self,
        frames: ArrayView2<'_, T>,
        limit: f64,
    ) -> Result<Option<f64>, DtwError> {
        self.dtw.distance_within(self.frames.view(), frames, limit)
    }
}

impl Search {
    /// The frames as they are compared.
    pub(super) fn normalised<T: Sample>(&self, frames: ArrayView2<'_, T>) -> Array2<T> {
        if self.is_z_normalised() {
            z_normalised(frames)
        } else {
            frames.to_owned()
        }
    }
}

/// Samples, or those of the frames' directions, dimension after dimension.
pub(super) fn points_of<T: Sample>(
    local: LocalCost,
    frames: ArrayView2<'_, T>,
    points: &mut Vec<f64>,
) {
    points.clear();
    if local == LocalCost::Cosine {
        let mut directions = frames.to_owned();
        for mut frame in directions.axis_iter_mut(Axis(0)) {
            let length = frame.fold(T::zero(), |sum, &x| sum + x * x).sqrt();
            frame.mapv_inplace(|x| x / length);
        }
        extend(points, directions.view());
    } else {
        extend(points, frames);
    }
}

fn extend<T: Sample>(points: &mut Vec<f64>, frames: ArrayView2<'_, T>) {
    points.reserve(frames.len());
    for dimension in frames.columns() {
        match dimension.as_slice() {
            Some(samples) => points.extend(samples.iter().map(|&x| -> f64 { x.into() })),
            None => points.extend(dimension.iter().map(|&x| -> f64 { x.into() })),
        }
    }
}

fn are_finite(points: &[f64]) -> bool {
    points.iter().all(|x| x.is_finite())
}
