use std::ops::Range;

use pulp::Simd;

use super::Costs;
use crate::Sample;
use crate::strip::Strip;

/// Costs that a function states for each cell of the band.
pub(crate) struct Called<F>(pub(crate) F);

impl<T: Sample, F: Fn(usize, usize) -> T> Costs<T> for Called<F> {
    fn enter(&mut self, _: &Strip) {}

    #[inline(always)]
    fn fill<S: Simd>(
        &mut self,
        _: S,
        strip: &Strip,
        columns: Range<usize>,
        tile: &mut [T::Vector<S>],
    ) {
        let tile = pulp::bytemuck::cast_slice_mut::<_, T>(tile);
        let of_columns = tile.chunks_exact_mut(strip.height);
        for (column, costs) in columns.zip(of_columns) {
            for ((row, band), cost) in strip.rows.clone().zip(&strip.bands).zip(costs) {
                if band.contains(&column) {
                    let called = (self.0)(row, column);
                    *cost = if called.is_finite() {
                        called
                    } else {
                        T::infinity()
                    };
                }
            }
        }
    }
}
