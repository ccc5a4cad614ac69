//! Motion bundles, stage by stage.
//!
//! `em`: an iteration of expectation maximisation on seeded random walks. Everybody starts from what ours
//! draws, so that everybody must come to the same mixture; a time is that of many iterations less few.
//!
//! `extract`, `extract-transitive`: bundles of a string of 7,300 frames in 250 letters, a seeded body that goes
//! through cyclic motions, by the direct and by the transitive closure; the peer is the paper's algorithm in
//! plain Python. `graph`: nodes, edges and strongly connected components of those bundles.

use std::ffi::OsStr;
use std::path::Path;

use anyhow::{Context, Result};

use super::install::{self, Package};
use super::{Amount, Fact, Job, Role, Toolbox};
use crate::workspace::Workspace;

mod cut;
mod data;
mod textbook;

use cut::Strings;
use data::{DIMS, Data, FRAMES, KAPPA};

const PYTHON: [Package; 2] = [
    Package {
        name: "numpy",
        version: "2.3.5",
    },
    Package {
        name: "scikit-learn",
        version: "1.9.1",
    },
];

const NETWORKX: Package = Package {
    name: "networkx",
    version: "3.6.1",
};

/// Inner runs of one process.
const FAST: u32 = 15;
const SLOW: u32 = 1;

/// Iterations after which the mixtures are compared.
const ITERATIONS: usize = 25;

/// Of facts, relative. Expanded squares lose up to eight of sixteen digits of a small variance, and
/// the iterations hand that on.
const ROUNDING: f64 = 1e-7;

/// Makes the data, builds ours, installs the peers.
pub(super) fn jobs(workspace: &Workspace, scratch: &Path) -> Result<Vec<Job>> {
    let ours = install::ours(workspace, "bundles_peer", "bundles")?;
    let program = ours.program().context("ours is not built")?;
    let data = data::write(&scratch.join("data"), program)?;
    let script = include_str!("bundles/drivers/peers.py");
    let python = install::python(&scratch.join("python"), script, &PYTHON, &[]);
    let kernel = install::c(&scratch.join("c"), include_str!("bundles/drivers/limit.c"));
    let strings = Strings::write(&scratch.join("strings"), program)?;
    let script = include_str!("bundles/drivers/cut.py");
    let plain = install::python(&scratch.join("plain"), script, &[NETWORKX], &[]);
    Ok(vec![
        em(&data, &ours, &python, &kernel),
        strings.extraction("extract", &ours, &plain)?,
        strings.extraction("extract-transitive", &ours, &plain)?,
        strings.graph(&ours, &plain)?,
    ])
}

fn em(data: &Data, ours: &Toolbox, python: &Toolbox, kernel: &Toolbox) -> Job {
    const STATES: &[&str] = &["log_likelihood", "spread"];
    let arguments: [&OsStr; 3] = [
        "em".as_ref(),
        data.frames_path.as_ref(),
        data.start_path.as_ref(),
    ];
    Job {
        name: "em",
        amount: Amount {
            millions: (FRAMES * KAPPA * DIMS) as f64 / 1e6,
            unit: "Mproducts",
        },
        facts: em_facts(data),
        contestants: vec![
            ours.contestant(Role::Ours, "motif", FAST, &arguments, STATES),
            python.contestant(Role::Peer, "scikit-learn", SLOW, &arguments, STATES),
            kernel.contestant(Role::Limit, "fused-f64", FAST, &arguments, STATES),
        ],
        duels: &[],
    }
}

fn em_facts(data: &Data) -> Vec<Fact> {
    let mut mixture = textbook::Mixture::from_numbers(&data.start);
    let mut log_likelihood = f64::NAN;
    for _ in 0..ITERATIONS {
        log_likelihood = mixture.iterate(&data.frames);
    }
    let fact = |key, value: f64| Fact {
        key,
        value,
        tolerance: ROUNDING * value.abs(),
    };
    vec![
        fact("log_likelihood", log_likelihood),
        fact("spread", mixture.spread()),
    ]
}
