//! Windows that start side by side, made ready to be compared in the lanes of vectors.

use std::ops::Range;

use ndarray::ArrayView2;
use pulp::{Arch, Simd, WithSimd};

use super::Search;
use super::margin::{Margin, Norm};
use super::query::points_of;
use crate::{LocalCost, Sample};

/// Windows are compared in groups that divide this.
pub(super) const GROUP: usize = 64;

/// Windows of a block; more for longer queries, so that the samples shared with the next block do
/// not come to more than its own.
pub(super) fn block_len(n: usize) -> usize {
    n.next_multiple_of(GROUP).max(1024)
}

/// Rounding to nearest.
const UNIT: f64 = f64::EPSILON / 2.0;

/// Windows `starts` of a series. Point j of the w-th in dimension d is
/// `samples[d][w + j] * factors[d][w] - shifts[d][w]`, up to an error.
#[derive(Debug, Default)]
pub(super) struct Block {
    pub(super) starts: Range<usize>,
    /// Entries of a dimension in `factors` and `shifts`.
    pub(super) width: usize,
    /// Entries of a dimension in `samples`.
    pub(super) stride: usize,
    pub(super) samples: Vec<f64>,
    pub(super) factors: Vec<f64>,
    pub(super) shifts: Vec<f64>,
    /// For each window, the error that [`Margin::lower_bound`] takes.
    pub(super) errors: Vec<f64>,
    /// Windows that hold a frame without a number.
    is_closed: Vec<bool>,
}

/// Memory that loading a block needs.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    raw: Vec<f64>,
    uncertain: Vec<f64>,
    sums: Sums,
}

/// Sums over windows.
#[derive(Debug, Default)]
struct Sums {
    plain: Vec<f64>,
    squares: Vec<f64>,
    level: Vec<f64>,
    next: Vec<f64>,
}

impl Block {
    /// Windows of `frames`, the first of which starts at `start` in its series.
    pub(super) fn load<T: Sample>(
        search: &Search,
        (frames, start): (ArrayView2<'_, T>, usize),
        (n, margin): (usize, &Margin),
        scratch: &mut Scratch,
    ) -> Self {
        let (n_frames, dims) = frames.dim();
        let n_windows = n_frames + 1 - n;
        let width = n_windows.next_multiple_of(GROUP);
        let mut block = Self {
            starts: start..start + n_windows,
            width,
            stride: width + n - 1,
            ..Self::default()
        };
        let has_directions = search.local == LocalCost::Cosine;
        let local = if search.is_z_normalised() {
            // Directions are those of normalised frames, which differ from window to window.
            LocalCost::SquaredEuclidean
        } else {
            search.local
        };
        points_of(local, frames, &mut scratch.raw);
        block.close(n, (&scratch.raw, n_frames));
        if search.is_z_normalised() && !has_directions {
            let (epsilon, least) = (T::epsilon().into(), T::min_positive_value().into());
            Arch::new().dispatch(Normalise {
                block: &mut block,
                scratch,
                frames: (n, n_frames),
                margin,
                precision: (epsilon, least),
            });
            return block;
        }
        for points in scratch.raw.chunks_exact(n_frames) {
            let padding = block.stride - n_frames;
            block.samples.extend_from_slice(points);
            block.samples.resize(block.samples.len() + padding, 0.0);
        }
        block.factors.resize(dims * width, 1.0);
        block.shifts.resize(dims * width, 0.0);
        let error = if search.is_z_normalised() {
            f64::INFINITY
        } else {
            margin.directions
        };
        block.errors.resize(width, error);
        block
    }

    pub(super) fn is_closed(&self, window: usize) -> bool {
        self.is_closed.get(window).copied().unwrap_or(false)
    }

    /// Makes the bounds of closed windows infinite.
    pub(super) fn close_bounds(&self, bounds: &mut [f64]) {
        for (bound, &is_closed) in bounds.iter_mut().zip(&self.is_closed) {
            if is_closed {
                *bound = f64::INFINITY;
            }
        }
    }

    fn close(&mut self, n: usize, (raw, n_frames): (&[f64], usize)) {
        // Without a branch, so that it is done for several at a time.
        if raw.iter().fold(true, |all, x| all & x.is_finite()) {
            return;
        }
        self.is_closed.resize(self.starts.len(), false);
        for points in raw.chunks_exact(n_frames) {
            let closed = points.iter().enumerate().filter(|(_, x)| !x.is_finite());
            // A window is closed once by each of its frames; few frames are not numbers.
            let mut done = 0;
            for (frame, _) in closed {
                let first = done.max((frame + 1).saturating_sub(n));
                let end = (frame + 1).min(self.starts.len());
                for window in first..end {
                    self.is_closed[window] = true;
                }
                done = end;
            }
        }
    }

    /// Means and deviations of all windows from sums over 1, 2, 4, … samples about one of them.
    ///
    /// These are not those of the definition, whose sums are made in order, but near them. With
    /// unit roundoff u, sums of depth h, a mean c + μ, mean square q and variance v about c:
    ///
    /// - the definition's mean is off by up to Δ = (n + 2) u (|c| + √q), this one by (h + 2) u √q;
    /// - the two variances differ by at most E = (4h + n + 20) u q + 2 Δ², and so the deviations by
    ///   a share ρ = E / (v - E) at most;
    /// - a normalised sample is at most √n; its scaling here rounds samples of up to √(n v) + √q,
    ///   its conversion to T by ε.
    ///
    /// So it is off by √n (ρ + ε) + (Δ + (h + 2) u √q + 4 u (√(n v) + 2 √q)) / √v, of which twice
    /// is taken. Where ρ is above a quarter nothing is said of the window.
    #[inline(always)]
    fn normalise(
        &mut self,
        scratch: &mut Scratch,
        (n, n_frames): (usize, usize),
        margin: &Margin,
        (epsilon, least): (f64, f64),
    ) {
        let Scratch {
            raw,
            uncertain: of_samples,
            sums,
        } = scratch;
        let count = n as f64;
        let share_of_one = 1.0 / count;
        let depth = 2.0 * f64::from(n.ilog2() + 1);
        let root = count.sqrt();
        self.errors.resize(self.width, 0.0);
        for points in raw.chunks_exact(n_frames) {
            let centre = points
                .iter()
                .copied()
                .find(|x| x.is_finite())
                .unwrap_or(0.0);
            let first = self.samples.len();
            self.samples.extend(points.iter().map(|x| x - centre));
            self.samples.resize(first + self.stride, 0.0);
            sums.set(&self.samples[first..], n, self.width);
            of_samples.clear();
            of_samples.resize(self.width, 0.0);
            let first = self.factors.len();
            self.factors.resize(first + self.width, 0.0);
            self.shifts.resize(first + self.width, 0.0);
            let results = self.factors[first..]
                .iter_mut()
                .zip(&mut self.shifts[first..]);
            let results = results.zip(&mut *of_samples);
            let sums = sums.plain.iter().zip(&sums.squares);
            for (((factor, shift), of_sample), (&sum, &squares)) in results.zip(sums) {
                let (mean, square) = (sum * share_of_one, squares * share_of_one);
                let length = square.sqrt();
                let variance = square - mean * mean;
                let delta = (count + 2.0) * UNIT * (centre.abs() + length);
                let uncertain = (4.0 * depth + count + 20.0) * UNIT * square + 2.0 * delta * delta;
                let certain = variance - uncertain;
                let share = uncertain / certain;
                let deviation = variance.sqrt();
                let inverse = 1.0 / deviation;
                let scaling = 4.0 * (root * deviation + 2.0 * length) + (depth + 2.0) * length;
                let error = root * (share + epsilon) + (delta + UNIT * scaling) * inverse;
                let is_known = (certain > LEAST_VARIANCE) & (share <= 0.25) & (error < 1.0);
                *factor = if is_known { inverse } else { 0.0 };
                *shift = if is_known { mean * inverse } else { 0.0 };
                *of_sample = if is_known {
                    2.0 * error + least
                } else {
                    f64::INFINITY
                };
            }
            clear_constant(of_samples, points, n);
            for (error, &of_sample) in self.errors.iter_mut().zip(&*of_samples) {
                *error += match margin.norm {
                    Norm::Absolutes => of_sample,
                    Norm::Squares | Norm::Root => of_sample * of_sample,
                };
            }
        }
        for error in &mut self.errors {
            let of_frame = match margin.norm {
                Norm::Absolutes => *error,
                Norm::Squares | Norm::Root => error.sqrt(),
            };
            *error = margin.error_of_frames(count, of_frame);
        }
    }
}

/// [`Block::normalise`] with the processor's vectors.
struct Normalise<'a> {
    block: &'a mut Block,
    scratch: &'a mut Scratch,
    frames: (usize, usize),
    margin: &'a Margin,
    precision: (f64, f64),
}

