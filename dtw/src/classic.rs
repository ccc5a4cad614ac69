//! D(i,j) = C(i,j) + min(D(i-1,j-1), D(i,j-1), D(i-1,j)), with C the local cost of rows i (first
//! sequence) and columns j (second), N rows and M columns.

use ndarray::ArrayView2;

use crate::{BandRadius, DtwError, LocalCost, WarpingPath};

/// Dynamic time warping with steps (1,1), (0,1), (1,0) of weight 1.
///
/// Among paths of equal cost the one chosen is fixed: seen from its end, it goes back by (1,1)
/// where that is as cheap as any, else by (0,1), the second sequence's step, and last by (1,0).
///
/// ```
/// use dtw::ndarray::array;
/// use dtw::{Dtw, LocalCost};
///
/// let dtw = Dtw::default().with_local_cost(LocalCost::Manhattan);
/// let (a, b) = (array![[0.0_f32, 1.0]], array![[2.0_f32, 0.0], [0.0, 1.0]]);
/// assert_eq!(dtw.distance(a.view(), b.view())?, Some(3.0));
/// # Ok::<(), dtw::DtwError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Dtw {
    band: BandRadius,
    local: LocalCost,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Step {
    Diagonal,
    Second,
    First,
}

impl Dtw {
    /// Warping inside `band`, with Euclidean local costs.
    pub fn new(band: BandRadius) -> Self {
        Self {
            band,
            local: LocalCost::default(),
        }
    }

    /// The same band with another local cost.
    #[must_use]
    pub fn with_local_cost(self, local: LocalCost) -> Self {
        Self { local, ..self }
    }

    /// Cost of the cheapest path; `None` when there is no path.
    ///
    /// # Errors
    ///
    /// [`DtwError::Dimensions`] when the sequences' dimensions differ, [`DtwError::TooLarge`] when
    /// one row of costs does not fit in memory.
    pub fn distance<T: Copy + Into<f64>>(
        &self,
        a: ArrayView2<'_, T>,
        b: ArrayView2<'_, T>,
    ) -> Result<Option<f64>, DtwError> {
        check_dimensions(&a, &b)?;
        let cost = |i, j| self.local.between(a.row(i), b.row(j));
        self.distance_with(a.nrows(), b.nrows(), cost)
    }

    /// The cheapest path; `None` when there is none.
    ///
    /// # Errors
    ///
    /// As [`Self::distance`], with [`DtwError::TooLarge`] also when the band's cells do not fit in
    /// memory.
    pub fn align<T: Copy + Into<f64>>(
        &self,
        a: ArrayView2<'_, T>,
        b: ArrayView2<'_, T>,
    ) -> Result<Option<WarpingPath>, DtwError> {
        check_dimensions(&a, &b)?;
        let cost = |i, j| self.local.between(a.row(i), b.row(j));
        self.align_with(a.nrows(), b.nrows(), cost)
    }

    /// [`Self::distance`] of two sequences of `n` and `m` frames whose local costs are `cost(i, j)`.
    ///
    /// `cost` is called once for each cell of the band, row by row. A cost that is not finite
    /// closes its cell.
    ///
    /// # Errors
    ///
    /// [`DtwError::TooLarge`] as above.
    pub fn distance_with(
        &self,
        n: usize,
        m: usize,
        cost: impl FnMut(usize, usize) -> f64,
    ) -> Result<Option<f64>, DtwError> {
        accumulate(self.band, (n, m), cost, |_, _, _| ())
    }

