//! Local costs by tiles: of a strip's rows and a block of columns.

use std::ops::Range;

use pulp::{Simd, WithSimd};

use crate::Sample;
use crate::lanes::GROUP;
use crate::strip::Strip;

mod called;
mod pair;
mod sums;

pub(crate) use called::Called;
pub(crate) use pair::Pair;

/// Where local costs come from.
pub(crate) trait Costs<T: Sample> {
    /// Called before the tiles of a strip, which are asked for from left to right.
    fn enter(&mut self, strip: &Strip);

    /// Costs of `columns`, which start at a group: two vectors a column, of the strip's upper and
    /// lower rows, each finite or infinite. Costs of cells outside the band may be anything, as may
    /// columns past the end.
    fn fill<S: Simd>(
        &mut self,
        simd: S,
        strip: &Strip,
        columns: Range<usize>,
        tile: &mut [T::Vector<S>],
    );
}

/// Fills a tile and closes what is outside the band.
pub(crate) struct Fill<'a, T, C> {
    pub(crate) costs: &'a mut C,
    pub(crate) strip: &'a Strip,
    pub(crate) columns: Range<usize>,
    pub(crate) tile: &'a mut [T],
}

impl<T: Sample, C: Costs<T>> WithSimd for Fill<'_, T, C> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let n_vectors = 2 * self.columns.len().next_multiple_of(GROUP);
        let tile = &mut T::vectors_mut::<S>(self.tile)[..n_vectors];
        self.costs
            .fill(simd, self.strip, self.columns.clone(), tile);
        close::<T, S>(simd, self.strip, self.columns, tile);
    }
}

/// The cost, or infinite where it is no finite number.
#[inline(always)]
fn finite<T: Sample, S: Simd>(simd: S, cost: T::Vector<S>) -> T::Vector<S> {
    let infinite = T::splat(simd, T::INFINITE);
    let is_finite = T::less(simd, T::magnitudes(simd, cost), infinite);
    T::select(simd, is_finite, cost, infinite)
}

/// Makes the cells outside the band infinite.
#[inline(always)]
fn close<T: Sample, S: Simd>(
    simd: S,
    strip: &Strip,
    columns: Range<usize>,
    tile: &mut [T::Vector<S>],
) {
    if strip.is_inside(&columns) {
        return;
    }
    let infinite = T::splat(simd, T::INFINITE);
    // Bounds relative to the block are small integers, which every sample type holds exactly.
    let n_columns = columns.len();
    let bounds = |bound: fn(&Range<usize>) -> usize| {
        let mut vectors = [infinite; 2];
        let lanes = pulp::bytemuck::cast_slice_mut::<_, T>(&mut vectors);
        for (lane, band) in lanes.iter_mut().zip(&strip.bands) {
            *lane = small(bound(band).saturating_sub(columns.start).min(n_columns));
        }
        vectors
    };
    let starts = bounds(|band| band.start);
    let ends = bounds(|band| band.end);
    for (column, costs) in tile.chunks_exact_mut(2).enumerate() {
        let column = T::splat(simd, small(column));
        for (half, cost) in costs.iter_mut().enumerate() {
            let inside = T::select(simd, T::less(simd, column, ends[half]), *cost, infinite);
            let before = T::less(simd, column, starts[half]);
            *cost = T::select(simd, before, infinite, inside);
        }
    }
}

/// A number of columns within a block.
#[inline(always)]
fn small<T: Sample>(columns: usize) -> T {
    T::from(columns).unwrap_or(T::INFINITE)
}
