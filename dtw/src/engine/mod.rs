//! The recurrence D(i,j) = min over steps (di, dj, w) of D(i-di,j-dj) + w C(i,j), row by row.

use std::ops::Range;

use crate::{Band, DtwError, Ends, Sample};

mod classic;
mod general;
mod row;
mod trace;
mod wavefront;

pub(crate) use classic::Classic;
pub(crate) use general::General;
pub(crate) use row::Row;
pub(crate) use trace::{Found, trace};

/// What the recurrence runs over.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Grid<'a> {
    /// Frames of the first and the second sequence; neither is 0.
    pub(crate) shape: (usize, usize),
    pub(crate) band: &'a Band,
    pub(crate) ends: Ends,
}

/// An implementation of the recurrence that can stop after some rows and go on from there.
pub(crate) trait Engine<T: Sample> {
    /// Which step led to each cell of some rows.
    type Record;

    fn grid(&self) -> Grid<'_>;

    /// Rows whose accumulated costs the next row needs; sweeps start at multiples of it.
    fn rows_at_once(&self) -> usize;

    /// The accumulated costs before the first row.
    fn start(&self) -> Result<Vec<Row<T>>, DtwError>;

    /// Replaces the accumulated costs of the rows before `rows` by those of its last rows.
    ///
    /// May stop early and return `false` when every path costs more than `limit`.
    fn sweep(
        &mut self,
        rows: Range<usize>,
        before: &mut Vec<Row<T>>,
        limit: T,
    ) -> Result<bool, DtwError>;

    /// The same, keeping the steps.
    fn record(
        &mut self,
        rows: Range<usize>,
        before: &mut Vec<Row<T>>,
    ) -> Result<Self::Record, DtwError>;

    /// Bytes that [`Self::record`] keeps for `rows`.
    fn record_bytes(&self, rows: Range<usize>) -> u64;

    /// From where the cheapest path came to (row, column); `None` when it starts there.
    fn origin(&self, record: &Self::Record, cell: (usize, usize)) -> Option<(usize, usize)>;
}
