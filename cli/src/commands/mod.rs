//! One module per command.

pub mod align;
pub mod annotate;
pub mod bundle;
pub mod convert;
pub mod demo;
pub mod eval;
pub mod features;
pub mod index;
pub mod info;
pub mod learn;
pub mod library;
pub mod report;
pub mod search;
pub mod template;
pub mod view;
pub mod walk;

use std::fmt;
use std::path::PathBuf;

use mocap_io::Warning;
use serde::Serialize;

use crate::output::{Voice, count};

/// A warning as JSON.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WarningJson {
    /// The file.
    pub path: String,
    /// 1-based, in a text file.
    pub line: Option<usize>,
    /// 1-based, in a text file.
    pub column: Option<usize>,
    /// 0-based.
    pub byte: usize,
    /// Such as `AMC001`.
    pub code: &'static str,
    /// What is odd, and what was done about it.
    pub message: String,
}

impl WarningJson {
    fn new(path: &std::path::Path, warning: &Warning) -> WarningJson {
        WarningJson {
            path: path.display().to_string(),
            line: warning.at.line(),
            column: warning.at.column(),
            byte: warning.at.byte(),
            code: warning.code(),
            message: warning.kind.to_string(),
        }
    }
}

impl fmt::Display for WarningJson {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:", self.path)?;
        match (self.line, self.column) {
            (Some(line), Some(column)) => write!(f, "{line}:{column}:")?,
            _ => write!(f, "byte {}:", self.byte)?,
        }
        write!(f, " {}: {}", self.code, self.message)
    }
}

/// Says how many gaps of markers were filled, if any were.
fn tell_filled(voice: Voice, n_filled: usize) {
    if n_filled > 0 {
        voice.note(&format!(
            "{} of markers filled, as asked",
            count(n_filled, "gap")
        ));
    }
}

/// Most warnings that are listed without `--verbose`.
const WARNINGS_LISTED: usize = 5;

/// Says the warnings on standard error, each file's skeleton only once.
fn tell_warnings<'a>(
    voice: Voice,
    warnings: impl Iterator<Item = &'a (PathBuf, Warning)>,
) -> Vec<WarningJson> {
    let mut all: Vec<WarningJson> = Vec::new();
    for (path, warning) in warnings {
        let warning = WarningJson::new(path, warning);
        if !all.contains(&warning) {
            all.push(warning);
        }
    }
    let limit = if voice.verbose {
        all.len()
    } else {
        WARNINGS_LISTED
    };
    for w in all.iter().take(limit) {
        voice.note(&w.to_string());
    }
    if all.len() > limit {
        let more = count(all.len() - limit, "more warning");
        voice.note(&format!("{more}; --verbose lists all"));
    }
    all
}
