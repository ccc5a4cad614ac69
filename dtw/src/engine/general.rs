//! Any step pattern, a row at a time.

use std::ops::Range;

use pulp::Arch;

use super::{Engine, Grid, Row};
use crate::aligned::Aligned;
use crate::costs::{Costs, Fill};
use crate::lanes::BLOCK;
use crate::strip::Strip;
use crate::{Band, DtwError, Sample, StepPattern};

pub(crate) struct General<'a, T, C> {
    grid: Grid<'a>,
    steps: Vec<Move<T>>,
    /// Rows that the longest step reaches back.
    depth: usize,
    /// Whether every weight is 1; then predecessors are compared before the local cost is added.
    is_unit: bool,
    arch: Arch,
    costs: C,
    strip: Strip,
    tile: Aligned<T>,
    /// Local costs of the strip, row after row.
    local: Vec<T>,
    /// Accumulated costs that a step starts from.
    sources: Vec<T>,
    /// Steps that led to the cells of a row.
    picked: Vec<u8>,
}

#[derive(Clone, Copy)]
struct Move<T> {
    rows: usize,
    columns: usize,
    weight: T,
}

/// Stands for "starts here" among the indices of steps.
const START: u8 = StepPattern::MAX_STEPS as u8;

/// Indices of steps, two in a byte.
pub(crate) struct Choices {
    first_row: usize,
    /// First column and first index of each row.
    rows: Vec<(usize, usize)>,
    bytes: Vec<u8>,
    len: usize,
}

impl<'a, T: Sample, C: Costs<T>> General<'a, T, C> {
    pub(crate) fn new(
        grid: Grid<'a>,
        pattern: &StepPattern,
        (arch, height): (Arch, usize),
        costs: C,
    ) -> Result<Self, DtwError> {
        let steps: Vec<Move<T>> = pattern
            .steps()
            .iter()
            .map(|step| Move {
                rows: step.rows,
                columns: step.columns,
                weight: T::from(step.weight).unwrap_or_else(T::infinity),
            })
            .collect();
        Ok(Self {
            grid,
            depth: steps.iter().map(|step| step.rows).max().unwrap_or(1).max(1),
            is_unit: steps.iter().all(|step| step.weight == T::one()),
            steps,
            arch,
            costs,
            strip: Strip::new(grid.band, 0..0, grid.shape, height),
            tile: Aligned::filled(BLOCK * height, T::zero())?,
            local: Vec::new(),
            sources: Vec::new(),
            picked: Vec::new(),
        })
    }

    /// As [`Engine::sweep`], keeping the steps in `choices`.
    fn run(
        &mut self,
        rows: Range<usize>,
        before: &mut Vec<Row<T>>,
        limit: T,
        mut choices: Option<&mut Choices>,
    ) -> Result<bool, DtwError> {
        let height = self.strip.height;
        for first in rows.clone().step_by(height) {
            let rows = first..(first + height).min(rows.end);
            self.strip
                .advance(self.grid.band, rows.clone(), self.grid.shape);
            self.load()?;
            for row in rows {
                let mut new = Row::unreachable();
                self.row(row, before, &mut new)?;
                if let Some(choices) = choices.as_deref_mut() {
                    let columns = &self.strip.bands[row - self.strip.rows.start];
                    choices.push_row(columns.start, &self.picked);
                }
                before.remove(0);
                before.push(new);
            }
            if before.iter().all(|row| row.exceeds(limit)) {
                return Ok(false);
            }
        }
        Ok(true)
    }

    fn cells(&self, rows: Range<usize>) -> u64 {
        let columns = |row| self.grid.band.columns(row, self.grid.shape);
        match self.grid.band {
            Band::Full => (rows.len() as u64).saturating_mul(self.grid.shape.1 as u64),
            _ => rows.map(|row| columns(row).len() as u64).sum(),
        }
    }

    /// Local costs of the strip.
    fn load(&mut self) -> Result<(), DtwError> {
        let width = self.strip.columns.len();
        let len = width * self.strip.rows.len();
        let more = len.saturating_sub(self.local.len());
        let too_large = DtwError::TooLarge {
            rows: self.strip.rows.len(),
            columns: width,
        };
        self.local.try_reserve(more).map_err(|_| too_large)?;
        self.local.resize(len.max(self.local.len()), T::zero());
        self.costs.enter(&self.strip);
        for columns in self.strip.blocks() {
            self.arch.dispatch(Fill {
                costs: &mut self.costs,
                strip: &self.strip,
                columns: columns.clone(),
                tile: self.tile.as_mut_slice(),
            });
            let first = columns.start - self.strip.columns.start;
            let tile = self.tile.as_slice().chunks_exact(self.strip.height);
            for (column, costs) in tile.take(columns.len()).enumerate() {
                for (row, &cost) in costs.iter().take(self.strip.rows.len()).enumerate() {
                    self.local[row * width + first + column] = cost;
                }
            }
        }
        Ok(())
    }

    /// Accumulated costs of one of the strip's rows, and the steps that led there.
    fn row(&mut self, row: usize, before: &[Row<T>], new: &mut Row<T>) -> Result<(), DtwError> {
        let nth = row - self.strip.rows.start;
        let columns = self.strip.bands[nth].clone();
        new.clear(columns.clone())?;
        self.picked.clear();
        self.picked.resize(columns.len(), START);
        let new = new.costs_mut();
        let offset = nth * self.strip.columns.len() + columns.start - self.strip.columns.start;
        let local = &self.local[offset..offset + columns.len()];
        if row == 0 {
            let is_start = self.grid.ends.begin_is_open() || columns.start == 0;
            let n_starts = if self.grid.ends.begin_is_open() {
                columns.len()
            } else {
                usize::from(is_start).min(columns.len())
            };
            for (new, &cost) in new.iter_mut().zip(local).take(n_starts) {
                *new = if self.is_unit { T::zero() } else { cost };
            }
        }
        let mut cells = Cells {
            is_unit: self.is_unit,
            first_column: columns.start,
            local,
            new,
            picked: &mut self.picked,
        };
        if self.steps.iter().any(|step| step.rows == 0) {
            cells.one_by_one(&self.steps, before);
        } else {
            self.sources.resize(columns.len(), T::infinity());
            cells.step_by_step(&self.steps, before, &mut self.sources);
        }
        Ok(())
    }
}

