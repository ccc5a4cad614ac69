//! What found the hits: which indexes, by which engines, and what they touched.

use std::io::{self, Write};
use std::path::Path;

use segidx::{Answer, Engine, EngineCosts, KeyframeAnswer};
use serde::Serialize;

use crate::output::table;

/// The search of one index.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlanStep {
    /// The file of the index, in the library's folder of shards.
    pub index: String,
    /// `lists`, `pivot` or `scan`; `verify` where the hits of parts were checked against all features;
    /// none if there was nothing to search.
    pub engine: Option<&'static str>,
    /// Segments of the query whose occurrences were looked at, counted from 1.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub pivots: Vec<usize>,
    /// What each engine was expected to cost, in units of one segment read in order.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub expected: Option<Expected>,
    /// Inverted lists read.
    pub lists: usize,
    /// Segment numbers read from them.
    pub postings: usize,
    /// Segments whose words were read.
    pub segments: usize,
    /// Places where a hit was looked for.
    pub candidates: usize,
    /// Hits found; those of removed clips are among them.
    pub hits: usize,
}

/// Expected costs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Expected {
    /// Of joining all lists.
    pub lists: u64,
    /// Of checking the occurrences of the rarest segment.
    pub pivot: u64,
    /// Of reading all segments in order.
    pub scan: u64,
}

impl From<EngineCosts> for Expected {
    fn from(costs: EngineCosts) -> Expected {
        let EngineCosts { lists, pivot, scan } = costs;
        Expected { lists, pivot, scan }
    }
}

impl PlanStep {
    pub(super) fn new(index: &Path, answer: &Answer) -> PlanStep {
        let step = PlanStep {
            hits: answer.hits.len(),
            ..PlanStep::empty(index)
        };
        let Some(plan) = &answer.plan else {
            return step;
        };
        PlanStep {
            engine: Some(match plan.engine {
                Engine::Lists => "lists",
                Engine::Scan => "scan",
                Engine::Pivot | Engine::Auto => "pivot",
            }),
            pivots: plan.pivots.iter().map(|pivot| pivot + 1).collect(),
            expected: Some(plan.estimated.into()),
            lists: plan.n_lists,
            postings: plan.n_postings,
            segments: plan.n_segments,
            candidates: plan.n_candidates,
            ..step
        }
    }

    /// Hits of parts held against all features.
    pub(super) fn verified(index: &Path, candidates: usize, hits: usize) -> PlanStep {
        PlanStep {
            engine: Some("verify"),
            candidates,
            hits,
            ..PlanStep::empty(index)
        }
    }

    /// Keyframes looked for, with as many `hits`.
    pub(super) fn keyframes(index: &Path, answer: &KeyframeAnswer) -> PlanStep {
        PlanStep {
            engine: Some(match answer.pivot {
                Some(_) => "pivot",
                None => "scan",
            }),
            pivots: answer.pivot.iter().map(|pivot| pivot + 1).collect(),
            postings: answer.pivot.map_or(0, |pivot| answer.n_accepted[pivot]),
            segments: answer.n_segments,
            candidates: answer.n_accepted.iter().copied().min().unwrap_or(0),
            hits: answer.hits.len(),
            ..PlanStep::empty(index)
        }
    }

    fn empty(index: &Path) -> PlanStep {
        let name = index.file_name().unwrap_or_default();
        PlanStep {
            index: name.display().to_string(),
            engine: None,
            pivots: Vec::new(),
            expected: None,
            lists: 0,
            postings: 0,
            segments: 0,
            candidates: 0,
            hits: 0,
        }
    }
}

pub(super) fn write_plan(out: &mut dyn Write, plan: &[PlanStep]) -> io::Result<()> {
    let heads = [
        "index",
        "engine",
        "from",
        "lists",
        "postings",
        "segments",
        "candidates",
        "hits",
        "expected lists/pivot/scan",
    ];
    let mut rows = table(&heads);
    for step in plan {
        let from: Vec<String> = step.pivots.iter().map(usize::to_string).collect();
        let expected = step
            .expected
            .map(|Expected { lists, pivot, scan }| format!("{lists}/{pivot}/{scan}"));
        rows.add_row([
            step.index.clone(),
            step.engine.unwrap_or("none").to_owned(),
            from.join(", "),
            step.lists.to_string(),
            step.postings.to_string(),
            step.segments.to_string(),
            step.candidates.to_string(),
            step.hits.to_string(),
            expected.unwrap_or_default(),
        ]);
    }
    writeln!(out, "{}", rows.trim_fmt())
}
