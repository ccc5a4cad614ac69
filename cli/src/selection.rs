//! Features as people name them.

use std::fs;
use std::path::Path;

use relfeat::{FeatureSet, Rig};

use crate::failure::Failure;

/// The bits of the features that `patterns` name; all bits of the set if there are none.
///
/// # Errors
/// [`Failure::Usage`] for a pattern that names nothing, with the nearest name.
pub fn select(set: &FeatureSet, patterns: &[String]) -> Result<u64, Failure> {
    if patterns.is_empty() {
        return Ok(set.all());
    }
    patterns.iter().try_fold(0, |bits, pattern| {
        let named = set.select(pattern).ok_or_else(|| unknown(set, pattern))?;
        Ok(bits | named)
    })
}

fn unknown(set: &FeatureSet, pattern: &str) -> Failure {
    let names = set.features().iter().map(|f| f.name.as_str());
    let nearest = nearest(pattern, names).map_or(String::new(), |name| {
        format!("; the nearest name is {name}")
    });
    Failure::Usage(format!(
        "{} has no feature {pattern:?}{nearest}; F1 to F{} are numbers that would do",
        set.name(),
        set.features().len()
    ))
}

/// The name with the fewest edits from `word`; of several the first by the alphabet.
pub(crate) fn nearest<'a>(word: &str, names: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let ranked = names.map(|name| (strsim::levenshtein(word, name), name));
    ranked.min().map(|(_, name)| name)
}

/// A built-in rig by its name, or the rig in a TOML file.
///
/// # Errors
/// [`Failure`]: no such rig or file, or one that is no rig.
pub fn rig(name: &str) -> Result<Rig, Failure> {
    let builtin = Rig::builtin();
    let path = Path::new(name);
    if let Some(rig) = builtin.iter().find(|rig| rig.name == name) {
        return Ok(rig.clone());
    }
    if !path.exists() {
        let known: Vec<&str> = builtin.iter().map(|rig| rig.name.as_str()).collect();
        return Err(Failure::Usage(format!(
            "--rig {name}: no such file, and no rig of this name; there are {}",
            known.join(", ")
        )));
    }
    let text = fs::read_to_string(path).map_err(|e| Failure::io(path, e))?;
    Rig::from_toml(&text).map_err(|e| Failure::input(path, e))
}

/// The names of the features in `bits`, in order.
#[must_use]
pub fn names(set: &FeatureSet, bits: u64) -> Vec<String> {
    let all = set.features().iter().enumerate();
    let chosen = all.filter(|(i, _)| bits >> i & 1 == 1);
    chosen.map(|(_, feature)| feature.name.clone()).collect()
}
