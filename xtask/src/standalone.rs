//! Tests each library crate as a downstream project sees it: alone, with no sibling in reach.

use std::ffi::OsStr;
use std::fs;
use std::path::Path;
use std::time::Instant;

use anyhow::{Context, Result, bail};
use toml::{Table, Value};

use crate::workspace::{DATA, LIBRARIES, Workspace, capture, tail, text};

/// Tests the named crates, or all of them; prints one line for each.
pub(crate) fn run(workspace: &Workspace, names: &[String]) -> Result<()> {
    if let Some(name) = names
        .iter()
        .find(|name| !LIBRARIES.contains(&name.as_str()))
    {
        bail!(
            "no library crate is named {name}; there are {}",
            LIBRARIES.join(", ")
        );
    }
    let is_chosen = |name: &&str| names.is_empty() || names.iter().any(|chosen| chosen == name);
    let mut failed = Vec::new();
    for name in LIBRARIES.into_iter().filter(is_chosen) {
        if !test_alone(workspace, name)? {
            failed.push(name);
        }
    }
    if !failed.is_empty() {
        bail!("standalone: {} failed", failed.join(", "));
    }
    Ok(())
}

fn test_alone(workspace: &Workspace, name: &str) -> Result<bool> {
    let start = Instant::now();
    let member = workspace
        .member(name)
        .with_context(|| format!("no member named {name}"))?;
    let folder = member
        .manifest_path
        .parent()
        .context("a manifest stands in a folder")?;
    // The same folder on every run: its path is part of the artefacts' names.
    let root = &workspace.target.join("alone").join(name);
    if root.exists() {
        fs::remove_dir_all(root).with_context(|| format!("cannot clear {}", root.display()))?;
    }
    copy_folder(folder.as_std_path(), &root.join(name))?;
    fs::copy(workspace.root.join("Cargo.lock"), root.join("Cargo.lock"))
        .context("cannot copy Cargo.lock")?;
    let manifest = fs::read_to_string(workspace.root.join("Cargo.toml"))?;
    fs::write(
        root.join("Cargo.toml"),
        single_member_manifest(&manifest, name)?,
    )?;

    let mut cargo = workspace.cargo();
    cargo
        .current_dir(root)
        .args(["test", "--color=never"])
        // Dependencies that the workspace has built with the same features are not built again.
        .env("CARGO_TARGET_DIR", &workspace.target);
    if let Some(data) = workspace.recordings() {
        cargo.env(DATA, data);
    }
    let output = capture(&mut cargo)?;
    let stdout = text(&output.stdout);
    let seconds = start.elapsed().as_secs_f64();
    if output.status.success() {
        println!(
            "standalone {name}: ok, {} tests passed, {seconds:.1} s",
            passed_tests(&stdout)
        );
    } else {
        println!("standalone {name}: FAILED after {seconds:.1} s");
        eprintln!("{}\n{}", tail(&text(&output.stderr), 60), tail(&stdout, 60));
    }
    Ok(output.status.success())
}

/// The root manifest with one member, and no way to name another.
fn single_member_manifest(manifest: &str, name: &str) -> Result<String> {
    let mut manifest: Table = manifest
        .parse()
        .context("the root manifest is no valid TOML")?;
    let workspace = manifest
        .get_mut("workspace")
        .and_then(Value::as_table_mut)
        .context("the root manifest has no [workspace]")?;
    workspace.insert("members".into(), Value::Array(vec![name.into()]));
    workspace.insert(
        "exclude".into(),
        Value::Array(vec![format!("{name}/fuzz").into()]),
    );
    workspace.remove("default-members");
    if let Some(dependencies) = workspace
        .get_mut("dependencies")
        .and_then(Value::as_table_mut)
    {
        dependencies.retain(|_, entry| entry.get("path").is_none());
    }
    Ok(toml::to_string(&manifest)?)
}

/// Copies a crate's folder without build output, whether its own or its fuzz crate's.
fn copy_folder(from: &Path, to: &Path) -> Result<()> {
    fs::create_dir_all(to)?;
    let entries = fs::read_dir(from).with_context(|| format!("cannot list {}", from.display()))?;
    for entry in entries {
        let entry = entry?;
        let (source, copy) = (entry.path(), to.join(entry.file_name()));
        if !entry.file_type()?.is_dir() {
            fs::copy(&source, &copy)
                .with_context(|| format!("cannot copy {}", source.display()))?;
        } else if !is_build_output(&source) {
            copy_folder(&source, &copy)?;
        }
    }
    Ok(())
}

fn is_build_output(folder: &Path) -> bool {
    folder.file_name() == Some(OsStr::new("target"))
        && folder
            .parent()
            .is_some_and(|parent| parent.join("Cargo.toml").is_file())
}

/// Sum over the test runner's closing lines.
fn passed_tests(stdout: &str) -> usize {
    let counts = stdout.lines().filter_map(|line| {
        let (_, rest) = line.strip_prefix("test result: ")?.split_once(". ")?;
        rest.split_once(" passed")?.0.parse::<usize>().ok()
    });
    counts.sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_manifest_keeps_one_member_and_no_path() {
        let manifest = single_member_manifest(
            "[workspace]\nresolver = \"3\"\nmembers = [\"a\", \"dtw\"]\n\
             [workspace.dependencies]\na = { path = \"a\" }\nndarray = \"=0.17.2\"\n\
             [workspace.lints.rust]\nunsafe_code = \"forbid\"\n[profile.dev]\nopt-level = 1\n",
            "dtw",
        )
        .unwrap();
        let manifest: Table = manifest.parse().unwrap();
        let expected: Table = "[workspace]\nresolver = \"3\"\nmembers = [\"dtw\"]\n\
             exclude = [\"dtw/fuzz\"]\n[workspace.dependencies]\nndarray = \"=0.17.2\"\n\
             [workspace.lints.rust]\nunsafe_code = \"forbid\"\n[profile.dev]\nopt-level = 1\n"
            .parse()
            .unwrap();
        assert_eq!(manifest, expected);
    }

    #[test]
    fn build_output_stays_behind() {
        let scratch = tempfile::tempdir().unwrap();
        let from = scratch.path().join("from");
        for path in [
            "target/a",
            "fuzz/target/a",
            "src/target/a.rs",
            "fuzz/corpus/ops/a",
        ] {
            let path = from.join(path);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, "").unwrap();
        }
        fs::write(from.join("Cargo.toml"), "").unwrap();
        fs::write(from.join("fuzz/Cargo.toml"), "").unwrap();
        let to = scratch.path().join("to");
        copy_folder(&from, &to).unwrap();
        assert!(to.join("src/target/a.rs").is_file());
        assert!(to.join("fuzz/corpus/ops/a").is_file());
        assert!(!to.join("target").exists());
        assert!(!to.join("fuzz/target").exists());
    }

    #[test]
    fn passed_tests_are_summed() {
        let stdout = "test result: ok. 3 passed; 0 failed; 0 ignored\nother\n\
                      test result: ok. 11 passed; 0 failed\n";
        assert_eq!(passed_tests(stdout), 14);
    }
}
