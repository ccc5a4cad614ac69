use std::path::PathBuf;

use clap::Args;

/// A motion template to look for.
#[derive(Args, Clone, Debug, Default)]
pub struct TemplateSearchArgs {
    /// A motion template to look for instead of an example, as `motif learn` writes them
    #[arg(
        long,
        value_name = "FILE",
        conflicts_with_all = [
            "example", "scene", "features", "enough", "mode", "segments", "alternatives", "mismatches", "engine",
            "indexes", "mirror", "by", "refine", "explain", "explain_png", "rate",
        ]
    )]
    pub template: Option<PathBuf>,
    /// The largest cost of a hit, from 0 to 1, or auto for what was learned with the template [default: auto, or 0.06 if the template has none]
    #[arg(long, value_name = "TAU", requires = "template", value_parser = parse_tau)]
    pub tau: Option<Tau>,
    /// Look only around keyframes: auto for the template's own, or if it has none those chosen from its columns; a file with [[keyframe]] tables; off to look everywhere [default: off]
    #[arg(long, value_name = "auto|off|FILE", requires = "template")]
    pub keyframes: Option<PathBuf>,
}

/// The largest cost of a hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tau {
    /// What the template has learned.
    Auto,
    /// This.
    Cost(f64),
}

fn parse_tau(text: &str) -> Result<Tau, String> {
    if text == "auto" {
        return Ok(Tau::Auto);
    }
    let cost = text.parse().ok();
    let cost = cost.filter(|cost: &f64| *cost >= 0.0 && cost.is_finite());
    cost.map(Tau::Cost)
        .ok_or_else(|| "expected a cost such as 0.06, or auto".to_owned())
}
