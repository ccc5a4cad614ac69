use ndarray::{Array1, Array2, ArrayView1, ArrayView2, Axis};

use crate::{QuantizedTemplate, TemplateError, quantize};

/// Features that fit one word.
pub const MAX_FEATURES: usize = 64;

/// For each column and feature, the share of motions of a class in which the feature holds there.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionTemplate {
    values: Array2<f64>,
    weights: Array1<f64>,
}

impl MotionTemplate {
    /// A template of `values`, of shape `(columns, features)`, with a weight for each column.
    ///
    /// # Errors
    ///
    /// When there are no features or more than [`MAX_FEATURES`], when a value lies outside \[0, 1\]
    /// or a weight is not positive and finite, and when the two disagree on the columns.
    pub fn new(values: Array2<f64>, weights: Array1<f64>) -> Result<Self, TemplateError> {
        check_features(values.ncols())?;
        if values.nrows() != weights.len() {
            let (columns, weights) = (values.nrows(), weights.len());
            return Err(TemplateError::Columns { columns, weights });
        }
        for ((column, feature), &value) in values.indexed_iter() {
            if !(0.0..=1.0).contains(&value) {
                return Err(TemplateError::Value {
                    column,
                    feature,
                    value,
                });
            }
        }
        for (column, &weight) in weights.iter().enumerate() {
            if !(weight > 0.0 && weight.is_finite()) {
                return Err(TemplateError::Weight { column, weight });
            }
        }
        Ok(Self { values, weights })
    }

    /// The template of one motion: its feature matrix, with weights 1.
    ///
    /// # Errors
    ///
    /// When `n_features` is 0 or more than [`MAX_FEATURES`], and when a word sets a bit at or above
    /// it.
    ///
    /// ```
    /// use mtemplate::MotionTemplate;
    /// use mtemplate::ndarray::array;
    ///
    /// let template = MotionTemplate::from_words(&[0b001, 0b110], 3)?;
    /// assert_eq!(template.values(), array![[1.0, 0.0, 0.0], [0.0, 1.0, 1.0]]);
    /// # Ok::<(), mtemplate::TemplateError>(())
    /// ```
    pub fn from_words(words: &[u64], n_features: usize) -> Result<Self, TemplateError> {
        check_features(n_features)?;
        let stray = !quantize::all_features(n_features);
        if let Some(frame) = words.iter().position(|word| word & stray != 0) {
            return Err(TemplateError::StrayBit {
                frame,
                word: words[frame],
                n_features,
            });
        }
        let bit = |(frame, feature): (usize, usize)| f64::from((words[frame] >> feature & 1) as u8);
        let values = Array2::from_shape_fn((words.len(), n_features), bit);
        Ok(Self {
            values,
            weights: Array1::ones(words.len()),
        })
    }

    /// Values, of shape `(columns, features)`.
    pub fn values(&self) -> ArrayView2<'_, f64> {
        self.values.view()
    }

    /// Weights, one for each column.
    pub fn weights(&self) -> ArrayView1<'_, f64> {
        self.weights.view()
    }

    /// Number of columns K.
    pub fn n_columns(&self) -> usize {
        self.values.nrows()
    }

    /// Number of features f.
    pub fn n_features(&self) -> usize {
        self.values.ncols()
    }

    /// Values up to `threshold` become 0, values from `1 - threshold` become 1, all others
    /// wildcards. The papers use 0.1.
    ///
    /// # Errors
    ///
    /// When the threshold lies outside \[0, 0.5), where a value would be both.
    pub fn quantize(&self, threshold: f64) -> Result<QuantizedTemplate, TemplateError> {
        quantize::quantize(self, threshold)
    }

    /// The template of the mirrored motions: its feature i is this one's feature
    /// `permutation[i]`.
    ///
    /// # Errors
    ///
    /// When `permutation` does not name each feature exactly once.
    pub fn mirrored(&self, permutation: &[usize]) -> Result<Self, TemplateError> {
        let n_features = self.n_features();
        let mut seen = vec![false; n_features];
        let is_new = |&feature: &usize| {
            seen.get_mut(feature)
                .is_some_and(|seen| !std::mem::replace(seen, true))
        };
        if permutation.len() != n_features || !permutation.iter().all(is_new) {
            return Err(TemplateError::Permutation { n_features });
        }
        let values = self.values.select(Axis(1), permutation);
        Ok(Self {
            values,
            weights: self.weights.clone(),
        })
    }
}

fn check_features(found: usize) -> Result<(), TemplateError> {
    if (1..=MAX_FEATURES).contains(&found) {
        Ok(())
    } else {
        Err(TemplateError::Features { found })
    }
}
