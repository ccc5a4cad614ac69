//! The command line of `motif learn`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use mtemplate::Unwarp;

use super::{SetArgs, Tau, parse_tau};

/// What `motif learn --help` ends with.
pub(super) const EXAMPLES: &str = "Example: motif learn squats/*.amc walk.bvh@120-360 -o squat.mtpl\n\
    Example: motif learn squats/ -o squat.mtpl --tau auto --negatives walks/ jumps/\n\
    Example: motif learn --by-folder training/ -o templates/\n\
    training/squat/*.amc become templates/squat.mtpl, and so on for each folder below training/ that has clips.\n\n\
    Each value of a template is the share of the motions in which a feature is on, aligned in time. Two classes in one \
    template: motif learn forward/ backward/ -o both.mtpl. A feature that the rig of any clip lacks the body points \
    for does not matter in the template. FILE is text, or binary if it ends with .mtpb; the first clip is the \
    reference that the others are aligned with.";

/// Arguments of `learn`.
#[derive(Args, Debug)]
pub struct LearnArgs {
    /// The motions of the class: files, with a span if wanted (walk.bvh@120-360), and folders
    #[arg(required_unless_present = "by_folder", value_name = "CLIP")]
    pub clips: Vec<PathBuf>,
    /// Learn one template for each folder below DIR that has clips
    #[arg(long, value_name = "DIR", conflicts_with_all = ["clips", "name"])]
    pub by_folder: Option<PathBuf>,
    /// The template to write; a folder with --by-folder
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Name of the class [default: that of FILE]
    #[arg(long, value_name = "NAME")]
    pub name: Option<String>,
    /// How columns that many frames were aligned with, or few, become columns of one frame
    #[arg(long, value_enum, default_value_t = UnwarpArg::Exact)]
    pub unwarp: UnwarpArg,
    /// The most that a match may cost, kept in the template: a number from 0 to 1, or auto to learn it, which
    /// needs clips of something else: --negatives, and other folders with --by-folder
    #[arg(long, value_name = "TAU", value_parser = parse_tau)]
    pub tau: Option<Tau>,
    /// Clips and folders of clips that do not show the class, for --tau auto
    #[arg(long, num_args = 1.., value_name = "PATH", requires = "tau")]
    pub negatives: Vec<PathBuf>,
    /// Which features and how often
    #[command(flatten)]
    pub set: SetArgs,
}

/// How averages are unwarped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum UnwarpArg {
    /// All columns but the last are of one frame
    #[default]
    Exact,
    /// As in the published experiments: whole columns are repeated or merged
    Balance,
}

impl From<UnwarpArg> for Unwarp {
    fn from(arg: UnwarpArg) -> Unwarp {
        match arg {
            UnwarpArg::Exact => Unwarp::Exact,
            UnwarpArg::Balance => Unwarp::Balance,
        }
    }
}
