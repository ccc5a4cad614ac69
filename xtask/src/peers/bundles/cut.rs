//! `extract`, `extract-transitive` and `graph`: bundles of a seeded string, and their graph.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

use super::super::install::Toolbox;
use super::super::{Amount, Fact, Job, Role};
use crate::workspace::{capture, tail, text};

/// As in the paper's largest example.
const FRAMES: f64 = 7_300.0;

/// Inner runs of one process.
const FAST: u32 = 15;
const SLOW: u32 = 1;

const EXTRACT: &[&str] = &["bundles", "members", "degenerate", "places"];
const GRAPH: &[&str] = &["nodes", "edges", "passages", "loose", "components"];

/// The string, its letters and the submotions of its bundles, as files in a folder.
pub(super) struct Strings {
    folder: PathBuf,
    ours: PathBuf,
}

impl Strings {
    /// Writes the files, the same ones at each call.
    pub(super) fn write(folder: &Path, ours: &Path) -> Result<Strings> {
        fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
        said(Command::new(ours).arg("spelt").arg(folder))?;
        let (folder, ours) = (folder.to_owned(), ours.to_owned());
        Ok(Strings { folder, ours })
    }

    pub(super) fn extraction(
        &self,
        name: &'static str,
        ours: &Toolbox,
        python: &Toolbox,
    ) -> Result<Job> {
        self.job((name, EXTRACT), ours, (python, "python", SLOW))
    }

    pub(super) fn graph(&self, ours: &Toolbox, python: &Toolbox) -> Result<Job> {
        self.job(("graph", GRAPH), ours, (python, "networkx", FAST))
    }

    /// Facts are what ours comes to: peers have no code in common with it and must come to the same.
    fn job(
        &self,
        (name, states): (&'static str, &'static [&'static str]),
        ours: &Toolbox,
        (python, peer, runs): (&Toolbox, &'static str, u32),
    ) -> Result<Job> {
        let arguments: [&OsStr; 2] = [name.as_ref(), self.folder.as_ref()];
        let line = said(
            Command::new(&self.ours)
                .args(["motif", "1"])
                .args(arguments),
        )?;
        let fact = |&key: &&'static str| {
            let mut words = line
                .split_whitespace()
                .filter_map(|word| word.split_once('='));
            let stated = words.find(|(stated, _)| *stated == key);
            let (_, value) = stated.with_context(|| format!("no {key} in `{line}`"))?;
            let (value, tolerance) = (value.parse()?, 0.0);
            Ok(Fact {
                key,
                value,
                tolerance,
            })
        };
        Ok(Job {
            name,
            amount: Amount {
                millions: FRAMES / 1e6,
                unit: "Mframes",
            },
            facts: states.iter().map(fact).collect::<Result<_>>()?,
            contestants: vec![
                ours.contestant(Role::Ours, "motif", FAST, &arguments, states),
                python.contestant(Role::Peer, peer, runs, &arguments, states),
            ],
            duels: &[],
        })
    }
}

/// The last line a program prints.
fn said(command: &mut Command) -> Result<String> {
    let output = capture(command)?;
    if !output.status.success() {
        bail!("ours fails: {}", text(&output.stderr));
    }
    Ok(tail(text(&output.stdout).trim(), 1))
}
