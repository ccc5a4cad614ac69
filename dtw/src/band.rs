use std::ops::Range;

use crate::DtwError;

/// How far a path may leave the middle of its band, in cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct BandRadius(usize);

impl BandRadius {
    /// So many cells to either side; 0 leaves the middle alone.
    pub const fn cells(radius: usize) -> Self {
        Self(radius)
    }

    /// The radius in cells.
    pub const fn radius(self) -> usize {
        self.0
    }
}

/// Steepest mean slope of a path from either end, in columns per row and in rows per column.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct Slope(f64);

impl Slope {
    /// At most `slope` columns per row and rows per column; `None` unless it is finite and >= 1.
    pub fn at_most(slope: f64) -> Option<Self> {
        (slope.is_finite() && slope >= 1.0).then_some(Self(slope))
    }

    /// Columns per row.
    pub const fn columns_per_row(self) -> f64 {
        self.0
    }
}

/// The cells (i, j) that a path may use; i is a frame of the first sequence (row), j one of the
/// second (column), N and M their numbers of frames.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub enum Band {
    /// Every cell.
    #[default]
    Full,
    /// `|i - j| <= r` (Sakoe and Chiba 1978), whatever the lengths; 0 is the diagonal.
    SakoeChiba(BandRadius),
    /// Up to r columns beside the line from the first to the last pair of frames. The line's own
    /// cells are the columns that it crosses between the rows' middles, so that steps (1,1), (0,1),
    /// (1,0) can follow it at any radius; for equal lengths this is the Sakoe–Chiba band.
    Slanted(BandRadius),
    /// Itakura's (1975) parallelogram: mean slope from the first pair to (i, j) and from there to
    /// the last pair between `1 / slope` and `slope`.
    Itakura(Slope),
    /// The columns of each row; what lies beyond the last column is cut off.
    Rows(Vec<Range<usize>>),
}

impl From<BandRadius> for Band {
    fn from(radius: BandRadius) -> Self {
        Self::SakoeChiba(radius)
    }
}

impl Band {
    /// Columns of `row` inside the band for sequences of `n` and `m` frames; empty where there are
    /// none.
    ///
    /// ```
    /// use dtw::{Band, BandRadius};
    ///
    /// assert_eq!(Band::from(BandRadius::cells(2)).columns(1, (9, 9)), 0..4);
    /// assert_eq!(Band::Slanted(BandRadius::cells(0)).columns(1, (3, 5)), 1..4);
    /// ```
    pub fn columns(&self, row: usize, (n, m): (usize, usize)) -> Range<usize> {
        if row >= n || m == 0 {
            return 0..0;
        }
        let (start, end) = match self {
            Self::Full => (0, m),
            Self::SakoeChiba(radius) => around(row, row + 1, *radius),
            Self::Slanted(radius) => {
                let line = slanted(row, (n, m));
                around(line.start, line.end, *radius)
            }
            Self::Itakura(slope) => itakura(*slope, row, (n, m)),
            Self::Rows(rows) => rows
                .get(row)
                .map_or((0, 0), |columns| (columns.start, columns.end)),
        };
        let end = end.min(m);
        start.min(end)..end
    }

    /// Number of cells inside the band, of `n * m` in all.
    pub fn cells(&self, n: usize, m: usize) -> u64 {
        match self {
            Self::Full => (n as u64).saturating_mul(m as u64),
            _ => (0..n)
                .map(|row| self.columns(row, (n, m)).len() as u64)
                .sum(),
        }
    }

    /// # Errors
    ///
    /// [`DtwError::BandRows`] when the band states its rows and there are not `n` of them.
    pub(crate) fn check(&self, n: usize) -> Result<(), DtwError> {
        match self {
            Self::Rows(rows) if rows.len() != n => Err(DtwError::BandRows {
                expected: n,
                found: rows.len(),
            }),
            _ => Ok(()),
        }
    }

    /// At least the columns of the widest row.
    pub(crate) fn width_bound(&self, m: usize) -> usize {
        match self {
            Self::SakoeChiba(radius) => radius.0.saturating_mul(2).saturating_add(1).min(m),
            Self::Full | Self::Slanted(_) | Self::Itakura(_) => m,
            Self::Rows(rows) => rows.iter().map(Range::len).max().unwrap_or(0).min(m),
        }
    }
}

fn around(start: usize, end: usize, radius: BandRadius) -> (usize, usize) {
    (start.saturating_sub(radius.0), end.saturating_add(radius.0))
}

/// Columns that the line j = i (M - 1) / (N - 1) crosses for i within half a row of `row`, rounded
/// to the nearest; from one row to the next they touch, and meet where the line is not diagonal.
fn slanted(row: usize, (n, m): (usize, usize)) -> Range<usize> {
    if n < 2 {
        return 0..m;
    }
    let (row, run, rise) = (row as u128, n as u128 - 1, m as u128 - 1);
    // With x = (2 row ± 1) rise / (2 run): floor(x + 1/2) below, ceil(x - 1/2) above.
    let below = ((2 * row).saturating_sub(1) * rise + run) / (2 * run);
    let first = if row == 0 { 0 } else { below };
    let last = ((2 * row + 1) * rise)
        .saturating_sub(run)
        .div_ceil(2 * run)
        .min(rise);
    first as usize..(last.max(first) as usize).saturating_add(1)
}

/// Rows and columns left and gone on both sides differ by the slope's factor at most.
fn itakura(slope: Slope, row: usize, (n, m): (usize, usize)) -> (usize, usize) {
    let (gone, left, last) = (row as f64, (n - 1 - row) as f64, (m - 1) as f64);
    let first = (gone / slope.0).ceil().max((last - left * slope.0).ceil());
    let end = (gone * slope.0)
        .floor()
        .min((last - left / slope.0).floor())
        + 1.0;
    // Float to integer saturates: below zero is zero.
    (first as usize, end.max(0.0) as usize)
}
