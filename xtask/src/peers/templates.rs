//! Motion templates: the distance curve beside subsequence alignment of others, and learning.
//!
//! Every feature is asked for and all weights are 1, since that is what peers can do; then costs are
//! disagreements, whole numbers, and everybody must have the same. `unit` has steps that all weigh 1,
//! `advance` ours, in which a step over a column weighs 2. The limit counts as peers do, with masks and
//! weights, in 16 bits. `learn` has no peer: the paper's class of its size took 24.6 s.

use std::ffi::OsStr;
use std::path::Path;

use anyhow::Result;

use super::install::{self, Package};
use super::{Amount, Fact, Job, Role};
use crate::workspace::Workspace;

mod data;

const PYTHON: [Package; 4] = [
    package("libfmp", "1.3.0"),
    package("librosa", "0.11.0"),
    package("numpy", "2.3.5"),
    package("scipy", "1.16.3"),
];

/// Inner runs of one process.
const FAST: u32 = 31;
const SLOW: u32 = 5;

const CURVE: &[&str] = &["least", "end", "sum"];
const MASS: &[&str] = &["mass"];

const fn package(name: &'static str, version: &'static str) -> Package {
    Package { name, version }
}

/// Makes the data, builds ours, installs the peers.
pub(super) fn jobs(workspace: &Workspace, scratch: &Path) -> Result<Vec<Job>> {
    let data = data::write(&scratch.join("data"))?;
    let script = include_str!("templates/drivers/peers.py");
    let ours = install::ours(workspace, "template_peer", "mtemplate")?;
    let python = install::python(&scratch.join("python"), script, &PYTHON, &[]);
    let kernel = install::c(
        &scratch.join("c"),
        include_str!("templates/drivers/limit.c"),
    );
    let curve = |name: &'static str, peers: &[&'static str], skip: u64| {
        let arguments: [&OsStr; 2] = [name.as_ref(), data.curve.as_ref()];
        let peers = peers
            .iter()
            .map(|peer| python.contestant(Role::Peer, peer, SLOW, &arguments, CURVE));
        Job {
            name,
            amount: Amount {
                millions: (data::COLUMNS * data::FRAMES) as f64 / 1e6,
                unit: "Mcells",
            },
            facts: facts_of_curve(&data.words, skip),
            contestants: [ours.contestant(Role::Ours, "motif", FAST, &arguments, CURVE)]
                .into_iter()
                .chain(peers)
                .chain([kernel.contestant(Role::Limit, "u16", FAST, &arguments, CURVE)])
                .collect(),
            duels: &[],
        }
    };
    let arguments: [&OsStr; 2] = ["learn".as_ref(), data.motions.as_ref()];
    let learn = Job {
        name: "learn",
        amount: Amount {
            // Each motion is aligned to each, in every round of learning.
            millions: data.lengths.iter().sum::<usize>().pow(2) as f64 / 1e6,
            unit: "Mcells",
        },
        facts: vec![Fact {
            // Learning keeps the mean length.
            key: "mass",
            value: data.lengths.iter().sum::<usize>() as f64 / data.lengths.len() as f64,
            tolerance: ROUNDING,
        }],
        contestants: vec![ours.contestant(Role::Ours, "motif", SLOW, &arguments, MASS)],
        duels: &[],
    };
    Ok(vec![
        curve("unit", &["libfmp", "librosa"], 1),
        curve("advance", &["librosa"], 2),
        learn,
    ])
}

/// Of a sum of some fifty weights, over a few rounds.
const ROUNDING: f64 = 1e-9;
/// Of costs that are whole numbers in other units.
const UNITS: f64 = 1e-3;

/// The curve cell by cell, in disagreements: the least cost, its first end, and the sum of all.
fn facts_of_curve(words: &[u64], skip: u64) -> Vec<Fact> {
    let (template, clip) = words.split_at(data::COLUMNS);
    let mut table = vec![vec![None; clip.len()]; template.len()];
    for (k, column) in template.iter().enumerate() {
        for (l, word) in clip.iter().enumerate() {
            let cost = u64::from((column ^ word).count_ones());
            let from = |columns: usize, frames: usize, weight: u64| {
                let before: Option<u64> = table[k.checked_sub(columns)?][l.checked_sub(frames)?];
                Some(before? + weight * cost)
            };
            let ways = [from(1, 1, 1), from(1, 2, 1), from(2, 1, skip)];
            let best = if k == 0 {
                Some(cost)
            } else {
                ways.into_iter().flatten().min()
            };
            table[k][l] = best;
        }
    }
    let curve = table.pop().unwrap_or_default().into_iter().enumerate();
    let costs: Vec<(u64, usize)> = curve.filter_map(|(end, cost)| Some((cost?, end))).collect();
    let (least, end) = costs.iter().copied().min().unwrap_or_default();
    let sum: u64 = costs.iter().map(|(cost, _)| cost).sum();
    let fact = |key, value, tolerance| Fact {
        key,
        value,
        tolerance,
    };
    vec![
        fact("least", least as f64, UNITS),
        fact("end", end as f64, 0.0),
        fact("sum", sum as f64, UNITS * costs.len() as f64),
    ]
}
