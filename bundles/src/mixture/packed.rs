//! Frames as the kernels read them.
//!
//! Frames go in blocks of [`BLOCK`]. A block is kept twice: as *tile*, dimension after dimension
//! with the block's frames side by side, and as *rows*, frame after frame, each (x, |x|², 1, 0, …).
//! The tile ends with |x|². Sums of responsibility times row are all that the M step needs.

use std::ops::Range;

use ndarray::{Array1, ArrayView2};

use super::{MixtureError, aligned::Aligned};

/// Frames that are worked on together: two of the widest vectors.
pub(super) const BLOCK: usize = 16;

/// Numbers of the widest vector: rows are whole ones.
const WIDEST: usize = 8;

/// Frames of the smallest chunk. Chunks are what threads work on, and how sums are grouped.
const CHUNK: usize = 1024;

/// Chunks at most, so that their partial sums stay small beside the frames.
const MAX_CHUNKS: usize = 64;

/// Frames about their mean, in blocks; those after the last one are zero.
#[derive(Debug)]
pub(super) struct Packed {
    pub(super) n_frames: usize,
    pub(super) dims: usize,
    /// The mean, which was subtracted from all frames.
    pub(super) centre: Array1<f64>,
    /// Mean over the dimensions of the population variance.
    pub(super) mean_variance: f64,
    /// Numbers of a row.
    pub(super) width: usize,
    tiles: Aligned,
    rows: Aligned,
}

impl Packed {
    pub(super) fn new(frames: ArrayView2<'_, f64>) -> Result<Self, MixtureError> {
        let (n_frames, dims) = frames.dim();
        if n_frames == 0 {
            return Err(MixtureError::NoFrames);
        }
        check_finite(frames)?;
        let width = (dims + 2).next_multiple_of(WIDEST);
        let padded = n_frames.next_multiple_of(BLOCK);
        let mut packed = Self {
            n_frames,
            dims,
            centre: centre(frames),
            mean_variance: 0.0,
            width,
            tiles: Aligned::filled(padded * (dims + 1), 0.0),
            rows: Aligned::filled(padded * width, 0.0),
        };
        packed.fill(frames)?;
        let rows = packed.rows.chunks_exact(width).take(n_frames);
        // A frame may be as far from the centre as can be: divide first.
        let share = 1.0 / (n_frames as f64 * dims.max(1) as f64);
        packed.mean_variance = rows.map(|row| row[dims] * share).sum();
        Ok(packed)
    }

    fn fill(&mut self, frames: ArrayView2<'_, f64>) -> Result<(), MixtureError> {
        let dims = self.dims;
        for (frame, numbers) in frames.rows().into_iter().enumerate() {
            let row = &mut self.rows[frame * self.width..][..self.width];
            let mut square = 0.0;
            for (slot, (x, centre)) in row.iter_mut().zip(numbers.iter().zip(&self.centre)) {
                *slot = x - centre;
                square += *slot * *slot;
            }
            (row[dims], row[dims + 1]) = (square, 1.0);
            // A margin, because sums of squares and their products with precisions must be finite.
            if square >= f64::MAX / 1e9 / self.n_frames as f64 || square.is_nan() {
                return Err(MixtureError::Magnitude { frame });
            }
            let tile = &mut self.tiles[frame / BLOCK * BLOCK * (dims + 1)..];
            for (dim, x) in row[..=dims].iter().enumerate() {
                tile[dim * BLOCK + frame % BLOCK] = *x;
            }
        }
        Ok(())
    }

    /// The frames in chunks of whole blocks; they depend on the number of frames alone.
    pub(super) fn chunks(&self) -> Vec<Range<usize>> {
        chunks(self.n_frames)
    }

    /// The tiles of the blocks that hold these frames, of a chunk.
    pub(super) fn tiles(&self, chunk: &Range<usize>) -> &[f64] {
        let blocks = chunk.start / BLOCK..chunk.end.div_ceil(BLOCK);
        let size = BLOCK * (self.dims + 1);
        &self.tiles[blocks.start * size..blocks.end * size]
    }

    /// The rows of the blocks that hold these frames, of a chunk.
    pub(super) fn rows(&self, chunk: &Range<usize>) -> &[f64] {
        let end = chunk.end.next_multiple_of(BLOCK);
        &self.rows[chunk.start * self.width..end * self.width]
    }

    /// A frame about the centre.
    pub(super) fn frame(&self, frame: usize) -> &[f64] {
        &self.rows[frame * self.width..][..self.dims]
    }
}

/// Chunks of `n_frames` frames: all but the last are of whole blocks.
pub(super) fn chunks(n_frames: usize) -> Vec<Range<usize>> {
    let size = n_frames.div_ceil(MAX_CHUNKS).max(CHUNK);
    let size = size.next_multiple_of(BLOCK);
    let starts = (0..n_frames).step_by(size);
    starts
        .map(|start| start..(start + size).min(n_frames))
        .collect()
}

pub(super) fn check_finite(frames: ArrayView2<'_, f64>) -> Result<(), MixtureError> {
    let mut numbers = frames.indexed_iter();
    match numbers.find(|(_, x)| !x.is_finite()) {
        Some(((frame, dim), &found)) => Err(MixtureError::NotFinite { frame, dim, found }),
        None => Ok(()),
    }
}

/// The mean, as the first frame and the mean difference from it: exact where all frames are equal.
fn centre(frames: ArrayView2<'_, f64>) -> Array1<f64> {
    let first = frames.row(0);
    let mut sums = Array1::<f64>::zeros(frames.ncols());
    for row in frames.rows() {
        sums.zip_mut_with(&(&row - &first), |sum, difference| *sum += difference);
    }
    &first + &(sums / frames.nrows() as f64)
}
