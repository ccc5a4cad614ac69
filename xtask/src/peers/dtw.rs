//! Dynamic time warping of seeded random walks.
//!
//! Costs come in two families: sums of Euclidean local costs, and roots of sums of squared ones. A
//! peer takes part in the jobs of a cost that it has; ours does the same cost in single precision,
//! and once more in double precision, which is what the peers have. The limit is one of single
//! precision, without band or path.

use std::ffi::OsStr;
use std::path::Path;

use anyhow::Result;

use super::install::{self, Package};
use super::{Amount, Fact, Job, Role, Toolbox};
use crate::workspace::Workspace;

mod data;
mod textbook;

use data::Sample;
use textbook::{Local, Warping};

const CRATES: [Package; 2] = [package("augurs-dtw", "0.10.3"), package("dtw_rs", "0.10.0")];
const PYTHON: [Package; 9] = [
    package("aeon", "1.6.0"),
    package("cython", "0.29.37"),
    package("dtaidistance", "2.5.1"),
    package("dtw-python", "1.9.0"),
    package("librosa", "0.11.0"),
    package("numpy", "2.3.5"),
    package("tsdistances", "0.1.7"),
    package("tslearn", "0.10.0"),
    package("wheel", "0.45.1"),
];
/// These come without wheels. Of `pydtw` newer versions are documented than the index has.
const SOURCES: [Package; 2] = [package("pydtw", "2.0.2"), package("ucrdtw", "0.201")];
/// Alone, because it needs another scikit-learn than the others.
const WILDBOAR: [Package; 1] = [package("wildboar", "1.2.1")];

/// Inner runs of one process: enough for a steady median, few where one takes a second.
const FAST: u32 = 15;
const SLOW: u32 = 5;
const SLOWEST: u32 = 1;

const SUMS: &[&str] = &["dtaidistance", "dtw_rs", "dtw-python", "librosa", "pydtw"];
const PATHS: &[&str] = &["dtaidistance", "dtw_rs", "dtw-python", "librosa"];
const BANDS: &[&str] = &["dtaidistance", "dtw_rs", "dtw-python"];
const ROOTS: &[&str] = &["dtaidistance", "tslearn", "aeon"];
const UNIVARIATE: &[&str] = &[
    "aeon",
    "dtaidistance",
    "tsdistances",
    "augurs-dtw",
    "wildboar",
];
const PAIRWISE: &[&str] = &["aeon", "dtaidistance", "tsdistances", "wildboar"];

const COST: &[&str] = &["cost"];
const PATH: &[&str] = &["cost", "steps"];
const WINDOW: &[&str] = &["start", "cost"];

const EUCLIDEAN: Warping = Warping::new(Local::Euclidean, None);
const SQUARED: Warping = Warping::new(Local::Squared, None);
const EUCLIDEAN_BAND: Warping = Warping::new(Local::Euclidean, Some(data::FRAMES / 10));
const SQUARED_BAND: Warping = Warping::new(Local::Squared, Some(data::FRAMES / 10));
const PAIRWISE_BAND: Warping = Warping::new(Local::Squared, Some(data::SAMPLES / 10));
const WINDOWS: Warping = Warping::new(Local::Squared, Some(data::QUERY / 20));

const fn package(name: &'static str, version: &'static str) -> Package {
    Package { name, version }
}

struct Programs {
    ours: Toolbox,
    rust: Toolbox,
    python: Toolbox,
    wildboar: Toolbox,
    kernel: Toolbox,
}

/// A job before its programs.
struct Plan<'a> {
    name: &'static str,
    sample: &'a Sample,
    /// Cells of all tables together.
    cells: usize,
    facts: Vec<Fact>,
    states: &'static [&'static str],
    /// Of the peers; ours has more, since it is faster.
    runs: u32,
    peers: &'static [&'static str],
    limit: Option<&'static str>,
}

