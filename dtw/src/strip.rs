use std::ops::Range;

use crate::Band;
use crate::lanes::{BLOCK, GROUP};

/// Rows that a kernel works on at once, as many as two vectors have lanes, and their cells.
#[derive(Debug, Clone)]
pub(crate) struct Strip {
    /// At most [`Self::height`] rows; fewer at the end.
    pub(crate) rows: Range<usize>,
    pub(crate) height: usize,
    /// Columns of each row inside the band; of rows past the end, none.
    pub(crate) bands: Vec<Range<usize>>,
    /// From the first to the last column of any row; starts at a group of packed columns.
    pub(crate) columns: Range<usize>,
}

impl Strip {
    pub(crate) fn new(
        band: &Band,
        rows: Range<usize>,
        shape: (usize, usize),
        height: usize,
    ) -> Self {
        let mut strip = Self {
            rows: 0..0,
            height,
            bands: Vec::with_capacity(height),
            columns: 0..0,
        };
        strip.advance(band, rows, shape);
        strip
    }

    /// The same for other rows.
    pub(crate) fn advance(&mut self, band: &Band, rows: Range<usize>, shape: (usize, usize)) {
        self.bands.clear();
        self.bands
            .extend(rows.clone().map(|row| band.columns(row, shape)));
        let filled = || self.bands.iter().filter(|columns| !columns.is_empty());
        let start = filled().map(|columns| columns.start).min().unwrap_or(0);
        let end = filled().map(|columns| columns.end).max().unwrap_or(0);
        let start = start / GROUP * GROUP;
        self.columns = start..end;
        self.bands.resize(self.height, start..start);
        for columns in &mut self.bands {
            if columns.start >= columns.end {
                *columns = start..start;
            }
        }
        self.rows = rows;
    }

    /// Column ranges of at most [`BLOCK`], side by side.
    pub(crate) fn blocks(&self) -> impl Iterator<Item = Range<usize>> + use<> {
        let Range { start, end } = self.columns.clone();
        (start..end)
            .step_by(BLOCK)
            .map(move |first| first..(first + BLOCK).min(end))
    }

    /// Whether every row holds every one of `columns`.
    pub(crate) fn is_inside(&self, columns: &Range<usize>) -> bool {
        let holds = |band: &Range<usize>| band.start <= columns.start && columns.end <= band.end;
        self.bands.iter().all(holds)
    }
}
