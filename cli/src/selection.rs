//! Features as people name them.

use relfeat::FeatureSet;

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
    let nearest = names
        .map(|name| (strsim::levenshtein(pattern, name), name))
        .min()
        .map_or(String::new(), |(_, name)| {
            format!("; the nearest name is {name}")
        });
    Failure::Usage(format!(
        "{} has no feature {pattern:?}{nearest}; F1 to F{} are numbers that would do",
        set.name(),
        set.features().len()
    ))
}

/// The names of the features in `bits`, in order.
#[must_use]
pub fn names(set: &FeatureSet, bits: u64) -> Vec<String> {
    let all = set.features().iter().enumerate();
    let chosen = all.filter(|(i, _)| bits >> i & 1 == 1);
    chosen.map(|(_, feature)| feature.name.clone()).collect()
}
