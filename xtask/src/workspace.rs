//! The workspace as cargo sees it, and how tasks start other programs in it.

use std::env;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Output};

use anyhow::{Context, Result, bail, ensure};
use cargo_metadata::{Metadata, MetadataCommand, Package};

/// The crates a downstream project may depend on alone.
pub(crate) const LIBRARIES: [&str; 6] = [
    "mocap-io",
    "relfeat",
    "segidx",
    "mtemplate",
    "dtw",
    "bundles",
];

/// Names the folder of real recordings, if it is not beside the repository.
pub(crate) const DATA: &str = "MOTIF_DATA";

/// The workspace that holds this program.
pub(crate) struct Workspace {
    pub(crate) root: PathBuf,
    pub(crate) target: PathBuf,
    pub(crate) metadata: Metadata,
}

impl Workspace {
    /// Asks cargo about the workspace this program was built from.
    pub(crate) fn load() -> Result<Self> {
        let mut command = MetadataCommand::new();
        command.no_deps();
        // Set by `cargo run`; it makes the task independent of the current folder.
        if let Some(own) = env::var_os("CARGO_MANIFEST_DIR") {
            command.current_dir(own);
        }
        let metadata = command
            .exec()
            .context("cannot read the workspace's cargo metadata")?;
        Ok(Self {
            root: metadata.workspace_root.clone().into(),
            target: metadata.target_directory.clone().into(),
            metadata,
        })
    }

    /// The folder of real recordings, if there is one.
    pub(crate) fn recordings(&self) -> Option<PathBuf> {
        let beside = || self.root.parent()?.join("shared/data").canonicalize().ok();
        env::var_os(DATA).map(PathBuf::from).or_else(beside)
    }

    /// Members, in the order cargo names them.
    pub(crate) fn members(&self) -> &[Package] {
        &self.metadata.packages
    }

    /// The member of that name.
    pub(crate) fn member(&self, name: &str) -> Option<&Package> {
        self.members()
            .iter()
            .find(|package| package.name.as_str() == name)
    }

    /// A cargo command that runs in the root.
    pub(crate) fn cargo(&self) -> Command {
        let mut command = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
        command.current_dir(&self.root);
        command
    }

    /// Files git tracks or would track: no build output, nothing ignored. Relative to the root,
    /// with `/` between folders, sorted.
    pub(crate) fn files(&self) -> Result<Vec<String>> {
        let mut command = Command::new("git");
        command.current_dir(&self.root).args([
            "ls-files",
            "-z",
            "--cached",
            "--others",
            "--exclude-standard",
        ]);
        let output = capture(&mut command)?;
        ensure!(
            output.status.success(),
            "git ls-files failed: {}",
            text(&output.stderr).trim()
        );
        let mut files: Vec<String> = text(&output.stdout)
            .split('\0')
            .filter(|path| !path.is_empty())
            .map(Into::into)
            .collect();
        files.retain(|path| self.root.join(path).is_file());
        files.sort();
        files.dedup();
        Ok(files)
    }
}

/// Runs a command with this program's own output streams; fails when it does.
pub(crate) fn run(command: &mut Command) -> Result<()> {
    let status = command
        .status()
        .with_context(|| format!("cannot start {}", command_line(command)))?;
    check(status, command)
}

/// Turns a command's failure into an error that names it.
pub(crate) fn check(status: ExitStatus, command: &Command) -> Result<()> {
    if !status.success() {
        bail!("{} failed: {status}", command_line(command));
    }
    Ok(())
}

/// Runs a command and keeps what it prints.
pub(crate) fn capture(command: &mut Command) -> Result<Output> {
    command
        .output()
        .with_context(|| format!("cannot start {}", command_line(command)))
}

/// What a program printed, with bytes that are no UTF-8 replaced.
pub(crate) fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// The last `count` lines.
pub(crate) fn tail(text: &str, count: usize) -> String {
    let lines: Vec<&str> = text.lines().collect();
    lines[lines.len().saturating_sub(count)..].join("\n")
}

fn command_line(command: &Command) -> String {
    let program = Path::new(command.get_program())
        .file_name()
        .unwrap_or(OsStr::new("?"));
    let mut line = program.to_string_lossy().into_owned();
    for argument in command.get_args() {
        line.push(' ');
        line.push_str(&argument.to_string_lossy());
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn failing_command_is_an_error_that_names_it() {
        let error = run(Command::new("false").arg("word")).unwrap_err();
        assert!(
            error.to_string().starts_with("false word failed"),
            "{error}"
        );
    }

    #[test]
    fn tail_keeps_the_last_lines() {
        assert_eq!(tail("a\nb\nc\n", 2), "b\nc");
        assert_eq!(tail("a", 2), "a");
    }
}
