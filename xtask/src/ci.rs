//! Everything a change must pass. Stops at the first failure.

use std::collections::BTreeSet;
use std::time::{Duration, Instant};

use anyhow::{Context, Result};
use cargo_metadata::{Package, TargetKind};

use crate::workspace::{self, LIBRARIES, Workspace};
use crate::{browser, examples, fuzz, glb, standalone, tidy};

/// A smoke test; longer runs are `cargo xtask fuzz --seconds N`.
const FUZZ_SECONDS: u32 = 60;

type Step = (&'static str, fn(&Workspace) -> Result<()>);

const STEPS: [Step; 12] = [
    ("fmt", |workspace| {
        workspace::run(workspace.cargo().args(["fmt", "--all", "--check"]))
    }),
    ("clippy", clippy),
    ("tidy", tidy::run),
    ("test", |workspace| {
        workspace::run(workspace.cargo().args(["test", "--workspace"]))
    }),
    ("doc", doc),
    ("feature sets", feature_sets),
    ("examples", examples::run),
    ("glb", glb::run),
    ("browser", |workspace| browser::run(workspace, None)),
    ("benches in test mode", benches),
    ("standalone", |workspace| standalone::run(workspace, &[])),
    ("fuzz", |workspace| fuzz::run(workspace, FUZZ_SECONDS, None)),
];

/// Runs every step and announces it with its name and its wall time.
pub(crate) fn run(workspace: &Workspace) -> Result<()> {
    let start = Instant::now();
    let mut times: Vec<(&str, Duration)> = Vec::new();
    for (name, step) in STEPS {
        println!("::: {name}");
        let step_start = Instant::now();
        let result = step(workspace);
        let elapsed = step_start.elapsed();
        let verdict = if result.is_ok() { "ok" } else { "FAILED" };
        println!("::: {name}: {verdict}, {:.1} s", elapsed.as_secs_f64());
        times.push((name, elapsed));
        result.with_context(|| format!("ci stopped at step `{name}`"))?;
    }
    for (name, elapsed) in times {
        println!("{:>8.1} s  {name}", elapsed.as_secs_f64());
    }
    println!("{:>8.1} s  all", start.elapsed().as_secs_f64());
    Ok(())
}

fn clippy(workspace: &Workspace) -> Result<()> {
    let arguments = ["clippy", "--workspace", "--all-targets", "--", "-Dwarnings"];
    workspace::run(workspace.cargo().args(arguments))
}

fn doc(workspace: &Workspace) -> Result<()> {
    let mut command = workspace.cargo();
    command
        .args(["doc", "--workspace", "--no-deps"])
        .env("RUSTDOCFLAGS", "-Dwarnings");
    workspace::run(&mut command)
}

/// Clippy checks first, so one run of it answers both whether a set compiles and how well.
fn feature_sets(workspace: &Workspace) -> Result<()> {
    let libraries = workspace
        .members()
        .iter()
        .filter(|m| LIBRARIES.contains(&m.name.as_str()));
    for member in libraries.filter(|member| has_choice(&features(member))) {
        for set in ["--no-default-features", "--all-features"] {
            println!("feature sets: {} {set}", member.name);
            let mut command = workspace.cargo();
            command.args([
                "clippy",
                "--quiet",
                "--all-targets",
                "--package",
                &member.name,
                set,
            ]);
            workspace::run(command.args(["--", "-Dwarnings"]))?;
        }
    }
    Ok(())
}

fn features(member: &Package) -> BTreeSet<&str> {
    member.features.keys().map(String::as_str).collect()
}

/// Whether a user can build more than one form of the crate.
fn has_choice(features: &BTreeSet<&str>) -> bool {
    features.iter().any(|&feature| feature != "default")
}

fn benches(workspace: &Workspace) -> Result<()> {
    let targets = workspace
        .members()
        .iter()
        .flat_map(|member| &member.targets);
    let benches = targets.filter(|target| target.kind.contains(&TargetKind::Bench));
    let names: Vec<&str> = benches.map(|bench| bench.name.as_str()).collect();
    if names.is_empty() {
        println!("benches: there is no bench target");
        return Ok(());
    }
    // Run by `cargo test`, criterion does each job once; in the profile of the tests and with the
    // features of the whole workspace, whose builds are there already, where `cargo bench` would
    // build everything in release.
    let mut command = workspace.cargo();
    command.args(["test", "--workspace"]);
    for name in names {
        command.args(["--bench", name]);
    }
    workspace::run(&mut command)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_more_than_default_is_a_choice() {
        assert!(!has_choice(&BTreeSet::new()));
        assert!(!has_choice(&BTreeSet::from(["default"])));
        assert!(has_choice(&BTreeSet::from(["default", "rayon"])));
    }
}
