//! Table 3: keyframes, what they leave to be searched, and what is found there.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context, Result};
use cli::args::{MatchingArgs, SetArgs, Tau};
use cli::commands::index;
use cli::commands::search::template::{Places, What, search};
use cli::eval::split::Role;
use cli::keyframes::{self, Rule};
use cli::library::Library;
use cli::output::{Voice, table};
use cli::recording::ReadOptions;
use cli::selection;
use mtemplate::{
    AutomaticConfig, ClassTemplate, ExampleConfig, Examples, Keyframe, learn_keyframes,
};

use crate::work::{Work, method};

/// The paper's threshold.
const TAU: f64 = 0.06;

/// Folder; keyframes, share of the database selected in percent, relevant motions, hits, relevant hits.
const PUBLISHED: [(&str, [&str; 5]); 3] = [
    ("grabHighR", ["2", "4.2", "30", "128", "30"]),
    ("lieDownFloor", ["2", "7.2", "20", "24", "16"]),
    ("squat1Reps", ["2", "1.1", "56", "55", "55"]),
];

pub(crate) fn report(work: &Work) -> Result<String> {
    let dir = tempfile::tempdir()?;
    let library = index_tests(work, dir.path())?;
    let set = &library.features.set;
    let mut rows = table(&["class", "", "keyframes", "% kept", "N", "H", "H+", "ms"]);
    for (class, name) in work.classes.iter().enumerate() {
        let learned = work.learned[class]
            .as_ref()
            .context("a class without training clips")?;
        let template = ClassTemplate {
            name: name.clone(),
            feature_set: set.name().to_owned(),
            rate: library.rate,
            features: selection::names(set, set.all()),
            template: learned.learned.template.clone(),
            n_motions: None,
            tau: None,
            keyframes: Vec::new(),
        };
        let automatic = keyframes::choose(&template, set, &AutomaticConfig::interactive())?;
        let ways = [
            ("everywhere", None, Rule::Stiffness),
            ("2006", Some(automatic.clone()), Rule::Greedy),
            ("2006, 2008 rule", Some(automatic), Rule::Stiffness),
            (
                "from examples",
                Some(from_examples(work, class, &template)?),
                Rule::Stiffness,
            ),
        ];
        let mut label = name.clone();
        for (way, keyframes, rule) in ways {
            let n_keyframes = keyframes.as_ref().map_or(0, Vec::len);
            let what = What {
                matching: MatchingArgs {
                    tau: Some(Tau::Value(TAU)),
                    delta: None,
                },
                places: keyframes.map_or(Places::Everywhere, Places::Around),
                rule,
                ..What::default()
            };
            let start = Instant::now();
            let found = search(&library, &template, &what, Voice::default())?;
            let seconds = start.elapsed().as_secs_f64();
            let is_relevant = |clip: &&str| clip.contains(name.as_str());
            let clips: BTreeSet<&str> = found.hits.iter().map(|hit| hit.clip.as_str()).collect();
            let tests = work.clips.iter().zip(&work.roles);
            let tests = tests.filter(|(clip, role)| clip.class == class && **role == Role::Test);
            rows.add_row([
                std::mem::take(&mut label),
                way.to_owned(),
                n_keyframes.to_string(),
                format!("{:.1}", 100.0 * found.searched.share),
                tests.count().to_string(),
                found.n_hits.to_string(),
                clips.into_iter().filter(is_relevant).count().to_string(),
                format!("{:.1}", 1e3 * seconds),
            ]);
        }
        if let Some((_, paper)) = PUBLISHED.iter().find(|row| row.0 == name) {
            let paper = paper.map(str::to_owned);
            rows.add_row([String::new(), "paper".to_owned()].into_iter().chain(paper));
        }
    }
    Ok(format!(
        "Table 3: keyframes and hits at {TAU} over the test clips; the paper's over 210 minutes of takes. The times are \
         of keyframes and matching together, on all threads\n{}\n\n",
        rows.trim_fmt()
    ))
}

fn index_tests(work: &Work, dir: &Path) -> Result<Library> {
    let tests = work.clips.iter().zip(&work.roles);
    let tests = tests.filter(|(_, role)| **role == Role::Test);
    let files: Vec<PathBuf> = tests.map(|(clip, _)| clip.file.path.clone()).collect();
    let what = index::What {
        set: &SetArgs::default(),
        sync: false,
    };
    let options = ReadOptions::default();
    index::index(&files, dir, &what, &options, Voice::default())?;
    Ok(Library::open(dir)?)
}

/// Keyframes that lose no training clip of the class and keep little of those of the others.
fn from_examples(work: &Work, class: usize, template: &ClassTemplate) -> Result<Vec<Keyframe>> {
    let training = work.clips.iter().zip(&work.roles);
    let training = training.filter(|(_, role)| **role == Role::Train);
    let (positives, negatives): (Vec<_>, Vec<_>) =
        training.partition(|(clip, _)| clip.class == class);
    let [positives, negatives] = [positives, negatives].map(|clips| -> Vec<&[u64]> {
        clips
            .iter()
            .map(|(clip, _)| clip.words.as_slice())
            .collect()
    });
    let examples = Examples {
        positives: &positives,
        negatives: &negatives,
    };
    let quantized = template.template.quantize(method().delta)?;
    let all = u64::MAX >> (u64::BITS as usize - template.features.len());
    let config = ExampleConfig::of_features(all);
    Ok(learn_keyframes(&quantized, &examples, &config).keyframes)
}
