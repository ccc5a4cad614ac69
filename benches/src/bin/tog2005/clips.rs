//! Which recordings there are, what they show, and the features they are seen through.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result, ensure};
use cli::source::{ClipRef, find_clips};
use relfeat::FeatureSet;
use segidx::{Index, IndexBuilder};

/// The features of an index: one of the paper's three sets, each with an index of its own (section
/// 5.3), or all of them in one word, as `motif index` has them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    Lower,
    Upper,
    Mix,
    All,
}

impl Part {
    pub(crate) const EACH: [Part; 4] = [Part::Lower, Part::Upper, Part::Mix, Part::All];

    /// The index as a library has it beside its others: that of all features has names and metadata, those of the
    /// parts have none.
    pub(crate) fn index(self, builder: &IndexBuilder) -> Index {
        match self {
            Part::All => builder.build(),
            Part::Lower | Part::Upper | Part::Mix => builder.build_restricted(u64::MAX),
        }
    }

    /// The paper's subscript.
    pub(crate) fn letter(self) -> &'static str {
        match self {
            Part::Lower => "l",
            Part::Upper => "u",
            Part::Mix => "m",
            Part::All => "all",
        }
    }

    /// `mueller2005` without the features of other parts: bit i - 1 is the paper's feature i of this
    /// part.
    pub(crate) fn features(self) -> Result<FeatureSet> {
        let lines = match self {
            Part::Lower => "\nset = \"lower\"\n",
            Part::Upper => "\nset = \"upper\"\n",
            Part::Mix => "\nset = \"mix\"\n",
            Part::All => "",
        };
        let text = FeatureSet::builtin_toml("mueller2005").context("no such set")?;
        let mut pieces = text.split("[[feature]]");
        let mut of_part = pieces.next().unwrap_or_default().to_owned();
        for feature in pieces.filter(|feature| feature.contains(lines)) {
            of_part += "[[feature]]";
            of_part += feature;
        }
        FeatureSet::from_toml(&of_part).with_context(|| format!("features of {self:?}"))
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
        for (part, n) in [(Part::Lower, 11), (Part::Upper, 12), (Part::Mix, 8)] {
            let features = part.features().unwrap();
            assert_eq!(features.features().len(), n);
            assert!(
                features
                    .features()
                    .iter()
                    .all(|f| names.next() == Some(&f.name))
            );
        }
    }

    #[test]
    fn all_features_are_the_set() {
        let all = FeatureSet::builtin("mueller2005").unwrap();
        assert_eq!(Part::All.features().unwrap(), all);
    }

    #[test]
    fn descriptions_may_hold_commas() {
        let text =
            "\"Subject\",\"Trial #\",\"Motion Description\"\n13,29,\"jacks, squats\",120,,\n";
        let described = descriptions(text);
        assert_eq!(described.len(), 1);
        assert_eq!(described["13_29"], "jacks, squats");
    }
}
