//! Node.js and packages of the npm registry, for checks that run on it.

use std::fs;
use std::path::Path;
use std::process::Command;

use anyhow::{Result, bail};

use crate::workspace::{self, capture};

/// Node.js with its package manager: on the path, or from Debian's packages. `what` is said to need it.
pub(crate) fn need_node(what: &str) -> Result<()> {
    let is_complete = || answers("node") && answers("npm");
    if !is_complete() {
        install_debian(&["nodejs", "npm"]);
    }
    if !is_complete() {
        bail!("{what} runs on Node.js: install node and npm");
    }
    Ok(())
}

/// Whether a program is on the path and tells its version.
pub(crate) fn answers(program: &str) -> bool {
    let output = capture(Command::new(program).arg("--version"));
    output.is_ok_and(|output| output.status.success())
}

/// Installs Debian packages where that is possible. Whether it worked is for the caller to see.
pub(crate) fn install_debian(packages: &[&str]) {
    println!("installing {}", packages.join(", "));
    let install = ["install", "--yes"];
    for arguments in [&["update"][..], &[&install[..], packages].concat()] {
        let _ = capture(Command::new("apt-get").args(arguments));
    }
}

/// Puts `name@version` into `folder/node_modules` unless it is there.
pub(crate) fn need_package(folder: &Path, package: &str) -> Result<()> {
    let (name, version) = package.rsplit_once('@').unwrap_or((package, ""));
    let stated = folder.join("node_modules").join(name).join("package.json");
    let is_installed = |text: String| text.contains(&format!("\"{version}\""));
    if fs::read_to_string(stated).is_ok_and(is_installed) {
        return Ok(());
    }
    let mut npm = Command::new("npm");
    let quiet = ["install", "--silent", "--no-audit", "--no-fund"];
    npm.args(quiet).arg("--ignore-scripts").arg("--prefix");
    workspace::run(npm.arg(folder).arg(package))
}
