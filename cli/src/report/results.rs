//! What other commands found, read back from their `--json`.

use std::fs;
use std::path::Path;

use mocap_io::Position;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

use crate::commands::align::AlignResult;
use crate::failure::Failure;

/// What a command found.
#[derive(Clone, Debug)]
pub enum Read {
    /// Searches, one or one per example.
    Searches(Vec<SearchRead>),
    /// Clips with labelled spans.
    Annotations(Vec<AnnotationRead>),
    /// Two clips, aligned.
    Alignment(Box<AlignRead>),
}

/// A search.
#[derive(Clone, Debug, Deserialize)]
pub struct SearchRead {
    /// What was asked.
    pub query: Map<String, Value>,
    /// Number of hits, listed or not.
    pub n_hits: usize,
    /// The listed ones.
    pub hits: Vec<HitRead>,
}

/// A hit.
#[derive(Clone, Debug, Deserialize)]
#[allow(missing_docs, reason = "as design.md section 4 has them")]
pub struct HitRead {
    pub clip: String,
    pub start: usize,
    pub end: usize,
    pub cost: f64,
    pub rank: usize,
    #[serde(default)]
    pub segments: Vec<[usize; 2]>,
    #[serde(default)]
    pub mirrored: bool,
    /// Of a scene.
    #[serde(default)]
    pub lines: Vec<LineRead>,
}

/// A line of a scene in a hit.
#[derive(Clone, Debug, Deserialize)]
#[allow(missing_docs, reason = "as `motif search --json` has them")]
pub struct LineRead {
    pub segments: Vec<[usize; 2]>,
}

/// A clip with labelled spans.
#[derive(Clone, Debug, Deserialize)]
#[allow(missing_docs, reason = "as design.md section 4 has them")]
pub struct AnnotationRead {
    pub clip: String,
    pub spans: Vec<SpanRead>,
}

/// A labelled span.
#[derive(Clone, Debug, Deserialize)]
#[allow(missing_docs, reason = "as design.md section 4 has them")]
pub struct SpanRead {
    pub label: String,
    pub start: usize,
    pub end: usize,
    pub cost: f64,
    #[serde(default)]
    pub tau: Option<f64>,
}

/// Two clips, aligned.
#[derive(Clone, Debug, Deserialize)]
#[allow(missing_docs, reason = "as `motif align --json` has them")]
pub struct AlignRead {
    pub a: SideRead,
    pub b: SideRead,
    pub rate: f64,
    pub points: Vec<String>,
    pub alignment: Option<PathRead>,
    pub reason: Option<String>,
}

/// One of the two clips.
#[derive(Clone, Debug, Deserialize)]
#[allow(missing_docs, reason = "as `motif align --json` has them")]
pub struct SideRead {
    pub clip: String,
}

/// A warping path.
#[derive(Clone, Debug, Deserialize)]
#[allow(missing_docs, reason = "as `motif align --json` has them")]
pub struct PathRead {
    pub cost: f64,
    pub mean_distance: f64,
    pub cells: CellsRead,
    pub excess: Option<f64>,
    pub path: Vec<StepRead>,
}

/// How much of the matrix was computed.
#[derive(Clone, Copy, Debug, Deserialize)]
#[allow(missing_docs, reason = "as `motif align --json` has them")]
pub struct CellsRead {
    pub full: u64,
    pub share: f64,
}

/// A step of a warping path.
#[derive(Clone, Debug, Deserialize)]
#[allow(missing_docs, reason = "as `motif align --json` has them")]
pub struct StepRead {
    pub a: usize,
    pub b: usize,
    pub cost: f64,
    pub points: Vec<Option<f64>>,
}

#[derive(Deserialize)]
struct Head {
    command: String,
}

#[derive(Deserialize)]
struct Body<T> {
    result: T,
}

#[derive(Deserialize)]
struct SearchesRead {
    searches: Vec<SearchRead>,
}

