//! Templates made of templates, or by hand.

use std::ops::Range;

use ndarray::{Array1, Array2, s};
use thiserror::Error;

use crate::{
    ANY, ClassError, ClassTemplate, Keyframe, LearnConfig, MotionTemplate, TemplateError, learn,
    quantize,
};

/// Why a template cannot be made of others.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum EditError {
    /// The columns are not a stretch of the template's.
    #[error("expected columns from 0 to {n_columns}, found {}-{}", found.start, found.end)]
    Columns {
        /// Number of columns.
        n_columns: usize,
        /// First column, and one past the last.
        found: Range<usize>,
    },
    /// The bits are none, or not those of features.
    #[error("expected bits of {n_features} features, found {found:#x}")]
    Features {
        /// Number of features.
        n_features: usize,
        /// The bits.
        found: u64,
    },
    /// Two templates are for different words.
    #[error(
        "expected templates for words of one feature set and rate, found {first} Hz of {first_set} \
         and {other} Hz of {other_set}"
    )]
    Words {
        /// Rate of the first template.
        first: f64,
        /// Feature set of the first template.
        first_set: String,
        /// Rate of another.
        other: f64,
        /// Feature set of that one.
        other_set: String,
    },
    /// The parts of a template do not fit each other.
    #[error(transparent)]
    Class(#[from] ClassError),
    /// Values, or what is to be learned from, break a rule.
    #[error(transparent)]
    Template(#[from] TemplateError),
}

impl MotionTemplate {
    /// A template to which nothing matters: all values [`ANY`], all weights 1.
    ///
    /// # Errors
    ///
    /// When there are no features or more than [`MAX_FEATURES`](crate::MAX_FEATURES).
    pub fn blank(n_columns: usize, n_features: usize) -> Result<Self, TemplateError> {
        let values = Array2::from_elem((n_columns, n_features), ANY);
        Self::new(values, Array1::ones(n_columns))
    }
}

impl ClassTemplate {
    /// The template of the mirrored class: its feature i is this one's feature `permutation[i]`, in
    /// keyframes, too. Everything else stays.
    ///
    /// # Errors
    ///
    /// When `permutation` does not name each feature exactly once, and as
    /// [`check`](Self::check).
    pub fn mirrored(&self, permutation: &[usize]) -> Result<ClassTemplate, EditError> {
        self.check()?;
        let template = self.template.mirrored(permutation)?;
        let moved = |bits: u64| {
            let bit = |(to, from): (usize, &usize)| (bits >> from & 1) << to;
            permutation.iter().enumerate().map(bit).sum()
        };
        let keyframes = self.keyframes.iter().map(|one| Keyframe {
            care: moved(one.care),
            value: moved(one.value),
            ..*one
        });
        Ok(ClassTemplate {
            keyframes: keyframes.collect(),
            template,
            ..self.clone()
        })
    }

    /// The stretch `columns`, in which nothing but the features of the bits `features` matters.
    ///
    /// The template stays one of all its features: the others become [`ANY`]. Keyframes outside the
    /// stretch go, and so do those that ask for none of these features. A τ goes, as it was learned
    /// for other costs, unless nothing is left out.
    ///
    /// # Errors
    ///
    /// When no feature or no column is left, or there are no such ones, and as
    /// [`check`](Self::check).
    pub fn restricted(
        &self,
        features: u64,
        columns: Range<usize>,
    ) -> Result<ClassTemplate, EditError> {
        self.check()?;
        self.check_part(features, &columns)?;
        let mut values = self
            .template
            .values()
            .slice(s![columns.clone(), ..])
            .to_owned();
        for (feature, mut row) in values.columns_mut().into_iter().enumerate() {
            if features >> feature & 1 == 0 {
                row.fill(ANY);
            }
        }
        let weights = self
            .template
            .weights()
            .slice(s![columns.clone()])
            .to_owned();
        let kept = self
            .keyframes
            .iter()
            .filter(|one| columns.contains(&one.column) && one.care & features != 0);
        let keyframes = kept.map(|one| Keyframe {
            column: one.column - columns.start,
            care: one.care & features,
            value: one.value & features,
            ..*one
        });
        let is_whole = features == quantize::all_features(self.template.n_features())
            && columns.len() == self.template.n_columns();
        Ok(ClassTemplate {
            keyframes: keyframes.collect(),
            template: MotionTemplate::new(values, weights)?,
            tau: self.tau.filter(|_| is_whole),
            ..self.clone()
        })
    }

    /// The template with `value` in the cells of the bits `features` and of `columns`; [`ANY`] says
    /// that they do not matter. A τ goes, as it was learned for other costs.
    ///
    /// # Errors
    ///
    /// As [`restricted`](Self::restricted), and when `value` lies outside \[0, 1\].
    ///
    /// ```
    /// use mtemplate::{ClassTemplate, MotionTemplate};
    ///
    /// let blank = ClassTemplate {
    ///     name: "sweep".to_owned(),
    ///     feature_set: "two".to_owned(),
    ///     rate: 30.0,
    ///     features: vec!["hand_fast".to_owned(), "spine_bent".to_owned()],
    ///     template: MotionTemplate::blank(50, 2)?,
    ///     n_motions: None,
    ///     tau: None,
    ///     keyframes: Vec::new(),
    /// };
    /// let sweep = blank.painted(1.0, 0b11, 0..50)?.painted(0.0, 0b01, 45..50)?;
    /// assert!(sweep.to_text()?.ends_with("hand_fast  = \"1x45 0x5\"\nspine_bent = \"1\"\n"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn painted(
        &self,
        value: f64,
        features: u64,
        columns: Range<usize>,
    ) -> Result<ClassTemplate, EditError> {
        self.check()?;
        self.check_part(features, &columns)?;
        let mut values = self.template.values().to_owned();
        for (feature, mut row) in values.columns_mut().into_iter().enumerate() {
            if features >> feature & 1 == 1 {
                row.slice_mut(s![columns.clone()]).fill(value);
            }
        }
        let weights = self.template.weights().to_owned();
        Ok(ClassTemplate {
            template: MotionTemplate::new(values, weights)?,
            tau: None,
            ..self.clone()
        })
    }

    fn check_part(&self, features: u64, columns: &Range<usize>) -> Result<(), EditError> {
        let (n_columns, n_features) = (self.template.n_columns(), self.template.n_features());
        if features == 0 || features & !quantize::all_features(n_features) != 0 {
            let found = features;
            return Err(EditError::Features { n_features, found });
        }
        if columns.is_empty() || columns.end > n_columns {
            let found = columns.clone();
            return Err(EditError::Columns { n_columns, found });
        }
        Ok(())
    }
}

