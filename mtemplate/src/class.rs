//! A template with everything that a reader has to know of it.

use std::collections::BTreeSet;

use ndarray::Array2;
use thiserror::Error;

use crate::{Keyframe, MAX_FEATURES, MotionTemplate, quantize};

/// The most columns that [`ClassTemplate`]s are written and read with; 36 minutes at 30 words per
/// second. A file cannot make its reader allocate more.
pub const MAX_COLUMNS: usize = 1 << 16;

/// The value inside a template that stands for "does not matter", written `*`. Every
/// [quantisation](MotionTemplate::quantize) turns it into a wildcard.
pub const ANY: f64 = 0.5;

/// The template of a class of motions: what its features are and how it is to be used.
#[derive(Debug, Clone, PartialEq)]
pub struct ClassTemplate {
    /// Name of the class.
    pub name: String,
    /// Name of the feature set whose words it is for.
    pub feature_set: String,
    /// Words per second.
    pub rate: f64,
    /// Name of each feature, in the order of the bits.
    pub features: Vec<String>,
    /// Values and weights.
    pub template: MotionTemplate,
    /// Number of motions it was learned from; `None` for a template written by hand.
    pub n_motions: Option<usize>,
    /// Quality threshold τ learned for this class.
    pub tau: Option<f64>,
    /// Columns that preselect candidates, in ascending order.
    pub keyframes: Vec<Keyframe>,
}

/// What keeps a [`ClassTemplate`] from being written, read or laid out anew.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ClassError {
    /// Names and template disagree on the number of features.
    #[error("expected a name for each of {n_features} features, found {found}")]
    Names {
        /// Features of the template.
        n_features: usize,
        /// Number of names.
        found: usize,
    },
    /// Two features have one name.
    #[error("expected names that differ, found feature {name:?} twice")]
    Repeated {
        /// The name.
        name: String,
    },
    /// A feature is none of those asked for.
    #[error("expected a feature of {feature_set}, found {name:?}")]
    Unknown {
        /// Name of the feature set.
        feature_set: String,
        /// Name of the feature.
        name: String,
    },
    /// The number of features does not fit a word.
    #[error("expected 1 to {MAX_FEATURES} features, found {found}")]
    Features {
        /// Number of features.
        found: usize,
    },
    /// There are too many columns.
    #[error("expected at most {MAX_COLUMNS} columns, found {found}")]
    Columns {
        /// Number of columns.
        found: usize,
    },
    /// The rate is not positive and finite.
    #[error("expected a positive and finite rate, found {found}")]
    Rate {
        /// The rate.
        found: f64,
    },
    /// The number of motions is zero or past all reason.
    #[error("expected 1 to {} motions, found {found}", u32::MAX)]
    Motions {
        /// The number.
        found: usize,
    },
    /// The threshold is negative, infinite or not a number.
    #[error("expected a finite tau of 0 or more, found {found}")]
    Tau {
        /// The threshold.
        found: f64,
    },
    /// A keyframe breaks a rule.
    #[error("keyframe {keyframe}: {kind}")]
    Keyframe {
        /// Its index.
        keyframe: usize,
        /// The rule.
        kind: KeyframeError,
    },
}

/// What is wrong with a [`Keyframe`] of a [`ClassTemplate`].
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum KeyframeError {
    /// The template has no such column.
    #[error("expected a column below {n_columns}, found {found}")]
    Column {
        /// Number of columns.
        n_columns: usize,
        /// The column.
        found: usize,
    },
    /// It stands before the keyframe that it follows.
    #[error("expected column {before} or a later one, found {found}")]
    Order {
        /// Column of the keyframe before it.
        before: usize,
        /// The column.
        found: usize,
    },
    /// It asks nothing.
    #[error("expected one feature or more, found none")]
    AsksNothing,
    /// It names a bit that is no feature, or wants a value of a feature that it does not ask for.
    #[error("expected bits of {n_features} features and values among them, found {found:#x}")]
    StrayBit {
        /// Number of features.
        n_features: usize,
        /// The bits that should not be there.
        found: u64,
    },
    /// The stiffness is not in (0, 1].
    #[error("expected a stiffness above 0 and up to 1, found {found}")]
    Stiffness {
        /// The stiffness.
        found: f64,
    },
}

