//! `motif template`.

mod new;
mod show;

use std::ops::Range;
use std::path::Path;

use mtemplate::{ClassTemplate, EditError, LearnConfig, combine};
use relfeat::FeatureSet;
use serde::Serialize;

use crate::args::{Global, MirrorArgs, RestrictArgs, TemplateArgs, TemplateCommand, ToArgs};
use crate::failure::{Exit, Failure};
use crate::library::NamedSet;
use crate::output::{Outcome, Voice, count};
use crate::selection;
use crate::templates;

/// A template that was written.
#[derive(Clone, Debug, Serialize)]
pub struct WrittenJson {
    /// The file.
    pub file: String,
    /// Name of the template.
    pub name: String,
    /// Its columns.
    pub columns: usize,
    /// Names of the features that matter somewhere.
    pub features: Vec<String>,
    /// Motions that it was learned from.
    pub n_motions: Option<usize>,
}

/// Runs the command.
///
/// # Errors
/// [`Failure`] if a template cannot be read, made or written.
pub fn run(args: &TemplateArgs, global: &Global) -> Result<Exit, Failure> {
    let voice = global.voice();
    match &args.command {
        TemplateCommand::Show(args) => show::run(args, voice),
        TemplateCommand::Mirror(args) => written(voice, mirror(args)?, &args.to.output),
        TemplateCommand::Combine(args) => {
            let classes = args.files.iter().map(|file| templates::load(file));
            let classes: Vec<ClassTemplate> = classes.collect::<Result<_, _>>()?;
            let combined = combine(&name(&args.to), &classes, &LearnConfig::default());
            written(voice, combined.map_err(refuse)?, &args.to.output)
        }
        TemplateCommand::Restrict(args) => written(voice, restrict(args)?, &args.to.output),
        TemplateCommand::New(args) => written(voice, new::template(args)?, &args.to.output),
        TemplateCommand::Convert(args) => {
            written(voice, templates::load(&args.input)?, &args.output)
        }
    }
}

/// Writes a template and says so.
fn written(voice: Voice, template: ClassTemplate, file: &Path) -> Result<Exit, Failure> {
    templates::save(&template, file)?;
    let outcome = Outcome {
        result: WrittenJson {
            file: file.display().to_string(),
            columns: template.template.n_columns(),
            features: asked(&template),
            n_motions: template.n_motions,
            name: template.name,
        },
        skipped: Vec::new(),
        found: true,
    };
    voice.report("template", &outcome, |out| {
        let done = &outcome.result;
        let columns = count(done.columns, "column");
        let features = count(done.features.len(), "feature");
        writeln!(out, "{}: {columns}, {features} that matter", done.file)
    })
}

/// Names of the features that a search looks at somewhere.
fn asked(template: &ClassTemplate) -> Vec<String> {
    let Ok(quantized) = template.template.quantize(DELTA) else {
        return Vec::new();
    };
    let words = (0..quantized.n_columns()).filter_map(|column| quantized.words(column));
    let asked = words.fold(0, |asked, (care, _)| asked | care);
    let named = template.features.iter().enumerate();
    let named = named.filter(|(bit, _)| asked >> bit & 1 == 1);
    named.map(|(_, name)| name.clone()).collect()
}

/// The papers' quantisation threshold δ.
const DELTA: f64 = 0.1;

fn refuse(error: EditError) -> Failure {
    Failure::Usage(error.to_string())
}

/// The name that was asked for, or that of the file.
fn name(to: &ToArgs) -> String {
    let given = to.name.clone();
    given.unwrap_or_else(|| templates::name_of(&to.output))
}

/// A template, and the set that its features are from.
fn with_set(file: &Path, set: Option<&str>) -> Result<(ClassTemplate, FeatureSet), Failure> {
    let template = templates::load(file)?;
    let named =
        NamedSet::find(set.unwrap_or(&template.feature_set)).map_err(|failure| match set {
            Some(_) => failure,
            None => Failure::Usage(format!(
                "{} is for the features of {:?}; name its TOML file with --set",
                file.display(),
                template.feature_set
            )),
        })?;
    let template = templates::for_set(&template, &named.set)?;
    Ok((template, named.set))
}

fn mirror(args: &MirrorArgs) -> Result<ClassTemplate, Failure> {
    let (template, set) = with_set(&args.file, args.set.as_deref())?;
    let permutation: Vec<usize> = set.features().iter().map(|f| f.mirror).collect();
    let mirrored = template.mirrored(&permutation).map_err(refuse)?;
    Ok(ClassTemplate {
        name: name(&args.to),
        ..mirrored
    })
}

fn restrict(args: &RestrictArgs) -> Result<ClassTemplate, Failure> {
    let (template, set) = with_set(&args.file, args.set.as_deref())?;
    let features = selection::select(&set, &args.features)?;
    let columns = match (&args.columns, &args.seconds) {
        (Some(columns), _) => columns.clone(),
        (None, Some(seconds)) => columns_in(&template, seconds),
        (None, None) => 0..template.template.n_columns(),
    };
    let restricted = template.restricted(features, columns).map_err(refuse)?;
    Ok(ClassTemplate {
        name: name(&args.to),
        ..restricted
    })
}

/// Columns that begin within a time, each being as long as its weight says.
fn columns_in(template: &ClassTemplate, seconds: &Range<f64>) -> Range<usize> {
    let mut frames = 0.0;
    let starts = template.template.weights().into_iter().map(|weight| {
        let start = frames / template.rate;
        frames += weight;
        start
    });
    let starts: Vec<f64> = starts.collect();
    // Sums of weights and seconds typed in decimals are both rounded.
    let index = |time: f64| starts.partition_point(|start| *start < time - ROUNDED);
    index(seconds.start)..index(seconds.end)
}

/// Seconds; far below a column, and far above what rounding does to times of hours.
const ROUNDED: f64 = 1e-6;
