//! One pass of EM over a chunk of frames: the E step and the sums of the M step.
//!
//! With y = (x, |x|², 1) the logarithm of w p(x|a) is the product of y with the coefficients
//! (2hµ, -h, ln w - (dims/2) ln 2πσ² - h|µ|²), where h = 1/2σ². So the E step is a matrix product,
//! and the sums over frames of responsibility times y, another one, give weights, means and
//! variances. Frames stand in the lanes of vectors. Where a responsibility is nothing beside the
//! frame's largest one, neither its exponential is taken nor its products are summed; as poses
//! belong to few clusters, that leaves little beyond the first product.

use std::ops::Range;

use pulp::bytemuck::{cast_slice, cast_slice_mut};
use pulp::{Simd, WithSimd};

use super::aligned::Aligned;
use super::exp::{LEAST, exp, mul_add};
use super::packed::{BLOCK, Packed};
use super::state::State;

/// Clusters whose exponents are summed at once.
const GROUP: usize = 4;

/// Vectors of frames whose exponents are summed at once.
const PAIR: usize = 2;

/// The largest exponent of a frame that is counted: differences of larger ones are finite.
const IMPOSSIBLE: f64 = f64::MIN / 4.0;

/// For each group of clusters the constants, then the coefficients of each dimension and of |x|².
#[derive(Debug)]
pub(super) struct Coefficients {
    numbers: Aligned,
    dims: usize,
}

impl Coefficients {
    pub(super) fn new(state: &State) -> Self {
        let dims = state.dims();
        let n_groups = state.n_letters().div_ceil(GROUP);
        let size = (dims + 2) * GROUP;
        let mut numbers = Aligned::filled(n_groups * size, 0.0);
        for (i, group) in numbers.chunks_exact_mut(size).enumerate() {
            // Clusters that only fill the last group are impossible.
            group[..GROUP].fill(f64::NEG_INFINITY);
            for (k, letter) in (i * GROUP..state.n_letters()).take(GROUP).enumerate() {
                let half = 0.5 / state.variances[letter];
                let mean = state.mean(letter);
                let square: f64 = mean.iter().map(|x| x * x).sum();
                let constant = state.log_scale(letter) - half * square;
                // A mean so far off that its numbers overflow takes no part.
                if !constant.is_finite() {
                    continue;
                }
                group[k] = constant;
                for (dim, x) in mean.iter().enumerate() {
                    group[(dim + 1) * GROUP + k] = 2.0 * half * x;
                }
                group[(dims + 1) * GROUP + k] = -half;
            }
        }
        Self { numbers, dims }
    }

    fn groups(&self) -> impl Iterator<Item = (&[f64; GROUP], &[[f64; GROUP]])> {
        let size = self.dims + 2;
        let (rows, _) = self.numbers.as_chunks::<GROUP>();
        rows.chunks_exact(size)
            .filter_map(|group| group.split_first())
    }

    /// Clusters, those that fill the last group included.
    fn n_padded(&self) -> usize {
        self.numbers.len() / (self.dims + 2)
    }
}

/// What a chunk of frames adds.
#[derive(Debug)]
pub(super) struct Partial {
    /// For each cluster the sum of responsibility times row.
    pub(super) sums: Aligned,
    /// ln p(x) of each frame.
    pub(super) log_densities: Vec<f64>,
}

/// The pass over a chunk.
pub(super) struct Pass<'a> {
    pub(super) packed: &'a Packed,
    pub(super) coefficients: &'a Coefficients,
    pub(super) chunk: &'a Range<usize>,
}

/// Working memory of a block.
struct Scratch {
    /// For each cluster the exponents of the block's frames.
    exponents: Aligned,
    /// Vectors of exponentials that are not nothing, as they come.
    likely: Aligned,
    /// Cluster and vector of each.
    places: Vec<(usize, usize)>,
    maxima: [f64; BLOCK],
    totals: [f64; BLOCK],
}

