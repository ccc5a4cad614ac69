//! From the last cell back to the first. Steps are kept where they fit the memory allowed; else the
//! rows are divided, the accumulated costs kept between the parts, and the parts swept again from
//! the last to the first, each divided in its turn (the idea of Hirschberg 1975, but forward only,
//! so that sums and ties are those of one sweep).

use std::ops::Range;

use super::{Engine, Row};
use crate::{DtwError, Sample, WarpingPath};

/// Parts that too many rows are divided into.
const PARTS: usize = 8;

/// Where the cheapest path ends, and for how much.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Found<T> {
    pub(crate) column: usize,
    pub(crate) cost: T,
}

impl<T: Sample> Found<T> {
    /// In the last row's accumulated costs.
    pub(crate) fn in_last_row(engine: &impl Engine<T>, row: &Row<T>) -> Option<Self> {
        let grid = engine.grid();
        if grid.ends.end_is_open() {
            let (column, cost) = row.cheapest()?;
            return Some(Self { column, cost });
        }
        let column = grid.shape.1 - 1;
        let cost = row.get(column);
        cost.is_finite().then_some(Self { column, cost })
    }
}

/// The cheapest path, with at most `bytes` for its steps at a time (but always those of a strip).
pub(crate) fn trace<T: Sample, E: Engine<T>>(
    engine: &mut E,
    bytes: u64,
) -> Result<Option<WarpingPath>, DtwError> {
    let n = engine.grid().shape.0;
    let mut tracer = Tracer {
        engine,
        bytes,
        at: None,
        steps: Vec::new(),
        cost: T::zero(),
    };
    let start = tracer.engine.start()?;
    tracer.part(0..n, start)?;
    if tracer.steps.is_empty() {
        return Ok(None);
    }
    let mut steps = tracer.steps;
    steps.reverse();
    Ok(Some(WarpingPath {
        steps,
        cost: tracer.cost.into(),
    }))
}

struct Tracer<'e, T, E> {
    engine: &'e mut E,
    bytes: u64,
    /// The cell reached so far, going back; `None` before the last row is known.
    at: Option<(usize, usize)>,
    steps: Vec<(usize, usize)>,
    cost: T,
}

impl<T: Sample, E: Engine<T>> Tracer<'_, T, E> {
    /// Follows the path back through `rows`, given the accumulated costs before them. Returns
    /// whether there is more of it before.
    fn part(&mut self, rows: Range<usize>, before: Vec<Row<T>>) -> Result<bool, DtwError> {
        let unit = self.engine.rows_at_once();
        let is_small = self.engine.record_bytes(rows.clone()) <= self.bytes;
        if is_small || rows.len() <= unit {
            return self.follow(rows, before);
        }
        let part_len = rows.len().div_ceil(PARTS).next_multiple_of(unit);
        let mut parts = Vec::new();
        let mut costs = before;
        for start in rows.clone().step_by(part_len) {
            let part = start..(start + part_len).min(rows.end);
            let is_last = part.end == rows.end;
            parts.push((part.clone(), costs.clone()));
            if !is_last {
                self.engine.sweep(part, &mut costs, T::infinity())?;
            }
        }
        for (part, before) in parts.into_iter().rev() {
            let is_beyond = self.at.is_some_and(|(row, _)| row < part.start);
            if !is_beyond && !self.part(part, before)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    fn follow(&mut self, rows: Range<usize>, mut costs: Vec<Row<T>>) -> Result<bool, DtwError> {
        let record = self.engine.record(rows.clone(), &mut costs)?;
        let mut at = match self.at {
            Some(at) => at,
            None => {
                let last = costs.last();
                let found = last.and_then(|row| Found::in_last_row(self.engine, row));
                let Some(found) = found else { return Ok(false) };
                self.cost = found.cost;
                (rows.end - 1, found.column)
            }
        };
        // Invariant: `at` lies on a path of finite cost and is not in `steps` yet.
        // Termination: every step advances a row or a column.
        while at.0 >= rows.start {
            self.steps.push(at);
            match self.engine.origin(&record, at) {
                Some(origin) => at = origin,
                None => return Ok(false),
            }
        }
        self.at = Some(at);
        Ok(true)
    }
}
