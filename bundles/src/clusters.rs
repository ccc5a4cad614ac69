use ndarray::{Array1, Array2, ArrayView1, ArrayView2, Zip};
use serde::{Deserialize, Serialize};

use crate::{BundlesError, Letter};

/// The isotropic Gaussian of each letter, and its weight in the mixture of all.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Stored")]
pub struct PoseClusters {
    means: Array2<f64>,
    sigmas: Array1<f64>,
    weights: Array1<f64>,
}

/// Clusters as read, before anybody has checked them.
#[derive(Deserialize)]
struct Stored {
    means: Array2<f64>,
    sigmas: Array1<f64>,
    weights: Array1<f64>,
}

impl TryFrom<Stored> for PoseClusters {
    type Error = BundlesError;

    fn try_from(stored: Stored) -> Result<Self, BundlesError> {
        let checked = Self::new(stored.means.view(), stored.sigmas.view())?;
        check_weights(stored.means.nrows(), stored.weights.view())?;
        Ok(Self {
            weights: stored.weights,
            ..checked
        })
    }
}

impl PoseClusters {
    /// Clusters with `means` of shape `(letters, dims)` and a standard deviation for each letter, all
    /// of equal weight.
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
        let n_letters = sigmas.len();
        Ok(Self {
            means: means.to_owned(),
            sigmas: sigmas.to_owned(),
            weights: Array1::from_elem(n_letters, 1.0 / n_letters.max(1) as f64),
        })
    }

    /// The same clusters with these weights, one for each letter, divided by their sum.
    ///
    /// # Errors
    ///
    /// When there is not one for each letter, one is negative or not finite, or the sum is not
    /// positive and finite.
    pub fn with_weights(self, weights: ArrayView1<'_, f64>) -> Result<Self, BundlesError> {
        let sum = check_weights(self.n_letters(), weights)?;
        let weights = weights.mapv(|weight| weight / sum);
        Ok(Self { weights, ..self })
    }

    /// Number of letters κ.
    pub fn n_letters(&self) -> usize {
        self.sigmas.len()
    }

    /// Means µ, of shape `(letters, dims)`.
    pub fn means(&self) -> ArrayView2<'_, f64> {
        self.means.view()
    }

    /// Standard deviations σ, one for each letter.
    pub fn sigmas(&self) -> ArrayView1<'_, f64> {
        self.sigmas.view()
    }

    /// Weights w, one for each letter; they sum to 1, but for rounding.
    pub fn weights(&self) -> ArrayView1<'_, f64> {
        self.weights.view()
    }

    /// Distances of all letters from each other, of shape `(letters, letters)`: symmetric, with
    /// zeros on the diagonal.
    pub fn distances(&self) -> Array2<f64> {
        let n_letters = self.n_letters();
        let mut distances = Array2::zeros((n_letters, n_letters));
        for (a, b) in (0..n_letters).flat_map(|a| (0..a).map(move |b| (a, b))) {
            let distance = self.distance_of_rows(a, b);
            (distances[[a, b]], distances[[b, a]]) = (distance, distance);
        }
        distances
    }

    /// Distance d(a, b) = ‖µ_b - µ_a‖ / min(σ_a, σ_b): the larger of the two letters' Mahalanobis
    /// distances to the other's mean (equation 1). `None` for a letter without a cluster.
    pub fn distance(&self, a: Letter, b: Letter) -> Option<f64> {
        Some(self.distance_of_rows(self.row(a)?, self.row(b)?))
    }

    fn distance_of_rows(&self, row_a: usize, row_b: usize) -> f64 {
        let mut squares = 0.0;
        Zip::from(self.means.row(row_a))
            .and(self.means.row(row_b))
            .for_each(|a, b| squares += (b - a).powi(2));
        squares.sqrt() / self.sigmas[row_a].min(self.sigmas[row_b])
    }

    fn row(&self, letter: Letter) -> Option<usize> {
        usize::try_from(letter.label())
            .ok()
            .filter(|&row| row < self.n_letters())
    }
}

/// The sum of weights that may be those of `letters` letters.
fn check_weights(letters: usize, weights: ArrayView1<'_, f64>) -> Result<f64, BundlesError> {
    if weights.len() != letters {
        let weights = weights.len();
        return Err(BundlesError::Weights { letters, weights });
    }
    for (letter, &found) in weights.iter().enumerate() {
        if !(found >= 0.0 && found.is_finite()) {
            return Err(BundlesError::Weight { letter, found });
        }
    }
    let found = weights.sum();
    if letters > 0 && !(found > 0.0 && found.is_finite()) {
        return Err(BundlesError::WeightSum { found });
    }
    Ok(found)
}
