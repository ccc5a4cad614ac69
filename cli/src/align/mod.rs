//! Aligning two clips in time: first the segments of their feature words, then ever finer frames
//! within a band around the alignment before (2005 paper, section 7).
//!
//! 1. Words are taken about 15 times a second ([`WORD_RATE`]). Their segments, the long ones cut into
//!    pieces of at most 0.1 s ([`MAX_PIECE_SECONDS`]), are aligned as wholes: the local cost is the
//!    distance of their mean poses, weighted by their lengths ([`segments::align_pieces`]).
//! 2. The frames that these pieces cover, enlarged by a margin, are the band of a DTW over mean poses
//!    of a few frames each; its path, enlarged by one cell, is the band at twice the rate, and so on
//!    until the frames themselves are aligned.
//!
//! Everything but the first stage is linear in frames. The first one is quadratic in segments up to
//! [`MAX_SEGMENT_CELLS`]; beyond, neighbouring pieces are joined two by two and aligned first, in the
//! same way, so that longer clips take linear time as well.
//!
//! The paper aligns segments by their words and refines once, at the full rate. Measured on CMU walks, by how many pairs
//! end more than 1 % above the best path (60 pairs for words alone, else all 666): words compared bit by bit
//! lose two pairs of five, for they do not tell where in a step a walker is; mean poses of whole segments lose 8 %,
//! of segments cut at 0.1 s 2.4 %. Clips cut every 0.1 s whatever their words lose 3.8 %, every 0.075 s, which
//! costs as much as the segments do, 2.3 %: words place the cuts well, they do not do wonders. Refining at once at
//! the full rate, 0.1 s around the segments, computes three times the cells and loses more; widening the band where
//! the path touches it computes up to twice the cells and loses as many.

pub mod blend;
pub mod pair;
pub mod pose;
pub mod segments;

#[cfg(test)]
mod tests;

use dtw::{Band, Dtw, DtwError, WarpingPath};
use segments::{Level, Rows, align_pieces, pieces, rows_around};

pub use pose::Poses;

/// Feature words per second, at least, that segments are made of.
pub const WORD_RATE: f64 = 15.0;

/// Longer segments are cut into even pieces: when nothing changes for long, the alignment still has to
/// know where in the segment it is.
pub const MAX_PIECE_SECONDS: f64 = 0.1;

/// By how much the band reaches beyond the aligned segments, unless asked otherwise.
pub const DEFAULT_MARGIN_SECONDS: f64 = 0.25;

/// By how many cells the band reaches beyond the path of half the rate.
const REFINEMENT_MARGIN: usize = 1;

/// Cells of the largest matrix of pieces that is computed whole: those of clips of more than a minute.
pub const MAX_SEGMENT_CELLS: usize = 1 << 20;

/// By how many pieces the band reaches beyond the path of pieces joined two by two.
const JOINED_MARGIN: usize = 8;

/// Cells of a matrix that is so small that the stages before would cost more than they save.
const SMALL_MATRIX: u64 = 1 << 12;

/// One clip, ready to be aligned: as many words as poses.
#[derive(Clone, Copy, Debug)]
pub struct Side<'a> {
    /// Normalised poses.
    pub poses: &'a Poses,
    /// A feature word per pose; bits that only one clip has are off.
    pub words: &'a [u64],
}

/// How two clips are aligned.
#[derive(Clone, Copy, Debug)]
pub struct Resolution {
    /// Poses per second of both clips.
    pub rate: f64,
    /// By how much the band reaches beyond the aligned segments, in seconds.
    pub margin: f64,
    /// Cells of the largest matrix of pieces that is computed whole, see [`MAX_SEGMENT_CELLS`].
    pub max_segment_cells: usize,
}

impl Resolution {
    /// The usual margin and limit.
    #[must_use]
    pub fn new(rate: f64) -> Resolution {
        Resolution {
            rate,
            margin: DEFAULT_MARGIN_SECONDS,
            max_segment_cells: MAX_SEGMENT_CELLS,
        }
    }
}

/// Matrix cells, each one a distance of two poses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cells {
    /// Computed to align segments, all rounds together.
    pub segments: u64,
    /// Computed in bands, all rates together.
    pub bands: u64,
    /// Of the full matrix, frames times frames.
    pub full: u64,
}

impl Cells {
    /// Cells computed as a share of the full matrix; more than 1 if the stages cost more than they save.
    #[must_use]
    pub fn share(self) -> f64 {
        (self.segments + self.bands) as f64 / self.full.max(1) as f64
    }
}

/// Which pose of one clip is which of the other.
#[derive(Clone, Debug, PartialEq)]
pub struct Alignment {
    /// Pairs of poses, 0-based, from both first to both last; each step advances one clip or both by 1.
    pub steps: Vec<(usize, usize)>,
    /// The sum of [`Poses::distance`] along the path, in metres.
    pub cost: f64,
    /// What it took.
    pub cells: Cells,
}

impl Alignment {
    fn new(path: WarpingPath, cells: Cells) -> Alignment {
        Alignment {
            steps: path.steps,
            cost: path.cost,
            cells,
        }
    }
}

