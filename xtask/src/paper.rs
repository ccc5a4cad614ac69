//! Tables of the papers beside ours. The work is done by a program of `benches`, built in release.

use std::env::consts::EXE_SUFFIX;
use std::fs;
use std::process::Command;

use anyhow::{Context, Result};
use clap::ValueEnum;

use crate::workspace::{self, DATA, Workspace};

/// A paper with figures to compare ours with.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum Paper {
    /// Efficient content-based retrieval of motion capture data: Tables 2 and 3, examples of 6.2
    Tog2005,
    /// Motion templates for automatic classification and retrieval: Tables 1 to 5
    Mt2006,
    /// Automatic construction of compact motion graphs: section 5
    Bundles2007,
}

impl Paper {
    /// The program of `benches`.
    fn program(self) -> &'static str {
        match self {
            Paper::Tog2005 => "tog2005",
            Paper::Mt2006 => "mt2006",
            Paper::Bundles2007 => "bundles2007",
        }
    }

    fn source(self) -> &'static str {
        match self {
            Paper::Tog2005 => "Müller, Röder, Clausen 2005, section 6",
            Paper::Mt2006 => "Müller, Röder 2006, sections 4 and 5",
            Paper::Bundles2007 => "Beaudoin, van de Panne, Poulin 2007, section 5",
        }
    }
}

/// Prints the paper's tables beside ours; the recordings must be there.
pub(crate) fn run(workspace: &Workspace, paper: Paper, options: &[String]) -> Result<()> {
    let data = workspace.recordings();
    let data = data.with_context(|| format!("no recordings: {DATA} is not set"))?;
    let name = paper.program();
    let build = ["build", "--release", "--quiet", "--package", "benches"];
    workspace::run(workspace.cargo().args(build).args(["--bin", name]))?;
    println!("{}, beside ours", paper.source());
    let processor = fs::read_to_string("/proc/cpuinfo").ok();
    let processor = processor.as_deref().and_then(model_name);
    println!("machine: {}", processor.unwrap_or("unknown processor"));
    let words = [name].into_iter().chain(options.iter().map(String::as_str));
    let words: Vec<&str> = words.collect();
    println!("command: cargo xtask paper {}\n", words.join(" "));
    let program = workspace.target.join(format!("release/{name}{EXE_SUFFIX}"));
    workspace::run(Command::new(program).arg(data).args(options))
}

/// The processor's name, as Linux states it.
fn model_name(cpuinfo: &str) -> Option<&str> {
    let mut lines = cpuinfo.lines().filter_map(|line| line.split_once(':'));
    lines.find_map(|(key, value)| (key.trim() == "model name").then(|| value.trim()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_processor_is_named() {
        let text = "processor\t: 0\nmodel name\t: Pentium 4\nmodel\t\t: 1\n";
        assert_eq!(model_name(text), Some("Pentium 4"));
        assert_eq!(model_name("processor : 0\n"), None);
    }
}
