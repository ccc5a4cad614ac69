//! The command line of `motif template`.

use std::ops::Range;
use std::path::PathBuf;

use clap::{Args, Subcommand};

use super::SetArgs;

/// Arguments of `template`.
#[derive(Args, Debug)]
pub struct TemplateArgs {
    /// What is to be done.
    #[command(subcommand)]
    pub command: TemplateCommand,
}

/// What can be done with templates.
#[derive(Debug, Subcommand)]
pub enum TemplateCommand {
    /// Draw a template as text, and as a picture
    #[command(after_help = "Example: motif template show squat.mtpl -o squat.png\n\
        A row per feature, a character per column: # on, . off, blank where it does not matter. The picture has \
        shades for the shares in between.")]
    Show(ShowArgs),
    /// Swap left and right
    #[command(after_help = "Example: motif template mirror kick_left.mtpl -o kick_right.mtpl")]
    Mirror(MirrorArgs),
    /// One template for the classes of several
    #[command(
        after_help = "Example: motif template combine forward.mtpl backward.mtpl -o either.mtpl\n\
        The templates are learned from as if they were motions, each as often as it has motions, or all alike if that \
        is not known of one. `motif learn forward/ backward/ -o either.mtpl` learns from the motions themselves."
    )]
    Combine(CombineArgs),
    /// Let only some features matter, or cut out some columns
    #[command(
        after_help = "Example: motif template restrict squat.mtpl --features lower F37 -o legs.mtpl\n\
        Example: motif template restrict squat.mtpl --seconds 0-0.8 -o down.mtpl"
    )]
    Restrict(RestrictArgs),
    /// A template from nothing but feature names
    #[command(
        after_help = "Example: motif template new --name sweeping --length 50 --one F13,F32,F33 -o sweep.mtpl\n\
        Sweeping with a hand brush: the right hand is fast and low and the spine horizontal, all along; no other \
        feature matters.\n\n\
        Example: motif template new --length 40 --one rknee_bent@10-30 --zero rhand_fast --at 0-10 -o bend.mtpl\n\
        @ gives a feature columns of its own, from 0, the end not included."
    )]
    New(NewArgs),
    /// Write a template in the other form
    #[command(after_help = "Example: motif template convert squat.mtpl squat.mtpb\n\
        .mtpb is the binary form; all else is text, which also writes a template made by hand in full.")]
    Convert(ConvertTemplateArgs),
}

/// Arguments of `template show`.
#[derive(Args, Debug)]
pub struct ShowArgs {
    /// The template
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// A picture to write
    #[arg(short, long, value_name = "PNG")]
    pub output: Option<PathBuf>,
}

/// Arguments of `template mirror`.
#[derive(Args, Debug)]
pub struct MirrorArgs {
    /// The template
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// What to write
    #[command(flatten)]
    pub to: ToArgs,
    /// The feature set, if it is none of the built-in ones: a TOML file
    #[arg(long, value_name = "SET")]
    pub set: Option<String>,
}

/// Where a template goes.
#[derive(Args, Debug)]
pub struct ToArgs {
    /// The template to write; binary if it ends with .mtpb
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Its name [default: that of the output]
    #[arg(long, value_name = "NAME")]
    pub name: Option<String>,
}

/// Arguments of `template combine`.
#[derive(Args, Debug)]
pub struct CombineArgs {
    /// The templates
    #[arg(required = true, num_args = 2.., value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// What to write
    #[command(flatten)]
    pub to: ToArgs,
}

/// Arguments of `template restrict`.
#[derive(Args, Debug)]
pub struct RestrictArgs {
    /// The template
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// What to write
    #[command(flatten)]
    pub to: ToArgs,
    /// Features that go on to matter: names, numbers (F20), parts of the set (upper), with * for anything (*knee*) [default: all]
    #[arg(long, value_name = "NAMES", num_args = 1.., value_delimiter = ',')]
    pub features: Vec<String>,
    /// Columns to keep, from 0, the end not included [default: all]
    #[arg(long, value_name = "A-B", value_parser = parse_columns)]
    pub columns: Option<Range<usize>>,
    /// Columns to keep that begin in this time
    #[arg(long, value_name = "A-B", value_parser = parse_seconds, conflicts_with = "columns")]
    pub seconds: Option<Range<f64>>,
    /// The feature set, if it is none of the built-in ones: a TOML file
    #[arg(long, value_name = "SET")]
    pub set: Option<String>,
}

/// Arguments of `template new`.
#[derive(Args, Debug)]
pub struct NewArgs {
    /// What to write
    #[command(flatten)]
    pub to: ToArgs,
    /// Number of columns
    #[arg(long, value_name = "COLUMNS")]
    pub length: usize,
    /// Features that are on: names, numbers (F20), parts of the set or wildcards, with columns of their own if wanted (F20@10-30)
    #[arg(long, value_name = "NAMES", num_args = 1.., value_delimiter = ',')]
    pub one: Vec<String>,
    /// Features that are off
    #[arg(long, value_name = "NAMES", num_args = 1.., value_delimiter = ',')]
    pub zero: Vec<String>,
    /// Columns in which they are, from 0, the end not included [default: all]
    #[arg(long, value_name = "A-B", value_parser = parse_columns)]
    pub at: Option<Range<usize>>,
    /// Which features and how often
    #[command(flatten)]
    pub set: SetArgs,
}

/// Arguments of `template convert`.
#[derive(Args, Debug)]
pub struct ConvertTemplateArgs {
    /// The template
    #[arg(value_name = "IN")]
    pub input: PathBuf,
    /// The template to write
    #[arg(value_name = "OUT")]
    pub output: PathBuf,
}

/// Reads `10-30`.
pub(crate) fn parse_columns(text: &str) -> Result<Range<usize>, String> {
    let ends = text
        .split_once('-')
        .and_then(|(a, b)| Some(a.parse().ok()?..b.parse().ok()?));
    ends.filter(|columns: &Range<usize>| !columns.is_empty())
        .ok_or_else(|| "expected columns such as 10-30 (first, end)".to_owned())
}

fn parse_seconds(text: &str) -> Result<Range<f64>, String> {
    let ends = text
        .split_once('-')
        .and_then(|(a, b)| Some(a.parse().ok()?..b.parse().ok()?));
    ends.filter(|seconds: &Range<f64>| seconds.start < seconds.end)
        .ok_or_else(|| "expected seconds such as 0.5-1.2 (first, end)".to_owned())
}
