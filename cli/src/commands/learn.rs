//! `motif learn`.

mod class;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use mtemplate::LearnConfig;
use rayon::prelude::*;
use relfeat::FeatureSet;
use serde::Serialize;

pub use self::class::learn_class;

use self::class::{available, keyframes, tau};
use super::index::{DEFAULT_RATE, DEFAULT_SET};
use super::{tell_filled, tell_warnings};
use crate::args::{Global, LearnArgs, SetArgs, Tau};
use crate::failure::{Exit, Failure, Skipped};
use crate::library::NamedSet;
use crate::output::{Outcome, Voice, count};
use crate::recording::ReadOptions;
use crate::selection;
use crate::source::{ClipRef, find_clips};
use crate::targets;
use crate::templates;
use crate::wire::{ClipWords, clip_words};

/// What was learned of a class.
#[derive(Clone, Debug, Serialize)]
pub struct LearnedJson {
    /// Name of the class.
    pub name: String,
    /// Motions that it was learned from.
    pub n_motions: usize,
    /// Columns of the template.
    pub columns: usize,
    /// Iterations of the averaging.
    pub iterations: usize,
    /// Mean number of words of the motions.
    pub mean_length: f64,
    /// The most that a match may cost, if that was given or learned.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tau: Option<f64>,
    /// Columns of the keyframes, if such were to be chosen.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub keyframes: Vec<usize>,
    /// The template file.
    pub file: String,
    /// Features that do not matter since the rig of some clip lacks a body point for them.
    pub unavailable: Vec<String>,
}

/// The motions of one class, and where its template goes.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Class {
    pub(super) name: String,
    pub(super) clips: Vec<ClipRef>,
    pub(super) file: PathBuf,
}

/// What templates are learned from.
pub(super) struct Clips {
    pub(super) classes: Vec<Class>,
    /// Clips that show none of the classes.
    pub(super) negatives: Vec<ClipRef>,
}

/// How templates are learned.
#[derive(Clone, Copy, Debug)]
pub struct What<'a> {
    /// The features.
    pub set: &'a FeatureSet,
    /// Words per second.
    pub rate: f64,
    /// How motions are averaged.
    pub config: LearnConfig,
    /// The most that a match may cost.
    pub tau: Option<Tau>,
    /// Whether keyframes are chosen.
    pub keyframes: bool,
}

/// Runs the command.
///
/// # Errors
/// [`Failure`] if the command line makes no sense or a template cannot be written.
pub fn run(args: &LearnArgs, global: &Global) -> Result<Exit, Failure> {
    let voice = global.voice();
    let (named, rate) = words_of(&args.set)?;
    let what = What {
        set: &named.set,
        rate,
        config: LearnConfig {
            unwarp: args.unwarp.into(),
            ..LearnConfig::default()
        },
        tau: args.tau,
        keyframes: args.keyframes,
    };
    let negatives = match args.negatives.as_slice() {
        [] => Vec::new(),
        paths => find_clips(paths)?,
    };
    let classes = match &args.by_folder {
        Some(dir) => by_folder(dir, &args.output, voice)?,
        None => vec![one_class(args)?],
    };
    let needs_others = what.tau == Some(Tau::Learned) || what.keyframes;
    if needs_others && negatives.is_empty() && classes.len() < 2 {
        let message =
            "expected clips of something else to tell the class from, found no --negatives";
        return Err(Failure::Usage(message.to_owned()));
    }
    let clips = Clips { classes, negatives };
    let outcome = learn_all(&clips, &what, &global.read_options()?, voice)?;
    voice.report("learn", &outcome, |out| {
        for class in &outcome.result {
            writeln!(
                out,
                "{}: {} from {} of {:.1} words on average, {}",
                class.file,
                count(class.columns, "column"),
                count(class.n_motions, "motion"),
                class.mean_length,
                count(class.iterations, "iteration"),
            )?;
            if let Some(tau) = class.tau {
                writeln!(out, "  a match may cost {tau:.4}")?;
            }
            if let [first, ..] = class.keyframes.as_slice() {
                let columns = class.keyframes[1..].iter();
                let columns = columns.fold(first.to_string(), |all, next| format!("{all}, {next}"));
                writeln!(out, "  keyframes at columns {columns}")?;
            }
            if !class.unavailable.is_empty() {
                let names = class.unavailable.join(", ");
                writeln!(out, "  does not matter, as not all clips have it: {names}")?;
            }
        }
        Ok(())
    })
}

/// The feature set and the rate that a template is to have.
pub(super) fn words_of(args: &SetArgs) -> Result<(NamedSet, f64), Failure> {
    let named = NamedSet::find(args.set.as_deref().unwrap_or(DEFAULT_SET))?;
    let rate = args.rate.unwrap_or(DEFAULT_RATE);
    if rate > 0.0 && rate.is_finite() {
        return Ok((named, rate));
    }
    let message = format!("expected a positive --rate, found {rate}");
    Err(Failure::Usage(message))
}

fn one_class(args: &LearnArgs) -> Result<Class, Failure> {
    let file = args.output.clone();
    if targets::is_folder(&file) {
        let message = format!("{} is a folder; name a file", file.display());
        return Err(Failure::Usage(message));
    }
    let name = args.name.clone();
    Ok(Class {
        name: name.unwrap_or_else(|| templates::name_of(&file)),
        clips: find_clips(&args.clips)?,
        file,
    })
}

