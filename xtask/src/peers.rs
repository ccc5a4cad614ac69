//! Ours beside others' programs: the same seeded data, in turn, in one go.
//!
//! A topic makes its data, installs its peers into `target/peers/<topic>` and hands over [`Job`]s;
//! everything after that is common. A new topic is a variant of [`Topic`] and a module like
//! [`parse`].

use anyhow::{Result, bail};
use clap::ValueEnum;

use crate::workspace::Workspace;

mod bundles;
mod dice;
mod dtw;
mod install;
mod parse;
mod race;
mod report;
mod retrieval;
mod templates;

use install::Toolbox;

/// Interleaved rounds; a time is the median over them.
const ROUNDS: usize = 5;

/// A stage of motif that others do too.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum Topic {
    /// Motion bundles: an iteration of the mixture of poses, extraction, graph
    Bundles,
    /// Dynamic time warping: distances, paths, all pairs, the nearest window
    Dtw,
    /// Readers of BVH, AMC and C3D
    Parse,
    /// Search engines: exact queries as phrases, and what indexes take on disk
    Retrieval,
    /// Motion templates: distance curves, learning
    Templates,
}

/// One input and what everybody must make of it.
struct Job {
    name: &'static str,
    amount: Amount,
    facts: Vec<Fact>,
    contestants: Vec<Contestant>,
    /// Further lines of the report, each against one peer: name of the line, name of the peer.
    duels: &'static [(&'static str, &'static str)],
}

/// How much there is to do; the table states who does how much of it in a second.
#[derive(Debug, Clone, Copy)]
struct Amount {
    millions: f64,
    /// Of a million.
    unit: &'static str,
}

/// A number that follows from the data. Whoever states another one is not counted.
#[derive(Debug, Clone, Copy)]
struct Fact {
    key: &'static str,
    value: f64,
    tolerance: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Role {
    /// The first of a job is the one that the limit is of; further ones get a line of their own.
    Ours,
    Peer,
    /// A kernel that measures what the processor can do at best.
    Limit,
}

/// A program that does the job some times, each time in a new process.
struct Contestant {
    role: Role,
    name: &'static str,
    version: String,
    /// Program and arguments, or why there are none.
    command: install::Command,
    /// Keys of the facts it must state.
    states: &'static [&'static str],
}

/// Runs the named jobs of a topic, or all of them; prints a table and a line for each.
pub(crate) fn run(workspace: &Workspace, topic: Topic, names: &[String]) -> Result<()> {
    let jobs = match topic {
        Topic::Bundles => bundles::jobs(workspace, &workspace.target.join("peers/bundles"))?,
        Topic::Dtw => dtw::jobs(workspace, &workspace.target.join("peers/dtw"))?,
        Topic::Parse => parse::jobs(workspace, &workspace.target.join("peers/parse"))?,
        Topic::Retrieval => retrieval::jobs(workspace, &workspace.target.join("peers/retrieval"))?,
        Topic::Templates => templates::jobs(workspace, &workspace.target.join("peers/templates"))?,
    };
    if let Some(name) = names.iter().find(|n| jobs.iter().all(|j| j.name != **n)) {
        let known: Vec<&str> = jobs.iter().map(|job| job.name).collect();
        bail!("no job is named {name}; there are {}", known.join(", "));
    }
    let core = race::last_core();
    let is_chosen = |job: &&Job| names.is_empty() || names.iter().any(|name| name == job.name);
    for job in jobs.iter().filter(is_chosen) {
        let outcomes = race::run(job, core)?;
        print!("{}", report::table(job, &outcomes, core));
        print!("{}", report::lines(job, &outcomes));
    }
    Ok(())
}
