use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::{ArgGroup, Args};

pub(super) const EXAMPLES: &str = "\
Example: motif walk walks.mbg --seconds 20 --seed 3 -o walk.bvh
Example: motif walk walks.mbg --path B3,B1,B7 -o walk.amc
Example: motif walk walks.mbg --from B1 --to B5 --footlock -o walk.glb

Each bundle on the way is blended from the submotion it is entered by to the one it is left by; place \
and heading go on from bundle to bundle. Foot skate is the mean speed over the floor of ankles and toes \
while they rest in the takes: within 4 cm of their low level and slower than 0.4 m/s.

At random, a walk stays where it can go on for ever: in the largest part of the graph whose bundles all lead to \
each other. How much that is of all bundles is told.";

/// Arguments of `walk`.
#[derive(Args, Clone, Debug)]
#[command(group = ArgGroup::new("way").required(true).args(["random", "seconds", "path", "from"]))]
#[command(group = ArgGroup::new("chance").args(["random", "seconds"]))]
pub struct WalkArgs {
    /// Bundles of clips, made by `bundle`; the clips are read again
    #[arg(value_name = "FILE.mbg")]
    pub bundles: PathBuf,
    /// The file to write, by its extension: .bvh, .amc (with its .asf), .glb, .csv, .npy or .npz
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Up to N bundles at random, without running into a dead end
    #[arg(long, value_name = "N")]
    pub random: Option<NonZeroUsize>,
    /// As many bundles at random as last S seconds, 3600 at most
    #[arg(long, value_name = "S", value_parser = parse_seconds)]
    pub seconds: Option<f64>,
    /// Another seed, another way
    #[arg(long, requires = "chance", default_value_t = 0)]
    pub seed: u64,
    /// Run into dead ends as well, and stop there
    #[arg(long, requires = "chance")]
    pub dead_ends: bool,
    /// These bundles one after the other: B3,B1,B7
    #[arg(long, value_name = "IDS", value_delimiter = ',', value_parser = parse_bundle)]
    pub path: Vec<usize>,
    /// The shortest way from this bundle
    #[arg(long, value_name = "ID", requires = "to", value_parser = parse_bundle)]
    pub from: Option<usize>,
    /// to this one
    #[arg(long, value_name = "ID", requires = "from", value_parser = parse_bundle)]
    pub to: Option<usize>,
    /// Hold the feet in place while they rest
    #[arg(long)]
    pub footlock: bool,
}

/// Memory holds walks of an hour.
const MAX_SECONDS: f64 = 3600.0;

fn parse_seconds(text: &str) -> Result<f64, String> {
    let seconds = text.parse().ok();
    let seconds = seconds.filter(|&s: &f64| s > 0.0 && s <= MAX_SECONDS);
    seconds.ok_or_else(|| format!("expected seconds above 0, up to {MAX_SECONDS}"))
}

fn parse_bundle(text: &str) -> Result<usize, String> {
    let text = text.trim();
    let digits = text.strip_prefix(['B', 'b']).unwrap_or(text);
    digits
        .parse()
        .map_err(|_| "expected the id of a bundle, such as B3".to_owned())
}
