use std::path::PathBuf;

use clap::Args;

use super::MatchingArgs;

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
    /// How well it has to fit
    #[command(flatten)]
    pub matching: MatchingArgs,
    /// Look only around keyframes: auto for the template's own, or if it has none those chosen from its columns; a file with tables of keyframes; off to look everywhere [default: off]
    #[arg(long, value_name = "auto|off|FILE", requires = "template")]
    pub keyframes: Option<PathBuf>,
}