/// A class for each folder below `dir` that has clips, by name. Its template goes where the folder is
/// seen from `dir`, below `output`.
fn by_folder(dir: &Path, output: &Path, voice: Voice) -> Result<Vec<Class>, Failure> {
    if dir.is_file() || output.is_file() {
        let message = "--by-folder takes a folder of folders of clips, and -o a folder";
        return Err(Failure::Usage(message.to_owned()));
    }
    let mut folders: BTreeMap<PathBuf, Vec<ClipRef>> = BTreeMap::new();
    for clip in find_clips(&[dir.to_owned()])? {
        let folder = clip.path.parent().unwrap_or(dir);
        let below = folder.strip_prefix(dir).unwrap_or(folder);
        folders.entry(below.to_owned()).or_default().push(clip);
    }
    if let Some(strays) = folders.remove(Path::new("")) {
        let strays = count(strays.len(), "clip");
        voice.note(&format!(
            "left out: {strays} in no folder below {}",
            dir.display()
        ));
    }
    let classes = folders.into_iter().map(|(below, clips)| {
        let name = below.display().to_string();
        let mut file = output.join(below).into_os_string();
        file.push(format!(".{}", templates::TEXT_EXTENSION));
        let file = PathBuf::from(file);
        Class { name, clips, file }
    });
    Ok(classes.collect())
}

/// Learns and writes the templates of classes that have at least one readable clip.
pub(super) fn learn_all(
    Clips { classes, negatives }: &Clips,
    what: &What<'_>,
    options: &ReadOptions,
    voice: Voice,
) -> Result<Outcome<Vec<LearnedJson>>, Failure> {
    let clips = classes.iter().flat_map(|c| &c.clips).chain(negatives);
    let clips: Vec<ClipRef> = clips.cloned().collect();
    let (done, skipped) = voice.batch(&clips, "reading", |clip| read(clip, what, options));
    tell_warnings(voice, done.iter().flat_map(|(_, words)| &words.warnings));
    tell_filled(voice, done.iter().map(|(_, words)| words.filled).sum());
    let words: BTreeMap<&ClipRef, &ClipWords> = done.iter().map(|(c, w)| (c, w)).collect();
    let bar = voice.progress(classes.len(), "learning");
    let learned: Vec<Option<Result<LearnedJson, Failure>>> = classes
        .par_iter()
        .with_max_len(1)
        .map(|class| {
            let known = |clips: &[ClipRef]| -> Vec<&ClipWords> {
                clips.iter().filter_map(|c| words.get(c).copied()).collect()
            };
            let others = classes.iter().filter(|other| *other != class);
            let mut rest: Vec<&ClipWords> = others.flat_map(|c| known(&c.clips)).collect();
            rest.extend(known(negatives));
            let learned = learn_one(class, &known(&class.clips), &rest, what);
            bar.inc(1);
            learned
        })
        .collect();
    bar.finish_and_clear();
    let mut outcome = Outcome {
        found: false,
        result: Vec::new(),
        skipped,
    };
    for class in learned.into_iter().flatten() {
        match class {
            Ok(learned) => outcome.result.push(learned),
            // One class never stops the others.
            Err(failure @ Failure::Input { .. }) => {
                outcome.skipped.push(Skipped::new(Path::new(""), &failure));
            }
            Err(failure) => return Err(failure),
        }
    }
    outcome.found = !outcome.result.is_empty();
    Ok(outcome)
}

fn read(clip: &ClipRef, what: &What<'_>, options: &ReadOptions) -> Result<ClipWords, Failure> {
    let words = clip_words(clip, options, what.set, what.rate)?;
    if words.words.is_empty() {
        let message = format!(
            "expected frames at {} words per second, found none",
            what.rate
        );
        return Err(Failure::input(&clip.path, message));
    }
    Ok(words)
}

fn learn_one(
    class: &Class,
    motions: &[&ClipWords],
    rest: &[&ClipWords],
    what: &What<'_>,
) -> Option<Result<LearnedJson, Failure>> {
    if motions.is_empty() {
        return None;
    }
    let learned = learn_class(&class.name, motions, what).and_then(|(mut template, learned)| {
        template.tau = match what.tau {
            None => None,
            Some(Tau::Value(tau)) => Some(tau),
            Some(Tau::Learned) => Some(tau(&class.name, motions, rest, what)?),
        };
        if what.keyframes {
            template.keyframes = keyframes(&template, motions, rest, what)?;
        }
        templates::save(&template, &class.file)?;
        let available = available(motions, what.set);
        let n_words: usize = motions.iter().map(|words| words.words.len()).sum();
        Ok(LearnedJson {
            name: class.name.clone(),
            n_motions: motions.len(),
            columns: template.template.n_columns(),
            iterations: learned.iterations,
            mean_length: n_words as f64 / motions.len() as f64,
            tau: template.tau,
            keyframes: template.keyframes.iter().map(|k| k.column).collect(),
            file: class.file.display().to_string(),
            unavailable: selection::names(what.set, what.set.all() & !available),
        })
    });
    Some(learned)
}
