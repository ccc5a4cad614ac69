//! Sums over dimensions for two vectors of rows and a few columns at once.

use pulp::Simd;

use crate::lanes::{GROUP, Real};

/// What is summed for a sample of a row and one of a column.
pub(super) trait Term {
    fn add<T: Real, S: Simd>(
        simd: S,
        a: T::Vector<S>,
        b: T::Vector<S>,
        sum: T::Vector<S>,
    ) -> T::Vector<S>;
}

/// a b
pub(super) struct Product;
/// (a - b)²
pub(super) struct Square;
/// |a - b|
pub(super) struct Absolute;

impl Term for Product {
    #[inline(always)]
    fn add<T: Real, S: Simd>(
        simd: S,
        a: T::Vector<S>,
        b: T::Vector<S>,
        sum: T::Vector<S>,
    ) -> T::Vector<S> {
        T::mul_adds(simd, a, b, sum)
    }
}

impl Term for Square {
    #[inline(always)]
    fn add<T: Real, S: Simd>(
        simd: S,
        a: T::Vector<S>,
        b: T::Vector<S>,
        sum: T::Vector<S>,
    ) -> T::Vector<S> {
        let difference = T::subs(simd, a, b);
        T::mul_adds(simd, difference, difference, sum)
    }
}

impl Term for Absolute {
    #[inline(always)]
    fn add<T: Real, S: Simd>(
        simd: S,
        a: T::Vector<S>,
        b: T::Vector<S>,
        sum: T::Vector<S>,
    ) -> T::Vector<S> {
        T::adds(simd, sum, T::magnitudes(simd, T::subs(simd, a, b)))
    }
}

/// Costs of a group of columns into their tile: `rows` holds two vectors for each dimension,
/// `columns` [`GROUP`] samples for each dimension; `cost` makes a cost of a sum.
///
/// Each sum is made in order of dimensions, so it does not depend on how many are made at once:
/// twice [`GROUP`] accumulators hide the latency of an addition where they fit into registers.
#[inline(always)]
pub(super) fn group<T: Real, S: Simd, A: Term>(
    simd: S,
    rows: &[T::Vector<S>],
    columns: &[T],
    tile: &mut [T::Vector<S>],
    cost: impl Fn(T::Vector<S>) -> T::Vector<S>,
) {
    if S::REGISTER_COUNT >= 32 {
        some_columns::<T, S, A, GROUP>(simd, rows, columns, tile, &cost);
    } else {
        let (left, right) = tile.split_at_mut(GROUP);
        some_columns::<T, S, A, 4>(simd, rows, columns, left, &cost);
        let columns = columns.get(4..).unwrap_or(&[]);
        some_columns::<T, S, A, 4>(simd, rows, columns, right, &cost);
    }
}

/// The same for the first `W` columns of a group.
#[inline(always)]
fn some_columns<T: Real, S: Simd, A: Term, const W: usize>(
    simd: S,
    rows: &[T::Vector<S>],
    columns: &[T],
    tile: &mut [T::Vector<S>],
    cost: impl Fn(T::Vector<S>) -> T::Vector<S>,
) {
    let zero = T::splat(simd, T::ZERO);
    let (mut upper, mut lower) = ([zero; W], [zero; W]);
    for (a, b) in rows.chunks_exact(2).zip(columns.chunks(GROUP)) {
        let Some(b) = b.first_chunk::<W>() else { break };
        for column in 0..W {
            let b = T::splat(simd, b[column]);
            upper[column] = A::add::<T, S>(simd, a[0], b, upper[column]);
            lower[column] = A::add::<T, S>(simd, a[1], b, lower[column]);
        }
    }
    for column in 0..W {
        tile[2 * column] = cost(upper[column]);
        tile[2 * column + 1] = cost(lower[column]);
    }
}
