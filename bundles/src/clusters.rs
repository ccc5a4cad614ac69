use ndarray::{Array1, Array2, ArrayView1, ArrayView2, Zip};

use crate::{BundlesError, Letter};

/// The isotropic Gaussian of each letter.
#[derive(Debug, Clone, PartialEq)]
pub struct PoseClusters {
    means: Array2<f64>,
    sigmas: Array1<f64>,
}

impl PoseClusters {
    /// Clusters with `means` of shape `(letters, dims)` and a standard deviation for each letter.
    ///
    /// # Errors
    ///
    /// When the two disagree on the number of letters, a mean is not finite, or a standard
    /// deviation is not positive and finite.
    pub fn new(
        means: ArrayView2<'_, f64>,
        sigmas: ArrayView1<'_, f64>,
    ) -> Result<Self, BundlesError> {
        if means.nrows() != sigmas.len() {
            let (means, sigmas) = (means.nrows(), sigmas.len());
            return Err(BundlesError::Letters { means, sigmas });
        }
        for ((letter, _), &found) in means.indexed_iter() {
            if !found.is_finite() {
                return Err(BundlesError::Mean { letter, found });
            }
        }
        for (letter, &found) in sigmas.iter().enumerate() {
            if !(found > 0.0 && found.is_finite()) {
                return Err(BundlesError::Sigma { letter, found });
            }
        }
        Ok(Self {
            means: means.to_owned(),
            sigmas: sigmas.to_owned(),
        })
    }

    /// Number of letters κ.
    pub fn n_letters(&self) -> usize {
        self.sigmas.len()
    }

    /// Distance d(a, b) = ‖µ_b - µ_a‖ / min(σ_a, σ_b): the larger of the two letters' Mahalanobis
    /// distances to the other's mean (equation 1). `None` for a letter without a cluster.
    pub fn distance(&self, a: Letter, b: Letter) -> Option<f64> {
        let (row_a, row_b) = (self.row(a)?, self.row(b)?);
        let mut squares = 0.0;
        Zip::from(self.means.row(row_a))
            .and(self.means.row(row_b))
            .for_each(|a, b| squares += (b - a).powi(2));
        Some(squares.sqrt() / self.sigmas[row_a].min(self.sigmas[row_b]))
    }

    fn row(&self, letter: Letter) -> Option<usize> {
        usize::try_from(letter.label())
            .ok()
            .filter(|&row| row < self.n_letters())
    }
}