impl WithSimd for Pass<'_> {
    type Output = Partial;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Partial {
        let Packed { dims, width, .. } = *self.packed;
        let n_padded = self.coefficients.n_padded();
        let mut scratch = Scratch {
            exponents: Aligned::filled(n_padded * BLOCK, 0.0),
            likely: Aligned::filled(n_padded * BLOCK, 0.0),
            places: Vec::with_capacity(n_padded * BLOCK / S::F64_LANES),
            maxima: [0.0; BLOCK],
            totals: [0.0; BLOCK],
        };
        let mut sums = Aligned::filled(n_padded * width, 0.0);
        let mut log_densities = Vec::with_capacity(self.chunk.len().next_multiple_of(BLOCK));
        let tiles = self
            .packed
            .tiles(self.chunk)
            .chunks_exact((dims + 1) * BLOCK);
        let rows = self.packed.rows(self.chunk).chunks_exact(width * BLOCK);
        for (tile, rows) in tiles.zip(rows) {
            exponents(simd, tile, self.coefficients, &mut scratch);
            exponentials(simd, &mut scratch);
            let both = scratch.maxima.iter().zip(&scratch.totals);
            log_densities.extend(both.map(|(max, total)| max + total.ln()));
            add(simd, rows, width, &mut scratch, &mut sums);
        }
        log_densities.truncate(self.chunk.len());
        Partial {
            sums,
            log_densities,
        }
    }
}

/// ln w p(x|a) of every cluster and frame, and the largest of each frame.
#[inline(always)]
fn exponents<S: Simd>(simd: S, tile: &[f64], coefficients: &Coefficients, scratch: &mut Scratch) {
    let lanes = S::F64_LANES;
    let (tile, _) = tile.as_chunks::<BLOCK>();
    let maxima = cast_slice_mut::<_, S::f64s>(&mut scratch.maxima);
    for (pair, maxima) in maxima.chunks_exact_mut(PAIR).enumerate() {
        let first = pair * PAIR * lanes;
        let mut largest = [simd.splat_f64s(IMPOSSIBLE); PAIR];
        let outputs = scratch.exponents.chunks_exact_mut(GROUP * BLOCK);
        for ((constants, factors), outputs) in coefficients.groups().zip(outputs) {
            let mut sums = constants.map(|constant| [simd.splat_f64s(constant); PAIR]);
            for (factors, numbers) in factors.iter().zip(tile) {
                let numbers = cast_slice::<_, S::f64s>(&numbers[first..first + PAIR * lanes]);
                for (sums, &factor) in sums.iter_mut().zip(factors) {
                    let factor = simd.splat_f64s(factor);
                    for (sum, &x) in sums.iter_mut().zip(numbers) {
                        *sum = mul_add(simd, factor, x, *sum);
                    }
                }
            }
            for (sums, outputs) in sums.iter().zip(outputs.chunks_exact_mut(BLOCK)) {
                let outputs = &mut outputs[first..first + PAIR * lanes];
                cast_slice_mut::<_, S::f64s>(outputs).copy_from_slice(sums);
                for (largest, &sum) in largest.iter_mut().zip(sums) {
                    *largest = simd.max_f64s(*largest, sum);
                }
            }
        }
        maxima.copy_from_slice(&largest);
    }
}

/// Exponentials of exponents less the largest, where they are not nothing, and their totals.
#[inline(always)]
fn exponentials<S: Simd>(simd: S, scratch: &mut Scratch) {
    let n_vectors = BLOCK / S::F64_LANES;
    let least = simd.splat_f64s(LEAST);
    let zero = simd.splat_f64s(0.0);
    let maxima = cast_slice::<_, S::f64s>(&scratch.maxima);
    let likely = cast_slice_mut::<_, S::f64s>(&mut scratch.likely);
    scratch.totals = [0.0; BLOCK];
    let totals = cast_slice_mut::<_, S::f64s>(&mut scratch.totals);
    scratch.places.clear();
    let exponents = cast_slice::<_, S::f64s>(&scratch.exponents);
    for (letter, exponents) in exponents.chunks_exact(n_vectors).enumerate() {
        for (i, ((&exponent, &max), total)) in
            exponents.iter().zip(maxima).zip(&mut *totals).enumerate()
        {
            let exponent = simd.sub_f64s(exponent, max);
            let is_likely = simd.less_than_f64s(least, exponent);
            if simd.first_true_m64s(is_likely) == S::F64_LANES {
                continue;
            }
            let exponential = exp(simd, simd.max_f64s(exponent, least));
            let exponential = simd.select_f64s(is_likely, exponential, zero);
            *total = simd.add_f64s(*total, exponential);
            likely[scratch.places.len()] = exponential;
            scratch.places.push((letter, i));
        }
    }
}