/// Aligns two clips. `None` if one of them has no pose, or not as many words as poses.
///
/// O(frames) in time and space but for the pieces, see the [module](self).
///
/// # Errors
/// [`DtwError::TooLarge`] for clips that do not fit in memory.
pub fn align(
    a: Side<'_>,
    b: Side<'_>,
    resolution: &Resolution,
) -> Result<Option<Alignment>, DtwError> {
    let (n, m) = (a.poses.n_frames(), b.poses.n_frames());
    if (n, m) != (a.words.len(), b.words.len()) || n.min(m) == 0 {
        return Ok(None);
    }
    let mut cells = Cells {
        full: n as u64 * m as u64,
        ..Cells::default()
    };
    if cells.full <= SMALL_MATRIX {
        cells.bands = cells.full;
        let path = path_within(Band::Full, a.poses, b.poses)?;
        return Ok(path.map(|path| Alignment::new(path, cells)));
    }
    let mut stride = coarsest_stride(resolution.rate);
    let max_piece = ((MAX_PIECE_SECONDS * resolution.rate).round() as usize).max(1);
    let cut = |side: Side<'_>| pieces(side.words, stride, max_piece);
    let mut coarse = (Level::new(a.poses, cut(a)), Level::new(b.poses, cut(b)));
    let max_cells = resolution.max_segment_cells;
    let Some(mut steps) = segment_path(&coarse.0, &coarse.1, max_cells, &mut cells.segments) else {
        return Ok(None);
    };
    let mut margin = (resolution.margin * resolution.rate / stride as f64).ceil() as usize;
    loop {
        let fine = (Level::even(a.poses, stride), Level::even(b.poses, stride));
        let rows = rows_around(&steps, (&coarse.0, &coarse.1), (&fine.0, &fine.1), margin);
        cells.bands += n_cells(&rows);
        let Some(path) = path_within(Band::Rows(rows), &fine.0.poses, &fine.1.poses)? else {
            return Ok(None);
        };
        if stride == 1 {
            return Ok(Some(Alignment::new(path, cells)));
        }
        (steps, coarse) = (path.steps, fine);
        margin = REFINEMENT_MARGIN;
        stride /= 2;
    }
}

/// The cost of the best path of all, in metres: DTW over the full matrix. `None` if a clip has no pose.
///
/// # Errors
/// [`DtwError::TooLarge`] for clips that do not fit in memory.
pub fn full_cost(a: &Poses, b: &Poses) -> Result<Option<f64>, DtwError> {
    let distance = |i: usize, j: usize| a.distance(i, b, j);
    Dtw::new(Band::Full).distance_with(a.n_frames(), b.n_frames(), distance)
}

/// Cells up to which [`mean_distance`] computes the full matrix: those of two clips of a minute at 30 poses per second.
const MEAN_DISTANCE_CELLS: usize = 1 << 22;

/// The mean of [`Poses::distance`] along the path that costs least, in metres per step. `None` if a clip has no
/// pose.
///
/// DTW over the full matrix; for clips too long for that, [`align`] by pieces of [`MAX_PIECE_SECONDS`], whose path may
/// cost a little more. `rate` is in poses per second.
///
/// # Errors
/// [`DtwError::TooLarge`] for clips that do not fit in memory.
pub fn mean_distance(a: &Poses, b: &Poses, rate: f64) -> Result<Option<f64>, DtwError> {
    let (n, m) = (a.n_frames(), b.n_frames());
    let (steps, cost) = if n.saturating_mul(m) <= MEAN_DISTANCE_CELLS {
        let Some(path) = path_within(Band::Full, a, b)? else {
            return Ok(None);
        };
        (path.steps.len(), path.cost)
    } else {
        let (of_a, of_b) = (vec![0; n], vec![0; m]);
        let a = Side {
            poses: a,
            words: &of_a,
        };
        let b = Side {
            poses: b,
            words: &of_b,
        };
        let Some(found) = align(a, b, &Resolution::new(rate))? else {
            return Ok(None);
        };
        (found.steps.len(), found.cost)
    };
    Ok((steps > 0).then(|| cost / steps as f64))
}

/// The largest power of two that leaves [`WORD_RATE`] frames per second, at least 1.
fn coarsest_stride(rate: f64) -> usize {
    let mut stride = 1;
    while rate / (2 * stride) as f64 >= WORD_RATE {
        stride *= 2;
    }
    stride
}

/// The alignment of pieces; `cells` counts those computed.
fn segment_path(
    a: &Level<'_>,
    b: &Level<'_>,
    max_cells: usize,
    cells: &mut u64,
) -> Option<Vec<(usize, usize)>> {
    let is_small = a.len().saturating_mul(b.len()) <= max_cells;
    let rows: Rows = if is_small || a.len().min(b.len()) < 2 {
        vec![0..b.len(); a.len()]
    } else {
        let (joined_a, joined_b) = (a.joined(), b.joined());
        let steps = segment_path(&joined_a, &joined_b, max_cells, cells)?;
        rows_around(&steps, (&joined_a, &joined_b), (a, b), JOINED_MARGIN)
    };
    *cells += n_cells(&rows);
    let distance = |i: usize, j: usize| a.poses.distance(i, &b.poses, j);
    align_pieces(&a.lengths(), &b.lengths(), &rows, distance)
}

fn path_within(band: Band, a: &Poses, b: &Poses) -> Result<Option<WarpingPath>, DtwError> {
    let distance = |i: usize, j: usize| a.distance(i, b, j);
    Dtw::new(band).align_with(a.n_frames(), b.n_frames(), distance)
}

fn n_cells(rows: &Rows) -> u64 {
    rows.iter().map(|row| row.len() as u64).sum()
}
