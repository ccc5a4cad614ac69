//! Principal components of standardised pose vectors.

use std::ops::Range;

use nalgebra::{DMatrix, SymmetricEigen};
use ndarray::{Array1, Array2, ArrayView2, Axis, s};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::parallel;

/// A dimension whose values differ by no more than this share of the largest number of any dimension
/// is constant but for rounding: a few thousand units in the last place. Any dimension, because the
/// angles of a pose are computed from each other: a clavicle that is fixed at 0 degrees is recorded as
/// 1e-14 degrees of noise, and would be standardised to as much as the swing of an arm.
const CONSTANT: f64 = 1e-12;

/// Elements of a component whose magnitudes differ by no more than this share are equal but for the
/// rounding of the eigenvalue iteration.
const EQUAL: f64 = 1e-9;

/// Of the total variance: so much may be missing from the share that is asked for, as sums of
/// variances are rounded.
const MISSING: f64 = 1e-12;

/// Frames whose products are summed together.
const CHUNK: usize = 4096;

/// Why frames have no principal components, or cannot be projected on them.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum PcaError {
    /// There is nothing to take the components of.
    #[error("expected at least one frame, found none")]
    NoFrames,
    /// A number of a frame is infinite or NaN.
    #[error("frame {frame}, dimension {dim}: expected a finite number, found {found}")]
    NotFinite {
        /// The frame.
        frame: usize,
        /// The dimension.
        dim: usize,
        /// The number.
        found: f64,
    },
    /// The variance of a dimension overflows.
    #[error("dimension {dim}: expected a finite variance, found {found}")]
    Variance {
        /// The dimension.
        dim: usize,
        /// What the sum of squares came to.
        found: f64,
    },
    /// A share of the variance is not in `(0, 1]`.
    #[error("expected a share of the variance above 0 and up to 1, found {found}")]
    Share {
        /// The share.
        found: f64,
    },
    /// The frames have other dimensions than those that the components are of.
    #[error("expected frames of {expected} dimensions, found {found}")]
    Dimensions {
        /// Dimensions there should be.
        expected: usize,
        /// Dimensions of the frames.
        found: usize,
    },
    /// Stored parts that do not belong together.
    #[error("expected the parts of one set of components, found {found}")]
    Stored {
        /// What is wrong.
        found: &'static str,
    },
}

/// The share of the total variance that the paper keeps.
pub const PAPER_SHARE: f64 = 0.7;

/// Standardisation and principal components of the frames they were fitted to, for these and
/// further frames.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Stored")]
pub struct Pca {
    /// Dimensions that vary, ascending.
    varying: Vec<usize>,
    /// Of all dimensions.
    means: Array1<f64>,
    /// Standard deviations of the dimensions that vary.
    sigmas: Array1<f64>,
    /// Variances along all components, descending.
    variances: Array1<f64>,
    /// `(components, varying dimensions)`, orthonormal.
    components: Array2<f64>,
}

/// Components as read, before anybody has checked them.
#[derive(Deserialize)]
struct Stored {
    varying: Vec<usize>,
    means: Array1<f64>,
    sigmas: Array1<f64>,
    variances: Array1<f64>,
    components: Array2<f64>,
}

impl TryFrom<Stored> for Pca {
    type Error = PcaError;

    fn try_from(stored: Stored) -> Result<Self, PcaError> {
        let Stored {
            varying,
            means,
            sigmas,
            variances,
            components,
        } = stored;
        let n_varying = varying.len();
        let is_ascending = varying.is_sorted_by(|a, b| a < b);
        let numbers = means.iter().chain(&sigmas).chain(&variances);
        let found = if !is_ascending || varying.last().is_some_and(|&dim| dim >= means.len()) {
            "dimensions out of order or range"
        } else if [sigmas.len(), variances.len(), components.ncols()] != [n_varying; 3]
            || components.nrows() > n_varying
        {
            "parts of different shapes"
        } else if !numbers.chain(&components).all(|x| x.is_finite())
            || sigmas.iter().any(|sigma| *sigma <= 0.0)
        {
            "numbers that are not finite or no standard deviations"
        } else {
            return Ok(Self {
                varying,
                means,
                sigmas,
                variances,
                components,
            });
        };
        Err(PcaError::Stored { found })
    }
}

