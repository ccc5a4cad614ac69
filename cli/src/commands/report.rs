//! `motif report`.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Serialize;

use super::index::{DEFAULT_RATE, DEFAULT_SET};
use crate::args::{Global, ReportArgs};
use crate::failure::{Exit, Failure};
use crate::library::NamedSet;
use crate::output::{Outcome, count};
use crate::report::given::Given;
use crate::report::html;
use crate::report::make::{How, document};
use crate::targets;

/// A page that was written.
#[derive(Clone, Debug, Serialize)]
pub struct ReportResult {
    /// The file.
    pub file: String,
    /// Its length.
    pub bytes: usize,
    /// Its tabs.
    pub pages: usize,
    /// Clips that pages speak of.
    pub clips: usize,
}

/// Runs the command.
///
/// # Errors
/// [`Failure`] if something given cannot be read, or the page cannot be written.
pub fn run(args: &ReportArgs, global: &Global) -> Result<Exit, Failure> {
    let voice = global.voice();
    let given = Given::read(&args.paths)?;
    let options = global.read_options()?;
    let features = match (&args.set, given.libraries.first()) {
        (None, Some(library)) => library.features.clone(),
        (set, _) => NamedSet::find(set.as_deref().unwrap_or(DEFAULT_SET))?,
    };
    let how = How {
        options: &options,
        features,
        rate: given.libraries.first().map_or(DEFAULT_RATE, |l| l.rate),
        // Up to a thousand megabytes are a number of bytes.
        budget: (args.budget * 1e6) as usize,
        matching: args.matching,
        labels: BTreeMap::new(),
        voice,
    };
    let title = args.title.clone();
    let title = title.unwrap_or_else(|| Given::title(&args.paths));
    let (result, skipped) = write(&args.output, &given, title, &how)?;
    let outcome = Outcome {
        found: result.pages > 0,
        result,
        skipped,
    };
    let result = &outcome.result;
    voice.report("report", &outcome, |out| {
        writeln!(
            out,
            "{}: {} of {}, {:.2} MB",
            result.file,
            count(result.pages, "page"),
            count(result.clips, "clip"),
            result.bytes as f64 / 1e6
        )
    })
}

/// Writes the page of everything given; gives what was left out as well.
///
/// # Errors
/// As [`document`], or [`Failure::Io`].
pub fn write(
    path: &Path,
    given: &Given,
    title: String,
    how: &How<'_>,
) -> Result<(ReportResult, Vec<crate::failure::Skipped>), Failure> {
    let (document, skipped) = document(given, title, how)?;
    let html = html::page(&document);
    targets::write(path, html.as_bytes())?;
    let result = ReportResult {
        file: path.display().to_string(),
        bytes: html.len(),
        pages: document.pages.len(),
        clips: document.clips.len(),
    };
    Ok((result, skipped))
}
