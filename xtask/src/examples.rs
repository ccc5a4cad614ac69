//! Runs every example, as built by one cargo call.

use std::io::BufReader;
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail, ensure};
use cargo_metadata::{Message, TargetKind};

use crate::workspace::{self, Workspace, capture, text};

/// Builds all examples of all members, runs them in order of package and name.
pub(crate) fn run(workspace: &Workspace) -> Result<()> {
    let mut examples = build(workspace)?;
    examples.sort();
    let count = examples.len();
    for (package, name, executable) in examples {
        let mut command = Command::new(executable);
        command.current_dir(&workspace.root);
        let output = capture(&mut command)?;
        if !output.status.success() {
            print!("{}", text(&output.stdout));
            eprint!("{}", text(&output.stderr));
            bail!("example {package}/{name} failed: {}", output.status);
        }
        ensure!(
            !output.stdout.is_empty(),
            "example {package}/{name} prints nothing"
        );
        println!("example {package}/{name}: ok");
    }
    println!("examples: {count} ran");
    Ok(())
}

/// Package, name and executable of each example.
fn build(workspace: &Workspace) -> Result<Vec<(String, String, String)>> {
    let mut command = workspace.cargo();
    command
        .args(["build", "--quiet", "--workspace", "--examples"])
        .arg("--message-format=json-render-diagnostics")
        .stdout(Stdio::piped());
    let mut child = command.spawn().context("cannot start cargo build")?;
    let stdout = child.stdout.take().context("cargo build has no output")?;
    let mut examples = Vec::new();
    for message in Message::parse_stream(BufReader::new(stdout)) {
        let Message::CompilerArtifact(artifact) = message? else {
            continue;
        };
        let Some(executable) = artifact.executable else {
            continue;
        };
        if !artifact.target.kind.contains(&TargetKind::Example) {
            continue;
        }
        let package = workspace
            .members()
            .iter()
            .find(|member| member.id == artifact.package_id);
        let package = package.map_or_else(String::new, |member| member.name.to_string());
        examples.push((package, artifact.target.name, executable.into_string()));
    }
    workspace::check(child.wait()?, &command)?;
    Ok(examples)
}
