use std::ops::Range;

use ndarray::{ArrayView2, CowArray, Ix2};
use pulp::Simd;

use super::sums::{Absolute, Product, Square, Term, group};
use super::{Costs, finite};
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

/// A sequence or, for cosines, its frames' directions; frame after frame in memory.
struct Sequence<'a, T> {
    frames: CowArray<'a, T, Ix2>,
}

impl<'a, T: Sample> Sequence<'a, T> {
    fn new(local: LocalCost, frames: ArrayView2<'a, T>) -> Self {
        let mut frames = if frames.is_standard_layout() {
            CowArray::from(frames)
        } else {
            CowArray::from(frames.as_standard_layout().into_owned())
        };
        if local == LocalCost::Cosine {
            for mut frame in frames.rows_mut() {
                let length = frame.fold(T::zero(), |sum, &x| sum + x * x).sqrt();
                frame.mapv_inplace(|x| x / length);
            }
        }
        Self { frames }
    }

    fn len(&self) -> usize {
        self.frames.nrows()
    }

    fn n_dims(&self) -> usize {
        self.frames.ncols()
    }

    /// Samples of a frame; none past the end.
    fn frame(&self, nth: usize) -> &[T] {
        let n_dims = self.n_dims();
        let samples = self.frames.as_slice().unwrap_or(&[]);
        samples.get(nth * n_dims..(nth + 1) * n_dims).unwrap_or(&[])
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
        let n_dims = a.n_dims();
        // With few dimensions the differences are as fast.
        let form = if T::IS_FAST && local != LocalCost::Manhattan && n_dims > 3 {
            Form::Expanded
        } else {
            Form::Direct
        };
        let centre = match form {
            Form::Direct => vec![T::zero(); n_dims],
            Form::Expanded => centre(&a, &b),
        };
        let n_groups = b.len().div_ceil(GROUP);
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
        let n_dims = self.b.n_dims();
        for column in 0..self.b.len() {
            let frame = self.b.frame(column);
            let group = &mut self.groups.as_mut_slice()[column / GROUP * GROUP * n_dims..];
            pack(frame, &self.centre, (group, column % GROUP, GROUP));
            if self.form == Form::Expanded {
                self.column_norms[column] = norm_about(&self.centre, frame);
            }
        }
    }
}

/// Writes a frame's samples, less the centre's, to every `stride`th slot from `first` on.
fn pack<T: Sample>(frame: &[T], centre: &[T], (slots, first, stride): (&mut [T], usize, usize)) {
    let slots = slots.chunks_exact_mut(stride);
    for (slots, (&sample, &centre)) in slots.zip(frame.iter().zip(centre)) {
        slots[first] = sample - centre;
    }
}

