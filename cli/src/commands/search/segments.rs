//! `motif search --segment` and `--or`: other features, or other words as well, at some segments of the
//! query.

use std::collections::BTreeMap;

use relfeat::FeatureSet;
use segidx::{FuzzySet, Mask, Query, QueryPosition};

use super::example::Example;
use crate::args::SegmentArgs;
use crate::failure::Failure;
use crate::selection;

/// What is asked for at one segment.
#[derive(Clone, Debug, Default)]
struct Change {
    /// The features compared, if they are others than everywhere.
    care: Option<u64>,
    /// Alternatives: the features that differ, and their values.
    or: Vec<Mask>,
}

/// What differs from segment to segment.
#[derive(Clone, Debug, Default)]
pub(super) struct Changes {
    by_segment: BTreeMap<usize, Change>,
}

impl Changes {
    /// Reads the options; features are those of `set`, compared everywhere are those of `care`.
    pub(super) fn read(
        args: &SegmentArgs,
        set: &FeatureSet,
        care: u64,
    ) -> Result<Changes, Failure> {
        let mut changes = Changes::default();
        for text in &args.segments {
            let (segment, names) = numbered("--segment", text)?;
            let change = changes.by_segment.entry(segment).or_default();
            change.care = Some(features(set, names, change.care.unwrap_or(care))?);
        }
        for text in &args.alternatives {
            let (segment, values) = numbered("--or", text)?;
            let mask = alternative(set, text, values)?;
            changes.by_segment.entry(segment).or_default().or.push(mask);
        }
        Ok(changes)
    }

    pub(super) fn is_empty(&self) -> bool {
        self.by_segment.is_empty()
    }

    /// The same of the left/right mirrored body.
    pub(super) fn mirrored(&self, set: &FeatureSet) -> Changes {
        let mirror = |mask: &Mask| Mask::new(set.mirrored(mask.care()), set.mirrored(mask.value()));
        let changes = self.by_segment.iter().map(|(&segment, change)| {
            let change = Change {
                care: change.care.map(|care| set.mirrored(care)),
                or: change.or.iter().map(mirror).collect(),
            };
            (segment, change)
        });
        Changes {
            by_segment: changes.collect(),
        }
    }

    /// All features that are compared at some segment of a query that compares those of `care`.
    pub(super) fn care(&self, care: u64) -> u64 {
        let changes = self.by_segment.values();
        changes.fold(care, |all, change| {
            let or = change.or.iter().fold(0, |bits, mask| bits | mask.care());
            all | change.care.unwrap_or(0) | or
        })
    }

    /// `query` with other sets where they were asked for.
    pub(super) fn apply(&self, query: &Query, example: &Example) -> Result<Query, Failure> {
        let n_segments = query.positions().len();
        let known = 1..=n_segments;
        if let Some(found) = self.by_segment.keys().find(|k| !known.contains(k)) {
            return Err(Failure::Usage(format!(
                "--segment, --or: expected a segment of the query, from 1 to {n_segments}, found {found}"
            )));
        }
        Ok(
            query.map_sets(|position, was| match self.by_segment.get(&(position + 1)) {
                Some(change) => change.set(was, words_of(query, position, example), example.care),
                None => was.set.clone(),
            }),
        )
    }
}

/// The words of the example at a position.
fn words_of<'e>(query: &Query, position: usize, example: &'e Example) -> &'e [u64] {
    let frames = query.frames_of(position);
    frames
        .and_then(|frames| example.clip.words.get(frames))
        .unwrap_or_default()
}

impl Change {
    /// The words that agree with any of `words` on the features compared here, and the alternatives to them.
    fn set(&self, was: &QueryPosition, words: &[u64], care: u64) -> FuzzySet {
        let set = match self.care {
            Some(care) => FuzzySet::of_example(words, care),
            None => was.set.clone(),
        };
        let care = self.care.unwrap_or(care);
        let alternatives = self.or.iter().flat_map(|or| {
            let agrees = |word: u64| {
                let rest = care & !or.care();
                Mask::new(rest | or.care(), word & rest | or.value())
            };
            words
                .iter()
                .map(move |&word| agrees(word))
                .collect::<Vec<_>>()
        });
        set.union(&FuzzySet::new(alternatives))
    }
}

/// `K:…` as the number and what follows.
fn numbered<'t>(option: &str, text: &'t str) -> Result<(usize, &'t str), Failure> {
    let parts = text.split_once(':');
    let number = parts.and_then(|(number, rest)| Some((number.trim().parse().ok()?, rest)));
    number.ok_or_else(|| {
        Failure::Usage(format!(
            "{option}: expected the number of a segment, a colon and features, found {text:?}"
        ))
    })
}

/// The features that a list names. `+NAME` and `-NAME` change those of `care`; names alone are in their place.
fn features(set: &FeatureSet, names: &str, care: u64) -> Result<u64, Failure> {
    let names: Vec<&str> = names
        .split(',')
        .map(str::trim)
        .filter(|n| !n.is_empty())
        .collect();
    let is_change = names.iter().all(|name| name.starts_with(['+', '-']));
    let start = if is_change { care } else { 0 };
    names.into_iter().try_fold(start, |bits, name| {
        let select = |name: &str| selection::select(set, &[name.to_owned()]);
        Ok(match (name.strip_prefix('+'), name.strip_prefix('-')) {
            (Some(more), _) => bits | select(more)?,
            (None, Some(less)) => bits & !select(less)?,
            (None, None) => bits | select(name)?,
        })
    })
}

fn alternative(set: &FeatureSet, text: &str, values: &str) -> Result<Mask, Failure> {
    let wrong = || {
        Failure::Usage(format!(
            "--or: expected features with = and 0 or 1, such as 2:rknee_bent=0,F5=1, found {text:?}"
        ))
    };
    let (mut care, mut value) = (0, 0);
    for one in values.split(',') {
        let (name, bit) = one.split_once('=').ok_or_else(wrong)?;
        let bits = selection::select(set, &[name.trim().to_owned()])?;
        care |= bits;
        match bit.trim() {
            "0" => value &= !bits,
            "1" => value |= bits,
            _ => return Err(wrong()),
        }
    }
    Ok(Mask::new(care, value))
}
