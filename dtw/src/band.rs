use std::ops::Range;

/// How far a path may leave `i = j`, in cells (Sakoe–Chiba band).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct BandRadius(usize);

impl BandRadius {
    /// Cells with `|i - j| <= radius`; 0 leaves the diagonal alone.
    pub const fn cells(radius: usize) -> Self {
        Self(radius)
    }

    /// Every cell.
    pub const fn full() -> Self {
        Self(usize::MAX)
    }

    /// The radius in cells; `None` when nothing is cut off.
    pub const fn radius(self) -> Option<usize> {
        if self.0 == usize::MAX {
            None
        } else {
            Some(self.0)
        }
    }

    /// Columns of `row` inside the band, of `n_columns` in all; empty past its end.
    pub(crate) fn columns(self, row: usize, n_columns: usize) -> Range<usize> {
        let end = row.saturating_add(self.0).saturating_add(1).min(n_columns);
        row.saturating_sub(self.0).min(end)..end
    }

    /// Columns of the widest row.
    pub(crate) fn width(self, n_columns: usize) -> usize {
        self.0.saturating_mul(2).saturating_add(1).min(n_columns)
    }
}

impl Default for BandRadius {
    fn default() -> Self {
        Self::full()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_stay_inside_the_row() {
        assert_eq!(BandRadius::cells(0).columns(3, 5), 3..4);
        assert_eq!(BandRadius::cells(2).columns(1, 5), 0..4);
        assert_eq!(BandRadius::cells(2).columns(4, 5), 2..5);
        assert!(BandRadius::cells(1).columns(9, 5).is_empty());
        assert_eq!(BandRadius::full().columns(usize::MAX, 5), 0..5);
    }

    #[test]
    fn width_is_at_most_the_row() {
        assert_eq!(BandRadius::cells(2).width(9), 5);
        assert_eq!(BandRadius::cells(2).width(3), 3);
        assert_eq!(BandRadius::full().width(3), 3);
    }

    #[test]
    fn full_has_no_radius() {
        assert_eq!(BandRadius::full().radius(), None);
        assert_eq!(BandRadius::cells(7).radius(), Some(7));
    }
}
