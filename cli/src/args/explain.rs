use std::path::PathBuf;

use clap::Args;

/// What is told about each hit.
#[derive(Args, Clone, Debug, Default)]
pub struct ExplainArgs {
    /// Tell for each hit which features are equal, different or masked, segment by segment
    #[arg(long, conflicts_with = "scene")]
    pub explain: bool,
    /// The same, and as a picture as well: a panel per hit, features by time
    #[arg(long, value_name = "FILE", conflicts_with = "scene")]
    pub explain_png: Option<PathBuf>,
}

impl ExplainArgs {
    /// Whether hits are explained.
    #[must_use]
    pub fn is_asked(&self) -> bool {
        self.explain || self.explain_png.is_some()
    }
}
