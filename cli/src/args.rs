//! The command line.

mod align;
mod annotate;
mod bundle;
mod by_template;
mod eval;
mod explain;
mod learn;
mod library;
mod matching;
mod mismatch;
mod query;
mod rank;
mod report;
mod scene;
mod search;
mod template;
mod view;
mod walk;

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use mocap_io::{FrameRate, LengthUnit, UpAxis};

use crate::failure::Failure;
use crate::output::Voice;
use crate::recording::ReadOptions;
use crate::selection;

pub use align::AlignArgs;
pub use annotate::{AnnotateArgs, AnnotationFormat};
pub use bundle::{BundleArgs, ClosureArg, FromArg, KappaArg, MethodArg};
pub use by_template::TemplateSearchArgs;
pub use eval::{EvalArgs, SplitArg, StepsArg, TestClipsArg};
pub use explain::ExplainArgs;
pub use learn::{LearnArgs, UnwarpArg};
pub use library::{LibraryArg, LibraryArgs, LibraryCommand, RemoveArgs};
use matching::parse_tau;
pub use matching::{DEFAULT_TAU, MatchingArgs, ShortClipsArg, Tau};
pub use mismatch::MismatchArgs;
pub use query::{EngineArg, IndexArg, PlanArgs, SegmentArgs};
pub use rank::{RankArgs, RankBy};
pub use report::ReportArgs;
pub use scene::SceneArgs;
pub use search::{Mode, SearchArgs};
pub(crate) use template::parse_columns;
pub use template::{
    CombineArgs, ConvertTemplateArgs, MirrorArgs, NewArgs, RestrictArgs, ShowArgs, TemplateArgs,
    TemplateCommand, ToArgs,
};
pub use view::ViewArgs;
pub use walk::WalkArgs;

/// Finds human motion in motion-capture libraries.
#[derive(Debug, Parser)]
#[command(name = "motif", version, propagate_version = true)]
#[command(after_help = "Exit codes: 0 ok, 1 nothing found, 2 bad usage, 3 bad input, 4 I/O.")]
pub struct Cli {
    /// What is to be done.
    #[command(subcommand)]
    pub command: Command,
    /// What holds for every command.
    #[command(flatten)]
    pub global: Global,
}

/// Options of every command.
#[derive(Args, Debug)]
pub struct Global {
    /// Print one JSON document
    #[arg(long, global = true)]
    pub json: bool,
    /// Use N threads; 0 is one per core
    #[arg(long, global = true, value_name = "N", default_value_t = 0)]
    pub threads: usize,
    /// No progress bar, no notes
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    pub quiet: bool,
    /// Say every warning in full
    #[arg(short, long, global = true)]
    pub verbose: bool,
    /// Warnings are errors, and a skipped file makes the exit code 3
    #[arg(long, global = true)]
    pub strict: bool,
    /// The skeleton of AMC files [default: found beside each]
    #[arg(long, global = true, value_name = "FILE")]
    pub asf: Option<PathBuf>,
    /// Frames per second of the files, instead of what they say
    #[arg(long, global = true, value_name = "HZ", visible_alias = "fps", value_parser = parse_rate)]
    pub source_rate: Option<FrameRate>,
    /// Length unit of the files, instead of what they say or what is guessed: m, cm, mm, inch, foot, cmu or a number of metres
    #[arg(long, global = true, value_name = "UNIT", value_parser = parse_unit)]
    pub unit: Option<LengthUnit>,
    /// Axis that points up in the files, instead of what they say or what is guessed: y, z, -y, …
    #[arg(long, global = true, value_name = "AXIS", value_parser = parse_up, allow_hyphen_values = true)]
    pub up: Option<UpAxis>,
    /// Rig of the files, instead of the one recognised: a TOML file, or a name that `info` shows
    #[arg(long, global = true, value_name = "FILE")]
    pub rig: Option<String>,
    /// Fill gaps of markers up to this long, such as 0.25s or 250ms [default: gaps stay]
    #[arg(long, global = true, value_name = "TIME", value_parser = parse_seconds)]
    pub fill: Option<f64>,
}

fn parse_rate(text: &str) -> Result<FrameRate, String> {
    let hz = text.parse().ok().and_then(FrameRate::from_hz);
    hz.ok_or_else(|| "expected a positive number of frames per second".to_owned())
}

fn parse_up(text: &str) -> Result<UpAxis, String> {
    UpAxis::from_name(text).ok_or_else(|| "expected x, y, z, -x, -y or -z".to_owned())
}

fn parse_seconds(text: &str) -> Result<f64, String> {
    let (number, factor) = match text.strip_suffix("ms") {
        Some(number) => (number, 1e-3),
        None => (text.strip_suffix('s').unwrap_or(text), 1.0),
    };
    let seconds = number.trim().parse::<f64>().ok().map(|n| n * factor);
    let seconds = seconds.filter(|s| *s >= 0.0 && s.is_finite());
    seconds.ok_or_else(|| "expected a time such as 0.25s or 250ms".to_owned())
}

