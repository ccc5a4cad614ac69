//! The command line of `motif bundle`.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use bundles::{Closure, Kappa};
use clap::{Args, ValueEnum};

/// What `motif bundle --help` ends with.
pub(super) const EXAMPLES: &str = "Example: motif bundle boxing.amc -o boxing.mbg\n\
    Example: motif bundle walks/ turn.bvh@120-960 -o walks.mbg --rho 2 --kappa 90 --svg walks.svg\n\
    Example: motif bundle more/ --add walks.mbg -o more.mbg\n\n\
    Poses are put into clusters, clips spelt in them, and what is similar gathered in bundles, after Beaudoin, van de \
    Panne and Poulin (2007). With --method paper all is as they do it; there a little noise or another seed makes other \
    bundles, so the default is another: clusters are about poses at even distances in time, poses are smoothed before, \
    and each bundle is the largest there is. Clips are read at their own rate, and all of one model have the same rate and the same \
    degrees of freedom; others are skipped, and so are markers, which do not turn. With --add, poses are labelled by \
    the old clusters, old bundles keep what they have and take what is like it, and the rest makes new bundles.";

/// Arguments of `bundle`.
#[derive(Args, Clone, Debug)]
pub struct BundleArgs {
    /// Files, with a span if wanted (walk.bvh@120-360), and folders
    #[arg(required = true, value_name = "PATH")]
    pub paths: Vec<PathBuf>,
    /// The model to write
    #[arg(short, long, value_name = "FILE.mbg")]
    pub output: PathBuf,
    /// Extend this model; everything else is as it was made
    #[arg(long, value_name = "OLD.mbg", conflicts_with_all = ["kappa", "rho", "gamma", "max_frames", "seed", "duration_weight", "closure", "from", "smooth", "near", "method"])]
    pub add: Option<PathBuf>,
    /// How bundles are made; sets what --closure, --from and --smooth are where they are not given
    #[arg(long, value_enum, default_value_t = MethodArg::Steady)]
    pub method: MethodArg,
    /// Pose clusters; auto takes as many as the Bayesian information criterion says [default: six for each second, up to
    /// 2,000; auto with --method paper]
    #[arg(long, value_name = "N|auto", value_parser = parse_kappa)]
    pub kappa: Option<KappaArg>,
    /// Bias towards long submotions: the volume of a bundle is (height - 1) * frames^rho
    #[arg(long, default_value_t = 1.0, value_parser = parse_rho)]
    pub rho: f64,
    /// Least ratio of durations in a bundle, 0 to 1; 0 lets them differ
    #[arg(long, default_value_t = 0.8, value_parser = parse_gamma)]
    pub gamma: f64,
    /// Longest submotion, in frames on average
    #[arg(long, value_name = "N", default_value_t = NonZeroUsize::new(200).unwrap_or(NonZeroUsize::MIN))]
    pub max_frames: NonZeroUsize,
    /// Another seed, other draws: of clusters and bundles with --method paper, of the order in which frames are chosen with
    /// both
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// What a frame² of difference in duration weighs beside a degree² in the poses where submotions begin and end
    #[arg(long, value_name = "WEIGHT", default_value_t = 1.0, value_parser = parse_rho)]
    pub duration_weight: f64,
    /// How far similarity is followed [default: direct; transitive with --method paper]
    #[arg(long, value_enum)]
    pub closure: Option<ClosureArg>,
    /// Which poses bundles grow from [default: all; frequent with --method paper]
    #[arg(long, value_enum)]
    pub from: Option<FromArg>,
    /// Smooth poses before they are put into clusters, by a normal curve with this standard deviation; more keeps more
    /// bundles as they are where poses are noisy, and makes neighbouring pieces of one motion alike [default: 0.1; 0 with
    /// --method paper]
    #[arg(long, value_name = "SECONDS", value_parser = parse_rho)]
    pub smooth: Option<f64>,
    /// How near poses are to be, as a multiple of the median distance of clusters that follow each other; with 1.4 or 2
    /// far more frames are in bundles, of which the motions are less alike
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, value_parser = parse_rho)]
    pub near: f64,
    /// Write the graph in the DOT language
    #[arg(long, value_name = "FILE")]
    pub dot: Option<PathBuf>,
    /// Draw the graph: boxes as wide as their frames and as high as the root of their height
    #[arg(long, value_name = "FILE")]
    pub svg: Option<PathBuf>,
    /// Write the graph in GraphML
    #[arg(long, value_name = "FILE")]
    pub graphml: Option<PathBuf>,
}

/// How many pose clusters there are to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KappaArg(pub Kappa);

/// How bundles are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum MethodArg {
    /// Clusters about poses at even distances in time: a little noise changes little
    Steady,
    /// As published: clusters are a Gaussian mixture, and bundles grow from a pose drawn by chance
    Paper,
}

/// How far similarity is followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ClosureArg {
    /// To what is similar to the seed of the bundle
    Direct,
    /// To what is similar to any member, as in the paper; bundles drift
    Transitive,
}

/// Which poses bundles grow from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FromArg {
    /// From any pose of the cluster that most of what is left goes through, as in the paper
    Frequent,
    /// From all, so that each bundle is the largest there is; takes longer
    All,
}

impl From<ClosureArg> for Closure {
    fn from(arg: ClosureArg) -> Closure {
        match arg {
            ClosureArg::Transitive => Closure::Transitive,
            ClosureArg::Direct => Closure::Direct,
        }
    }
}

fn parse_kappa(text: &str) -> Result<KappaArg, String> {
    let kappa = match text {
        "auto" => Some(Kappa::Auto),
        number => number.parse().ok().map(Kappa::Letters),
    };
    let kappa = kappa.map(KappaArg);
    kappa.ok_or_else(|| "expected a number of at least 1, or auto".to_owned())
}

fn parse_rho(text: &str) -> Result<f64, String> {
    let number = text.parse().ok();
    let number = number.filter(|rho: &f64| rho.is_finite() && *rho >= 0.0);
    number.ok_or_else(|| "expected a number of at least 0".to_owned())
}

fn parse_gamma(text: &str) -> Result<f64, String> {
    let number = text.parse().ok();
    let number = number.filter(|gamma| (0.0..=1.0).contains(gamma));
    number.ok_or_else(|| "expected a number from 0 to 1".to_owned())
}
