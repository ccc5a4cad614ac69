use std::path::PathBuf;

use clap::Args;

use super::MatchingArgs;

pub(super) const EXAMPLES: &str = "\
Example: motif report walk.bvh limp.bvh -o two.html
Example: motif report takes.lib found.json classes/ walks.mbg -o all.html
Example: motif search takes.lib --example squat.amc --json > found.json; motif report found.json -o found.html

The page is one file that loads nothing, and opens from anywhere. Two motion files are aligned as well; motion files \
are labelled by the templates that are given with them. What search, annotate or align printed with --json is shown \
with its clips, which are read again.";

/// Most megabytes of motion unless asked otherwise.
const DEFAULT_BUDGET_MB: f64 = 8.0;

/// Arguments of `report`.
#[derive(Args, Clone, Debug)]
pub struct ReportArgs {
    /// Libraries, motion files with a span if wanted (walk.bvh@120-360), templates, bundles (.mbg), what search, annotate
    /// or align printed with --json, and folders of clips and templates
    #[arg(required = true, value_name = "LIB|FILE")]
    pub paths: Vec<PathBuf>,
    /// The page to write
    #[arg(short, long, value_name = "OUT.html")]
    pub output: PathBuf,
    /// Megabytes of motion in the page at most; clips beyond are shown by a few poses
    #[arg(long, value_name = "MB", default_value_t = DEFAULT_BUDGET_MB, value_parser = parse_megabytes)]
    pub budget: f64,
    /// What stands above the page [default: what is shown]
    #[arg(long, value_name = "TEXT")]
    pub title: Option<String>,
    /// Feature set of motion files [default: mueller2006]
    #[arg(long, value_name = "SET")]
    pub set: Option<String>,
    /// How well spans have to fit templates
    #[command(flatten)]
    pub matching: MatchingArgs,
}

fn parse_megabytes(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|mb| (0.0..=1000.0).contains(mb));
    number.ok_or_else(|| "expected a number of megabytes up to 1000".to_owned())
}