impl WithSimd for Normalise<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.block
            .normalise(self.scratch, self.frames, self.margin, self.precision);
    }
}

/// Squares are far from where they lose digits.
const LEAST_VARIANCE: f64 = 1e-280;

/// Windows of equal samples, of which nothing is known by their variance, are zeros for certain.
fn clear_constant(uncertain: &mut [f64], points: &[f64], n: usize) {
    if uncertain.iter().fold(true, |all, x| all & x.is_finite()) {
        return;
    }
    let mut run = 0;
    let mut next = f64::NAN;
    for (frame, &point) in points.iter().enumerate().rev() {
        run = if point == next { run + 1 } else { 1 };
        next = point;
        if run >= n
            && let Some(uncertain) = uncertain.get_mut(frame)
        {
            *uncertain = 0.0;
        }
    }
}

impl Sums {
    /// Of each of `width` windows of `n` samples, by the binary digits of `n`.
    #[inline(always)]
    fn set(&mut self, samples: &[f64], n: usize, width: usize) {
        self.level.clear();
        self.level.extend_from_slice(samples);
        windows_of(n, width, &mut self.level, &mut self.next, &mut self.plain);
        self.level.clear();
        self.level.extend(samples.iter().map(|x| x * x));
        windows_of(n, width, &mut self.level, &mut self.next, &mut self.squares);
    }
}

#[inline(always)]
fn windows_of(
    n: usize,
    width: usize,
    level: &mut Vec<f64>,
    next: &mut Vec<f64>,
    sums: &mut Vec<f64>,
) {
    sums.clear();
    sums.resize(width, 0.0);
    let (mut len, mut offset) = (1, 0);
    loop {
        if n & len != 0 {
            for (sum, part) in sums.iter_mut().zip(&level[offset..]) {
                *sum += part;
            }
            offset += len;
        }
        if len > n / 2 {
            return;
        }
        next.clear();
        next.extend(level.iter().zip(&level[len..]).map(|(a, b)| a + b));
        std::mem::swap(level, next);
        len *= 2;
    }
}
