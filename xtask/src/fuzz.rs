//! Coverage-guided fuzzing with the stable toolchain.
//!
//! `cargo fuzz` wants a nightly compiler for its address sanitizer. The crates attacked here have
//! no unsafe code: a panic, an overflow, a hang or too much memory is what can go wrong, and
//! libFuzzer finds these with LLVM's coverage instrumentation alone.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;
use std::thread;
use std::time::Instant;

use anyhow::{Context, Result, anyhow, bail, ensure};

use crate::workspace::{self, Workspace, capture, tail, text};

const RUSTFLAGS: [&str; 10] = [
    "--cfg=fuzzing",
    "-Cpasses=sancov-module",
    "-Cllvm-args=-sanitizer-coverage-level=4",
    "-Cllvm-args=-sanitizer-coverage-inline-8bit-counters",
    "-Cllvm-args=-sanitizer-coverage-pc-table",
    "-Cllvm-args=-sanitizer-coverage-trace-compares",
    // Without it, a comparison with a short constant becomes wide loads whose operands
    // libFuzzer never sees, and keywords are only ever found by luck.
    "-Cllvm-args=-max-loads-per-memcmp=0",
    "-Ccodegen-units=1",
    "-Cdebug-assertions=on",
    "-Coverflow-checks=on",
];

/// A crate's `fuzz` folder.
struct FuzzCrate {
    /// Name of the crate attacked.
    name: String,
    folder: PathBuf,
    targets: Vec<String>,
}

/// One target of a crate.
struct Attack<'a> {
    fuzz: &'a FuzzCrate,
    target: &'a str,
    binary: PathBuf,
}

impl Attack<'_> {
    fn name(&self) -> String {
        format!("{}/{}", self.fuzz.name, self.target)
    }

    /// Runs it on a copy of its corpus; false when it crashed.
    fn run(&self, seconds: u32) -> Result<bool> {
        let start = Instant::now();
        let committed = self.fuzz.folder.join("corpus").join(self.target);
        let corpus = tempfile::tempdir()?;
        let seeds = copy_files(&committed, corpus.path())
            .with_context(|| format!("no corpus in {}", committed.display()))?;
        ensure!(seeds > 0, "no corpus in {}", committed.display());
        let artifacts = self.fuzz.folder.join("artifacts").join(self.target);
        fs::create_dir_all(&artifacts)?;
        let mut artifact_prefix = std::ffi::OsString::from("-artifact_prefix=");
        artifact_prefix.push(artifacts);
        artifact_prefix.push("/");

        let mut command = Command::new(&self.binary);
        command
            .current_dir(corpus.path())
            .arg(corpus.path())
            .args([
                format!("-max_total_time={seconds}"),
                "-seed=1".into(),
                "-timeout=10".into(),
            ])
            .arg("-rss_limit_mb=2048")
            .arg(artifact_prefix);
        let output = capture(&mut command)?;
        let log = text(&output.stderr);
        let name = self.name();
        if output.status.success() {
            ensure!(
                is_instrumented(&log),
                "{name}: the build has no coverage counters:\n{log}"
            );
            let elapsed = start.elapsed().as_secs();
            println!(
                "fuzz {name}: ok, {} runs from {seeds} seeds, {elapsed} s",
                executed(&log)
            );
            return Ok(true);
        }
        eprintln!("{}", tail(&without_progress(&log), 60));
        match artifact(&log) {
            Some(path) => println!("fuzz {name}: FAILED, input kept in {path}"),
            None => println!("fuzz {name}: FAILED ({})", output.status),
        }
        Ok(false)
    }
}

/// Targets that are fuzzed at the same time, one per core of the machines that this runs on.
const AT_ONCE: usize = 2;

/// Fuzzes every target for `seconds`, or only the one named.
pub(crate) fn run(workspace: &Workspace, seconds: u32, only: Option<&str>) -> Result<()> {
    let mut crates = fuzz_crates(workspace)?;
    if let Some(only) = only {
        crates
            .iter_mut()
            .for_each(|fuzz| fuzz.targets.retain(|target| target == only));
        ensure!(
            crates.iter().any(|fuzz| !fuzz.targets.is_empty()),
            "no fuzz target named {only}"
        );
    }
    crates.retain(|fuzz| !fuzz.targets.is_empty());
    if crates.is_empty() {
        println!("fuzz: no crate has a fuzz target");
        return Ok(());
    }
    let host = host_triple()?;
    // All of them first: a build beside an attack would take the core that it is to have.
    let mut attacks: Vec<Attack<'_>> = Vec::new();
    for fuzz in &crates {
        let binaries = build(workspace, fuzz, &host)?;
        attacks.extend(fuzz.targets.iter().map(|target| Attack {
            fuzz,
            target,
            binary: binaries.join(target),
        }));
    }
    let mut crashed = Vec::new();
    for (attack, outcome) in attacks.iter().zip(run_all(&attacks, seconds)?) {
        if !outcome? {
            crashed.push(attack.name());
        }
    }
    if !crashed.is_empty() {
        bail!("fuzz: {} failed", crashed.join(", "));
    }
    Ok(())
}

