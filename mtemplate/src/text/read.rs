//! Reading the text form.

use std::collections::BTreeMap;
use std::ops::Range;

use ndarray::{Array1, Array2};
use serde::Deserialize;
use toml::Spanned;

use super::VERSION;
use super::runs::{Row, RowError};
use crate::{
    ANY, ClassError, ClassTemplate, FileError, FileErrorKind, Keyframe, KeyframeError, MAX_COLUMNS,
    MAX_FEATURES, MotionTemplate, Place,
};

#[derive(Deserialize)]
struct Versioned {
    motion_template: Spanned<u32>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Raw {
    motion_template: Spanned<u32>,
    name: String,
    feature_set: String,
    rate: Spanned<f64>,
    columns: Spanned<usize>,
    n_motions: Option<Spanned<usize>>,
    tau: Option<Spanned<f64>>,
    weights: Option<Spanned<String>>,
    features: Spanned<BTreeMap<Spanned<String>, Spanned<String>>>,
    #[serde(default)]
    keyframe: Vec<Spanned<RawKeyframe>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawKeyframe {
    column: Spanned<usize>,
    stiffness: Option<Spanned<f64>>,
    features: BTreeMap<Spanned<String>, Spanned<i64>>,
}

/// What is wrong, and at which byte.
type Located<T> = Result<T, (usize, FileErrorKind)>;

pub(super) fn read(
    text: &str,
    names: impl Fn(&str) -> Option<Vec<String>>,
) -> Result<ClassTemplate, FileError> {
    let located = parse(text).and_then(|raw| {
        let names = names(&raw.feature_set);
        raw.class(text, names)
    });
    located.map_err(|(byte, kind)| FileError {
        at: Place::in_text(text.as_bytes(), byte),
        kind,
    })
}

fn parse(text: &str) -> Located<Raw> {
    let raw = toml::from_str::<Raw>(text);
    // Another version may have other keys, and is then the better explanation.
    let version = match &raw {
        Ok(raw) => Some(raw.motion_template.clone()),
        Err(_) => {
            let versioned = toml::from_str::<Versioned>(text).ok();
            versioned.map(|versioned| versioned.motion_template)
        }
    };
    if let Some(version) = version.filter(|version| *version.get_ref() != VERSION) {
        let (expected, found) = (VERSION, *version.get_ref());
        let kind = FileErrorKind::Version { expected, found };
        return Err((version.span().start, kind));
    }
    raw.map_err(|error| {
        let message = error.message().trim().replace('\n', "; ");
        let at = error.span().map_or(0, |span| span.start);
        (at, FileErrorKind::Toml(message))
    })
}

impl Raw {
    fn class(self, text: &str, names: Option<Vec<String>>) -> Located<ClassTemplate> {
        let n_columns = *self.columns.get_ref();
        if n_columns > MAX_COLUMNS {
            let kind = ClassError::Columns { found: n_columns };
            return Err((self.columns.span().start, kind.into()));
        }
        let mut rows: Vec<(&Spanned<String>, &Spanned<String>)> =
            self.features.get_ref().iter().collect();
        rows.sort_by_key(|(name, _)| name.span().start);
        let features = names.unwrap_or_else(|| {
            let names = rows.iter().map(|(name, _)| (*name).get_ref().clone());
            names.collect()
        });
        // Before any row becomes columns: a word has no room for more.
        let features_at = self.features.span().start;
        if !(1..=MAX_FEATURES).contains(&features.len()) {
            let found = features.len();
            return Err((features_at, ClassError::Features { found }.into()));
        }
        let mut values = Array2::from_elem((n_columns, features.len()), ANY);
        for (name, row) in &rows {
            let row = columns(text, row.span(), Row::Values, n_columns)?;
            let feature = self.feature(name, &features)?;
            values.column_mut(feature).assign(&Array1::from(row));
        }
        let weights = match &self.weights {
            Some(row) => columns(text, row.span(), Row::Weights, n_columns)?,
            None => vec![1.0; n_columns],
        };
        let keyframes = self.keyframe.iter();
        let keyframes = keyframes.map(|one| self.keyframe(one.get_ref(), &features));
        let class = ClassTemplate {
            keyframes: keyframes.collect::<Located<_>>()?,
            name: self.name.clone(),
            feature_set: self.feature_set.clone(),
            rate: *self.rate.get_ref(),
            features,
            template: MotionTemplate::new(values, Array1::from(weights))
                .map_err(|error| (features_at, error.into()))?,
            n_motions: self.n_motions.as_ref().map(|n| *n.get_ref()),
            tau: self.tau.as_ref().map(|tau| *tau.get_ref()),
        };
        class
            .check()
            .map_err(|error| (self.place(&error), error.into()))?;
        Ok(class)
    }

    /// The index of a feature.
    fn feature(&self, name: &Spanned<String>, features: &[String]) -> Located<usize> {
        let feature = features.iter().position(|other| other == name.get_ref());
        feature.ok_or_else(|| {
            let kind = ClassError::Unknown {
                feature_set: self.feature_set.clone(),
                name: name.get_ref().clone(),
            };
            (name.span().start, kind.into())
        })
    }

    fn keyframe(&self, one: &RawKeyframe, features: &[String]) -> Located<Keyframe> {
        let mut keyframe = Keyframe {
            column: *one.column.get_ref(),
            care: 0,
            value: 0,
            stiffness: one
                .stiffness
                .as_ref()
                .map_or(Keyframe::LOOSE, |s| *s.get_ref()),
        };
        for (name, wanted) in &one.features {
            let bit = self.feature(name, features)?;
            let wanted_bit = match *wanted.get_ref() {
                found @ (0 | 1) => found as u64,
                found => return Err((wanted.span().start, FileErrorKind::Bit { found })),
            };
            keyframe.care |= 1 << bit;
            keyframe.value |= wanted_bit << bit;
        }
        Ok(keyframe)
    }

    /// The byte where the text breaks a rule.
    fn place(&self, error: &ClassError) -> usize {
        let start = match error {
            ClassError::Rate { .. } => Some(self.rate.span()),
            ClassError::Columns { .. } => Some(self.columns.span()),
            ClassError::Motions { .. } => self.n_motions.as_ref().map(Spanned::span),
            ClassError::Tau { .. } => self.tau.as_ref().map(Spanned::span),
            ClassError::Keyframe { keyframe, kind } => {
                let one = self.keyframe.get(*keyframe);
                one.map(|one| keyframe_place(one, kind))
            }
            _ => None,
        };
        start.unwrap_or_else(|| self.features.span()).start
    }
}

fn keyframe_place(one: &Spanned<RawKeyframe>, kind: &KeyframeError) -> Range<usize> {
    let (whole, one) = (one.span(), one.get_ref());
    match kind {
        KeyframeError::Column { .. } | KeyframeError::Order { .. } => one.column.span(),
        KeyframeError::Stiffness { .. } => one.stiffness.as_ref().map_or(whole, Spanned::span),
        _ => whole,
    }
}

/// The columns of the row whose string stands at `span`.
///
/// The text between the quotes is read as it stands, and not what TOML makes of it: a row needs no
/// escapes, and so every byte of it has its place in the file.
fn columns(text: &str, span: Range<usize>, row: Row, n_columns: usize) -> Located<Vec<f64>> {
    let literal = text.get(span.clone()).unwrap_or_default();
    let delimiters = ["\"\"\"", "'''", "\"", "'"];
    let inside = |quotes: &&str| {
        let inside = literal.strip_prefix(*quotes)?.strip_suffix(*quotes)?;
        Some((inside, span.start + quotes.len()))
    };
    let (inside, start) = delimiters
        .iter()
        .find_map(inside)
        .unwrap_or((literal, span.start));
    row.values(inside, n_columns).map_err(|error| match error {
        RowError::Run(at) => {
            let found = inside[at.clone()].to_owned();
            let kind = match row {
                Row::Values => FileErrorKind::Run { found },
                Row::Weights => FileErrorKind::Weight { found },
            };
            (start + at.start, kind)
        }
        RowError::Columns { found, byte } => {
            let expected = n_columns;
            (start + byte, FileErrorKind::Columns { expected, found })
        }
    })
}
