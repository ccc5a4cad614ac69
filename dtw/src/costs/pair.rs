use std::ops::Range;

use ndarray::{Array2, ArrayView2, Axis};
use pulp::Simd;

use super::Costs;
use super::sums::{Absolute, Product, Square, group};
use crate::aligned::Aligned;
use crate::lanes::GROUP;
use crate::strip::Strip;
use crate::{DtwError, LocalCost, Sample};

/// Below this share of |a|² + |b|², the squared distance |a|² + |b|² - 2 ab has lost so many digits
/// that it is summed again from the differences. Above it, its relative error is at most
/// (dims + 4) 2⁻²⁴ / share.
const CANCELLATION: f64 = 1.0 / 16.0;

/// Local costs of two sequences without gaps.
pub(crate) struct Pair<'a, T: Sample> {
    form: Form,
    local: LocalCost,
    a: Sequence<'a, T>,
    b: Sequence<'a, T>,
    /// Groups of columns of b, minus the centre: [`GROUP`] samples for each dimension.
    groups: Aligned<T>,
    /// The strip's rows, minus the centre: for each dimension a sample of each row.
    rows: Aligned<T>,
    /// The strip's rows as they are, for [`Form::Expanded`].
    exact_rows: Aligned<T>,
    row_norms: Aligned<T>,
    column_norms: Vec<T>,
    centre: Vec<T>,
}

/// How the sums over dimensions are made.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Form {
    /// From differences.
    Direct,
    /// From norms and one product, both about the sequences' common mean.
    Expanded,
}

/// A sequence, or its frames' directions.
enum Sequence<'a, T> {
    Given(ArrayView2<'a, T>),
    Directions(Array2<T>),
}

impl<'a, T: Sample> Sequence<'a, T> {
    fn new(local: LocalCost, frames: ArrayView2<'a, T>) -> Self {
        if local != LocalCost::Cosine {
            return Self::Given(frames);
        }
        let mut directions = frames.to_owned();
        for mut frame in directions.axis_iter_mut(Axis(0)) {
            let length = frame.fold(T::zero(), |sum, &x| sum + x * x).sqrt();
            frame.mapv_inplace(|x| x / length);
        }
        Self::Directions(directions)
    }

    fn view(&self) -> ArrayView2<'_, T> {
        match self {
            Self::Given(frames) => frames.view(),
            Self::Directions(frames) => frames.view(),
        }
    }
}

impl<'a, T: Sample> Pair<'a, T> {
    /// Costs of sequences of equal dimension for strips of `height` rows.
    ///
    /// # Errors
    ///
    /// [`DtwError::TooLarge`] when there is no memory for a copy of `b`.
    pub(crate) fn new(
        local: LocalCost,
        (a, b): (ArrayView2<'a, T>, ArrayView2<'a, T>),
        height: usize,
    ) -> Result<Self, DtwError> {
        let (a, b) = (Sequence::new(local, a), Sequence::new(local, b));
        let n_dims = a.view().ncols();
        // With few dimensions the differences are as fast.
        let form = if T::IS_FAST && local != LocalCost::Manhattan && n_dims > 3 {
            Form::Expanded
        } else {
            Form::Direct
        };
        let centre = match form {
            Form::Direct => vec![T::zero(); n_dims],
            Form::Expanded => centre(a.view(), b.view()),
        };
        let n_groups = b.view().nrows().div_ceil(GROUP);
        let mut pair = Self {
            form,
            local,
            groups: Aligned::filled(n_groups * GROUP * n_dims, T::zero())?,
            rows: Aligned::filled(height * n_dims, T::zero())?,
            exact_rows: Aligned::filled(height * n_dims, T::zero())?,
            row_norms: Aligned::filled(height, T::zero())?,
            column_norms: vec![T::zero(); n_groups * GROUP],
            centre,
            a,
            b,
        };
        pair.pack_columns();
        Ok(pair)
    }

    fn pack_columns(&mut self) {
        let frames = self.b.view();
        let n_dims = frames.ncols();
        if n_dims == 0 {
            return;
        }
        let groups = self.groups.as_mut_slice().chunks_exact_mut(GROUP * n_dims);
        for (group, frames) in groups.zip(frames.axis_chunks_iter(Axis(0), GROUP)) {
            for (column, frame) in frames.rows().into_iter().enumerate() {
                let samples = frame.iter().zip(&self.centre);
                for (slots, (&sample, &centre)) in group.chunks_exact_mut(GROUP).zip(samples) {
                    slots[column] = sample - centre;
                }
            }
        }
        if self.form == Form::Expanded {
            for (norm, frame) in self.column_norms.iter_mut().zip(frames.rows()) {
                *norm = norm_about(&self.centre, frame.iter());
            }
        }
    }
}

/// Mean of all frames of both without a NaN, in each dimension.
fn centre<T: Sample>(a: ArrayView2<'_, T>, b: ArrayView2<'_, T>) -> Vec<T> {
    let mut sums = vec![0.0_f64; a.ncols()];
    let mut n_frames = 0.0_f64;
    for frame in a.rows().into_iter().chain(b.rows()) {
        if frame.iter().all(|sample| sample.is_finite()) {
            n_frames += 1.0;
            for (sum, &sample) in sums.iter_mut().zip(frame) {
                *sum += sample.into();
            }
        }
    }
    let mean = |sum: f64| T::from(sum / n_frames.max(1.0)).unwrap_or(T::zero());
    sums.into_iter().map(mean).collect()
}

