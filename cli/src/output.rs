//! Speaking: text, JSON, progress, batches.

use std::io::{self, IsTerminal, Write};

use comfy_table::Table;
use comfy_table::presets::NOTHING;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use rayon::prelude::*;
use serde::Serialize;

use crate::failure::{Exit, Failure, Skipped};
use crate::source::ClipRef;

/// How much a command says, and in which form.
#[derive(Clone, Copy, Debug, Default)]
pub struct Voice {
    /// One JSON document instead of text.
    pub json: bool,
    /// No progress bar, no notes.
    pub quiet: bool,
    /// Every warning in full.
    pub verbose: bool,
    /// Skipped files make the exit code 3.
    pub strict: bool,
}

/// What a command found or made.
#[derive(Debug)]
pub struct Outcome<R> {
    /// The JSON result.
    pub result: R,
    /// Files that were left out.
    pub skipped: Vec<Skipped>,
    /// Whether there is anything in the result.
    pub found: bool,
}

#[derive(Serialize)]
struct Envelope<'a, R> {
    motif: &'a str,
    command: &'a str,
    skipped: &'a [Skipped],
    result: &'a R,
}

impl Voice {
    /// Prints an outcome: the JSON document of design.md §4, or what `text` writes, and gives the
    /// exit code.
    ///
    /// # Errors
    /// [`Failure`] if standard output fails.
    pub fn report<R: Serialize>(
        self,
        command: &str,
        outcome: &Outcome<R>,
        text: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<Exit, Failure> {
        let mut out = io::stdout().lock();
        if self.json {
            let envelope = Envelope {
                motif: env!("CARGO_PKG_VERSION"),
                command,
                skipped: &outcome.skipped,
                result: &outcome.result,
            };
            serde_json::to_writer(&mut out, &envelope).map_err(|e| Failure::stdout(e.into()))?;
            writeln!(out).map_err(Failure::stdout)?;
        } else {
            text(&mut out).map_err(Failure::stdout)?;
        }
        out.flush().map_err(Failure::stdout)?;
        drop(out);
        self.list_skipped(&outcome.skipped);
        Ok(
            match (self.strict && !outcome.skipped.is_empty(), outcome.found) {
                (true, _) => Exit::Input,
                (false, true) => Exit::Ok,
                // Nothing came out because nothing could be read.
                (false, false) if !outcome.skipped.is_empty() => Exit::Input,
                (false, false) => Exit::Nothing,
            },
        )
    }

    fn list_skipped(self, skipped: &[Skipped]) {
        if self.json || skipped.is_empty() {
            return;
        }
        let files = if skipped.len() == 1 {
            "file was"
        } else {
            "files were"
        };
        note(&format!("{} {files} skipped:", skipped.len()));
        for one in skipped {
            let at = match (one.line, one.column) {
                (Some(line), Some(column)) => format!(":{line}:{column}"),
                _ => String::new(),
            };
            note(&format!("  {}{at}: {}", one.path, one.error));
        }
    }

    /// Says something on standard error, unless asked to be quiet or to speak JSON.
    pub fn note(self, text: &str) {
        if !self.quiet && !self.json {
            note(text);
        }
    }

    /// A bar on standard error while it is a terminal and nobody minds.
    #[must_use]
    pub fn progress(self, n_steps: usize, what: &'static str) -> ProgressBar {
        if self.quiet || self.json || !io::stderr().is_terminal() {
            return ProgressBar::hidden();
        }
        let bar = ProgressBar::with_draw_target(Some(n_steps as u64), ProgressDrawTarget::stderr());
        let style = ProgressStyle::with_template("{msg} [{bar:40}] {pos}/{len} {eta}")
            .unwrap_or_else(|_| ProgressStyle::default_bar());
        bar.set_style(style.progress_chars("=> "));
        bar.set_message(what);
        bar
    }

    /// Does `work` for every clip in parallel. Results are in the order of `clips`; clips that fail
    /// are left out and listed.
    pub fn batch<T: Send>(
        self,
        clips: &[ClipRef],
        what: &'static str,
        work: impl Fn(&ClipRef) -> Result<T, Failure> + Sync,
    ) -> (Vec<(ClipRef, T)>, Vec<Skipped>) {
        let bar = self.progress(clips.len(), what);
        let outcomes: Vec<Result<T, Failure>> = clips
            .par_iter()
            .with_max_len(1)
            .map(|clip| {
                let outcome = work(clip);
                bar.inc(1);
                outcome
            })
            .collect();
        bar.finish_and_clear();
        let mut done = Vec::new();
        let mut skipped = Vec::new();
        for (clip, outcome) in clips.iter().zip(outcomes) {
            match outcome {
                Ok(value) => done.push((clip.clone(), value)),
                Err(failure) => skipped.push(Skipped::new(&clip.path, &failure)),
            }
        }
        (done, skipped)
    }
}

/// A failed note is nothing to stop for: standard error may be closed.
fn note(text: &str) {
    let _ = writeln!(io::stderr(), "{text}");
}

/// A plain table with these column heads.
#[must_use]
pub fn table(heads: &[&str]) -> Table {
    let mut table = Table::new();
    table.load_style(NOTHING).set_header(heads.iter().copied());
    table.force_no_tty();
    table
}

/// `1 clip`, `2 clips`.
#[must_use]
pub fn count(n: usize, noun: &str) -> String {
    match n {
        1 => format!("1 {noun}"),
        n => format!("{n} {noun}s"),
    }
}