/// What came of each attack, in their order: whether it found nothing.
///
/// The next attack begins as soon as one ends, whichever crate it is of.
fn run_all(attacks: &[Attack<'_>], seconds: u32) -> Result<Vec<Result<bool>>> {
    let queue = Mutex::new(attacks.iter().enumerate());
    let next = || queue.lock().ok()?.next();
    let work = || {
        let mut outcomes = Vec::new();
        while let Some((at, attack)) = next() {
            outcomes.push((at, attack.run(seconds)));
        }
        outcomes
    };
    let mut outcomes: Vec<(usize, Result<bool>)> = Vec::new();
    thread::scope(|scope| {
        let workers = [(); AT_ONCE].map(|()| scope.spawn(work));
        for worker in workers {
            outcomes.extend(worker.join().map_err(|_| anyhow!("an attack panicked"))?);
        }
        anyhow::Ok(())
    })?;
    outcomes.sort_by_key(|(at, _)| *at);
    Ok(outcomes.into_iter().map(|(_, outcome)| outcome).collect())
}

fn fuzz_crates(workspace: &Workspace) -> Result<Vec<FuzzCrate>> {
    let mut crates = Vec::new();
    for member in workspace.members() {
        let Some(folder) = member.manifest_path.parent() else {
            continue;
        };
        let folder = folder.as_std_path().join("fuzz");
        let sources = folder.join("fuzz_targets");
        if !sources.is_dir() {
            continue;
        }
        let mut targets = Vec::new();
        for entry in fs::read_dir(&sources)? {
            let path = entry?.path();
            if path.extension().is_some_and(|extension| extension == "rs") {
                targets.extend(
                    path.file_stem()
                        .map(|stem| stem.to_string_lossy().into_owned()),
                );
            }
        }
        targets.sort();
        crates.push(FuzzCrate {
            name: member.name.to_string(),
            folder,
            targets,
        });
    }
    Ok(crates)
}

fn host_triple() -> Result<String> {
    let rustc = env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let output = capture(Command::new(rustc).arg("-vV"))?;
    let version = text(&output.stdout);
    let host = version.lines().find_map(|line| line.strip_prefix("host: "));
    Ok(host.context("rustc -vV names no host")?.to_owned())
}

/// Builds all targets of one crate; gives the folder of the binaries.
fn build(workspace: &Workspace, fuzz: &FuzzCrate, host: &str) -> Result<PathBuf> {
    let target_dir = workspace.target.join("fuzz");
    // An explicit target keeps the flags away from build scripts, which have no fuzzer to link.
    workspace::run(
        workspace
            .cargo()
            .current_dir(&fuzz.folder)
            .args(["build", "--quiet", "--release", "--bins", "--target", host])
            .env("CARGO_TARGET_DIR", &target_dir)
            .env("CARGO_ENCODED_RUSTFLAGS", RUSTFLAGS.join("\u{1f}")),
    )
    .with_context(|| format!("cannot build the fuzz targets of {}", fuzz.name))?;
    Ok(target_dir.join(host).join("release"))
}

fn copy_files(from: &Path, to: &Path) -> Result<usize> {
    let mut count = 0;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        if entry.file_type()?.is_file() {
            fs::copy(entry.path(), to.join(entry.file_name()))?;
            count += 1;
        }
    }
    Ok(count)
}

/// Whether libFuzzer found counters: without them it searches blindly and still succeeds.
fn is_instrumented(log: &str) -> bool {
    log.lines()
        .any(|line| line.contains("inline 8-bit counters") && !line.contains("(0 inline"))
}

/// The log without a line for every input that reached something new.
fn without_progress(log: &str) -> String {
    let lines = log.lines().filter(|line| !line.starts_with('#'));
    lines.collect::<Vec<_>>().join("\n")
}

fn executed(log: &str) -> &str {
    let runs = log
        .lines()
        .rev()
        .find_map(|line| line.strip_prefix("Done ")?.split_once(" runs"));
    runs.map_or("?", |(runs, _)| runs)
}

fn artifact(log: &str) -> Option<&str> {
    log.lines()
        .find_map(|line| Some(line.split_once("Test unit written to ")?.1.trim()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_log_is_understood() {
        let log = "INFO: Loaded 1 modules   (182 inline 8-bit counters): 182\n\
                   artifact_prefix='/a/'; Test unit written to /a/crash-1\n\
                   Done 42 runs in 1 second(s)\n";
        assert!(is_instrumented(log));
        assert!(!is_instrumented("INFO: A corpus is not provided"));
        assert_eq!(executed(log), "42");
        assert_eq!(without_progress("a\n#1 NEW cov: 3\nb"), "a\nb");
        assert_eq!(artifact(log), Some("/a/crash-1"));
    }
}