/// Makes the data, builds ours, installs the peers.
pub(super) fn jobs(workspace: &Workspace, scratch: &Path) -> Result<Vec<Job>> {
    let data = data::write(&scratch.join("data"))?;
    let main = include_str!("dtw/drivers/main.rs");
    let script = include_str!("dtw/drivers/peers.py");
    let python = |folder: &str, packages: &[Package], sources: &[Package]| {
        install::python(&scratch.join(folder), script, packages, sources)
    };
    let programs = Programs {
        ours: install::ours(workspace, "dtw_peer", "dtw")?,
        rust: install::rust(workspace, &scratch.join("rust"), main, &CRATES, &[]),
        python: python("python", &PYTHON, &SOURCES),
        wildboar: python("wildboar", &WILDBOAR, &[]),
        kernel: install::c(&scratch.join("c"), include_str!("dtw/drivers/limit.c")),
    };
    Ok(plans(&data)
        .into_iter()
        .map(|plan| programs.job(plan))
        .collect())
}

fn plans(data: &data::Data) -> Vec<Plan<'_>> {
    let pair = |name, sample, warping: Warping, peers| Plan {
        name,
        sample,
        cells: warping.cells(data::FRAMES),
        facts: warping.facts_of_pair(data::FRAMES, &sample.numbers),
        states: COST,
        runs: SLOW,
        peers,
        limit: None,
    };
    let multi = |name, warping, peers| pair(name, &data.multi, warping, peers);
    let limited = |plan| Plan {
        limit: Some("fused-f32"),
        ..plan
    };
    let path = |plan| Plan {
        states: PATH,
        ..plan
    };
    let pairwise = |name, warping: Warping, peers| Plan {
        name,
        sample: &data.pairwise,
        cells: warping.cells(data::SAMPLES) * data::SERIES * (data::SERIES - 1) / 2,
        facts: warping.facts_of_all_pairs(data::SAMPLES, &data.pairwise.numbers),
        states: COST,
        runs: SLOWEST,
        peers,
        limit: None,
    };
    let (query, series) = data.windows.numbers.split_at(data::QUERY);
    let windows = Plan {
        name: "windows",
        sample: &data.windows,
        cells: WINDOWS.cells(data::QUERY) * (series.len() - data::QUERY + 1),
        facts: WINDOWS.facts_of_windows(query, series),
        states: WINDOW,
        runs: SLOW,
        peers: &["ucrdtw", "wildboar"],
        limit: None,
    };
    vec![
        limited(multi("multi", EUCLIDEAN, SUMS)),
        limited(multi("multi-squared", SQUARED, ROOTS)),
        path(multi("path", EUCLIDEAN, PATHS)),
        path(multi("path-squared", SQUARED, ROOTS)),
        multi("band", EUCLIDEAN_BAND, BANDS),
        multi("band-squared", SQUARED_BAND, ROOTS),
        pair("univariate", &data.univariate, SQUARED_BAND, UNIVARIATE),
        pairwise("pairwise", SQUARED, PAIRWISE),
        pairwise("pairwise-band", PAIRWISE_BAND, PAIRWISE),
        windows,
    ]
}

impl Programs {
    fn job(&self, plan: Plan<'_>) -> Job {
        let arguments: [&OsStr; 2] = [plan.name.as_ref(), plan.sample.path.as_ref()];
        let ours = ["motif", "motif:f64"].into_iter();
        let runs = plan.runs.max(SLOW);
        let ours = ours.map(|name| {
            self.ours
                .contestant(Role::Ours, name, runs, &arguments, plan.states)
        });
        let peers = plan.peers.iter().map(|name| {
            self.of(name)
                .contestant(Role::Peer, name, plan.runs, &arguments, plan.states)
        });
        let limit = plan.limit.map(|name| {
            self.kernel
                .contestant(Role::Limit, name, FAST, &arguments, COST)
        });
        Job {
            name: plan.name,
            amount: Amount {
                millions: plan.cells as f64 / 1e6,
                unit: "Mcells",
            },
            facts: plan.facts,
            contestants: ours.chain(peers).chain(limit).collect(),
            duels: &[],
        }
    }

    /// The program that has this peer.
    fn of(&self, peer: &str) -> &Toolbox {
        let has = |packages: &[Package]| packages.iter().any(|package| package.name == peer);
        if has(&CRATES) {
            &self.rust
        } else if has(&WILDBOAR) {
            &self.wildboar
        } else {
            &self.python
        }
    }
}
