//! Programs under comparison, built or installed into a scratch folder and kept there.
//!
//! Only ours must be there; whatever else cannot be installed is named in the report.

use std::env::consts::EXE_SUFFIX;
use std::ffi::{OsStr, OsString};
use std::fs;
use std::path::{Path, PathBuf};
use std::process;

use anyhow::{Context, Result, bail};

use super::{Contestant, Role};
use crate::workspace::{self, Workspace, capture, tail, text};

/// Program and first arguments, or why they are missing.
pub(super) type Command = std::result::Result<Vec<OsString>, String>;

/// A package of a registry, pinned.
#[derive(Debug, Clone, Copy)]
pub(super) struct Package {
    pub(super) name: &'static str,
    pub(super) version: &'static str,
}

/// One program that can play several contestants.
pub(super) struct Toolbox {
    command: Command,
    packages: Vec<(&'static str, String)>,
    /// Packages that are not there although the program is, and why.
    missing: Vec<(&'static str, String)>,
}

impl Toolbox {
    fn new(program: Result<Vec<OsString>>, packages: &[Package]) -> Self {
        let versions = packages.iter().map(|p| (p.name, p.version.to_owned()));
        Self {
            command: program.map_err(|error| format!("not installed: {error:#}")),
            packages: versions.collect(),
            missing: Vec::new(),
        }
    }

    /// The file that is run, unless it is missing.
    pub(super) fn program(&self) -> Option<&Path> {
        Some(Path::new(self.command.as_ref().ok()?.first()?))
    }

    /// The program run as `PROGRAM name runs arguments…`, with a package's name, or with that and a
    /// colon and how the package is used.
    pub(super) fn contestant(
        &self,
        role: Role,
        name: &'static str,
        runs: u32,
        arguments: &[impl AsRef<OsStr>],
        states: &'static [&'static str],
    ) -> Contestant {
        let (package, _) = name.split_once(':').unwrap_or((name, ""));
        let of = |list: &[(&str, String)]| {
            let found = list.iter().find(|(known, _)| *known == package);
            found.map(|(_, text)| text.clone())
        };
        let version = of(&self.packages);
        let mut command = self.command.clone().map(|mut line| {
            line.extend([name.into(), runs.to_string().into()]);
            line.extend(arguments.iter().map(|argument| argument.as_ref().into()));
            line
        });
        if let (Ok(_), Some(reason)) = (&command, of(&self.missing)) {
            command = Err(reason);
        }
        Contestant {
            role,
            name,
            version: version.unwrap_or_default(),
            command,
            states,
        }
    }
}

/// A program of the benches; its version is that of the room it measures.
pub(super) fn ours(workspace: &Workspace, bin: &str, room: &str) -> Result<Toolbox> {
    let arguments = ["build", "--release", "--quiet", "--package", "benches"];
    workspace::run(workspace.cargo().args(arguments).args(["--bin", bin]))?;
    let program = workspace.target.join(format!("release/{bin}{EXE_SUFFIX}"));
    let member = workspace.member(room).context("no such room")?;
    Ok(Toolbox {
        command: Ok(vec![program.into()]),
        packages: vec![("motif", member.version.to_string())],
        missing: Vec::new(),
    })
}

/// A program over crates, with our release profile and our stopwatch, for this processor.
///
/// `unused` are dependencies that a crate names but does not need: empty crates take their place.
pub(super) fn rust(
    workspace: &Workspace,
    folder: &Path,
    main: &str,
    crates: &[Package],
    unused: &[Package],
) -> Toolbox {
    let build = || {
        write(&folder.join("src/main.rs"), main)?;
        let stopwatch = workspace.root.join("benches/src/stopwatch.rs");
        let stopwatch = fs::read_to_string(&stopwatch)
            .with_context(|| format!("cannot read {}", stopwatch.display()))?;
        write(&folder.join("src/stopwatch.rs"), &stopwatch)?;
        write(&folder.join("Cargo.toml"), &manifest(crates, unused))?;
        for Package { name, version } in unused {
            let stub = folder.join(name);
            let text = format!("[package]\nname = \"{name}\"\nversion = \"{version}\"\n");
            write(&stub.join("Cargo.toml"), &text)?;
            write(&stub.join("src/lib.rs"), "")?;
        }
        let mut cargo = workspace.cargo();
        cargo.current_dir(folder);
        cargo.env("CARGO_TARGET_DIR", folder.join("target"));
        cargo.env("RUSTFLAGS", "-C target-cpu=native");
        run(cargo.args(["build", "--release", "--quiet"]))?;
        let program = folder.join(format!("target/release/rust_peers{EXE_SUFFIX}"));
        Ok(vec![program.into()])
    };
    Toolbox::new(build(), crates)
}

fn manifest(crates: &[Package], unused: &[Package]) -> String {
    let mut text = "[workspace]\n[package]\nname = \"rust_peers\"\nedition = \"2024\"\n\
                    [profile.release]\ncodegen-units = 1\nlto = \"thin\"\n\
                    [dependencies]\ncpu-time = \"=1.0.0\"\n"
        .to_owned();
    for Package { name, version } in crates {
        text += &format!("{name} = \"={version}\"\n");
    }
    text += "[patch.crates-io]\n";
    for Package { name, .. } in unused {
        text += &format!("{name} = {{ path = \"{name}\" }}\n");
    }
    text
}

/// A script over packages of PyPI, in an environment of its own.
///
/// `sources` are packages to compile for this processor with what `packages` bring; one that does
/// not compile is missed alone.
pub(super) fn python(
    folder: &Path,
    script: &str,
    packages: &[Package],
    sources: &[Package],
) -> Toolbox {
    let python = folder.join("venv/bin/python");
    let build = || {
        let path = folder.join("peers.py");
        write(&path, script)?;
        let pins = packages
            .iter()
            .map(|p| format!("{}=={}", p.name, p.version));
        let pins: Vec<String> = pins.collect();
        let (done, wanted) = (folder.join("installed"), pins.join("\n"));
        if fs::read_to_string(&done).ok().as_ref() != Some(&wanted) {
            let venv = ["-m", "venv", "--clear"];
            run(process::Command::new("python3")
                .args(venv)
                .arg(folder.join("venv")))?;
            let pip = ["-m", "pip", "install", "--quiet"];
            run(process::Command::new(&python).args(pip).args(&pins))?;
            write(&done, &wanted)?;
        }
        Ok(vec![python.clone().into(), path.into()])
    };
    let mut toolbox = Toolbox::new(build(), &[packages, sources].concat());
    for Package { name, version } in sources.iter().filter(|_| toolbox.command.is_ok()) {
        let pip = ["-m", "pip", "install", "--quiet", "--no-deps"];
        let mut compile = process::Command::new(&python);
        compile.args(pip).arg("--no-build-isolation");
        compile.env("CFLAGS", "-O3 -march=native");
        if let Err(error) = run(compile.arg(format!("{name}=={version}"))) {
            toolbox
                .missing
                .push((name, format!("not installed: {error:#}")));
        }
    }
    toolbox
}

/// A kernel in C, compiled for this processor.
pub(super) fn c(folder: &Path, source: &str) -> Toolbox {
    let build = || {
        let (code, program) = (folder.join("limit.c"), folder.join("limit"));
        write(&code, source)?;
        let mut gcc = process::Command::new("gcc");
        gcc.args(["-O3", "-march=native", "-o"]).arg(&program);
        run(gcc.arg(&code).arg("-lm"))?;
        Ok(vec![program.into()])
    };
    Toolbox::new(build(), &[])
}

/// Writes a file that is not there yet as wanted; untouched files are not built again.
fn write(path: &Path, text: &str) -> Result<()> {
    if fs::read_to_string(path).is_ok_and(|old| old == text) {
        return Ok(());
    }
    let folder = path.parent().map_or_else(PathBuf::new, Path::to_path_buf);
    fs::create_dir_all(folder)
        .and_then(|()| fs::write(path, text))
        .with_context(|| format!("cannot write {}", path.display()))
}

/// Runs a command silently; its last words are in the error.
fn run(command: &mut process::Command) -> Result<()> {
    let output = capture(command)?;
    if !output.status.success() {
        let program = command.get_program().to_string_lossy().into_owned();
        bail!("{program}: {}", last_words(text(&output.stderr).trim()));
    }
    Ok(())
}

/// The last line that names an error, since pip ends with advice; else the last one.
fn last_words(stderr: &str) -> String {
    let named = stderr.lines().rev().find(|line| line.contains("Error: "));
    named.map_or_else(|| tail(stderr, 1), |line| line.trim().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_manifest_pins_every_crate_and_replaces_the_unused() {
        let package = |name, version| Package { name, version };
        let text = manifest(&[package("a", "1.0.1")], &[package("b", "0.2.0")]);
        let manifest: toml::Table = text.parse().unwrap();
        assert_eq!(manifest["dependencies"]["a"].as_str(), Some("=1.0.1"));
        assert_eq!(
            manifest["patch"]["crates-io"]["b"]["path"].as_str(),
            Some("b")
        );
        assert!(manifest.contains_key("workspace"), "{text}");
    }

    #[test]
    fn what_is_missing_says_why() {
        let toolbox = Toolbox::new(Err(anyhow::anyhow!("no compiler")), &[]);
        let contestant = toolbox.contestant(Role::Peer, "x", 1, &[""; 0], &[]);
        assert_eq!(
            contestant.command.unwrap_err(),
            "not installed: no compiler"
        );
    }
}
