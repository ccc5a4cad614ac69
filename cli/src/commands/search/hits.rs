//! Hits, as JSON and as a table.

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::sync::Arc;

use segidx::Hit;
use serde::Serialize;

use super::auto::TrailStep;
use super::explain::Explained;
use super::mismatch::list;
use super::plan::{PlanStep, write_plan};
use crate::failure::{Failure, Skipped};
use crate::library::{Clip, ClipId, Library};
use crate::output::{count, table};
use crate::source::Span;

/// What was looked for and where it was found.
#[derive(Clone, Debug, Serialize)]
pub struct SearchResult {
    /// What was looked for.
    pub query: QueryJson,
    /// Number of hits, listed or not.
    pub n_hits: usize,
    /// Number of clips with a hit.
    pub n_clips: usize,
    /// Clips that could not be searched, because their rigs lack a chosen feature.
    pub n_unsearched: usize,
    /// How features were left out, if they were to be chosen.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub trail: Option<Vec<TrailStep>>,
    /// How the hits were found, if that was asked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plan: Option<Vec<PlanStep>>,
    /// The best hits.
    pub hits: Vec<HitJson>,
    /// Files that hits could not be compared in, for the list that every command has.
    #[serde(skip)]
    pub skipped: Vec<Skipped>,
}

/// What was looked for.
#[derive(Clone, Debug, Serialize)]
pub struct QueryJson {
    /// The example.
    pub clip: String,
    /// Its first source frame.
    pub start: usize,
    /// One past its last source frame.
    pub end: usize,
    /// `exact`, `fuzzy` or `adaptive`.
    pub mode: &'static str,
    /// The features compared.
    pub features: Vec<String>,
    /// Whether the left/right mirrored example was looked for as well.
    #[serde(skip_serializing_if = "is_false")]
    pub mirror: bool,
    /// The example's segments under these features, in source frames.
    pub segments: Vec<[usize; 2]>,
    /// Segments compared on features of their own, as they were given.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub segment: Vec<String>,
    /// What else is accepted at some segments, as it was given.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub or: Vec<String>,
    /// Most segments that differ in a hit, if any may.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_mismatches: Option<usize>,
    /// The segments that may differ, counted from 1; all of them if it is missing.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub at: Vec<usize>,
}

/// A hit, as design.md §4 lays it down. Frames are those of the source file.
#[derive(Clone, Debug, Serialize)]
pub struct HitJson {
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
    /// Sum of the differences of segment lengths, in words.
    pub cost: u64,
    /// 1 is best.
    pub rank: usize,
    /// Frames that match each segment of the query.
    pub segments: Vec<[usize; 2]>,
    /// Whether it is a hit of the left/right mirrored example.
    #[serde(skip_serializing_if = "is_false")]
    pub mirrored: bool,
    /// Mean distance from the example along the best path, in metres, where it was computed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dtw: Option<f64>,
    /// The segments of the query that differ here, counted from 1, if any may.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mismatches: Option<Vec<usize>>,
    /// Where it agrees with the example, if that was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub explained: Option<Explained>,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks for it")]
fn is_false(flag: &bool) -> bool {
    !flag
}

/// A hit of the example, or of the mirrored one.
#[derive(Clone, Debug)]
pub(super) struct Matched {
    pub(super) hit: Hit,
    pub(super) mirrored: bool,
    /// Mean distance from the example along the best path, in metres, where it was computed.
    pub(super) dtw: Option<f64>,
}

/// Hits with their clips.
pub(super) struct Found<'a, H> {
    library: &'a Library,
    /// The clips that have hits.
    clips: BTreeMap<ClipId, Arc<Clip>>,
    pub(super) hits: Vec<(Arc<Clip>, H)>,
    /// Clips whose rigs lack a feature. Their bits mean nothing, so their hits are left out.
    unsearched: BTreeSet<ClipId>,
}