fn norm_about<'s, T: Sample>(centre: &[T], frame: impl Iterator<Item = &'s T>) -> T {
    frame
        .zip(centre)
        .fold(T::zero(), |sum, (&sample, &centre)| {
            let difference = sample - centre;
            sum + difference * difference
        })
}

impl<T: Sample> Costs<T> for Pair<'_, T> {
    fn enter(&mut self, strip: &Strip) {
        let frames = self.a.view();
        let n_dims = frames.ncols();
        let height = strip.height;
        for (lane, row) in strip.rows.clone().enumerate() {
            let frame = frames.row(row);
            if self.form == Form::Expanded {
                self.row_norms.as_mut_slice()[lane] = norm_about(&self.centre, frame.iter());
                let exact = self.exact_rows.as_mut_slice().iter_mut().skip(lane);
                for (slot, &sample) in exact.step_by(height).zip(frame) {
                    *slot = sample;
                }
            }
            let slots = self
                .rows
                .as_mut_slice()
                .iter_mut()
                .skip(lane)
                .step_by(height);
            for (slot, (&sample, &centre)) in slots.take(n_dims).zip(frame.iter().zip(&self.centre))
            {
                *slot = sample - centre;
            }
        }
    }

    #[inline(always)]
    fn fill<S: Simd>(
        &mut self,
        simd: S,
        _: &Strip,
        columns: Range<usize>,
        tile: &mut [T::Vector<S>],
    ) {
        match (self.form, self.local) {
            (Form::Expanded, _) => self.expanded(simd, columns.start, tile),
            (Form::Direct, LocalCost::Manhattan) => {
                self.each_group(columns.start, tile, |rows, columns, tile| {
                    group::<T, S, Absolute>(simd, rows, columns, tile);
                });
            }
            (Form::Direct, _) => {
                self.each_group(columns.start, tile, |rows, columns, tile| {
                    group::<T, S, Square>(simd, rows, columns, tile);
                });
            }
        }
        match self.local {
            LocalCost::Euclidean => {
                for cost in tile {
                    *cost = T::roots(simd, *cost);
                }
            }
            LocalCost::Cosine => {
                let one = T::one();
                let half = T::splat(simd, one / (one + one));
                for cost in tile {
                    *cost = T::muls(simd, half, *cost);
                }
            }
            LocalCost::SquaredEuclidean | LocalCost::Manhattan => {}
        }
    }
}

impl<T: Sample> Pair<'_, T> {
    #[inline(always)]
    fn each_group<S: Simd>(
        &self,
        first_column: usize,
        tile: &mut [T::Vector<S>],
        fill: impl Fn(&[T::Vector<S>], &[T], &mut [T::Vector<S>]),
    ) {
        let n_samples = GROUP * self.centre.len();
        let rows = T::vectors::<S>(self.rows.as_slice());
        let groups = self.groups.as_slice();
        for (nth, tile) in tile.chunks_exact_mut(2 * GROUP).enumerate() {
            let start = (first_column / GROUP + nth) * n_samples;
            let columns = groups.get(start..start + n_samples).unwrap_or(&[]);
            fill(rows, columns, tile);
        }
    }

    /// |a|² + |b|² - 2 ab, summed again from the differences where that has cancelled.
    #[inline(always)]
    fn expanded<S: Simd>(&self, simd: S, first_column: usize, tile: &mut [T::Vector<S>]) {
        self.each_group(first_column, tile, |rows, columns, tile| {
            group::<T, S, Product>(simd, rows, columns, tile);
        });
        let two = T::one() + T::one();
        let minus_two = T::splat(simd, -two);
        let share = T::splat(simd, T::from(CANCELLATION).unwrap_or(T::zero()));
        let row_norms = T::vectors::<S>(self.row_norms.as_slice());
        let column_norms = self.column_norms.get(first_column..).unwrap_or(&[]);
        let costs = tile.chunks_exact_mut(2).zip(column_norms).enumerate();
        for (nth, (costs, &column_norm)) in costs {
            let column_norm = T::splat(simd, column_norm);
            for half in 0..2 {
                let norms = T::adds(simd, row_norms[half], column_norm);
                let squared = T::mul_adds(simd, minus_two, costs[half], norms);
                let has_cancelled = T::less(simd, squared, T::muls(simd, share, norms));
                costs[half] = if T::any(simd, has_cancelled) {
                    let exact = self.squared(simd, half, first_column + nth);
                    T::select(simd, has_cancelled, exact, squared)
                } else {
                    squared
                };
            }
        }
    }

    /// Squared distances of one half of the strip's rows and one column, from the differences.
    #[inline(always)]
    fn squared<S: Simd>(&self, simd: S, half: usize, column: usize) -> T::Vector<S> {
        let mut sum = T::splat(simd, T::zero());
        let frames = self.b.view();
        if column >= frames.nrows() {
            return sum;
        }
        let rows = T::vectors::<S>(self.exact_rows.as_slice());
        for (a, &b) in rows.chunks_exact(2).zip(frames.row(column)) {
            let difference = T::subs(simd, a[half], T::splat(simd, b));
            sum = T::mul_adds(simd, difference, difference, sum);
        }
        sum
    }
}