impl Pca {
    /// The fewest components with at least `share` of the total variance of `frames`, of shape
    /// `(frames, dims)`, once each dimension has mean 0 and population variance 1.
    ///
    /// Dimensions that do not vary, but for rounding, are left out: those whose values differ by at
    /// most 1e-12 of the largest magnitude in `frames`. Components are ordered by
    /// descending variance; of the elements of largest magnitude in each the first is positive.
    /// Frames that are all equal have no component.
    ///
    /// # Errors
    ///
    /// When there are no frames, a number or a variance is not finite, or the share is not in
    /// `(0, 1]`.
    pub fn fit(frames: ArrayView2<'_, f64>, share: f64) -> Result<Self, PcaError> {
        if !(share > 0.0 && share <= 1.0) {
            return Err(PcaError::Share { found: share });
        }
        check_finite(frames)?;
        let standard = Standard::of(frames)?;
        let (variances, mut components) = standard.eigen(frames);
        let wanted = share * variances.sum() * (1.0 - MISSING);
        let mut kept = 0.0;
        let n_kept = variances.iter().take_while(|variance| {
            let is_needed = kept < wanted;
            kept += **variance;
            is_needed
        });
        let n_kept = n_kept.count();
        components = components.slice(s![..n_kept, ..]).to_owned();
        Ok(Self {
            varying: standard.varying,
            means: standard.means,
            sigmas: standard.sigmas,
            variances,
            components,
        })
    }

    /// Dimensions of the frames.
    pub fn dims(&self) -> usize {
        self.means.len()
    }

    /// Dimensions that vary in the frames of the fit, ascending.
    pub fn varying_dims(&self) -> &[usize] {
        &self.varying
    }

    /// Number of components that are kept.
    pub fn n_components(&self) -> usize {
        self.components.nrows()
    }

    /// The components that are kept, of shape `(components, varying dimensions)`, each of length 1.
    pub fn components(&self) -> ArrayView2<'_, f64> {
        self.components.view()
    }

    /// Variances along all components, kept or not, descending; they add up to the number of
    /// varying dimensions.
    pub fn variances(&self) -> &Array1<f64> {
        &self.variances
    }

    /// The share of the variance that the kept components have; 1 where nothing varies.
    pub fn share(&self) -> f64 {
        let all = self.variances.sum();
        if all == 0.0 {
            return 1.0;
        }
        self.variances.slice(s![..self.n_components()]).sum() / all
    }

    /// Coordinates of `frames`, of shape `(frames, dims)`, along the components:
    /// `(frames, components)`. The unit is one standard deviation of a dimension.
    ///
    /// # Errors
    ///
    /// When the dimensions differ or a number is not finite.
    pub fn project(&self, frames: ArrayView2<'_, f64>) -> Result<Array2<f64>, PcaError> {
        check_dims(self.dims(), frames)?;
        check_finite(frames)?;
        let chunks = chunks(frames.nrows());
        let parts = parallel::map(&chunks, |_, chunk| {
            let frames = frames.slice(s![chunk.clone(), ..]);
            standardised(frames, &self.varying, &self.means, &self.sigmas).dot(&self.components.t())
        });
        let mut projected = Array2::zeros((frames.nrows(), self.n_components()));
        for (chunk, part) in chunks.into_iter().zip(parts) {
            projected.slice_mut(s![chunk, ..]).assign(&part);
        }
        Ok(projected)
    }

    /// Frames, of shape `(frames, dims)`, whose coordinates are `projected`, of shape
    /// `(frames, components)`; dimensions that do not vary have their mean.
    ///
    /// # Errors
    ///
    /// When the number of components differs or a number is not finite.
    pub fn reconstruct(&self, projected: ArrayView2<'_, f64>) -> Result<Array2<f64>, PcaError> {
        check_dims(self.n_components(), projected)?;
        check_finite(projected)?;
        let standard = projected.dot(&self.components);
        let shape = (projected.nrows(), self.dims());
        let mut frames = Array2::from_shape_fn(shape, |(_, dim)| self.means[dim]);
        for (place, (&dim, sigma)) in self.varying.iter().zip(&self.sigmas).enumerate() {
            let mut column = frames.column_mut(dim);
            column.scaled_add(*sigma, &standard.column(place));
        }
        Ok(frames)
    }
}

/// Means and standard deviations.
struct Standard {
    varying: Vec<usize>,
    means: Array1<f64>,
    sigmas: Array1<f64>,
}