impl ClassTemplate {
    /// Whether the parts fit each other and can be written.
    ///
    /// # Errors
    ///
    /// [`ClassError`]: names that repeat or are not one for each feature, more than [`MAX_COLUMNS`]
    /// columns, a rate or a τ that is none, keyframes out of order or outside the template.
    pub fn check(&self) -> Result<(), ClassError> {
        let (n_columns, n_features) = (self.template.n_columns(), self.template.n_features());
        if self.features.len() != n_features {
            let found = self.features.len();
            return Err(ClassError::Names { n_features, found });
        }
        let mut names = BTreeSet::new();
        if let Some(name) = self.features.iter().find(|name| !names.insert(*name)) {
            let name = name.clone();
            return Err(ClassError::Repeated { name });
        }
        if n_columns > MAX_COLUMNS {
            return Err(ClassError::Columns { found: n_columns });
        }
        if !(self.rate > 0.0 && self.rate.is_finite()) {
            return Err(ClassError::Rate { found: self.rate });
        }
        let is_odd = |&n: &usize| n == 0 || u32::try_from(n).is_err();
        if let Some(found) = self.n_motions.filter(is_odd) {
            return Err(ClassError::Motions { found });
        }
        let is_threshold = |tau: &f64| *tau >= 0.0 && tau.is_finite();
        if let Some(found) = self.tau.filter(|tau| !is_threshold(tau)) {
            return Err(ClassError::Tau { found });
        }
        let mut before = 0;
        for (keyframe, one) in self.keyframes.iter().enumerate() {
            check_keyframe(one, before, n_columns, n_features)
                .map_err(|kind| ClassError::Keyframe { keyframe, kind })?;
            before = one.column;
        }
        Ok(())
    }

    /// The same template for words of the features `names`: by name, features that it lacks are
    /// wildcards.
    ///
    /// # Errors
    ///
    /// When it has a feature that is not among the names, they repeat, or there are none or more than
    /// 64 of them.
    pub fn over(&self, names: &[String]) -> Result<ClassTemplate, ClassError> {
        self.check()?;
        if !(1..=MAX_FEATURES).contains(&names.len()) {
            let found = names.len();
            return Err(ClassError::Features { found });
        }
        let place = |name: &String| {
            let place = names.iter().position(|other| other == name);
            place.ok_or_else(|| ClassError::Unknown {
                feature_set: self.feature_set.clone(),
                name: name.clone(),
            })
        };
        let places: Vec<usize> = self.features.iter().map(place).collect::<Result<_, _>>()?;
        let mut values = Array2::from_elem((self.template.n_columns(), names.len()), ANY);
        for (column, &place) in self.template.values().columns().into_iter().zip(&places) {
            values.column_mut(place).assign(&column);
        }
        let moved = |bits: u64| {
            let set = places.iter().enumerate();
            set.filter(|(i, _)| bits >> i & 1 == 1)
                .fold(0, |moved, (_, place)| moved | 1 << place)
        };
        let keyframes = self.keyframes.iter().map(|one| Keyframe {
            care: moved(one.care),
            value: moved(one.value),
            ..*one
        });
        let template = MotionTemplate::new(values, self.template.weights().to_owned())
            .expect("the values of a template, and wildcards");
        let laid_out = ClassTemplate {
            features: names.to_vec(),
            keyframes: keyframes.collect(),
            template,
            ..self.clone()
        };
        laid_out.check()?;
        Ok(laid_out)
    }
}

fn check_keyframe(
    one: &Keyframe,
    before: usize,
    n_columns: usize,
    n_features: usize,
) -> Result<(), KeyframeError> {
    let found = one.column;
    if found >= n_columns {
        return Err(KeyframeError::Column { n_columns, found });
    }
    if found < before {
        return Err(KeyframeError::Order { before, found });
    }
    if one.care == 0 {
        return Err(KeyframeError::AsksNothing);
    }
    let found = one.care & !quantize::all_features(n_features) | one.value & !one.care;
    if found != 0 {
        return Err(KeyframeError::StrayBit { n_features, found });
    }
    if !(one.stiffness > 0.0 && one.stiffness <= 1.0) {
        let found = one.stiffness;
        return Err(KeyframeError::Stiffness { found });
    }
    Ok(())
}