/// Mean of all frames of both that are finite, in each dimension.
fn centre<T: Sample>(a: &Sequence<'_, T>, b: &Sequence<'_, T>) -> Vec<T> {
    let mut sums = vec![0.0_f64; a.n_dims()];
    let mut n_frames = 0.0_f64;
    let frames = (0..a.len()).map(|nth| a.frame(nth));
    for frame in frames.chain((0..b.len()).map(|nth| b.frame(nth))) {
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

fn norm_about<T: Sample>(centre: &[T], frame: &[T]) -> T {
    frame
        .iter()
        .zip(centre)
        .fold(T::zero(), |sum, (&sample, &centre)| {
            let difference = sample - centre;
            sum + difference * difference
        })
}

impl<T: Sample> Costs<T> for Pair<'_, T> {
    fn enter(&mut self, strip: &Strip) {
        let height = strip.height;
        for (lane, row) in strip.rows.clone().enumerate() {
            let frame = self.a.frame(row);
            pack(
                frame,
                &self.centre,
                (self.rows.as_mut_slice(), lane, height),
            );
            if self.form == Form::Expanded {
                let exact = self.exact_rows.as_mut_slice().chunks_exact_mut(height);
                for (slots, &sample) in exact.zip(frame) {
                    slots[lane] = sample;
                }
                self.row_norms.as_mut_slice()[lane] = norm_about(&self.centre, frame);
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
            (Form::Expanded, LocalCost::Euclidean) => {
                self.expanded(simd, columns.start, tile, |squared| T::roots(simd, squared));
            }
            (Form::Expanded, LocalCost::Cosine) => {
                self.expanded(simd, columns.start, tile, |squared| {
                    half::<T, S>(simd, squared)
                });
            }
            (Form::Expanded, _) => self.expanded(simd, columns.start, tile, |squared| squared),
            (Form::Direct, LocalCost::Manhattan) => {
                self.direct::<S, Absolute>(simd, columns.start, tile, |sum| sum);
            }
            (Form::Direct, LocalCost::Euclidean) => {
                let root = |squared| T::roots(simd, squared);
                self.direct::<S, Square>(simd, columns.start, tile, root);
            }
            (Form::Direct, LocalCost::Cosine) => {
                let half = |squared| half::<T, S>(simd, squared);
                self.direct::<S, Square>(simd, columns.start, tile, half);
            }
            (Form::Direct, LocalCost::SquaredEuclidean) => {
                self.direct::<S, Square>(simd, columns.start, tile, |squared| squared);
            }
        }
    }
}

#[inline(always)]
fn half<T: Sample, S: Simd>(simd: S, sum: T::Vector<S>) -> T::Vector<S> {
    let one = T::one();
    T::muls(simd, T::splat(simd, one / (one + one)), sum)
}

impl<T: Sample> Pair<'_, T> {
    /// Samples of the group of columns from `first_column` on; none past the end.
    #[inline(always)]
    fn group(&self, first_column: usize) -> &[T] {
        let n_samples = GROUP * self.centre.len();
        let start = first_column / GROUP * n_samples;
        let groups = self.groups.as_slice();
        groups.get(start..start + n_samples).unwrap_or(&[])
    }

    #[inline(always)]
    fn direct<S: Simd, A: Term>(
        &self,
        simd: S,
        first_column: usize,
        tile: &mut [T::Vector<S>],
        cost: impl Fn(T::Vector<S>) -> T::Vector<S>,
    ) {
        let rows = T::vectors::<S>(self.rows.as_slice());
        let groups = (first_column..).step_by(GROUP);
        for (first, tile) in groups.zip(tile.chunks_exact_mut(2 * GROUP)) {
            group::<T, S, A>(simd, rows, self.group(first), tile, |sum| {
                finite::<T, S>(simd, cost(sum))
            });
        }
    }

    /// |a|² + |b|² - 2 ab, summed again from the differences where that has cancelled.
    #[inline(always)]
    fn expanded<S: Simd>(
        &self,
        simd: S,
        first_column: usize,
        tile: &mut [T::Vector<S>],
        cost: impl Fn(T::Vector<S>) -> T::Vector<S>,
    ) {
        let two = T::one() + T::one();
        let minus_two = T::splat(simd, -two);
        let share = T::splat(simd, T::from(CANCELLATION).unwrap_or(T::zero()));
        let rows = T::vectors::<S>(self.rows.as_slice());
        let row_norms = T::vectors::<S>(self.row_norms.as_slice());
        let groups = (first_column..).step_by(GROUP);
        for (first, tile) in groups.zip(tile.chunks_exact_mut(2 * GROUP)) {
            group::<T, S, Product>(simd, rows, self.group(first), tile, |product| product);
            let norms = self.column_norms.get(first..).unwrap_or(&[]);
            let costs = tile.chunks_exact_mut(2).zip(norms).zip(first..);
            for ((costs, &norm), column) in costs {
                let norm = T::splat(simd, norm);
                for half in 0..2 {
                    let norms = T::adds(simd, row_norms[half], norm);
                    let squared = T::mul_adds(simd, minus_two, costs[half], norms);
                    let has_cancelled = T::less(simd, squared, T::muls(simd, share, norms));
                    let squared = if T::any(simd, has_cancelled) {
                        let exact = self.squared(simd, half, column);
                        T::select(simd, has_cancelled, exact, squared)
                    } else {
                        squared
                    };
                    costs[half] = finite::<T, S>(simd, cost(squared));
                }
            }
        }
    }

    /// Squared distances of one half of the strip's rows and one column, from the differences.
    #[inline(always)]
    fn squared<S: Simd>(&self, simd: S, half: usize, column: usize) -> T::Vector<S> {
        let mut sum = T::splat(simd, T::zero());
        let rows = T::vectors::<S>(self.exact_rows.as_slice());
        for (a, &b) in rows.chunks_exact(2).zip(self.b.frame(column)) {
            let difference = T::subs(simd, a[half], T::splat(simd, b));
            sum = T::mul_adds(simd, difference, difference, sum);
        }
        sum
    }
}