fn parse_unit(text: &str) -> Result<LengthUnit, String> {
    LengthUnit::from_name(text).ok_or_else(|| {
        "expected m, cm, mm, inch, foot, cmu or a positive number of metres".to_owned()
    })
}

impl Global {
    /// How to speak.
    #[must_use]
    pub fn voice(&self) -> Voice {
        Voice {
            json: self.json,
            quiet: self.quiet,
            verbose: self.verbose,
            strict: self.strict,
        }
    }

    /// How to read files, reading the rig file if one is named.
    ///
    /// # Errors
    /// [`Failure`] for a rig that cannot be read or is not known.
    pub fn read_options(&self) -> Result<ReadOptions, Failure> {
        Ok(ReadOptions {
            asf: self.asf.clone(),
            rate: self.source_rate,
            unit: self.unit,
            up: self.up,
            rig: self.rig.as_deref().map(selection::rig).transpose()?,
            fill: self.fill,
            strict: self.strict,
        })
    }
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// The tour on a built-in corpus; nothing to download
    #[command(after_help = "Example: motif demo")]
    Demo(DemoArgs),
    /// Format, frames, rate, skeleton, unit and body map of files
    #[command(after_help = "Example: motif info walk.bvh")]
    Info(InfoArgs),
    /// Write files in another format: bvh, amc (with its asf), glb, csv, npy or npz
    #[command(
        after_help = "Example: motif convert walk.amc@120-360 walk.glb --rate 30\n\
        Example: motif convert takes/ converted/ --to bvh"
    )]
    Convert(ConvertArgs),
    /// Feature matrix as csv, npy, json or png
    #[command(after_help = "Example: motif features walk.bvh -o walk.png")]
    Features(FeaturesArgs),
    /// Build or extend a library; clips that did not change are left alone
    #[command(after_help = "Example: motif index takes/ -o takes.lib\n\
        Example: motif index takes/ -o takes.lib --sync")]
    Index(IndexArgs),
    /// Look after a library: info, verify, compact, remove
    #[command(after_help = "Example: motif library info takes.lib\n\
        Example: motif library remove takes.lib takes/bad.amc takes/old")]
    Library(LibraryArgs),
    /// Find motions like an example, or a scene
    #[command(after_help = search::EXAMPLES)]
    Search(SearchArgs),
    /// Label what happens in clips, or in a stream, by motion templates
    #[command(after_help = annotate::EXAMPLES)]
    Annotate(AnnotateArgs),
    /// Learn the template of a class of motions from examples
    #[command(after_help = learn::EXAMPLES)]
    Learn(LearnArgs),
    /// Look at templates, edit them, write them by hand: show, mirror, combine, restrict, new, convert
    #[command(after_help = "Example: motif template show squat.mtpl")]
    Template(TemplateArgs),
    /// Align two clips in time, and blend them
    #[command(after_help = "Example: motif align slow.amc brisk.amc -o path.csv\n\
        Example: motif align walk.bvh@120-360 limp.bvh --blend 0.5 -o path.json -o between.bvh\n\n\
        Poses are compared on the body points that both clips have, wherever the bodies stand and face and \
        however tall they are, so the clips may have different skeletons and formats; the cost of a \
        step is the mean distance of these points in metres, the cost of the path the sum of its steps.")]
    Align(AlignArgs),
    /// Gather what is similar in clips, and how it goes on: motion bundles and their graph
    #[command(after_help = bundle::EXAMPLES)]
    Bundle(BundleArgs),
    /// A new motion from bundles: at random, along a path, or from here to there
    #[command(after_help = walk::EXAMPLES)]
    Walk(WalkArgs),
    /// One self-contained page of a library, clips, templates, bundles and results
    #[command(after_help = report::EXAMPLES)]
    Report(ReportArgs),
    /// Show a library in the browser, with searches
    #[command(after_help = view::EXAMPLES)]
    View(ViewArgs),
    /// How well templates find the motions of labelled folders
    #[command(after_help = eval::EXAMPLES)]
    Eval(EvalArgs),
}

/// Arguments of `demo`.
#[derive(Args, Debug)]
pub struct DemoArgs {
    /// Where to put the corpus and the library [default: motif-demo in the temporary folder]
    #[arg(long, value_name = "DIR")]
    pub dir: Option<PathBuf>,
    /// Another seed, another corpus
    #[arg(long, default_value_t = crate::commands::demo::SEED)]
    pub seed: u64,
}

