//! House rules that no compiler checks. Each rule is a pure function over file texts.

use std::fmt;
use std::fs;

use anyhow::{Context, Result, bail};

use crate::workspace::Workspace;

mod edges;
mod fuzz_targets;
mod layout;
mod sources;

/// One broken rule, printed as `path:line: rule: message`.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Finding {
    path: String,
    line: usize,
    rule: &'static str,
    message: String,
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}:{}: {}: {}",
            self.path, self.line, self.rule, self.message
        )
    }
}

/// A file of the repository.
#[derive(Debug, Clone, Default)]
struct File {
    /// Relative to the root, with `/` between folders.
    path: String,
    size: u64,
    /// Only of sources, manifests and prose; empty otherwise.
    text: String,
}

impl File {
    fn extension(&self) -> &str {
        self.path
            .rsplit_once('.')
            .map_or("", |(_, extension)| extension)
    }

    fn is_text(&self) -> bool {
        matches!(self.extension(), "rs" | "toml" | "md")
    }
}

/// Checks every rule and prints every finding.
pub(crate) fn run(workspace: &Workspace) -> Result<()> {
    let files = read_files(workspace)?;
    let packages = edges::packages(workspace);
    let mut findings = edges::sibling_edges(&packages, &files);
    findings.extend(edges::fuzz_edges(&packages, &files));
    findings.extend(layout::check(&files));
    findings.extend(fuzz_targets::check(&files));
    findings.extend(files.iter().flat_map(sources::check));
    findings.sort();
    for finding in &findings {
        println!("{finding}");
    }
    if !findings.is_empty() {
        bail!(
            "tidy: {} finding(s) in {} files",
            findings.len(),
            files.len()
        );
    }
    println!("tidy: {} files, no finding", files.len());
    Ok(())
}

fn read_files(workspace: &Workspace) -> Result<Vec<File>> {
    workspace
        .files()?
        .into_iter()
        .map(|path| {
            let full = workspace.root.join(&path);
            let context = || format!("cannot read {}", full.display());
            let size = fs::metadata(&full).with_context(context)?.len();
            let mut file = File {
                path,
                size,
                text: String::new(),
            };
            if file.is_text() {
                file.text = fs::read_to_string(&full).with_context(context)?;
            }
            Ok(file)
        })
        .collect()
}

/// The 1-based line of the first line for which `holds`; 1 when there is none.
fn line_where(text: &str, holds: impl Fn(&str) -> bool) -> usize {
    text.lines().position(holds).map_or(1, |at| at + 1)
}

#[cfg(test)]
fn file(path: &str, text: &str) -> File {
    File {
        path: path.into(),
        size: text.len() as u64,
        text: text.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_finding_prints_as_editors_expect() {
        let finding = Finding {
            path: "a/b.rs".into(),
            line: 3,
            rule: "rule",
            message: "why".into(),
        };
        assert_eq!(finding.to_string(), "a/b.rs:3: rule: why");
    }

    #[test]
    fn line_of_nothing_is_the_first() {
        assert_eq!(line_where("a\nb\n", |line| line == "b"), 2);
        assert_eq!(line_where("a\nb\n", |line| line == "c"), 1);
    }
}
