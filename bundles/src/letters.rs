//! A: which letters count as equal (equation 2), with the distances that order candidates.

use ndarray::ArrayView2;
use thiserror::Error;

use crate::Letter;

/// The accessibility matrix A of all letters, and the distances it comes from.
///
/// Letters are near each other when their distance is at most τ. The relation is reflexive and
/// symmetric, and not transitive.
#[derive(Debug, Clone, PartialEq)]
pub struct Accessibility {
    n_letters: usize,
    distances: Vec<f64>,
    /// One row of bits for each letter, letter 0 in the lowest bit of the first word.
    near: Vec<u64>,
    tau: f64,
}

/// Why distances do not make an accessibility matrix.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum AccessibilityError {
    /// The distances are no square.
    #[error("expected as many columns as rows, found {rows} rows and {columns} columns")]
    Square {
        /// Number of rows.
        rows: usize,
        /// Number of columns.
        columns: usize,
    },
    /// A distance is negative or not finite, or a letter is away from itself.
    #[error("letters {a} and {b}: expected a finite distance, 0 if they are one, found {found}")]
    Distance {
        /// The row.
        a: usize,
        /// The column.
        b: usize,
        /// Their distance.
        found: f64,
    },
    /// Two letters are not as far from each other both ways.
    #[error("letters {a} and {b}: expected the distance {expected} both ways, found {found}")]
    Symmetry {
        /// The row.
        a: usize,
        /// The column.
        b: usize,
        /// The distance from b to a.
        expected: f64,
        /// The distance from a to b.
        found: f64,
    },
    /// The threshold is negative or not finite.
    #[error("expected a finite threshold of at least 0, found {found}")]
    Threshold {
        /// The threshold.
        found: f64,
    },
}

impl Accessibility {
    /// The matrix of all letters up to `tau` apart, from `distances` of shape `(letters, letters)`.
    ///
    /// Takes O(letters²) time and memory.
    ///
    /// # Errors
    ///
    /// When `distances` are not square, finite, symmetric and 0 on the diagonal, or `tau` is
    /// negative or not finite.
    pub fn new(distances: ArrayView2<'_, f64>, tau: f64) -> Result<Self, AccessibilityError> {
        let (rows, columns) = distances.dim();
        if rows != columns {
            return Err(AccessibilityError::Square { rows, columns });
        }
        if !(tau.is_finite() && tau >= 0.0) {
            return Err(AccessibilityError::Threshold { found: tau });
        }
        let words = rows.div_ceil(64);
        let mut near = vec![0; rows * words];
        for ((a, b), &found) in distances.indexed_iter() {
            if !(found.is_finite() && found >= 0.0) || (a == b && found != 0.0) {
                return Err(AccessibilityError::Distance { a, b, found });
            }
            let expected = distances[[b, a]];
            if b < a && found != expected {
                return Err(AccessibilityError::Symmetry {
                    a,
                    b,
                    expected,
                    found,
                });
            }
            if found <= tau {
                near[a * words + b / 64] |= 1 << (b % 64);
            }
        }
        Ok(Self {
            n_letters: rows,
            distances: distances.iter().copied().collect(),
            near,
            tau,
        })
    }

    /// Number of letters κ.
    pub fn n_letters(&self) -> usize {
        self.n_letters
    }

    /// The threshold τ.
    pub fn tau(&self) -> f64 {
        self.tau
    }

    /// Whether A\[a, b\] is 1; `None` for a letter outside the matrix.
    pub fn is_near(&self, a: Letter, b: Letter) -> Option<bool> {
        let (a, b) = (self.row(a)?, self.row(b)?);
        Some(self.near_row(a)[b / 64] >> (b % 64) & 1 == 1)
    }

    /// Their distance d(a, b); `None` for a letter outside the matrix.
    pub fn distance(&self, a: Letter, b: Letter) -> Option<f64> {
        let (a, b) = (self.row(a)?, self.row(b)?);
        Some(self.distance_row(a)[b])
    }

    /// The letters near letter `a`, as bits.
    pub(crate) fn near_row(&self, a: usize) -> &[u64] {
        let words = self.n_letters.div_ceil(64);
        &self.near[a * words..][..words]
    }

    /// The distances of letter `a` to all letters.
    pub(crate) fn distance_row(&self, a: usize) -> &[f64] {
        &self.distances[a * self.n_letters..][..self.n_letters]
    }

    fn row(&self, letter: Letter) -> Option<usize> {
        let row = usize::try_from(letter.label()).ok()?;
        (row < self.n_letters).then_some(row)
    }
}