/// Adds responsibility times row of the likely ones.
#[inline(always)]
fn add<S: Simd>(simd: S, rows: &[f64], width: usize, scratch: &mut Scratch, sums: &mut [f64]) {
    let lanes = S::F64_LANES;
    let totals = cast_slice::<_, S::f64s>(&scratch.totals);
    let rows = cast_slice::<_, S::f64s>(rows);
    let sums = cast_slice_mut::<_, S::f64s>(sums);
    let width = width / lanes;
    let likely = cast_slice::<_, S::f64s>(&scratch.likely);
    for (&(letter, i), &exponential) in scratch.places.iter().zip(likely) {
        let responsibility = simd.div_f64s(exponential, totals[i]);
        let shares = cast_slice::<_, f64>(std::slice::from_ref(&responsibility));
        let rows = &rows[i * lanes * width..][..lanes * width];
        for (place, sum) in sums[letter * width..][..width].iter_mut().enumerate() {
            let mut total = *sum;
            for (row, &share) in rows.chunks_exact(width).zip(shares) {
                total = mul_add(simd, simd.splat_f64s(share), row[place], total);
            }
            *sum = total;
        }
    }
}

#[cfg(test)]
mod tests {
    use ndarray::{Array1, Array2};
    use pulp::Scalar;

    use super::*;
    use crate::PoseClusters;

    /// Of sums of numbers up to 10: fused operations round once where others round twice.
    const TOL: f64 = 1e-10;

    /// Two blocks and a part of one, clusters that do not fill a group, and rows of two vectors.
    #[test]
    fn every_width_of_vector_sums_the_same() {
        let (n_frames, dims, n_letters) = (37, 9, 6);
        let frames = Array2::from_shape_fn((n_frames, dims), |(i, j)| {
            10.0 * ((7 * i + 3 * j * j) as f64).sin()
        });
        let means = frames.slice(ndarray::s![..n_letters, ..]).to_owned();
        let sigmas = Array1::linspace(0.5, 9.0, n_letters);
        let clusters = PoseClusters::new(means.view(), sigmas.view()).unwrap();
        let packed = Packed::new(frames.view()).unwrap();
        let coefficients = Coefficients::new(&State::of_clusters(&clusters, &packed));
        let chunk = &(0..n_frames);
        let pass = || Pass {
            packed: &packed,
            coefficients: &coefficients,
            chunk,
        };
        let expected = pass().with_simd(Scalar::new());
        assert_eq!(expected.log_densities.len(), n_frames);
        let amounts = expected
            .sums
            .chunks_exact(packed.width)
            .map(|row| row[dims + 1]);
        assert!((amounts.sum::<f64>() - n_frames as f64).abs() < TOL);
        for arch in kinds() {
            let found = arch.dispatch(pass());
            let sums = found.sums.iter().chain(&found.log_densities);
            for (found, expected) in sums.zip(expected.sums.iter().chain(&expected.log_densities)) {
                assert!(
                    (found - expected).abs() <= TOL * (1.0 + expected.abs()),
                    "{arch:?}"
                );
            }
        }
    }

    /// What the processor can do, each width of vector.
    fn kinds() -> Vec<pulp::Arch> {
        let mut kinds = vec![pulp::Arch::new()];
        #[cfg(target_arch = "x86_64")]
        {
            kinds.extend(pulp::x86::V3::try_new().map(pulp::Arch::V3));
            kinds.extend(pulp::x86::V4::try_new().map(pulp::Arch::V4));
        }
        kinds
    }
}
