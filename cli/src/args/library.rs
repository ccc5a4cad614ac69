//! The command line of `motif library`.

use std::path::PathBuf;

use clap::{Args, Subcommand};

/// Arguments of `library`.
#[derive(Args, Debug)]
pub struct LibraryArgs {
    /// What is to be done with the library.
    #[command(subcommand)]
    pub command: LibraryCommand,
}

/// What can be done with a library.
#[derive(Debug, Subcommand)]
pub enum LibraryCommand {
    /// Features, rate, clips, shards and size
    #[command(after_help = "Example: motif library info takes.lib")]
    Info(LibraryArg),
    /// Check every byte; names each damaged file and where
    #[command(after_help = "Example: motif library verify takes.lib")]
    Verify(LibraryArg),
    /// Put all shards into as few as it takes, without the clips that were removed or replaced
    #[command(after_help = "Example: motif library compact takes.lib")]
    Compact(LibraryArg),
    /// Remove clips
    #[command(after_help = "Example: motif library remove takes.lib takes/bad.amc takes/old")]
    Remove(RemoveArgs),
}

/// The library alone.
#[derive(Args, Debug)]
pub struct LibraryArg {
    /// The library's folder
    #[arg(value_name = "LIB")]
    pub library: PathBuf,
}

/// Arguments of `library remove`.
#[derive(Args, Debug)]
pub struct RemoveArgs {
    /// The library's folder
    #[arg(value_name = "LIB")]
    pub library: PathBuf,
    /// Clips as indexed, with their spans, or folders of them
    #[arg(required = true, value_name = "CLIP")]
    pub clips: Vec<PathBuf>,
}