    /// [`Self::align`] of two sequences of `n` and `m` frames whose local costs are `cost(i, j)`.
    ///
    /// ```
    /// let path = dtw::Dtw::default().align_with(2, 3, |i, j| i.abs_diff(j) as f64)?;
    /// assert_eq!(path.expect("a path exists").steps, [(0, 0), (1, 1), (1, 2)]);
    /// # Ok::<(), dtw::DtwError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`DtwError::TooLarge`] as above.
    pub fn align_with(
        &self,
        n: usize,
        m: usize,
        cost: impl FnMut(usize, usize) -> f64,
    ) -> Result<Option<WarpingPath>, DtwError> {
        if !reaches_the_end(self.band, n, m) {
            return Ok(None);
        }
        let width = self.band.width(m);
        let too_large = DtwError::TooLarge {
            rows: n,
            columns: width,
        };
        let n_cells = n.checked_mul(width).ok_or(too_large)?;
        let mut came_by = filled(n_cells, Step::Diagonal).ok_or(too_large)?;
        let cell = |i: usize, j: usize| i * width + j - self.band.columns(i, m).start;
        let end_cost = accumulate(self.band, (n, m), cost, |i, j, step| {
            came_by[cell(i, j)] = step
        })?;
        let Some(cost) = end_cost else {
            return Ok(None);
        };

        let (mut i, mut j) = (n - 1, m - 1);
        let mut steps = vec![(i, j)];
        // Invariant: (i, j) lies on a path of finite cost. Termination: i + j shrinks.
        while (i, j) != (0, 0) {
            match came_by[cell(i, j)] {
                Step::Diagonal => (i, j) = (i - 1, j - 1),
                Step::Second => j -= 1,
                Step::First => i -= 1,
            }
            steps.push((i, j));
        }
        steps.reverse();
        Ok(Some(WarpingPath { steps, cost }))
    }
}

/// D(N-1,M-1); tells `record` of every open cell and the step that led there.
fn accumulate(
    band: BandRadius,
    (n, m): (usize, usize),
    mut cost: impl FnMut(usize, usize) -> f64,
    mut record: impl FnMut(usize, usize, Step),
) -> Result<Option<f64>, DtwError> {
    if !reaches_the_end(band, n, m) {
        return Ok(None);
    }
    let mut row = filled(m, f64::INFINITY).ok_or(DtwError::TooLarge {
        rows: 1,
        columns: m,
    })?;
    for i in 0..n {
        let columns = band.columns(i, m);
        // Invariant: at column j, row[j..] holds D(i-1,·), row[..j] holds D(i,·), diagonal holds
        // D(i-1,j-1); cells outside the band are infinite. Before the first row stands D(-1,-1) = 0.
        let mut diagonal = if i == 0 { 0.0 } else { f64::INFINITY };
        let mut left = f64::INFINITY;
        if let Some(before) = columns.start.checked_sub(1) {
            diagonal = std::mem::replace(&mut row[before], f64::INFINITY);
        }
        for j in columns {
            let up = row[j];
            let (mut best, mut step) = (diagonal, Step::Diagonal);
            if left < best {
                (best, step) = (left, Step::Second);
            }
            if up < best {
                (best, step) = (up, Step::First);
            }
            let local = cost(i, j);
            left = if local.is_finite() {
                best + local
            } else {
                f64::INFINITY
            };
            if left.is_finite() {
                record(i, j, step);
            }
            row[j] = left;
            diagonal = up;
        }
    }
    Ok(Some(row[m - 1]).filter(|cost| cost.is_finite()))
}

fn reaches_the_end(band: BandRadius, n: usize, m: usize) -> bool {
    n > 0 && m > 0 && band.columns(n - 1, m).contains(&(m - 1))
}

fn filled<T: Copy>(length: usize, value: T) -> Option<Vec<T>> {
    let mut cells = Vec::new();
    cells.try_reserve_exact(length).ok()?;
    cells.resize(length, value);
    Some(cells)
}

fn check_dimensions<T>(a: &ArrayView2<'_, T>, b: &ArrayView2<'_, T>) -> Result<(), DtwError> {
    if a.ncols() == b.ncols() {
        Ok(())
    } else {
        Err(DtwError::Dimensions {
            a: a.ncols(),
            b: b.ncols(),
        })
    }
}