impl Standard {
    fn of(frames: ArrayView2<'_, f64>) -> Result<Self, PcaError> {
        if frames.nrows() == 0 {
            return Err(PcaError::NoFrames);
        }
        let mut standard = Self {
            varying: Vec::new(),
            means: Array1::zeros(frames.ncols()),
            sigmas: Array1::zeros(0),
        };
        let mut sigmas = Vec::new();
        let largest = frames.fold(0.0_f64, |most, x| most.max(x.abs()));
        let share = 1.0 / frames.nrows() as f64;
        for (dim, column) in frames.columns().into_iter().enumerate() {
            // Differences from one frame are small, whatever the distance from zero.
            let first = column[0];
            let least = column.iter().copied().fold(first, f64::min);
            let most = column.iter().copied().fold(first, f64::max);
            let mean = first + column.iter().map(|x| (x - first) * share).sum::<f64>();
            standard.means[dim] = mean;
            if most - least <= CONSTANT * largest {
                continue;
            }
            let squares = column.iter().map(|x| (x - mean) * (x - mean));
            let variance = squares.map(|square| square * share).sum::<f64>();
            let sigma = variance.sqrt();
            if !sigma.is_finite() {
                let found = variance;
                return Err(PcaError::Variance { dim, found });
            }
            // Squares may underflow.
            if sigma > 0.0 {
                standard.varying.push(dim);
                sigmas.push(sigma);
            }
        }
        standard.sigmas = Array1::from(sigmas);
        Ok(standard)
    }

    /// Eigenvalues of the correlation matrix, descending, and eigenvectors as rows.
    fn eigen(&self, frames: ArrayView2<'_, f64>) -> (Array1<f64>, Array2<f64>) {
        let n = self.varying.len();
        if n == 0 {
            return (Array1::zeros(0), Array2::zeros((0, 0)));
        }
        let parts = parallel::map(&chunks(frames.nrows()), |_, chunk| {
            let frames = frames.slice(s![chunk.clone(), ..]);
            let standard = standardised(frames, &self.varying, &self.means, &self.sigmas);
            standard.t().dot(&standard)
        });
        let mut sums = Array2::<f64>::zeros((n, n));
        parts.iter().for_each(|part| sums += part);
        let share = 1.0 / frames.nrows() as f64;
        // Products are summed in another order below the diagonal.
        let matrix = DMatrix::from_fn(n, n, |i, j| sums[[i.max(j), i.min(j)]] * share);
        let eigen = SymmetricEigen::new(matrix);
        let mut order: Vec<usize> = (0..n).collect();
        order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
        let mut vectors = Array2::from_shape_fn((n, n), |(i, j)| eigen.eigenvectors[(j, order[i])]);
        for mut vector in vectors.axis_iter_mut(Axis(0)) {
            let largest = vector.fold(0.0_f64, |most, x| most.max(x.abs()));
            let first = vector.iter().find(|x| x.abs() >= largest * (1.0 - EQUAL));
            if first.is_some_and(|x| *x < 0.0) {
                vector.mapv_inplace(|x| -x);
            }
        }
        // A variance of nothing may come out as less than nothing.
        let values = order.iter().map(|&i| eigen.eigenvalues[i].max(0.0));
        (values.collect(), vectors)
    }
}

/// The varying dimensions of frames, with mean 0 and variance 1.
fn standardised(
    frames: ArrayView2<'_, f64>,
    varying: &[usize],
    means: &Array1<f64>,
    sigmas: &Array1<f64>,
) -> Array2<f64> {
    Array2::from_shape_fn((frames.nrows(), varying.len()), |(frame, place)| {
        let dim = varying[place];
        (frames[[frame, dim]] - means[dim]) / sigmas[place]
    })
}

fn chunks(n_frames: usize) -> Vec<Range<usize>> {
    let starts = (0..n_frames).step_by(CHUNK);
    starts
        .map(|start| start..(start + CHUNK).min(n_frames))
        .collect()
}

fn check_dims(expected: usize, frames: ArrayView2<'_, f64>) -> Result<(), PcaError> {
    let found = frames.ncols();
    if found == expected {
        Ok(())
    } else {
        Err(PcaError::Dimensions { expected, found })
    }
}

fn check_finite(frames: ArrayView2<'_, f64>) -> Result<(), PcaError> {
    let mut numbers = frames.indexed_iter();
    match numbers.find(|(_, x)| !x.is_finite()) {
        Some(((frame, dim), &found)) => Err(PcaError::NotFinite { frame, dim, found }),
        None => Ok(()),
    }
}
