//! The command line of `motif view`.

use std::path::PathBuf;

use clap::Args;

/// What `motif view --help` ends with.
pub(super) const EXAMPLES: &str = "Example: motif view takes.lib --templates templates/ --open\n\n\
    The pages of a report for the browsers of this machine, until Ctrl-C: every clip of the library, and searches by \
    spans that are dragged, by scenes that are typed, and by templates. Nothing but the library and the files it was \
    made of can be read, from the folder where it was indexed and with the same --asf, --unit and the like; a file \
    that is not what was indexed is not shown.";

/// Arguments of `view`.
#[derive(Args, Clone, Debug)]
pub struct ViewArgs {
    /// The library's folder
    #[arg(value_name = "LIB")]
    pub library: PathBuf,
    /// The port on 127.0.0.1; 0 is any that is free
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub port: u16,
    /// Show it in the browser
    #[arg(long)]
    pub open: bool,
    /// Motion templates to search by: files, and folders of them
    #[arg(long, value_name = "DIR|FILE", num_args = 1..)]
    pub templates: Vec<PathBuf>,
    /// Motion bundles to show beside the clips, as `motif bundle` writes them
    #[arg(long, value_name = "FILE.mbg")]
    pub bundles: Option<PathBuf>,
}