impl<'a, H> Found<'a, H> {
    pub(super) fn new(library: &'a Library) -> Found<'a, H> {
        Found {
            library,
            clips: BTreeMap::new(),
            hits: Vec::new(),
            unsearched: BTreeSet::new(),
        }
    }

    /// Adds the hits in clips whose rigs have all features of `care`.
    pub(super) fn add(
        &mut self,
        care: u64,
        found: impl IntoIterator<Item = (ClipId, H)>,
    ) -> Result<(), Failure> {
        let lacking = self.library.lacking(care)?;
        for (id, hit) in found {
            if lacking.contains(&id) {
                continue;
            }
            let clip = match self.clips.entry(id) {
                Entry::Occupied(known) => Arc::clone(known.get()),
                Entry::Vacant(new) => Arc::clone(new.insert(Arc::new(self.library.clip(id)?))),
            };
            self.hits.push((clip, hit));
        }
        self.unsearched.extend(lacking);
        Ok(())
    }

    pub(super) fn n_unsearched(&self) -> usize {
        self.unsearched.len()
    }

    pub(super) fn n_clips(&self) -> usize {
        self.clips.len()
    }

    /// The first `top` hits with their ranks, all if it is 0.
    pub(super) fn listed(&self, top: usize) -> impl Iterator<Item = (usize, &Clip, &H)> {
        let n = if top == 0 { self.hits.len() } else { top };
        let hits = self.hits.iter().take(n);
        (1..)
            .zip(hits)
            .map(|(rank, (clip, hit))| (rank, &**clip, hit))
    }
}

impl Found<'_, Matched> {
    /// Puts hits in order: by cost, clip, start; of equals the example's before those of the mirrored one. Where both
    /// match the same frames, the first of them stays.
    pub(super) fn settle(&mut self) {
        self.hits
            .sort_by_key(|(clip, Matched { hit, mirrored, .. })| {
                (hit.cost, clip.id, hit.span().start, *mirrored)
            });
        let mut known = BTreeSet::new();
        self.hits.retain(|(clip, Matched { hit, .. })| {
            let span = hit.span();
            known.insert((clip.id, span.start, span.end))
        });
    }
}

/// Where a hit is, in words of its clip.
pub(super) struct Place<'a> {
    pub(super) span: Range<usize>,
    pub(super) segments: &'a [Range<usize>],
    pub(super) cost: u64,
}

impl HitJson {
    pub(super) fn new(library: &Library, clip: &Clip, place: Place<'_>, rank: usize) -> HitJson {
        let meta = &clip.meta;
        let source = |words: Range<usize>| meta.source_span(words, clip.n_words, library.rate);
        let Span { start, end } = source(place.span);
        let segments = place.segments.iter().map(|words| source(words.clone()));
        HitJson {
            clip: clip.name.clone(),
            start,
            end,
            start_s: start as f64 / meta.source_rate,
            end_s: end as f64 / meta.source_rate,
            cost: place.cost,
            rank,
            segments: segments.map(|span| [span.start, span.end]).collect(),
            mirrored: false,
            dtw: None,
            mismatches: None,
            explained: None,
        }
    }
}

/// Boundaries of the segments, as `40-92-131`.
pub(super) fn boundaries(segments: &[[usize; 2]]) -> String {
    let starts = segments.iter().map(|s| s[0]);
    let end = segments.last().map(|s| s[1]);
    let all: Vec<String> = starts.chain(end).map(|f| f.to_string()).collect();
    all.join("-")
}

/// Features that are named in full before the rest is only counted.
const FEATURES_NAMED: usize = 6;

fn write_trail(out: &mut dyn std::io::Write, trail: &[TrailStep]) -> std::io::Result<()> {
    writeln!(out, "features left out until there were enough hits:")?;
    let mut rows = table(&["features", "segments", "hits", "left out"]);
    for step in trail {
        rows.add_row([
            step.n_features.to_string(),
            step.n_segments.to_string(),
            step.n_hits.to_string(),
            step.dropped.clone().unwrap_or_default(),
        ]);
    }
    writeln!(out, "{}", rows.trim_fmt())
}

