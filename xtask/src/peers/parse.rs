//! Readers of BVH, AMC and C3D.
//!
//! Who takes bytes or text reads from memory, who takes a path reads a cached file as well. Skeletons
//! of AMC files are read beforehand. The limits read the same numbers and points and nothing else: no
//! names, no structure, no errors.

use std::path::Path;

use anyhow::Result;

use super::install::{self, Package};
use super::{Amount, Contestant, Job, Role, Toolbox};
use crate::workspace::Workspace;

mod c3d;
mod data;
mod text;

const CRATES: [Package; 3] = [
    package("bvh_anim", "0.4.0"),
    package("bvh_anim_parser", "1.0.1"),
    package("c3dio", "0.8.0"),
];
/// `bvh_anim_parser` names all of cargo as a dependency and uses nothing of it.
const UNUSED: [Package; 1] = [package("cargo", "0.78.1")];
const PYTHON: [Package; 6] = [
    package("asfamc-parser", "0.0.2"),
    package("bvhio", "1.5.4"),
    package("c3d", "0.6.0"),
    package("ezc3d", "1.7.2"),
    package("pyacclaim", "0.0.1"),
    package("pybvh", "0.9.0"),
];

/// Inner runs of one process: enough for a steady median, few where one takes a second.
const FAST: u32 = 15;
const SLOW: u32 = 5;
const SLOWEST: u32 = 3;

const ALL: &[&str] = &["frames", "sum"];
/// Who turns angles into rotations keeps only the root's positions as they were.
const ROOT: &[&str] = &["frames", "root_sum"];

const fn package(name: &'static str, version: &'static str) -> Package {
    Package { name, version }
}

/// Makes the data, builds ours, installs the peers.
pub(super) fn jobs(workspace: &Workspace, scratch: &Path) -> Result<Vec<Job>> {
    let data = data::write(&scratch.join("data"))?;
    let ours = install::ours(workspace, "parse_peer", "mocap-io")?;
    let main = include_str!("parse/drivers/main.rs");
    let rust = install::rust(workspace, &scratch.join("rust"), main, &CRATES, &UNUSED);
    let script = include_str!("parse/drivers/peers.py");
    let python = install::python(&scratch.join("python"), script, &PYTHON, &[]);
    let kernel = install::c(&scratch.join("c"), include_str!("parse/drivers/limit.c"));
    let peer = |toolbox: &Toolbox, name, runs, files: &[&Path], states| {
        toolbox.contestant(Role::Peer, name, runs, files, states)
    };
    let motif = |files: &[&Path]| ours.contestant(Role::Ours, "motif", FAST, files, ALL);
    let limit = |name, file: &Path| kernel.contestant(Role::Limit, name, FAST, &[file], &["sum"]);
    let bvh: &[&Path] = &[&data.bvh.path];
    let amc: &[&Path] = &[&data.asf, &data.amc.path];
    let c3d: &[&Path] = &[&data.c3d.path];
    Ok(vec![
        Job {
            name: "bvh",
            amount: megabytes(&data.bvh),
            facts: data.bvh.facts,
            contestants: vec![
                motif(bvh),
                peer(&rust, "bvh_anim_parser", FAST, bvh, ROOT),
                peer(&rust, "bvh_anim", FAST, bvh, ALL),
                peer(&python, "pybvh", SLOW, bvh, ALL),
                peer(&python, "bvhio", SLOWEST, bvh, ROOT),
                limit("sse-numbers", &data.bvh_numbers),
            ],
            duels: &[("bvh-bvhio", "bvhio")],
        },
        Job {
            name: "amc",
            amount: megabytes(&data.amc),
            facts: data.amc.facts,
            contestants: vec![
                motif(amc),
                peer(&python, "pyacclaim", SLOW, amc, ROOT),
                peer(&python, "asfamc-parser", SLOW, &[&data.amc_bare], ALL),
                Contestant {
                    role: Role::Peer,
                    name: "CalciferZh",
                    version: String::new(),
                    command: Err("not installed: on GitHub only, in no registry".into()),
                    states: ALL,
                },
                limit("sse-numbers", &data.amc_numbers),
            ],
            duels: &[],
        },
        Job {
            name: "c3d",
            amount: megabytes(&data.c3d),
            facts: data.c3d.facts,
            contestants: vec![
                motif(c3d),
                peer(&rust, "c3dio", FAST, c3d, ALL),
                peer(&python, "c3d", SLOW, c3d, ALL),
                peer(&python, "ezc3d", SLOW, c3d, ALL),
                limit("copy-points", &data.c3d_points),
            ],
            duels: &[],
        },
    ])
}

fn megabytes(sample: &data::Sample) -> Amount {
    Amount {
        millions: sample.bytes as f64 / 1e6,
        unit: "MB",
    }
}
