use std::path::PathBuf;

use clap::{Args, ValueEnum};
use mtemplate::{ShortClips, Steps};

use super::matching::parse_tau;
use super::{SetArgs, Tau, UnwarpArg};
use crate::eval::Documents;

pub(super) const EXAMPLES: &str = "Example: motif eval labelled/\n\
    Example: motif eval hdm05/ --split actor --test mm,tr --baselines\n\
    Example: motif eval hdm05/ --unwarp balance --tau auto --json\n\n\
    DIR has a sub-folder for each class. A template is learned from the training clips of each class and matched \
    against the test clips of all classes. A hit costs at most tau; relevant are the test clips of the class that \
    have a hit; precision is relevant over hits, recall relevant over the test clips of the class. Average \
    precision (ap) ranks all test clips by their least cost, equals in order of class and file name. The separation \
    quotient (sep) is the median of all costs over the median cost of the correct hits among the best ten. A clip is \
    taken for the class that it costs least for, in units of the class's tau.\n\n\
    A clip with half as many frames as a template or fewer is too short for a match. Its first and last frame are held \
    as long as is needed, half of it on either side; its match is the whole clip. --short-clips unmatched leaves it \
    without a cost: then it is ranked last, and a relevant one counts as not found. --short-clips joined matches all test \
    clips as one stream, in order of class and file name, as published; a hit is one of the clip that has most of its \
    frames.\n\n\
    --split actor tells actors by the names of files: the path below the folder of the class in parts of letters \
    and digits; the first part that is not the same in all names is the actor (bd in HDM_bd_squat1Reps_001_120), \
    unless --actor-part says which one.";

/// Arguments of `eval`.
#[derive(Args, Clone, Debug)]
pub struct EvalArgs {
    /// A folder with a sub-folder of clips for each class
    #[arg(value_name = "DIR")]
    pub dir: PathBuf,
    /// How clips are divided into those to learn from and those to test on
    #[arg(long, value_enum, default_value_t = SplitArg::Paper)]
    pub split: SplitArg,
    /// Actors whose clips are tests, for --split actor
    #[arg(long, value_name = "ACTORS", value_delimiter = ',')]
    pub test: Vec<String>,
    /// Which part of the names is the actor, from 1, for --split actor [default: the first that differs]
    #[arg(long, value_name = "N")]
    pub actor_part: Option<usize>,
    /// Every K-th clip of each class is a test, for --split file
    #[arg(long, value_name = "K", default_value_t = 2, value_parser = parse_every)]
    pub every: usize,
    /// Seed of a random order of the clips of each class, for --split file [default: order of file names]
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// The largest cost of a hit; auto learns it for each class from the training clips
    #[arg(long, value_name = "TAU|auto", default_value = "0.06", value_parser = parse_tau)]
    pub tau: Tau,
    /// Values this near to 0 or 1 count as that, others as either
    #[arg(long, value_name = "DELTA", default_value_t = 0.1, value_parser = parse_delta)]
    pub delta: f64,
    /// How averages are brought back to real time
    #[arg(long, value_enum, default_value_t = UnwarpArg::Exact)]
    pub unwarp: UnwarpArg,
    /// What steps weigh: the template's advance, or one each as equation 2 is printed
    #[arg(long, value_enum, default_value_t = StepsArg::Advance)]
    pub steps: StepsArg,
    /// What becomes of test clips that are too short for any match
    #[arg(long, value_enum, default_value_t = TestClipsArg::Held)]
    pub short_clips: TestClipsArg,
    /// Match one example of each class as well: its features (RF), joint rotations (Q), coordinates (3D)
    #[arg(long)]
    pub baselines: bool,
    /// Which features and how often
    #[command(flatten)]
    pub set: SetArgs,
}

/// How clips are divided.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SplitArg {
    /// About every other clip of each class, as in the 2006 paper.
    Paper,
    /// Learn from some actors, test on others.
    Actor,
    /// Every K-th clip of each class is a test.
    File,
}

/// What becomes of test clips that are too short for any match.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum TestClipsArg {
    /// Their first and last frames are held until a match is possible.
    Held,
    /// Nothing matches.
    Unmatched,
    /// All test clips are one stream, so that matches may reach into their neighbours.
    Joined,
}

impl From<TestClipsArg> for Documents {
    fn from(arg: TestClipsArg) -> Documents {
        match arg {
            TestClipsArg::Held => Documents::Apart(ShortClips::Held),
            TestClipsArg::Unmatched => Documents::Apart(ShortClips::Unmatched),
            TestClipsArg::Joined => Documents::Joined,
        }
    }
}

/// What steps weigh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum StepsArg {
    /// 1, 1, 2: the template's advance.
    Advance,
    /// 1 each.
    Unit,
}

impl From<StepsArg> for Steps {
    fn from(arg: StepsArg) -> Steps {
        match arg {
            StepsArg::Advance => Steps::Advance,
            StepsArg::Unit => Steps::Unit,
        }
    }
}

fn parse_every(text: &str) -> Result<usize, String> {
    let every = text.parse().ok().filter(|every| *every >= 2);
    every.ok_or_else(|| "expected a whole number from 2".to_owned())
}

fn parse_delta(text: &str) -> Result<f64, String> {
    let delta = text.parse().ok().filter(|delta| (0.0..0.5).contains(delta));
    delta.ok_or_else(|| "expected a number from 0, below 0.5".to_owned())
}
