//! A library of a hundred million frames: what it costs to build and to ask.

use std::env::consts::EXE_SUFFIX;
use std::fs;
use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context, Result, ensure};
use clap::Args;

use crate::workspace::{self, DATA, Workspace};

#[derive(Debug, Args)]
pub(crate) struct Options {
    /// How many times the words of the real data
    #[arg(long, default_value_t = 2000)]
    times: u32,
    /// Where the libraries go, about a gigabyte at 2000 times; `target/scale` if not given
    #[arg(long)]
    dir: Option<PathBuf>,
    /// Leave the largest library there
    #[arg(long)]
    keep: bool,
}

/// Builds the benches' `scale` in release mode and runs it over the data that `MOTIF_DATA` names.
pub(crate) fn run(workspace: &Workspace, options: &Options) -> Result<()> {
    ensure!(options.times > 0, "--times 0 is no library");
    let data = workspace.recordings();
    let data = data.with_context(|| format!("no recordings: {DATA} is not set"))?;
    ensure!(data.is_dir(), "no data at {}", data.display());
    let dir = match &options.dir {
        Some(dir) => dir.clone(),
        None => workspace.target.join("scale"),
    };
    // It is removed in the end, so nothing of anybody's may be in there.
    let is_free = fs::read_dir(&dir).map_or(true, |mut entries| entries.next().is_none());
    ensure!(is_free, "{} is not empty", dir.display());
    let arguments = ["build", "--release", "--quiet", "--package", "benches"];
    workspace::run(workspace.cargo().args(arguments).args(["--bin", "scale"]))?;
    let program = workspace.target.join(format!("release/scale{EXE_SUFFIX}"));
    let mut command = Command::new(program);
    let measured = workspace::run(command.arg(options.times.to_string()).args([&dir, &data]));
    if !options.keep {
        fs::remove_dir_all(&dir).with_context(|| format!("{}", dir.display()))?;
    }
    measured
}
