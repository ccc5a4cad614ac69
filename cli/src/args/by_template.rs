use std::path::PathBuf;

use clap::Args;

use super::{MatchingArgs, ShortClipsArg};

/// A motion template to look for.
#[derive(Args, Clone, Debug)]
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
    /// Search everywhere as well, and tell which hits the keyframes lose; takes as long as without them
    #[arg(long, requires = "keyframes")]
    pub lost: bool,
    /// Clips with half as many words as the template has columns or fewer: hold the first and the last word until a match is possible, or leave them unmatched
    #[arg(long, value_enum, default_value_t = ShortClipsArg::Unmatched, requires = "template")]
    pub short_clips: ShortClipsArg,
}
