//! Other templates warped onto a reference, and the average of all (section 4.1).

use ndarray::{Array1, Array2};
use pulp::{Arch, Simd, WithSimd};

use crate::{MotionTemplate, TemplateError};

/// Columns with weights, one after the other.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Weighted {
    pub(super) n_features: usize,
    pub(super) values: Vec<f64>,
    pub(super) weights: Vec<f64>,
}

impl Weighted {
    pub(super) fn columns(&self) -> impl Iterator<Item = (&[f64], f64)> {
        let columns = self.values.chunks_exact(self.n_features);
        columns.zip(self.weights.iter().copied())
    }

    /// Appends a column.
    pub(super) fn push(&mut self, column: &[f64], weight: f64) {
        self.values.extend_from_slice(column);
        self.weights.push(weight);
    }

    pub(super) fn into_template(self) -> Result<MotionTemplate, TemplateError> {
        let shape = (self.weights.len(), self.n_features);
        let values = Array2::from_shape_vec(shape, self.values).expect("a value for each feature");
        MotionTemplate::new(values, Array1::from(self.weights))
    }
}

/// Sums over templates that are warped onto the columns of one of them.
#[derive(Debug)]
pub(super) struct Average {
    sums: Weighted,
    n_templates: usize,
    /// The column that is being warped.
    warped: Vec<f64>,
    /// For each column of the warped template, the number of reference columns it is matched to.
    n_partners: Vec<u32>,
}

impl Average {
    pub(super) fn onto(reference: &MotionTemplate) -> Self {
        let (n_columns, n_features) = reference.values().dim();
        let sums = Weighted {
            n_features,
            values: vec![0.0; n_columns * n_features],
            weights: vec![0.0; n_columns],
        };
        Self {
            sums,
            n_templates: 0,
            warped: vec![0.0; n_features],
            n_partners: Vec::new(),
        }
    }

    /// Adds the reference itself.
    pub(super) fn add_reference(&mut self, reference: &MotionTemplate) {
        let sums = self.sums.values.chunks_exact_mut(self.sums.n_features);
        let sums = sums.zip(&mut self.sums.weights);
        let columns = reference.values();
        let columns = columns.outer_iter().zip(reference.weights());
        for ((sums, total), (column, &weight)) in sums.zip(columns) {
            for (sum, value) in sums.iter_mut().zip(column) {
                *sum += weight * value;
            }
            *total += weight;
        }
        self.n_templates += 1;
    }

    /// Adds a template along a path of (reference column, column of the template).
    ///
    /// The column for k is the mean of those matched to k by weight; its weight is the sum of
    /// α(ℓ)/n(ℓ) over them, where n(ℓ) columns of the reference share column ℓ, so that the
    /// template's whole weight is kept.
    pub(super) fn add(
        &mut self,
        template: &MotionTemplate,
        path: impl Iterator<Item = (usize, usize)> + Clone,
    ) {
        self.n_partners.clear();
        self.n_partners.resize(template.n_columns(), 0);
        for (_, column) in path.clone() {
            self.n_partners[column] += 1;
        }
        // Owned arrays may have any order in memory; nearly all have this one already.
        let (values, weights) = (template.values(), template.weights());
        let (values, weights) = (values.as_standard_layout(), weights.as_standard_layout());
        let values = values.as_slice().expect("in standard layout");
        let weights = weights.as_slice().expect("in standard layout");
        Arch::new().dispatch(Add {
            average: self,
            values,
            weights,
            path,
        });
        self.n_templates += 1;
    }

    #[inline(always)]
    fn sweep(
        &mut self,
        values: &[f64],
        weights: &[f64],
        path: impl Iterator<Item = (usize, usize)>,
    ) {
        let n_features = self.sums.n_features;
        let mut at = 0;
        let (mut matched, mut share) = (0.0, 0.0);
        self.warped.fill(0.0);
        for (to, from) in path {
            if to != at {
                self.flush(at, matched, share);
                (at, matched, share) = (to, 0.0, 0.0);
                self.warped.fill(0.0);
            }
            let column = &values[from * n_features..(from + 1) * n_features];
            for (warped, value) in self.warped.iter_mut().zip(column) {
                *warped += weights[from] * value;
            }
            matched += weights[from];
            share += weights[from] / f64::from(self.n_partners[from]);
        }
        self.flush(at, matched, share);
    }

    /// Adds a warped column, of which `matched` is the weight of its parts.
    #[inline(always)]
    fn flush(&mut self, at: usize, matched: f64, weight: f64) {
        // Dividing by 1 changes nothing, and after an exact unwarp most weights are 1.
        if matched != 1.0 {
            self.warped.iter_mut().for_each(|value| *value /= matched);
        }
        let n_features = self.sums.n_features;
        let sums = &mut self.sums.values[at * n_features..(at + 1) * n_features];
        for (sum, value) in sums.iter_mut().zip(&self.warped) {
            *sum += weight * value;
        }
        self.sums.weights[at] += weight;
    }

    /// Means of the values by weight, and means of the weights.
    pub(super) fn finish(mut self) -> Weighted {
        let columns = self.sums.values.chunks_exact_mut(self.sums.n_features);
        for (column, weight) in columns.zip(&mut self.sums.weights) {
            // A mean of shares may be rounded to a little more than 1.
            column
                .iter_mut()
                .for_each(|value| *value = (*value / *weight).clamp(0.0, 1.0));
            *weight /= self.n_templates as f64;
        }
        self.sums
    }
}

struct Add<'a, P> {
    average: &'a mut Average,
    values: &'a [f64],
    weights: &'a [f64],
    path: P,
}

/// Its loops are compiled for every instruction set; no operation is fused, so all give the same.
impl<P: Iterator<Item = (usize, usize)>> WithSimd for Add<'_, P> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.average.sweep(self.values, self.weights, self.path);
    }
}
