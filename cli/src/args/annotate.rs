use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::MatchingArgs;
use crate::annotation::Labeller;
use crate::failure::Failure;
use crate::library::NamedSet;
use crate::templates;

/// Shown below the help of `annotate`.
pub(super) const EXAMPLES: &str = "Examples:
  motif annotate takes/ --templates classes/ -o spans.csv
  motif annotate gym.amc --templates squat.mtpl --tau 0.04 --exclusive -o gym.eaf
  motif convert live.bvh live.csv; motif annotate --stream --templates classes/ < live.csv

--stream reads, line by line, one of: a BVH file; positions as `convert` writes them to .csv; or words in \
hexadecimal, one a line, as `features --json` gives them (rate: that of the templates). Each span is printed as \
soon as no frame to come can change it: label, first frame, frame after the last, the same in seconds, cost; with \
--json one JSON object a line.";

/// Arguments of `annotate`.
#[derive(Args, Debug)]
pub struct AnnotateArgs {
    /// Files, with a span if wanted (walk.bvh@120-360), and folders
    #[arg(
        required_unless_present = "stream",
        conflicts_with = "stream",
        value_name = "PATH"
    )]
    pub paths: Vec<PathBuf>,
    /// Template files, and folders of them
    #[arg(long, required = true, num_args = 1.., value_name = "PATH")]
    pub templates: Vec<PathBuf>,
    /// How well a span has to match
    #[command(flatten)]
    pub matching: MatchingArgs,
    /// The feature set of the templates, if it is none of the built-in ones: a TOML file
    #[arg(long, value_name = "SET")]
    pub set: Option<String>,
    /// One label a frame at most: that of the span with the least cost for its threshold
    #[arg(long)]
    pub exclusive: bool,
    /// A file for all clips, or a folder (with / at its end) for one file per clip [default: a table on standard output]
    #[arg(short, long, value_name = "FILE", conflicts_with = "stream")]
    pub output: Option<PathBuf>,
    /// The form of the output [default: by the extension of FILE]
    #[arg(long, value_enum, conflicts_with = "stream")]
    pub format: Option<AnnotationFormat>,
    /// Read frames or words from standard input, and print spans as they become certain
    #[arg(long, conflicts_with = "exclusive")]
    pub stream: bool,
}

impl AnnotateArgs {
    /// The templates, ready to be matched.
    ///
    /// # Errors
    /// [`Failure`] for templates and sets that cannot be read or do not fit.
    pub fn labeller(&self) -> Result<Labeller, Failure> {
        let set = self.set.as_deref().map(NamedSet::find).transpose()?;
        let templates = templates::load_all(&self.templates)?;
        let with_tau = templates.into_iter().map(|(_, template)| {
            let tau = self.matching.tau_of(&template)?;
            Ok((template, tau))
        });
        let with_tau: Result<Vec<_>, Failure> = with_tau.collect();
        Labeller::new(&with_tau?, self.matching.delta(), set.as_ref())
    }
}

/// A file format of labelled spans.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum AnnotationFormat {
    /// As `--json`.
    Json,
    /// A row per span.
    Csv,
    /// ELAN, one clip a file, a tier per label.
    Eaf,
}

impl AnnotationFormat {
    /// The usual ending of such files.
    #[must_use]
    pub fn extension(self) -> &'static str {
        match self {
            AnnotationFormat::Json => "json",
            AnnotationFormat::Csv => "csv",
            AnnotationFormat::Eaf => "eaf",
        }
    }
}
