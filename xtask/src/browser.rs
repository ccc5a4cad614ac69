//! Tries the pages of `cli/web` in headless Chromium, with the tests in `cli/web/tests`.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

use crate::node::{answers, install_debian, need_node, need_package};
use crate::workspace::{self, Workspace};

/// Drives a browser that is there; it downloads none.
const DRIVER: &str = "playwright-core@1.65.1";
/// Names that Chromium goes by.
const BROWSERS: [&str; 4] = [
    "chromium",
    "chromium-browser",
    "google-chrome",
    "google-chrome-stable",
];
/// Says which browser to use instead.
const BROWSER: &str = "MOTIF_BROWSER";

/// Builds `motif`, installs what is missing below the target folder, and runs the tests.
pub(crate) fn run(workspace: &Workspace, only: Option<&str>) -> Result<()> {
    need_node("browser: its driver")?;
    let browser = need_browser()?;
    let folder = workspace.target.join("browser");
    copy_tests(&workspace.root.join("cli/web/tests"), &folder)?;
    need_package(&folder, DRIVER)?;
    // With the features of the whole workspace, whose builds are there already.
    let build = ["build", "--quiet", "--workspace", "--bin", "motif"];
    workspace::run(workspace.cargo().args(build))?;
    let program = format!("debug/motif{}", env::consts::EXE_SUFFIX);
    let mut node = Command::new("node");
    // One after the other: a second browser would only slow the first one on two cores.
    node.args(["--test", "--test-concurrency=1", "--test-reporter=spec"]);
    if let Some(only) = only {
        node.arg(format!("--test-name-pattern={only}"));
    }
    let tests = tests_of(&folder)?;
    node.args(tests)
        .current_dir(&folder)
        .env("MOTIF", workspace.target.join(program))
        .env(BROWSER, browser);
    workspace::run(&mut node)
}

/// The browser that is asked for, or on the path, or from Debian's packages.
fn need_browser() -> Result<PathBuf> {
    if let Some(named) = env::var_os(BROWSER) {
        return Ok(named.into());
    }
    let find = || BROWSERS.into_iter().find_map(on_path);
    if let Some(found) = find() {
        return Ok(found);
    }
    install_debian(&["chromium"]);
    match find() {
        Some(found) => Ok(found),
        None => bail!("browser: install chromium, or name one in {BROWSER}"),
    }
}

fn on_path(program: &str) -> Option<PathBuf> {
    let folders = env::var_os("PATH")?;
    let mut paths = env::split_paths(&folders).map(|folder| folder.join(program));
    let found = paths.find(|path| path.is_file())?;
    answers(program).then_some(found)
}

/// The driver is found from where the tests are, so they stand beside it and not in the sources.
fn copy_tests(from: &Path, to: &Path) -> Result<()> {
    fs::create_dir_all(to).with_context(|| format!("cannot make {}", to.display()))?;
    for file in tests_of(to)? {
        fs::remove_file(to.join(&file)).with_context(|| format!("cannot remove {file}"))?;
    }
    let entries = fs::read_dir(from).with_context(|| format!("no tests in {}", from.display()))?;
    for entry in entries {
        let path = entry?.path();
        let name = path.file_name().context("a file has a name")?;
        fs::copy(&path, to.join(name))
            .with_context(|| format!("cannot copy {}", path.display()))?;
    }
    Ok(())
}

/// File names of the tests in a folder, in order.
fn tests_of(folder: &Path) -> Result<Vec<String>> {
    let mut names = Vec::new();
    let entries = fs::read_dir(folder).with_context(|| format!("no {}", folder.display()))?;
    for entry in entries {
        let name = entry?.file_name().to_string_lossy().into_owned();
        if name.ends_with(".test.mjs") {
            names.push(name);
        }
    }
    names.sort_unstable();
    Ok(names)
}
