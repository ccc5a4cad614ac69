use std::path::PathBuf;

use clap::Args;
use mocap_io::FrameRate;

use super::{parse_rate, parse_seconds};
use crate::align::DEFAULT_MARGIN_SECONDS;
use crate::commands::align::DEFAULT_MAX_DISTANCE;

/// Arguments of `align`.
#[derive(Args, Clone, Debug)]
pub struct AlignArgs {
    /// A file, with a span if wanted: walk.bvh@120-360
    #[arg(value_name = "A")]
    pub a: PathBuf,
    /// Another one
    #[arg(value_name = "B")]
    pub b: PathBuf,
    /// A file to write, by its extension: .csv or .json for the path, .bvh, .amc, .glb, .npy or .npz for
    /// the blend; may be given more than once
    #[arg(short, long, value_name = "FILE")]
    pub output: Vec<PathBuf>,
    /// Blend the aligned clips: 0 is A, 1 is B; takes one skeleton and an -o for the motion
    #[arg(long, value_name = "WEIGHT", value_parser = parse_weight)]
    pub blend: Option<f64>,
    /// Feature set whose segments guide the alignment [default: mueller2006]
    #[arg(long, value_name = "SET")]
    pub set: Option<String>,
    /// Poses per second to compare [default: the lower of the two clips' own rates]
    #[arg(long, value_name = "HZ", value_parser = parse_rate)]
    pub rate: Option<FrameRate>,
    /// How far around the aligned segments the path may lie
    #[arg(long, value_name = "TIME", value_parser = parse_seconds, default_value_t = DEFAULT_MARGIN_SECONDS)]
    pub margin: f64,
    /// Clips are too different if their points are further apart than this on average, in metres
    #[arg(long, value_name = "METRES", default_value_t = DEFAULT_MAX_DISTANCE)]
    pub max_distance: f64,
    /// Compare with DTW over the full matrix, however large [default: up to four million cells]
    #[arg(long)]
    pub check: bool,
}

fn parse_weight(text: &str) -> Result<f64, String> {
    let weight = text.parse().ok().filter(|w| (0.0..=1.0).contains(w));
    weight.ok_or_else(|| "expected a number from 0 to 1".to_owned())
}
