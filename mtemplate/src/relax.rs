//! The recurrence over a run of cells that do not depend on each other. D(1,l) = c(1,l), and for
//! k > 1 D(k,l) = min(D(k-1,l-1) + c(k,l), D(k-1,l-2) + c(k,l), D(k-2,l-1) + w c(k,l)), with c the
//! local cost of template column k and data frame l, and w the weight of a step that skips a
//! column. Ties go to the first of the three.
//!
//! A run lies along the frames of one column, or along the columns of one frame.

/// Costs of paths to the cells that a run of cells is reached from.
#[derive(Clone, Copy)]
pub(crate) struct From<'a> {
    /// By a step (1,1).
    pub(crate) ahead: &'a [u32],
    /// By a step (1,2), over a frame.
    pub(crate) over_a_frame: &'a [u32],
    /// By a step (2,1), over a column.
    pub(crate) over_a_column: &'a [u32],
}

impl<'a> From<'a> {
    #[inline(always)]
    fn ways(self) -> impl Iterator<Item = [u32; 3]> + 'a {
        let along = self
            .ahead
            .iter()
            .zip(self.over_a_frame)
            .zip(self.over_a_column);
        along.map(|((ahead, by_frame), by_column)| [*ahead, *by_frame, *by_column])
    }
}

/// Costs of paths to the cells `to`, with `local` the cells' own costs and `skip` as in
/// [`FixedCosts`](crate::fixed::FixedCosts).
#[inline(always)]
pub(crate) fn costs(to: &mut [u32], from: From<'_>, skip: u32, local: impl Iterator<Item = u32>) {
    for ((to, [ahead, by_frame, by_column]), cost) in to.iter_mut().zip(from.ways()).zip(local) {
        *to = ahead.min(by_frame).min(by_column + (cost & skip)) + cost;
    }
}

/// Starts of these paths: `from` the costs, and `begun` the starts, of the paths to where they come
/// from.
///
/// A loop of its own, because a loop with fewer places to write to is known to be free of overlaps
/// and made of vectors.
#[inline(always)]
pub(crate) fn starts(
    to: &mut [u32],
    from: From<'_>,
    begun: From<'_>,
    skip: u32,
    local: impl Iterator<Item = u32>,
) {
    let ways = from.ways().zip(begun.ways()).zip(local);
    for (to, (([ahead, by_frame, by_column], begun), cost)) in to.iter_mut().zip(ways) {
        let first = if by_frame < ahead { begun[1] } else { begun[0] };
        let is_skip = by_column + (cost & skip) < ahead.min(by_frame);
        *to = if is_skip { begun[2] } else { first };
    }
}