/// Arguments of `info`.
#[derive(Args, Debug)]
pub struct InfoArgs {
    /// Files and folders
    #[arg(required_unless_present = "explain", value_name = "PATH")]
    pub paths: Vec<PathBuf>,
    /// Save the rig of the one file as TOML, to be changed and given back with --rig
    #[arg(long, value_name = "FILE")]
    pub save_rig: Option<PathBuf>,
    /// Say what a warning's code means, such as BVH012
    #[arg(long, value_name = "CODE")]
    pub explain: Option<String>,
    /// The rate of the files
    #[command(flatten)]
    pub rate: RateArg,
}

/// The rate of the files, for commands that make nothing with a rate of its own.
#[derive(Args, Clone, Copy, Debug, Default)]
pub struct RateArg {
    /// The same as --source-rate
    #[arg(long = "rate", value_name = "HZ", value_parser = parse_rate, conflicts_with = "source_rate")]
    pub rate: Option<FrameRate>,
}

/// Arguments of `features`.
#[derive(Args, Debug)]
pub struct FeaturesArgs {
    /// Files, with a span if wanted (walk.bvh@120-360), and folders
    #[arg(required = true, value_name = "PATH")]
    pub paths: Vec<PathBuf>,
    /// A file, or a folder for one file per clip [default: a summary on standard output]
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// The form of the output [default: by the extension of FILE]
    #[arg(long, value_enum)]
    pub format: Option<FeatureFormat>,
    /// Which features and how often
    #[command(flatten)]
    pub set: SetArgs,
}

/// A file format of feature matrices.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FeatureFormat {
    /// A row per word: clip, frame, seconds, features.
    Csv,
    /// `(words, features)`, `u8`.
    Npy,
    /// As `--json`.
    Json,
    /// A picture.
    Png,
}

impl FeatureFormat {
    /// The usual ending of such files.
    #[must_use]
    pub fn extension(self) -> &'static str {
        match self {
            FeatureFormat::Csv => "csv",
            FeatureFormat::Npy => "npy",
            FeatureFormat::Json => "json",
            FeatureFormat::Png => "png",
        }
    }
}

/// Arguments of `convert`.
#[derive(Args, Debug)]
pub struct ConvertArgs {
    /// A file, with a span if wanted (walk.bvh@120-360), or a folder
    #[arg(value_name = "IN")]
    pub input: PathBuf,
    /// The file to write, or a folder (with / at its end) for one file per clip
    #[arg(value_name = "OUT")]
    pub output: PathBuf,
    /// The format to write [default: by the extension of OUT]
    #[arg(long, value_enum)]
    pub to: Option<MotionFormat>,
    /// Frames per second to write; poses between frames are interpolated [default: the file's]
    #[arg(long, value_name = "HZ", value_parser = parse_rate)]
    pub rate: Option<FrameRate>,
    /// Length unit of the BVH or AMC to write [default: the file's if its format stays, else cm]
    #[arg(long, value_name = "UNIT", value_parser = parse_unit)]
    pub to_unit: Option<LengthUnit>,
    /// Swap left and right
    #[arg(long)]
    pub mirror: bool,
}

/// A file format that motions are written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum MotionFormat {
    /// Biovision hierarchy.
    Bvh,
    /// Acclaim motion, and its skeleton in an ASF file beside it.
    Amc,
    /// Binary glTF: skeleton, animation, and a small mesh with a skin.
    Glb,
    /// Positions: a row per frame, x, y, z per joint, metres, Y up.
    Csv,
    /// Positions `(frames, joints, 3)`, `f32`, metres, Y up.
    Npy,
    /// Positions, names, parents, rotations, channels and rate.
    Npz,
}

impl MotionFormat {
    /// The usual ending of such files.
    #[must_use]
    pub fn extension(self) -> &'static str {
        match self {
            MotionFormat::Bvh => "bvh",
            MotionFormat::Amc => "amc",
            MotionFormat::Glb => "glb",
            MotionFormat::Csv => "csv",
            MotionFormat::Npy => "npy",
            MotionFormat::Npz => "npz",
        }
    }
}

/// Which features, and how often.
#[derive(Args, Clone, Debug, Default)]
pub struct SetArgs {
    /// Feature set: mueller2006, mueller2006-table6, mueller2005, mueller2005-text, or a TOML file [default: mueller2006]
    #[arg(long, value_name = "SET")]
    pub set: Option<String>,
    /// Words per second [default: 30]
    #[arg(long, value_name = "HZ")]
    pub rate: Option<f64>,
}

/// Arguments of `index`.
#[derive(Args, Debug)]
pub struct IndexArgs {
    /// Files and folders
    #[arg(required = true, value_name = "PATH")]
    pub paths: Vec<PathBuf>,
    /// The library's folder
    #[arg(short, long, value_name = "LIB")]
    pub output: PathBuf,
    /// Which features and how often
    #[command(flatten)]
    pub set: SetArgs,
    /// Forget clips at or below the paths whose files are gone
    #[arg(long)]
    pub sync: bool,
}