/// Says how many clips could not be searched, if there are any.
pub(super) fn write_unsearched(out: &mut dyn std::io::Write, n: usize) -> std::io::Result<()> {
    if n == 0 {
        return Ok(());
    }
    let clips = count(n, "clip");
    writeln!(
        out,
        "{clips} could not be searched: their rigs lack some of these features"
    )
}

pub(crate) fn write_hits(
    out: &mut dyn std::io::Write,
    result: &SearchResult,
) -> std::io::Result<()> {
    let query = &result.query;
    let mut features = query
        .features
        .iter()
        .take(FEATURES_NAMED)
        .cloned()
        .collect::<Vec<_>>();
    if query.features.len() > FEATURES_NAMED {
        features.push(format!("{} more", query.features.len() - FEATURES_NAMED));
    }
    writeln!(
        out,
        "looked for {} frames {}-{} by {}: {} ({})",
        query.clip,
        query.start,
        query.end,
        features.join(", "),
        count(query.segments.len(), "segment"),
        boundaries(&query.segments)
    )?;
    for (what, changes) in [
        ("compared otherwise", &query.segment),
        ("or else", &query.or),
    ] {
        if !changes.is_empty() {
            writeln!(out, "{what}: segment {}", changes.join("; segment "))?;
        }
    }
    if let Some(max) = query.max_mismatches {
        let which = match &query.at[..] {
            [] => format!("the {}", count(query.segments.len(), "segment")),
            [at] => format!("segment {at}"),
            at => format!("segments {}", list(at)),
        };
        writeln!(out, "up to {max} of {which} may differ")?;
    }
    if let Some(trail) = &result.trail {
        write_trail(out, trail)?;
    }
    if let Some(plan) = &result.plan {
        write_plan(out, plan)?;
    }
    write_unsearched(out, result.n_unsearched)?;
    if result.n_hits == 0 {
        return writeln!(out, "nothing found");
    }
    writeln!(
        out,
        "{} in {}",
        count(result.n_hits, "hit"),
        count(result.n_clips, "clip")
    )?;
    let mut heads = vec!["rank", "cost", "clip", "frames", "seconds", "segments"];
    heads.extend(query.max_mismatches.map(|_| "differing"));
    heads.extend(query.mirror.then_some("sides"));
    let is_refined = result.hits.iter().any(|hit| hit.dtw.is_some());
    if is_refined {
        heads.insert(1, "dtw");
    }
    let mut rows = table(&heads);
    for hit in &result.hits {
        let mut row = vec![
            hit.rank.to_string(),
            hit.cost.to_string(),
            hit.clip.clone(),
            format!("{}-{}", hit.start, hit.end),
            format!("{:.2}-{:.2}", hit.start_s, hit.end_s),
            boundaries(&hit.segments),
        ];
        row.extend(hit.mismatches.as_deref().map(list));
        let sides = if hit.mirrored {
            "exchanged"
        } else {
            "as given"
        };
        row.extend(query.mirror.then(|| sides.to_owned()));
        if is_refined {
            let distance = hit.dtw.map(|metres| format!("{metres:.3}"));
            row.insert(1, distance.unwrap_or_else(|| "-".to_owned()));
        }
        rows.add_row(row);
    }
    let rows = rows.trim_fmt();
    let mut lines = rows.lines();
    writeln!(out, "{}", lines.next().unwrap_or_default())?;
    let hits = result.hits.iter().map(Some).chain(std::iter::repeat(None));
    for (line, hit) in lines.zip(hits) {
        writeln!(out, "{line}")?;
        if let Some(explained) = hit.and_then(|hit| hit.explained.as_ref()) {
            writeln!(out, "      {}", explained.summary)?;
        }
    }
    if result.hits.len() < result.n_hits {
        writeln!(
            out,
            "… and {} more; --top 0 lists all",
            result.n_hits - result.hits.len()
        )?;
    }
    Ok(())
}
