//! How a command ends, and why it failed.

use std::io;
use std::path::{Path, PathBuf};

use mocap_io::{ParseError, Position};
use serde::Serialize;

/// How a run ends; the value is the exit code of design.md §4.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// Something was found or made.
    Ok = 0,
    /// Nothing was found.
    Nothing = 1,
    /// The command line asks for something that does not exist.
    Usage = 2,
    /// An input cannot be read as what it should be.
    Input = 3,
    /// The file system failed.
    Io = 4,
}

/// Why a command, or one file of a batch, failed.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// The command line asks for something that does not exist.
    #[error("{0}")]
    Usage(String),
    /// A file cannot be read as what it should be.
    #[error("{}{}: {message}", path.display(), place(*at))]
    Input {
        /// The file.
        path: PathBuf,
        /// Where in the file, if it is text.
        at: Option<Position>,
        /// What was expected and what was found.
        message: String,
    },
    /// The file system failed.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The reader of our output went away, which is no failure.
    #[error("the output was closed")]
    Closed,
}

fn place(at: Option<Position>) -> String {
    at.map_or(String::new(), |at| format!(":{at}"))
}

impl Failure {
    /// The exit code.
    #[must_use]
    pub fn exit(&self) -> Exit {
        match self {
            Failure::Usage(_) => Exit::Usage,
            Failure::Input { .. } => Exit::Input,
            Failure::Io { .. } => Exit::Io,
            Failure::Closed => Exit::Ok,
        }
    }

    pub(crate) fn input(path: &Path, message: impl ToString) -> Failure {
        Failure::Input {
            path: path.to_owned(),
            at: None,
            message: message.to_string(),
        }
    }

    pub(crate) fn parse(path: &Path, error: &ParseError) -> Failure {
        Failure::Input {
            path: path.to_owned(),
            at: Some(error.at),
            message: error.kind.to_string(),
        }
    }

    pub(crate) fn io(path: &Path, source: io::Error) -> Failure {
        let path = path.to_owned();
        Failure::Io { path, source }
    }

    /// An error of writing to standard output.
    pub(crate) fn stdout(source: io::Error) -> Failure {
        match source.kind() {
            io::ErrorKind::BrokenPipe => Failure::Closed,
            _ => Failure::io(Path::new("standard output"), source),
        }
    }
}

/// A file that a batch left out, as in the JSON of design.md §4.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Skipped {
    /// The file.
    pub path: String,
    /// 1-based line, if the place is known.
    pub line: Option<usize>,
    /// 1-based column.
    pub column: Option<usize>,
    /// 0-based byte.
    pub byte: Option<usize>,
    /// What was expected and what was found.
    pub error: String,
}

impl Skipped {
    pub(crate) fn new(clip: &Path, failure: &Failure) -> Skipped {
        let (path, at, error) = match failure {
            Failure::Input { path, at, message } => (path.as_path(), *at, message.clone()),
            Failure::Io { path, source } => (path.as_path(), None, source.to_string()),
            other => (clip, None, other.to_string()),
        };
        Skipped {
            path: path.display().to_string(),
            line: at.and_then(Position::line),
            column: at.and_then(Position::column),
            byte: at.map(Position::byte),
            error,
        }
    }
}