/// Reads what `motif search`, `annotate` or `align` printed with `--json`.
///
/// # Errors
/// [`Failure`] with line and column: a file that cannot be read, or is something else.
pub fn read(path: &Path) -> Result<Read, Failure> {
    let text = fs::read_to_string(path).map_err(|e| Failure::io(path, e))?;
    parse(&text).map_err(|(at, message)| Failure::Input {
        path: path.to_owned(),
        at: Some(at),
        message,
    })
}

type Refusal = (Position, String);

fn parse(text: &str) -> Result<Read, Refusal> {
    let head: Head = of_json(text)?;
    match head.command.as_str() {
        "search" if is_of_many(text)? => {
            let body: Body<SearchesRead> = of_json(text)?;
            Ok(Read::Searches(body.result.searches))
        }
        "search" => Ok(Read::Searches(vec![of_json::<Body<_>>(text)?.result])),
        "annotate" => Ok(Read::Annotations(of_json::<Body<_>>(text)?.result)),
        "align" => Ok(Read::Alignment(of_json::<Body<_>>(text)?.result)),
        other => Err((
            Position::Text {
                line: 1,
                column: 1,
                byte: 0,
            },
            format!("expected what search, annotate or align printed with --json, found {other:?}"),
        )),
    }
}

/// Whether a search had a folder of examples.
fn is_of_many(text: &str) -> Result<bool, Refusal> {
    #[derive(Deserialize)]
    struct Outline {
        searches: Option<serde::de::IgnoredAny>,
    }
    Ok(of_json::<Body<Outline>>(text)?.result.searches.is_some())
}

fn of_json<T: DeserializeOwned>(text: &str) -> Result<T, Refusal> {
    serde_json::from_str(text).map_err(|error| {
        let (line, column) = (error.line().max(1), error.column().max(1));
        let before = text.split_inclusive('\n').take(line - 1).map(str::len);
        let at = Position::Text {
            line,
            column,
            byte: (before.sum::<usize>() + column - 1).min(text.len()),
        };
        (at, error.to_string())
    })
}

impl SearchRead {
    /// What a search of this run gave; `None` if it is none.
    #[must_use]
    pub fn of(result: &impl serde::Serialize) -> Option<SearchRead> {
        serde_json::from_value(serde_json::to_value(result).ok()?).ok()
    }

    /// Source frames of the example's segments; none if there is no example.
    #[must_use]
    pub fn segments(&self) -> Vec<[usize; 2]> {
        let said = self.query.get("segments").cloned().unwrap_or_default();
        serde_json::from_value(said).unwrap_or_default()
    }
}

impl AlignRead {
    /// What an alignment of this run gave.
    #[must_use]
    pub fn of(result: &AlignResult) -> Option<AlignRead> {
        serde_json::from_value(serde_json::to_value(result).ok()?).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_is_told_for_what_is_no_result() {
        let place = |text: &str| match parse(text).unwrap_err() {
            (Position::Text { line, column, byte }, _) => (line, column, byte),
            other => panic!("{other:?}"),
        };
        assert_eq!(place("{\"command\": \"info\"}"), (1, 1, 0));
        let (line, _, byte) = place("{\"command\": \"align\",\n \"result\": [] }");
        assert_eq!(line, 2);
        assert!(byte > 20);
        assert_eq!(place("").0, 1);
    }

    #[test]
    fn one_search_and_many_are_told_apart() {
        let one = r#"{"query": {}, "n_hits": 3, "hits": [{"clip": "a", "start": 1, "end": 2, "cost": 4, "rank": 1}]}"#;
        let text = format!(r#"{{"command": "search", "result": {one}}}"#);
        let Read::Searches(found) = parse(&text).unwrap() else {
            panic!("no search");
        };
        assert_eq!(
            (found.len(), found[0].n_hits, found[0].hits[0].end),
            (1, 3, 2)
        );
        let text = format!(r#"{{"command": "search", "result": {{"searches": [{one}, {one}]}}}}"#);
        let Read::Searches(found) = parse(&text).unwrap() else {
            panic!("no search");
        };
        assert_eq!(found.len(), 2);
    }
}
