//! Keyframes of templates: where they come from, and where they are in a library.

use std::collections::BTreeMap;
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};

use mocap_io::Position;
use mtemplate::{AutomaticConfig, ClassTemplate, Keyframe, Preselection, choose_keyframes};
use relfeat::FeatureSet;
use segidx::{KeyframeAnswer, search_keyframes};
use serde::Deserialize;
use toml::Spanned;

use crate::failure::Failure;
use crate::library::{Clip, ClipId, Library};
use crate::selection;
use crate::wire::keyframe_query;

/// When keyframes follow each other (spec.md e).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Rule {
    /// At distances that their stiffness allows (2008).
    #[default]
    Stiffness,
    /// From the last frame of a segment to first frames of segments, those of the part of the feature set that a keyframe
    /// belongs to; not much farther apart in all than the template's columns (2006). Loses more.
    Greedy,
}

/// What keyframes leave of a library.
#[derive(Clone, Debug)]
pub struct Preselected {
    /// Words of the clips that have any, ascending, none touching another.
    pub stretches: BTreeMap<ClipId, Vec<Range<usize>>>,
    /// The file of each index that was searched, and what was found there, also in clips that do not count.
    pub answers: Vec<(PathBuf, KeyframeAnswer)>,
}

/// Chooses keyframes by the heuristic of 2006 among the columns of each part of the feature set.
///
/// # Errors
/// Never with the thresholds of [`AutomaticConfig`]'s own.
pub fn choose(
    template: &ClassTemplate,
    set: &FeatureSet,
    config: &AutomaticConfig,
) -> Result<Vec<Keyframe>, Failure> {
    let groups = groups(set);
    choose_keyframes(&template.template, &groups, config)
        .map_err(|e| Failure::Usage(format!("template {:?}: {e}", template.name)))
}

/// The bits of each part of a feature set, in the order of their first features.
#[must_use]
pub fn groups(set: &FeatureSet) -> Vec<u64> {
    let mut groups: BTreeMap<&str, u64> = BTreeMap::new();
    for (bit, feature) in set.features().iter().enumerate() {
        *groups.entry(&feature.set).or_default() |= 1 << bit;
    }
    let mut groups: Vec<u64> = groups.into_values().collect();
    groups.sort_unstable_by_key(|bits| bits.trailing_zeros());
    groups
}

/// Finds the stretches of all `clips` that have a chain of the keyframes, by the library's indexes. Clips that do not
/// count, or are not among these, have none.
///
/// # Errors
/// [`Failure::Input`] where the library is damaged.
pub fn preselect(
    library: &Library,
    clips: &[Clip],
    preselection: &Preselection,
    rule: Rule,
) -> Result<Preselected, Failure> {
    let query = keyframe_query(preselection);
    let query = match rule {
        Rule::Stiffness => query,
        Rule::Greedy => {
            let groups = groups(&library.features.set);
            let part = |k: &Keyframe| groups.iter().copied().find(|bits| k.care & !bits == 0);
            let parts = preselection.keyframes().iter();
            let parts: Vec<u64> = parts.map(|k| part(k).unwrap_or(u64::MAX)).collect();
            query.greedy(preselection.greedy_frames(), parts)
        }
    };
    let (hits, answers) = library.search_each(|open| {
        let (path, shard) = open.index_for(query.care());
        let answer = search_keyframes(shard, &query).map_err(|e| Failure::input(path, e))?;
        Ok((answer.hits.clone(), (path.to_owned(), answer)))
    })?;
    let n_words: BTreeMap<ClipId, usize> = clips.iter().map(|c| (c.id, c.n_words)).collect();
    let mut stretches: BTreeMap<ClipId, Vec<Range<usize>>> = BTreeMap::new();
    for (id, hit) in hits {
        let Some(&n_words) = n_words.get(&id) else {
            continue;
        };
        let stretch = preselection.stretch(hit.first.start, hit.last.end - 1, n_words);
        stretches.entry(id).or_default().push(stretch);
    }
    stretches.values_mut().for_each(Preselection::merge);
    Ok(Preselected { stretches, answers })
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(default)]
    keyframe: Vec<Table>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    column: usize,
    #[serde(default = "loose")]
    stiffness: f64,
    features: BTreeMap<Spanned<String>, Spanned<u8>>,
}

fn loose() -> f64 {
    Keyframe::LOOSE
}

/// Reads keyframes from a TOML file of `[[keyframe]]` tables, written as in the text form of templates:
/// `column` (0-based), `features = { rknee_bent = 1, lower = 0 }` with the names that `--features` takes, and `stiffness`,
/// which is [`Keyframe::LOOSE`] if it is missing.
///
/// # Errors
/// [`Failure`] with the place: no file, no TOML of this kind, a feature that the set does not have.
pub fn read(path: &Path, set: &FeatureSet) -> Result<Vec<Keyframe>, Failure> {
    let text = fs::read_to_string(path).map_err(|e| Failure::io(path, e))?;
    let refuse = |byte: usize, message: String| Failure::Input {
        path: path.to_owned(),
        at: Some(Position::locate(text.as_bytes(), byte)),
        message,
    };
    let file: File = toml::from_str(&text).map_err(|e| {
        refuse(
            e.span().map_or(0, |span| span.start),
            e.message().to_owned(),
        )
    })?;
    let mut keyframes = Vec::new();
    for table in file.keyframe {
        let (mut care, mut value) = (0, 0);
        for (name, asked) in &table.features {
            let named = selection::select(set, &[name.get_ref().clone()]);
            let bits = named.map_err(|e| refuse(name.span().start, e.to_string()))?;
            let on = match asked.get_ref() {
                0 => 0,
                1 => bits,
                other => {
                    let message = format!("expected 0 or 1, found {other}");
                    return Err(refuse(asked.span().start, message));
                }
            };
            if care & bits & (value ^ on) != 0 {
                let message = format!("{:?} is asked to be both 0 and 1", name.get_ref());
                return Err(refuse(name.span().start, message));
            }
            care |= bits;
            value |= on;
        }
        keyframes.push(Keyframe {
            column: table.column,
            care,
            value,
            stiffness: table.stiffness,
        });
    }
    Ok(keyframes)
}
