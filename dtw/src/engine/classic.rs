//! Steps (1,1), (0,1), (1,0) of any weights, a strip of rows at a time.

use std::ops::Range;

use pulp::Arch;

use super::wavefront::{Advance, Front, Weights, n_words, step_of, steps};
use super::{Engine, Grid, Row};
use crate::costs::{Costs, Fill};
use crate::lanes::BLOCK;
use crate::strip::Strip;
use crate::{DtwError, Sample};

pub(crate) struct Classic<'a, T: Sample, C> {
    grid: Grid<'a>,
    weights: [T; 3],
    arch: Arch,
    costs: C,
    strip: Strip,
    front: Front<T>,
    incoming: Vec<T>,
}

/// Steps of some strips, as bits.
pub(crate) struct Steps<T: Sample> {
    first_row: usize,
    /// Of each strip: its first column and its first word.
    strips: Vec<(usize, usize)>,
    words: Vec<T::Word>,
}

impl<'a, T: Sample, C: Costs<T>> Classic<'a, T, C> {
    pub(crate) fn new(
        grid: Grid<'a>,
        weights: [f64; 3],
        (arch, height): (Arch, usize),
        costs: C,
    ) -> Result<Self, DtwError> {
        Ok(Self {
            grid,
            weights: weights.map(|weight| T::from(weight).unwrap_or_else(T::infinity)),
            arch,
            costs,
            strip: Strip::new(grid.band, 0..0, grid.shape, height),
            front: Front::new(height)?,
            incoming: vec![T::infinity(); BLOCK],
        })
    }

    fn run(
        &mut self,
        rows: Range<usize>,
        above: &mut Row<T>,
        limit: T,
        mut record: Option<&mut Steps<T>>,
    ) -> Result<bool, DtwError> {
        let mut below = Row::unreachable();
        for first in rows.clone().step_by(self.strip.height) {
            let rows = first..(first + self.strip.height).min(rows.end);
            self.strip.advance(self.grid.band, rows, self.grid.shape);
            let words = match &mut record {
                Some(record) => Some(record.begin_strip(&self.strip)?),
                None => None,
            };
            self.strip(above, &mut below, words)?;
            std::mem::swap(above, &mut below);
            if above.exceeds(limit) {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// The last row's accumulated costs from those of the row above the strip.
    fn strip(
        &mut self,
        above: &Row<T>,
        below: &mut Row<T>,
        mut words: Option<&mut [T::Word]>,
    ) -> Result<(), DtwError> {
        let (height, n_rows) = (self.strip.height, self.strip.rows.len());
        let columns = self.strip.columns.clone();
        below.clear(self.strip.bands[n_rows - 1].clone())?;
        self.front.begin(above.back(columns.start, 1));
        self.costs.enter(&self.strip);
        let weights = Weights {
            steps: self.weights,
            at_start: self.strip.rows.start == 0,
        };
        let n_steps = steps(&columns, height);
        for done in (0..n_steps).step_by(BLOCK) {
            let first = columns.start + done;
            let block = first.min(columns.end)..(first + BLOCK).min(columns.end);
            if !block.is_empty() {
                self.arch.dispatch(Fill {
                    costs: &mut self.costs,
                    strip: &self.strip,
                    columns: block.clone(),
                    tile: self.front.tile.as_mut_slice(),
                });
            }
            let len = BLOCK.min(n_steps - done);
            let incoming = &mut self.incoming[..len];
            above.copy_to((first, 0), incoming);
            let record = words.as_deref_mut().map(|words| {
                let start = n_words::<T>(done, height);
                &mut words[start..start + n_words::<T>(len, height)]
            });
            self.arch.dispatch(Advance {
                front: &mut self.front,
                weights,
                n_rows,
                n_columns: block.len(),
                incoming,
                record,
            });
            for (step, cost) in self.front.outgoing(len).enumerate() {
                if let Some(column) = (first + step).checked_sub(height) {
                    below.set(column, cost);
                }
            }
        }
        Ok(())
    }
}

impl<T: Sample> Steps<T> {
    fn begin_strip(&mut self, strip: &Strip) -> Result<&mut [T::Word], DtwError> {
        let start = self.words.len();
        let len = n_words::<T>(steps(&strip.columns, strip.height), strip.height);
        self.words
            .try_reserve(len)
            .map_err(|_| DtwError::TooLarge {
                rows: strip.rows.len(),
                columns: strip.columns.len(),
            })?;
        self.words
            .resize(start + len, pulp::bytemuck::Zeroable::zeroed());
        self.strips.push((strip.columns.start, start));
        Ok(&mut self.words[start..])
    }
}

impl<T: Sample, C: Costs<T>> Engine<T> for Classic<'_, T, C> {
    type Record = Steps<T>;

    fn grid(&self) -> Grid<'_> {
        self.grid
    }

    fn rows_at_once(&self) -> usize {
        self.strip.height
    }

    fn start(&self) -> Result<Vec<Row<T>>, DtwError> {
        let is_open = self.grid.ends.begin_is_open();
        Ok(vec![Row::before_the_first(is_open, self.grid.shape.1)?])
    }

    fn sweep(
        &mut self,
        rows: Range<usize>,
        before: &mut Vec<Row<T>>,
        limit: T,
    ) -> Result<bool, DtwError> {
        self.run(rows, &mut before[0], limit, None)
    }

    fn record(
        &mut self,
        rows: Range<usize>,
        before: &mut Vec<Row<T>>,
    ) -> Result<Steps<T>, DtwError> {
        let mut steps = Steps {
            first_row: rows.start,
            strips: Vec::new(),
            words: Vec::new(),
        };
        self.run(rows, &mut before[0], T::infinity(), Some(&mut steps))?;
        Ok(steps)
    }

    fn record_bytes(&self, rows: Range<usize>) -> u64 {
        let height = self.strip.height;
        let strips = rows.clone().step_by(height).map(|first| {
            let rows = first..(first + height).min(rows.end);
            let strip = Strip::new(self.grid.band, rows, self.grid.shape, height);
            n_words::<T>(steps(&strip.columns, height), height) as u64
        });
        strips.sum::<u64>() * size_of::<T::Word>() as u64
    }

    fn origin(&self, steps: &Steps<T>, (row, column): (usize, usize)) -> Option<(usize, usize)> {
        let height = self.strip.height;
        let (strip, lane) = (
            (row - steps.first_row) / height,
            (row - steps.first_row) % height,
        );
        let (first_column, start) = steps.strips[strip];
        let words = &steps.words[start..];
        let step = step_of::<T>(words, height, lane, column - first_column);
        match step {
            0 => Some((row.checked_sub(1)?, column.checked_sub(1)?)),
            1 => Some((row, column - 1)),
            _ => Some((row - 1, column)),
        }
    }
}
