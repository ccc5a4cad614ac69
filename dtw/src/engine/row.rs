use std::ops::Range;

use crate::DtwError;

/// Accumulated costs of a row's columns; infinite beside them.
#[derive(Debug, Clone)]
pub(crate) struct Row<T> {
    /// Column of the first cost. Columns are counted from one here, so that 0 is the column before
    /// the first.
    start: usize,
    costs: Vec<T>,
}

impl<T: num_traits::Float> Row<T> {
    /// No path leads to this row.
    pub(crate) fn unreachable() -> Self {
        Self {
            start: 0,
            costs: Vec::new(),
        }
    }

    /// Row -1: paths start at no cost before column 0, or before any column.
    pub(crate) fn before_the_first(is_open: bool, n_columns: usize) -> Result<Self, DtwError> {
        let mut row = Self::unreachable();
        row.reset(0..1)?;
        if is_open {
            row.start = 0;
            row.resize(n_columns)?;
        }
        row.costs.fill(T::zero());
        Ok(row)
    }

    /// Infinite costs of `columns`, counted from one.
    fn reset(&mut self, columns: Range<usize>) -> Result<(), DtwError> {
        self.start = columns.start;
        self.costs.clear();
        self.resize(columns.len())
    }

    /// Infinite costs of `columns`.
    pub(crate) fn clear(&mut self, columns: Range<usize>) -> Result<(), DtwError> {
        self.reset(columns.start + 1..columns.end + 1)
    }

    fn resize(&mut self, len: usize) -> Result<(), DtwError> {
        let more = len.saturating_sub(self.costs.len());
        self.costs
            .try_reserve(more)
            .map_err(|_| DtwError::TooLarge {
                rows: 1,
                columns: len,
            })?;
        self.costs.resize(len, T::infinity());
        Ok(())
    }

    pub(crate) fn get(&self, column: usize) -> T {
        self.shifted(column + 1)
    }

    /// Cost of the column `back` before `column`; there is one column before the first.
    pub(crate) fn back(&self, column: usize, back: usize) -> T {
        (column + 1)
            .checked_sub(back)
            .map_or_else(T::infinity, |nth| self.shifted(nth))
    }

    /// Whether every cost is above `limit`.
    pub(crate) fn exceeds(&self, limit: T) -> bool {
        self.costs
            .iter()
            .all(|&cost| cost > limit || cost.is_infinite())
    }

    fn shifted(&self, column: usize) -> T {
        let nth = column.checked_sub(self.start);
        nth.and_then(|nth| self.costs.get(nth).copied())
            .unwrap_or_else(T::infinity)
    }

    /// Costs of the columns `back` before `first` and its successors into `costs`.
    pub(crate) fn copy_to(&self, (first, back): (usize, usize), costs: &mut [T]) {
        // Columns counted from one, so that nothing is below zero but what lies before the first.
        let skipped = back.saturating_sub(first + 1).min(costs.len());
        let (outside, costs) = costs.split_at_mut(skipped);
        outside.fill(T::infinity());
        let from = (first + 1).saturating_sub(back);
        let (start, end) = (self.start, self.start + self.costs.len());
        let (low, high) = (start.max(from), end.min(from + costs.len()));
        if low >= high {
            costs.fill(T::infinity());
            return;
        }
        costs[..low - from].fill(T::infinity());
        costs[low - from..high - from].copy_from_slice(&self.costs[low - start..high - start]);
        costs[high - from..].fill(T::infinity());
    }

    /// Sets the column's cost if the row has the column.
    pub(crate) fn set(&mut self, column: usize, cost: T) {
        let nth = (column + 1).checked_sub(self.start);
        if let Some(slot) = nth.and_then(|nth| self.costs.get_mut(nth)) {
            *slot = cost;
        }
    }

    /// Costs of [`Self::clear`]'s columns.
    pub(crate) fn costs_mut(&mut self) -> &mut [T] {
        &mut self.costs
    }

    /// The cheapest column and its cost, the first of equals; `None` when none is reached.
    pub(crate) fn cheapest(&self) -> Option<(usize, T)> {
        let mut best = None;
        for (nth, &cost) in self.costs.iter().enumerate() {
            if cost.is_finite() && best.is_none_or(|(_, least)| cost < least) {
                best = Some((self.start + nth, cost));
            }
        }
        best.and_then(|(column, cost)| Some((column.checked_sub(1)?, cost)))
    }
}