/// The most copies of templates that [`combine`] learns from.
const MAX_COPIES: usize = 64;

/// One template `name` for the classes of several, learned from these as if they were motions.
///
/// Each counts by its number of motions: as many copies of it are learned from, in the least ratio of
/// whole numbers; where that takes more than 64 copies, the ratio is rounded to shares of 64, with at
/// least one copy for each. If any number is unknown, all count the same. Keyframes and τ are not
/// carried over. A template learned from all motions at once may differ: these know more than their
/// averages.
///
/// Cost: that of [`learn`] from the copies.
///
/// # Errors
///
/// When there are no templates, one has no columns, or they are for words of different features or
/// rates.
pub fn combine(
    name: &str,
    classes: &[ClassTemplate],
    config: &LearnConfig,
) -> Result<ClassTemplate, EditError> {
    let first = classes.first().ok_or(TemplateError::NoMotions)?;
    for other in classes {
        other.check()?;
        let is_alike = other.feature_set == first.feature_set
            && other.features == first.features
            && other.rate == first.rate;
        if !is_alike {
            return Err(EditError::Words {
                first: first.rate,
                first_set: first.feature_set.clone(),
                other: other.rate,
                other_set: other.feature_set.clone(),
            });
        }
    }
    let known: Option<Vec<usize>> = classes.iter().map(|class| class.n_motions).collect();
    let copies = copies(known.as_deref().unwrap_or(&vec![1; classes.len()]));
    let inputs = classes.iter().zip(copies);
    let inputs: Vec<MotionTemplate> = inputs
        .flat_map(|(class, n)| std::iter::repeat_n(class.template.clone(), n))
        .collect();
    let combined = ClassTemplate {
        name: name.to_owned(),
        template: learn(&inputs, config)?.template,
        n_motions: known.map(|numbers| numbers.into_iter().sum()),
        tau: None,
        keyframes: Vec::new(),
        ..first.clone()
    };
    combined.check()?;
    Ok(combined)
}

/// Copies of each of several classes with these numbers of motions, all at least 1.
fn copies(numbers: &[usize]) -> Vec<usize> {
    let divisor = numbers.iter().copied().fold(0, gcd).max(1);
    let ratio: Vec<usize> = numbers.iter().map(|n| n / divisor).collect();
    let total: usize = ratio.iter().sum();
    if total <= MAX_COPIES {
        return ratio;
    }
    let share = |&n: &usize| (n as f64 / total as f64 * MAX_COPIES as f64).round() as usize;
    ratio.iter().map(|n| share(n).max(1)).collect()
}

fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn copies_keep_the_ratio() {
        assert_eq!(copies(&[26, 13, 39]), [2, 1, 3]);
        assert_eq!(copies(&[1]), [1]);
        assert_eq!(copies(&[7, 7]), [1, 1]);
        assert_eq!(copies(&[63, 1]), [63, 1]);
        assert_eq!(copies(&[1000, 1001]), [32, 32]);
        assert_eq!(copies(&[u32::MAX as usize, 1]), [64, 1]);
        assert_eq!(copies(&[]), [0; 0]);
    }
}
