//! `motif search`.

mod mismatch;
pub mod scene;

use std::collections::{BTreeMap, BTreeSet};

use segidx::{Hit, Query, search_adaptive, search_exact, search_mismatch};
use serde::Serialize;

pub use self::mismatch::Mismatches;
use self::mismatch::{from_one, list};
use super::{tell_filled, tell_warnings};
use crate::args::{Global, Mode, SearchArgs};
use crate::failure::{Exit, Failure};
use crate::library::{Clip, ClipId, Library};
use crate::output::{Outcome, Voice, count, table};
use crate::recording::ReadOptions;
use crate::selection;
use crate::source::{ClipRef, Span};
use crate::wire::clip_words;

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
    /// The best hits.
    pub hits: Vec<HitJson>,
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
    /// The example's segments under these features, in source frames.
    pub segments: Vec<[usize; 2]>,
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
    /// The segments of the query that differ here, counted from 1, if any may.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mismatches: Option<Vec<usize>>,
}

/// Runs the command.
///
/// # Errors
/// [`Failure`].
pub fn run(args: &SearchArgs, global: &Global) -> Result<Exit, Failure> {
    let voice = global.voice();
    if let Some(text) = &args.scene.scene {
        return scene::run(&args.library, text, args.top, global);
    }
    let Some(example) = &args.example else {
        return Err(Failure::Usage("expected --example or --scene".to_owned()));
    };
    let library = Library::open(&args.library)?;
    let example = ClipRef::parse(example.as_os_str())?;
    let options = ReadOptions {
        rate: args.rate.rate.or(global.source_rate),
        ..global.read_options()?
    };
    let what = What {
        features: &args.features,
        mode: args.mode,
        mismatches: args.wrong.mismatches(),
        top: args.top,
    };
    let result = search(&library, &example, &what, &options, voice)?;
    let outcome = Outcome {
        found: result.n_hits > 0,
        result,
        skipped: Vec::new(),
    };
    let result = &outcome.result;
    voice.report("search", &outcome, |out| write_hits(out, result))
}

/// What to look for and how much of it to list.
#[derive(Clone, Copy, Debug)]
pub struct What<'a> {
    /// Names, numbers or parts of features; none for all.
    pub features: &'a [String],
    /// What counts as the same.
    pub mode: Mode,
    /// What may be wrong all the same.
    pub mismatches: Option<Mismatches<'a>>,
    /// Most hits to list; 0 for all.
    pub top: usize,
}

/// Finds motions like `example`.
///
/// # Errors
/// [`Failure`]: an example that cannot be read, an unknown feature, a chosen feature that the
/// example's rig lacks, mismatches that the mode or the query cannot have.
pub fn search(
    library: &Library,
    example: &ClipRef,
    what: &What<'_>,
    options: &ReadOptions,
    voice: Voice,
) -> Result<SearchResult, Failure> {
    if let Some(mismatches) = what.mismatches {
        mismatches.check(what.mode)?;
    }
    let set = &library.features.set;
    let mut care = selection::select(set, what.features)?;
    let clip = clip_words(example, options, set, library.rate)?;
    tell_warnings(voice, clip.warnings.iter());
    tell_filled(voice, clip.filled);
    let lacking = care & !clip.meta.available;
    if lacking != 0 {
        let gone = selection::names(set, lacking).join(", ");
        let missing: Vec<&str> = clip.missing.iter().map(|p| p.name()).collect();
        let message = format!("its rig has no {}, so it lacks {gone}", missing.join(", "));
        if !what.features.is_empty() {
            return Err(Failure::input(&example.path, message));
        }
        voice.note(&format!(
            "{}: {message}; searching without",
            example.path.display()
        ));
        care &= !lacking;
    }
    let query = match what.mode {
        Mode::Exact => Query::exact(&clip.words, care),
        Mode::Fuzzy | Mode::Adaptive => Query::fuzzy(&clip.words, care),
    };
    let tolerant = what.mismatches.map(|m| m.of(&query)).transpose()?;
    let clips = library.clips()?;
    let found = library.search(|shard| match (&tolerant, what.mode) {
        (Some(tolerant), _) => search_mismatch(shard, tolerant),
        (None, Mode::Exact | Mode::Fuzzy) => search_exact(shard, &query),
        (None, Mode::Adaptive) => search_adaptive(shard, &query),
    })?;
    let found = Found::new(&clips, care, found);
    let listed = found.listed(what.top);
    let listed = listed.map(|(rank, clip, hit)| HitJson {
        mismatches: tolerant.as_ref().map(|_| from_one(&hit.mismatches)),
        ..hit_json(library, clip, hit, rank)
    });
    let n_words = clip.words.len();
    let whole = clip.meta.source_span(0..n_words, n_words, library.rate);
    let mut segments = Vec::new();
    let mut word = 0;
    for position in query.positions() {
        let next = word + position.n_frames.unwrap_or(0);
        let span = clip.meta.source_span(word..next, n_words, library.rate);
        segments.push([span.start, span.end]);
        word = next;
    }
    Ok(SearchResult {
        query: QueryJson {
            clip: example.path.display().to_string(),
            start: whole.start,
            end: whole.end,
            mode: what.mode.name(),
            features: selection::names(set, care),
            segments,
            max_mismatches: what.mismatches.map(|m| m.max),
            at: what.mismatches.map_or(Vec::new(), |m| m.at.to_vec()),
        },
        n_hits: found.hits.len(),
        n_clips: found.n_clips(),
        n_unsearched: found.n_unsearched,
        hits: listed.collect(),
    })
}