/// Columns of a row on their way from starts to accumulated costs.
struct Cells<'a, T> {
    is_unit: bool,
    first_column: usize,
    local: &'a [T],
    new: &'a mut [T],
    picked: &'a mut [u8],
}

impl<T: Sample> Cells<'_, T> {
    /// For steps that all come from earlier rows: columns do not depend on each other.
    fn step_by_step(&mut self, steps: &[Move<T>], before: &[Row<T>], sources: &mut [T]) {
        for (index, step) in steps.iter().enumerate() {
            let Some(row) = back(before, step.rows) else {
                continue;
            };
            row.copy_to((self.first_column, step.columns), sources);
            let weight = if self.is_unit { T::zero() } else { step.weight };
            let cells = self.new.iter_mut().zip(&mut *self.picked);
            for ((new, picked), (&source, &cost)) in cells.zip(sources.iter().zip(self.local)) {
                let through = source + weight * cost;
                if through < *new {
                    *new = through;
                    *picked = index as u8;
                }
            }
        }
        if self.is_unit {
            for (new, &cost) in self.new.iter_mut().zip(self.local) {
                *new = *new + cost;
            }
        }
    }

    /// For patterns with steps inside a row, which need the columns before.
    fn one_by_one(&mut self, steps: &[Move<T>], before: &[Row<T>]) {
        for (k, &cost) in self.local.iter().enumerate() {
            let column = self.first_column + k;
            for (index, step) in steps.iter().enumerate() {
                let source = match back(before, step.rows) {
                    Some(row) => row.back(column, step.columns),
                    None => k
                        .checked_sub(step.columns)
                        .map_or_else(T::infinity, |k| self.new[k]),
                };
                let weight = if self.is_unit { T::zero() } else { step.weight };
                let through = source + weight * cost;
                if through < self.new[k] {
                    self.new[k] = through;
                    self.picked[k] = index as u8;
                }
            }
            if self.is_unit {
                self.new[k] = self.new[k] + cost;
            }
        }
    }
}

/// The row so many rows back; `None` for the row itself.
fn back<T>(before: &[Row<T>], rows: usize) -> Option<&Row<T>> {
    before.get(before.len().checked_sub(rows)?)
}

impl Choices {
    fn new(rows: Range<usize>, n_cells: u64) -> Result<Self, DtwError> {
        let too_large = |columns| DtwError::TooLarge {
            rows: rows.len(),
            columns,
        };
        let n_bytes = usize::try_from(n_cells.div_ceil(2)).unwrap_or(usize::MAX);
        let mut choices = Self {
            first_row: rows.start,
            rows: Vec::new(),
            bytes: Vec::new(),
            len: 0,
        };
        let reserved = choices.bytes.try_reserve_exact(n_bytes);
        reserved.map_err(|_| too_large(n_bytes / rows.len().max(1)))?;
        let reserved = choices.rows.try_reserve_exact(rows.len());
        reserved.map_err(|_| too_large(1))?;
        Ok(choices)
    }

    fn push_row(&mut self, first_column: usize, picked: &[u8]) {
        self.rows.push((first_column, self.len));
        for &index in picked {
            if self.len.is_multiple_of(2) {
                self.bytes.push(index);
            } else if let Some(byte) = self.bytes.last_mut() {
                *byte |= index << 4;
            }
            self.len += 1;
        }
    }

    fn get(&self, (row, column): (usize, usize)) -> u8 {
        let (first_column, start) = self.rows[row - self.first_row];
        let nth = start + column - first_column;
        self.bytes[nth / 2] >> (4 * (nth % 2)) & 0xf
    }
}

impl<T: Sample, C: Costs<T>> Engine<T> for General<'_, T, C> {
    type Record = Choices;

    fn grid(&self) -> Grid<'_> {
        self.grid
    }

    fn rows_at_once(&self) -> usize {
        self.strip.height
    }

    fn start(&self) -> Result<Vec<Row<T>>, DtwError> {
        Ok(vec![Row::unreachable(); self.depth])
    }

    fn sweep(
        &mut self,
        rows: Range<usize>,
        before: &mut Vec<Row<T>>,
        limit: T,
    ) -> Result<bool, DtwError> {
        self.run(rows, before, limit, None)
    }

    fn record(
        &mut self,
        rows: Range<usize>,
        before: &mut Vec<Row<T>>,
    ) -> Result<Choices, DtwError> {
        let n_cells = self.cells(rows.clone());
        let mut choices = Choices::new(rows.clone(), n_cells)?;
        self.run(rows, before, T::infinity(), Some(&mut choices))?;
        Ok(choices)
    }

    fn record_bytes(&self, rows: Range<usize>) -> u64 {
        let n_rows = rows.len() as u64;
        self.cells(rows) / 2 + n_rows * size_of::<(usize, usize)>() as u64
    }

    fn origin(&self, choices: &Choices, cell: (usize, usize)) -> Option<(usize, usize)> {
        let step = self.steps.get(usize::from(choices.get(cell)))?;
        Some((cell.0 - step.rows, cell.1 - step.columns))
    }
}
