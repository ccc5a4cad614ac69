//! `motif search --example DIR`: every clip of a folder is an example.

use std::fs;
use std::io::{self, Write};

use serde::Serialize;

use super::{HitJson, SearchResult, What, search};
use crate::failure::{Exit, Failure, Skipped};
use crate::library::Library;
use crate::output::{Outcome, Voice, count, table};
use crate::recording::ReadOptions;
use crate::source::{ClipRef, find_clips};

/// What was found for each clip of a folder.
#[derive(Clone, Debug, Serialize)]
pub struct SearchesResult {
    /// One per clip, in the order of their paths.
    pub searches: Vec<SearchResult>,
}

/// Finds motions like each clip at or below the path of `examples`, in parallel. Clips that cannot be an
/// example are left out and listed.
///
/// # Errors
/// [`Failure`] if the folder has no clip.
pub fn search_all(
    library: &Library,
    examples: &ClipRef,
    what: &What<'_>,
    options: &ReadOptions,
    voice: Voice,
) -> Result<(SearchesResult, Vec<Skipped>), Failure> {
    let clips = find_clips(std::slice::from_ref(&examples.path))?;
    // What is odd about each example would drown the answers.
    let mute = Voice {
        quiet: true,
        ..voice
    };
    let (done, skipped) = voice.batch(&clips, "searching", |clip| {
        search(library, clip, what, options, mute)
    });
    let searches = done.into_iter().map(|(_, result)| result).collect();
    Ok((SearchesResult { searches }, skipped))
}

pub(super) fn run(
    library: &Library,
    examples: &ClipRef,
    what: &What<'_>,
    options: &ReadOptions,
    voice: Voice,
) -> Result<Exit, Failure> {
    let (result, skipped) = search_all(library, examples, what, options, voice)?;
    let outcome = Outcome {
        found: result.searches.iter().any(|search| search.n_hits > 0),
        result,
        skipped,
    };
    let searches = &outcome.result.searches;
    voice.report("search", &outcome, |out| tell(out, searches))
}

/// A row per example, with the best hit in another clip.
fn tell(out: &mut dyn Write, searches: &[SearchResult]) -> io::Result<()> {
    writeln!(out, "{}", count(searches.len(), "example"))?;
    let mut rows = table(&[
        "example", "features", "segments", "hits", "clips", "nearest", "frames", "cost",
    ]);
    for search in searches {
        let query = &search.query;
        let mut row = vec![
            query.clip.clone(),
            query.features.len().to_string(),
            query.segments.len().to_string(),
            search.n_hits.to_string(),
            search.n_clips.to_string(),
        ];
        let place = |clip: &str| fs::canonicalize(clip).ok();
        let own = place(&query.clip);
        let is_other = |hit: &&HitJson| hit.clip != query.clip && place(&hit.clip) != own;
        let mut others = search.hits.iter().filter(is_other);
        row.extend(match others.next() {
            Some(hit) => [
                hit.clip.clone(),
                format!("{}-{}", hit.start, hit.end),
                hit.cost.to_string(),
            ],
            None => Default::default(),
        });
        rows.add_row(row);
    }
    writeln!(out, "{}", rows.trim_fmt())
}
