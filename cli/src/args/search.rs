use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::{
    ExplainArgs, MismatchArgs, PlanArgs, RankArgs, RateArg, SceneArgs, SegmentArgs,
    TemplateSearchArgs,
};

/// What `motif search --help` ends with.
pub(super) const EXAMPLES: &str = "Example: motif search takes.lib --example squat.amc@40-260 --features F20 F21 F37\n\
    A feature is a name (rknee_bent), a number (F20) or a part of the set (upper, lower, mix).\n\n\
    Example: motif search takes.lib --example squat.amc --features F20 F21 --mismatches 1 --at 2,3\n\
    One segment of the query, the second or the third as it is printed, may be another one in the hits.\n\n\
    Example: motif search takes.lib --example squat.amc --features '*knee*' lower --segment 2:-F19 --or 3:F20=0\n\
    The second segment is compared without F19; at the third the right knee may as well be straight.\n\n\
    Example: motif search takes.lib --example squats/ --features auto --enough 10 --mirror\n\
    Each clip of the folder in turn, and its mirror image; features with the briefest details are left out until \
    there are ten hits.\n\n\
    Example: motif search takes.lib --example squat.amc --features F20 F21 --rank dtw --refine 100\n\
    The files of the 100 hits whose timing is nearest are read again, and these hits ranked by how far their poses are \
    from the example's: metres per step of the best alignment, from end to end, wherever the bodies stand and face and \
    however tall they are (as `motif align` has it), at 30 poses per second at most. 0 is the same motion; hits \
    whose files cannot be read follow, then the others.\n\n\
    Example: motif search takes.lib --example squat.amc --features F20 F21 --explain --explain-png hits.png\n\
    Below each hit: the compared features that differ (with mismatches), in which segments, and the others, which were \
    masked, that are least like the example's. --json has all of it by segment, the picture by word.\n\n\
    Example: motif search takes.lib --scene kick_punch.scene, with a file such as this:\n  \
    # right foot kick followed by a left hand punch\n  \
    rfoot_raised : 0 1 0\n  \
    rknee_bent   : 0 1 0 1 0\n  \
    lelbow_bent  : * 1 0 1\n  \
    overlap rfoot_raised[2] rknee_bent[3]\n  \
    before  rfoot_raised[2] lelbow_bent[3]\n  \
    within 2s rfoot_raised[2] lelbow_bent[3]\n\
    A line is a feature and what it goes through: 0 off, 1 on, * anything, at either end. Positions count \
    from 1. `overlap`: the two runs share a frame; `before`: the first has ended when the second begins; \
    `within TIME`: at most so much lies between them, or, without runs, the whole hit takes at most so long. \
    `NAME as OTHER : …` names a line; `;` ends a statement like a new line; lines without a relation overlap. \
    Hits are ranked by their duration.\n\n\
    Example: motif search takes.lib --template squat.mtpl --keyframes auto\n\
    Hits of a class of motions, ranked by cost: the mean share of features that are not as the template asks. Keyframes \
    are columns of the template; only around places that have them in order is it matched, which is fast and may lose \
    hits. Without --keyframes everything is matched; with --lost that is done as well, and hits are counted as lost of \
    which less than half lies in a hit around keyframes.";

/// Hits that `--features auto` is content with: as many as a page lists.
const ENOUGH: usize = 20;

/// Arguments of `search`.
#[derive(Args, Debug)]
pub struct SearchArgs {
    /// The library's folder
    #[arg(value_name = "LIB")]
    pub library: PathBuf,
    /// The motion to look for, with a span if wanted: squat.amc@40-260; each clip of a folder in turn
    #[arg(long, value_name = "CLIP", required_unless_present_any = ["scene", "template"])]
    pub example: Option<PathBuf>,
    /// Or the scene
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Or the template
    #[command(flatten)]
    pub template: TemplateSearchArgs,
    /// Features to compare: names (rknee_bent), numbers (F20), parts of the set (upper), with * for anything (*knee*); or auto [default: all]
    #[arg(long, value_name = "NAMES", num_args = 1.., value_delimiter = ',')]
    pub features: Vec<String>,
    /// With --features auto, leave features out until there are N hits
    #[arg(long, value_name = "N", default_value_t = ENOUGH, conflicts_with = "scene")]
    pub enough: usize,
    /// What counts as the same
    #[arg(long, value_enum, default_value_t = Mode::Adaptive)]
    pub mode: Mode,
    /// What is different at some segments
    #[command(flatten)]
    pub segments: SegmentArgs,
    /// What may be wrong
    #[command(flatten)]
    pub wrong: MismatchArgs,
    /// How hits are found
    #[command(flatten)]
    pub plan: PlanArgs,
    /// Look for the left/right mirrored example as well
    #[arg(long, conflicts_with = "scene")]
    pub mirror: bool,
    /// In which order they are listed
    #[command(flatten)]
    pub rank: RankArgs,
    /// What is told about them
    #[command(flatten)]
    pub explain: ExplainArgs,
    /// How many hits to list; 0 for all
    #[arg(long, value_name = "N", default_value_t = 20)]
    pub top: usize,
    /// The rate of the example
    #[command(flatten)]
    pub rate: RateArg,
}

/// How segments are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Mode {
    /// Each segment of all features against one segment, compared on the chosen features
    Exact,
    /// Segments of the chosen features against single segments of all features
    Fuzzy,
    /// Segments of the chosen features on both sides
    Adaptive,
}

impl Mode {
    /// As on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Mode::Exact => "exact",
            Mode::Fuzzy => "fuzzy",
            Mode::Adaptive => "adaptive",
        }
    }
}
