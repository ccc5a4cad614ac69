//! Repository tasks, run as `cargo xtask <task>` from anywhere in the repository.

#![cfg_attr(test, allow(clippy::unwrap_used))]

use std::process::ExitCode;

use anyhow::Result;
use clap::{Parser, Subcommand};

mod browser;
mod ci;
mod examples;
mod fuzz;
mod glb;
mod node;
mod paper;
mod peers;
mod rust_text;
mod scale;
mod standalone;
mod tidy;
mod workspace;

use workspace::Workspace;

#[derive(Debug, Parser)]
#[command(
    name = "cargo xtask",
    about = "Repository tasks",
    arg_required_else_help = true
)]
struct Args {
    #[command(subcommand)]
    task: Task,
}

#[derive(Debug, Subcommand)]
enum Task {
    /// Try the report and the viewer in headless Chromium, which is installed
    Browser {
        /// Only tests whose names match this
        only: Option<String>,
    },
    /// Everything a change must pass, in order; stops at the first failure
    Ci,
    /// House rules that no compiler checks: layout, crate edges, comments, fuzz targets
    Tidy,
    /// Run criterion benches
    Bench {
        /// Passed on to criterion, such as a filter or `--test`
        #[arg(last = true)]
        args: Vec<String>,
    },
    /// Run every example of every member and fail if one does
    Examples,
    /// Fuzz every target (or one), starting from its committed corpus
    Fuzz {
        /// Seconds spent on each target
        #[arg(long, default_value_t = 60)]
        seconds: u32,
        /// Only this target, by the name of its file in `fuzz_targets`
        target: Option<String>,
    },
    /// Write GLB files and hold them against Khronos' validator, which is installed
    Glb,
    /// Print the figures of a paper beside ours, on the recordings that `MOTIF_DATA` names
    Paper {
        /// Which paper
        paper: paper::Paper,
        /// With single choices changed as well (mt2006)
        #[arg(long)]
        ablations: bool,
        /// Time and memory from 1,000 to 400,000 frames instead of tables (bundles2007)
        #[arg(long)]
        growth: bool,
    },
    /// Measure ours beside others' programs, which are installed into `target/peers`
    Peers {
        /// What is measured
        topic: peers::Topic,
        /// Only these jobs, such as `bvh`
        jobs: Vec<String>,
    },
    /// Build and ask a library of 10^8 frames, made of perturbed copies of the real data
    Scale(scale::Options),
    /// Test each library crate alone, copied out of this workspace
    Standalone {
        /// Library crates to test; all of them when none is named
        crates: Vec<String>,
    },
}

fn main() -> ExitCode {
    match run(Args::parse().task) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(task: Task) -> Result<()> {
    let workspace = Workspace::load()?;
    match task {
        Task::Browser { only } => browser::run(&workspace, only.as_deref()),
        Task::Ci => ci::run(&workspace),
        Task::Tidy => tidy::run(&workspace),
        Task::Bench { args } => workspace::run(
            workspace
                .cargo()
                .args(["bench", "--package", "benches", "--"])
                .args(args),
        ),
        Task::Examples => examples::run(&workspace),
        Task::Fuzz { seconds, target } => fuzz::run(&workspace, seconds, target.as_deref()),
        Task::Glb => glb::run(&workspace),
        Task::Paper {
            paper,
            ablations,
            growth,
        } => {
            let options = [(ablations, "--ablations"), (growth, "--growth")];
            let chosen = options.iter().filter(|(is_chosen, _)| *is_chosen);
            let chosen: Vec<String> = chosen.map(|(_, name)| (*name).to_owned()).collect();
            paper::run(&workspace, paper, &chosen)
        }
        Task::Peers { topic, jobs } => peers::run(&workspace, topic, &jobs),
        Task::Scale(options) => scale::run(&workspace, &options),
        Task::Standalone { crates } => standalone::run(&workspace, &crates),
    }
}
