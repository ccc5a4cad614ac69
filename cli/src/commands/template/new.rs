//! `motif template new`.

use std::ops::Range;

use mtemplate::{ClassTemplate, MAX_COLUMNS, MotionTemplate};
use relfeat::FeatureSet;

use super::refuse;
use crate::args::{NewArgs, parse_columns};
use crate::commands::learn::words_of;
use crate::failure::Failure;
use crate::selection;

/// The template that a command line describes.
pub(super) fn template(args: &NewArgs) -> Result<ClassTemplate, Failure> {
    let (named, rate) = words_of(&args.set)?;
    let set = &named.set;
    if !(1..=MAX_COLUMNS).contains(&args.length) {
        let found = args.length;
        let message = format!("expected a --length from 1 to {MAX_COLUMNS}, found {found}");
        return Err(Failure::Usage(message));
    }
    let whole = args.at.clone().unwrap_or(0..args.length);
    let blank = MotionTemplate::blank(args.length, set.features().len());
    let mut template = ClassTemplate {
        name: super::name(&args.to),
        feature_set: set.name().to_owned(),
        rate,
        features: selection::names(set, set.all()),
        template: blank.map_err(|e| refuse(e.into()))?,
        n_motions: None,
        tau: None,
        keyframes: Vec::new(),
    };
    for (value, wanted) in [(1.0, &args.one), (0.0, &args.zero)] {
        for wanted in wanted {
            let (features, columns) = cells(set, wanted, &whole)?;
            if value == 0.0 {
                refuse_both(&template, features, &columns)?;
            }
            template = template.painted(value, features, columns).map_err(refuse)?;
        }
    }
    Ok(template)
}

/// Reads `F13` or `F13@10-30`.
fn cells(
    set: &FeatureSet,
    text: &str,
    whole: &Range<usize>,
) -> Result<(u64, Range<usize>), Failure> {
    let (name, columns) = match text.split_once('@') {
        None => (text, whole.clone()),
        Some((name, columns)) => {
            let columns = parse_columns(columns);
            let columns = columns.map_err(|e| Failure::Usage(format!("{text}: {e}")))?;
            (name, columns)
        }
    };
    Ok((selection::select(set, &[name.to_owned()])?, columns))
}

/// A feature that is to be on cannot be off in the same column.
fn refuse_both(
    template: &ClassTemplate,
    features: u64,
    columns: &Range<usize>,
) -> Result<(), Failure> {
    for ((column, feature), &value) in template.template.values().indexed_iter() {
        if value == 1.0 && columns.contains(&column) && features >> feature & 1 == 1 {
            let name = &template.features[feature];
            return Err(Failure::Usage(format!(
                "{name} cannot be both on and off in column {column}"
            )));
        }
    }
    Ok(())
}
