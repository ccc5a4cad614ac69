//! Which recordings there are, what they show, and the features they are seen through.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result, ensure};
use cli::source::{ClipRef, find_clips};
use relfeat::FeatureSet;

/// One of the paper's three sets of features, each with an index of its own (section 5.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    Lower,
    Upper,
    Mix,
}

impl Part {
    pub(crate) const ALL: [Part; 3] = [Part::Lower, Part::Upper, Part::Mix];

    /// The paper's index letter.
    pub(crate) fn letter(self) -> char {
        match self {
            Part::Lower => 'l',
            Part::Upper => 'u',
            Part::Mix => 'm',
        }
    }

    /// `mueller2005` without the features of the other parts: bit i - 1 is the paper's feature i of
    /// this part.
    pub(crate) fn features(self) -> Result<FeatureSet> {
        let name = match self {
            Part::Lower => "lower",
            Part::Upper => "upper",
            Part::Mix => "mix",
        };
        let text = FeatureSet::builtin_toml("mueller2005").context("no such set")?;
        let mut pieces = text.split("[[feature]]");
        let mut of_part = pieces.next().unwrap_or_default().to_owned();
        let line = format!("\nset = {name:?}\n");
        for feature in pieces.filter(|feature| feature.contains(&line)) {
            of_part += "[[feature]]";
            of_part += feature;
        }
        FeatureSet::from_toml(&of_part).with_context(|| format!("features of {name}"))
    }
}

/// A recording and what is known about it.
#[derive(Clone, Debug)]
pub(crate) struct Clip {
    pub(crate) file: ClipRef,
    /// Its path in the data folder.
    pub(crate) name: String,
    /// What it shows: an HDM05 class, or the description of a CMU trial.
    pub(crate) shows: String,
}

/// The clips of `hdm05` and `cmu`, in order of path.
pub(crate) fn find(data: &Path) -> Result<Vec<Clip>> {
    let table = data.join("labels/cmu-descriptions.csv");
    let text =
        fs::read_to_string(&table).with_context(|| format!("cannot read {}", table.display()))?;
    let described = descriptions(&text);
    let mut clips = Vec::new();
    for file in find_clips(&[data.join("hdm05"), data.join("cmu")])? {
        let name = file.path.strip_prefix(data).unwrap_or(&file.path);
        let stem = name.file_stem().unwrap_or_default().to_string_lossy();
        let folder = name.parent().and_then(Path::file_name).unwrap_or_default();
        let shows = match described.get(&*stem) {
            Some(description) if name.starts_with("cmu") => description.clone(),
            _ => folder.to_string_lossy().into_owned(),
        };
        let name = name.display().to_string();
        clips.push(Clip { file, name, shows });
    }
    ensure!(!clips.is_empty(), "no clips in {}", data.display());
    Ok(clips)
}

/// Descriptions by trial, such as `02_05`, from lines `2,5,"punch/strike",…`.
fn descriptions(text: &str) -> BTreeMap<String, String> {
    let line = |line: &str| {
        let (subject, rest) = line.split_once(',')?;
        let (trial, rest) = rest.split_once(',')?;
        let (subject, trial): (u32, u32) = (subject.parse().ok()?, trial.parse().ok()?);
        let description = rest.strip_prefix('"')?.split('"').next()?;
        Some((format!("{subject:02}_{trial:02}"), description.to_owned()))
    };
    text.lines().filter_map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_have_as_many_features_as_the_paper_says() {
        let all = FeatureSet::builtin("mueller2005").unwrap();
        let mut names = all.features().iter().map(|f| &f.name);
        for (part, n) in Part::ALL.into_iter().zip([11, 12, 8]) {
            let features = part.features().unwrap();
            assert_eq!(features.features().len(), n);
            assert!(features.features().iter().all(|f| names.next() == Some(&f.name)));
        }
    }

    #[test]
    fn descriptions_may_hold_commas() {
        let text = "\"Subject\",\"Trial #\",\"Motion Description\"\n13,29,\"jacks, squats\",120,,\n";
        let described = descriptions(text);
        assert_eq!(described.len(), 1);
        assert_eq!(described["13_29"], "jacks, squats");
    }
}