/// Hits with their clips.
struct Found<'a, H> {
    hits: Vec<(&'a Clip, H)>,
    /// Clips whose rigs lack a feature. Their bits mean nothing, so their hits are left out.
    n_unsearched: usize,
}

impl<'a, H> Found<'a, H> {
    /// The hits in those of `clips` whose rigs have all features of `care`.
    fn new(clips: &'a [Clip], care: u64, found: Vec<(ClipId, H)>) -> Found<'a, H> {
        let searched = clips.iter().filter(|c| care & !c.meta.available == 0);
        let searched: BTreeMap<ClipId, &Clip> = searched.map(|clip| (clip.id, clip)).collect();
        let hits = found.into_iter();
        Found {
            hits: hits
                .filter_map(|(id, hit)| Some((*searched.get(&id)?, hit)))
                .collect(),
            n_unsearched: clips.len() - searched.len(),
        }
    }

    fn n_clips(&self) -> usize {
        let clips = self.hits.iter().map(|(clip, _)| clip.id);
        clips.collect::<BTreeSet<_>>().len()
    }

    /// The first `top` hits with their ranks, all if it is 0.
    fn listed(&self, top: usize) -> impl Iterator<Item = (usize, &'a Clip, &H)> {
        let n = if top == 0 { self.hits.len() } else { top };
        let hits = self.hits.iter().take(n);
        (1..)
            .zip(hits)
            .map(|(rank, (clip, hit))| (rank, *clip, hit))
    }
}

fn hit_json(library: &Library, clip: &Clip, hit: &Hit, rank: usize) -> HitJson {
    let meta = &clip.meta;
    let source = |words| meta.source_span(words, clip.n_words, library.rate);
    let Span { start, end } = source(hit.span());
    HitJson {
        clip: clip.name.clone(),
        start,
        end,
        start_s: start as f64 / meta.source_rate,
        end_s: end as f64 / meta.source_rate,
        cost: hit.cost,
        rank,
        segments: hit
            .segments
            .iter()
            .map(|words| source(words.clone()))
            .map(|span| [span.start, span.end])
            .collect(),
        mismatches: None,
    }
}

/// Boundaries of the segments, as `40-92-131`.
fn boundaries(segments: &[[usize; 2]]) -> String {
    let starts = segments.iter().map(|s| s[0]);
    let end = segments.last().map(|s| s[1]);
    let all: Vec<String> = starts.chain(end).map(|f| f.to_string()).collect();
    all.join("-")
}

/// Features that are named in full before the rest is only counted.
const FEATURES_NAMED: usize = 6;

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
    if let Some(max) = query.max_mismatches {
        let which = match &query.at[..] {
            [] => format!("the {}", count(query.segments.len(), "segment")),
            at => format!("segments {}", list(at)),
        };
        writeln!(out, "up to {max} of {which} may differ")?;
    }
    if result.n_unsearched > 0 {
        let clips = count(result.n_unsearched, "clip");
        writeln!(
            out,
            "{clips} could not be searched: their rigs lack some of these features"
        )?;
    }
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
        rows.add_row(row);
    }
    writeln!(out, "{}", rows.trim_fmt())?;
    if result.hits.len() < result.n_hits {
        writeln!(
            out,
            "… and {} more; --top 0 lists all",
            result.n_hits - result.hits.len()
        )?;
    }
    Ok(())
}
