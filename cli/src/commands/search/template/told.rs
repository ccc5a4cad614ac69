//! Hits of a template, as JSON and as a table.

use std::io::{self, Write};

use mtemplate::{Keyframe, Match};
use serde::Serialize;

use super::super::hits::write_unsearched;
use super::super::plan::{PlanStep, write_plan};
use crate::library::{Clip, Library};
use crate::output::{count, table};
use crate::selection;

/// What was looked for and where it was found.
#[derive(Clone, Debug, Serialize)]
pub struct TemplateResult {
    /// What was looked for.
    pub query: TemplateQueryJson,
    /// Number of hits, listed or not.
    pub n_hits: usize,
    /// Number of clips with a hit.
    pub n_clips: usize,
    /// Clips that could not be searched, because their rigs lack a feature that the template asks for.
    pub n_unsearched: usize,
    /// How much of the others was matched.
    pub searched: Searched,
    /// What is found everywhere but not around the keyframes, if that was asked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lost: Option<Lost>,
    /// How places were found, if that was asked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plan: Option<Vec<PlanStep>>,
    /// The best hits.
    pub hits: Vec<TemplateHitJson>,
}

/// What was looked for.
#[derive(Clone, Debug, Serialize)]
pub struct TemplateQueryJson {
    /// Name of the class.
    pub template: String,
    /// Columns of the template.
    pub columns: usize,
    /// The largest cost of a hit.
    pub tau: f64,
    /// Around which hits were looked for; none if everywhere.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub keyframes: Vec<KeyframeJson>,
}

/// A keyframe.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct KeyframeJson {
    /// Its column, 0-based.
    pub column: usize,
    /// Its stiffness.
    pub stiffness: f64,
    /// Features that have to be on.
    pub one: Vec<String>,
    /// Features that have to be off.
    pub zero: Vec<String>,
}

/// How much was matched, in words.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Searched {
    /// Words matched.
    pub words: usize,
    /// Words of the clips that could be searched.
    pub of: usize,
    /// The one by the other; 1 if there are none.
    pub share: f64,
}

/// Hits that keyframes lose.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Lost {
    /// Number of lost hits, listed or not.
    pub n_hits: usize,
    /// Number of hits without keyframes.
    pub of: usize,
    /// The best of the lost hits, with their ranks among all hits without keyframes.
    pub hits: Vec<TemplateHitJson>,
}

/// A hit, as design.md §4 lays it down. Frames are those of the source file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TemplateHitJson {
    /// Path as indexed.
    pub clip: String,
    /// First frame.
    pub start: usize,
    /// One past the last frame.
    pub end: usize,
    /// Seconds from the start of the file.
    pub start_s: f64,
    /// Seconds from the start of the file.
    pub end_s: f64,
    /// Cost Δ of the match.
    pub cost: f64,
    /// 1 is best.
    pub rank: usize,
}

impl KeyframeJson {
    pub(super) fn new(library: &Library, keyframe: &Keyframe) -> KeyframeJson {
        let names = |bits| selection::names(&library.features.set, bits);
        KeyframeJson {
            column: keyframe.column,
            stiffness: keyframe.stiffness,
            one: names(keyframe.care & keyframe.value),
            zero: names(keyframe.care & !keyframe.value),
        }
    }
}

impl TemplateHitJson {
    pub(super) fn new(
        library: &Library,
        clip: &Clip,
        found: &Match,
        rank: usize,
    ) -> TemplateHitJson {
        let meta = &clip.meta;
        let span = meta.source_span(found.span.clone(), clip.n_words, library.rate);
        TemplateHitJson {
            clip: clip.name.clone(),
            start: span.start,
            end: span.end,
            start_s: span.start as f64 / meta.source_rate,
            end_s: span.end as f64 / meta.source_rate,
            cost: found.cost,
            rank,
        }
    }
}

pub(super) fn write_hits(out: &mut dyn Write, result: &TemplateResult) -> io::Result<()> {
    let query = &result.query;
    let columns = count(query.columns, "column");
    writeln!(
        out,
        "looked for {}, {columns}, at a cost of up to {}",
        query.template, query.tau
    )?;
    if !query.keyframes.is_empty() {
        let n = count(query.keyframes.len(), "keyframe");
        let percent = 100.0 * result.searched.share;
        writeln!(out, "searched {percent:.1} % of the frames, around {n}")?;
    }
    if let Some(plan) = &result.plan {
        for keyframe in &query.keyframes {
            let asked = |names: &[String], is: u8| -> Vec<String> {
                names.iter().map(|name| format!("{name}={is}")).collect()
            };
            let features = [asked(&keyframe.one, 1), asked(&keyframe.zero, 0)].concat();
            let (column, stiffness) = (keyframe.column, keyframe.stiffness);
            writeln!(
                out,
                "keyframe in column {column}, stiffness {stiffness:.2}: {}",
                features.join(", ")
            )?;
        }
        write_plan(out, plan)?;
    }
    write_unsearched(out, result.n_unsearched)?;
    if result.n_hits == 0 {
        writeln!(out, "nothing found")?;
    } else {
        let (hits, clips) = (count(result.n_hits, "hit"), count(result.n_clips, "clip"));
        writeln!(out, "{hits} in {clips}")?;
        write_table(out, &result.hits, result.n_hits)?;
    }
    let Some(lost) = &result.lost else {
        return Ok(());
    };
    let all = count(lost.of, "hit");
    writeln!(out, "{} lost of {all} without keyframes", lost.n_hits)?;
    match lost.n_hits {
        0 => Ok(()),
        n_lost => write_table(out, &lost.hits, n_lost),
    }
}

fn write_table(out: &mut dyn Write, hits: &[TemplateHitJson], n_hits: usize) -> io::Result<()> {
    let mut rows = table(&["rank", "cost", "clip", "frames", "seconds"]);
    for hit in hits {
        rows.add_row([
            hit.rank.to_string(),
            format!("{:.4}", hit.cost),
            hit.clip.clone(),
            format!("{}-{}", hit.start, hit.end),
            format!("{:.2}-{:.2}", hit.start_s, hit.end_s),
        ]);
    }
    writeln!(out, "{}", rows.trim_fmt())?;
    let n_more = n_hits - hits.len();
    if n_more > 0 {
        writeln!(out, "… and {n_more} more; --top 0 lists all")?;
    }
    Ok(())
}
