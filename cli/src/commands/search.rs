//! `motif search`.

mod asked;
mod auto;
mod batch;
mod example;
pub mod explain;
mod hits;
mod mismatch;
mod plan;
mod rank;
pub mod scene;
mod segments;
pub mod template;

use self::asked::Asked;
pub use self::auto::TrailStep;
use self::auto::relax;
pub use self::batch::{SearchesResult, search_all};
use self::example::{Example, unread};
use self::explain::{Explainer, word_ranges, write_picture};
pub(crate) use self::hits::write_hits;
use self::hits::{Found, Matched, Place};
pub use self::hits::{HitJson, QueryJson, SearchResult};
pub use self::mismatch::Mismatches;
use self::mismatch::from_one;
pub use self::plan::{Expected, PlanStep};
use self::rank::Comparison;
pub use self::rank::{DEFAULT_REFINED, MAX_POSE_RATE, Ranking};
use self::segments::Changes;
use crate::args::{Global, IndexArg, Mode, SearchArgs, SegmentArgs};
use crate::failure::{Exit, Failure};
use crate::library::{Clip, Library};
use crate::output::{Outcome, Voice};
use crate::recording::ReadOptions;
use crate::selection;
use crate::source::{ClipRef, Span};
use crate::take::Take;
use segidx::Engine;

/// In place of names: features are to be chosen.
const AUTO: &str = "auto";

/// Runs the command.
///
/// # Errors
/// [`Failure`].
pub fn run(args: &SearchArgs, global: &Global) -> Result<Exit, Failure> {
    let voice = global.voice();
    if let Some(text) = &args.scene.scene {
        return scene::run(&args.library, text, args.top, global);
    }
    if let Some(path) = &args.template.template {
        return template::run(path, args, global);
    }
    let matching = &args.template.matching;
    if matching.tau.is_some() || matching.delta.is_some() {
        let message = "--tau and --delta: expected --template";
        return Err(Failure::Usage(message.to_owned()));
    }
    let Some(example) = &args.example else {
        return Err(Failure::Usage(
            "expected --example, --scene or --template".to_owned(),
        ));
    };
    let library = Library::open(&args.library)?;
    let example = ClipRef::parse(example.as_os_str())?;
    let options = ReadOptions {
        rate: args.rate.rate.or(global.source_rate),
        ..global.read_options()?
    };
    let is_auto = args.features == [AUTO];
    let what = What {
        features: if is_auto { &[] } else { &args.features },
        enough: is_auto.then_some(args.enough),
        mode: args.mode,
        segments: &args.segments,
        mismatches: args.wrong.mismatches(),
        indexes: args.plan.indexes,
        engine: args.plan.engine.engine(),
        explain_plan: args.plan.explain_plan,
        sides: if args.mirror {
            Sides::Both
        } else {
            Sides::AsGiven
        },
        ranking: args.rank.ranking()?,
        explain: args.explain.is_asked(),
        top: args.top,
    };
    if example.path.is_dir() {
        if args.explain.explain_png.is_some() {
            let message = "--explain-png: expected one example, found a folder";
            return Err(Failure::Usage(message.to_owned()));
        }
        return batch::run(&library, &example, &what, &options, voice);
    }
    let mut result = search(&library, &example, &what, &options, voice)?;
    if let (Some(path), false) = (&args.explain.explain_png, result.hits.is_empty()) {
        write_picture(path, &library, &result)?;
        voice.note(&format!("wrote {}", path.display()));
    }
    let outcome = Outcome {
        found: result.n_hits > 0,
        skipped: std::mem::take(&mut result.skipped),
        result,
    };
    let result = &outcome.result;
    voice.report("search", &outcome, |out| write_hits(out, result))
}

/// What to look for and how much of it to list.
#[derive(Clone, Copy, Debug)]
pub struct What<'a> {
    /// Names, numbers or parts of features; none for all.
    pub features: &'a [String],
    /// Features are left out until there are so many hits.
    pub enough: Option<usize>,
    /// What counts as the same.
    pub mode: Mode,
    /// What is different at some segments.
    pub segments: &'a SegmentArgs,
    /// What may be wrong all the same.
    pub mismatches: Option<Mismatches<'a>>,
    /// Which indexes are searched, which changes no hit.
    pub indexes: IndexArg,
    /// By which engine, which changes no hit.
    pub engine: Engine,
    /// Whether the result says how the hits were found.
    pub explain_plan: bool,
    /// Which bodies move like the example.
    pub sides: Sides,
    /// What hits are put in order by.
    pub ranking: Ranking,
    /// Whether it is told where the listed hits agree with the example.
    pub explain: bool,
    /// Most hits to list; 0 for all.
    pub top: usize,
}

impl<'a> What<'a> {
    /// The usual search: adaptive, nothing may be wrong, all hits listed.
    #[must_use]
    pub fn new(features: &'a [String]) -> What<'a> {
        What {
            features,
            enough: None,
            mode: Mode::Adaptive,
            segments: const {
                &SegmentArgs {
                    segments: Vec::new(),
                    alternatives: Vec::new(),
                }
            },
            mismatches: None,
            indexes: IndexArg::Auto,
            engine: Engine::Auto,
            explain_plan: false,
            sides: Sides::AsGiven,
            ranking: Ranking::Frames,
            explain: false,
            top: 0,
        }
    }
}

/// Which bodies move like an example.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sides {
    /// Those that do with the same sides.
    AsGiven,
    /// Also those that do with left and right exchanged.
    Both,
}

/// Finds motions like `example`.
///
/// # Errors
/// [`Failure`]: an example that cannot be read, an unknown feature, a chosen feature that the
/// example's rig lacks, mismatches that the query cannot have.
pub fn search(
    library: &Library,
    example: &ClipRef,
    what: &What<'_>,
    options: &ReadOptions,
    voice: Voice,
) -> Result<SearchResult, Failure> {
    let example = Example::read(example, library, what.features, (options, voice))?;
    search_by(library, example, what, (options, voice))
}

/// Finds motions like some source frames of a clip of the library, by the library's own words: no file is read. The
/// hits are those of [`search`].
///
/// # Errors
/// [`Failure`]: frames that the clip does not have, an unknown feature, a chosen feature that the clip's rig lacks,
/// mismatches that the query cannot have; mirrored bodies and ranking by DTW, which the words do not tell.
pub fn search_indexed(
    library: &Library,
    clip: &Clip,
    frames: Span,
    what: &What<'_>,
) -> Result<SearchResult, Failure> {
    if what.ranking != Ranking::Frames {
        return Err(unread("--rank dtw"));
    }
    let example = Example::indexed(library, clip, frames, what.features)?;
    search_by(library, example, what, (&ReadOptions::default(), SILENT))
}

/// [`search`] for an example that has been read.
///
/// # Errors
/// As [`search`].
pub fn search_take(
    library: &Library,
    take: Take,
    what: &What<'_>,
    options: &ReadOptions,
) -> Result<SearchResult, Failure> {
    let example = Example::of_take(take, library, what.features, SILENT)?;
    search_by(library, example, what, (options, SILENT))
}

/// For answers to something else than the terminal.
const SILENT: Voice = Voice {
    json: false,
    quiet: true,
    verbose: false,
    strict: false,
};

fn search_by(
    library: &Library,
    example: Example,
    what: &What<'_>,
    (options, voice): (&ReadOptions, Voice),
) -> Result<SearchResult, Failure> {
    let mut sides = vec![(example, false)];
    if what.sides == Sides::Both {
        sides.push((sides[0].0.mirrored(library)?, true));
    }
    let mut trail = None;
    if let Some(enough) = what.enough {
        trail = Some(relax(&mut sides, library, enough, |sides| {
            Ok(find(library, sides, what)?.found.hits.len())
        })?);
    }
    let Answer {
        mut found,
        asked,
        plan,
    } = find(library, &sides, what)?;
    let skipped = match what.ranking {
        Ranking::Frames => Vec::new(),
        Ranking::Dtw { refine } => {
            let comparison = Comparison {
                sides: &sides,
                word_rate: library.rate,
                options,
                voice,
            };
            comparison.refine(&mut found.hits, refine)
        }
    };
    let is_tolerant = what.mismatches.is_some();
    let hits = found.listed(what.top);
    let hits = hits.map(|(rank, clip, Matched { hit, mirrored, dtw })| {
        let place = Place {
            span: hit.span(),
            segments: &hit.segments,
            cost: hit.cost,
        };
        HitJson {
            mirrored: *mirrored,
            dtw: *dtw,
            mismatches: is_tolerant.then(|| from_one(&hit.mismatches)),
            ..HitJson::new(library, clip, place, rank)
        }
    });
    let mut hits: Vec<HitJson> = hits.collect();
    if what.explain {
        let explainer = Explainer {
            library,
            sides: &sides,
            asked: &asked,
        };
        explainer.explain(found.listed(what.top), &mut hits)?;
    }
    Ok(SearchResult {
        n_hits: found.hits.len(),
        n_clips: found.n_clips(),
        n_unsearched: found.n_unsearched(),
        hits,
        query: query_json(library, &sides[0].0, &asked[0], what),
        trail,
        plan: what.explain_plan.then_some(plan),
        skipped,
    })
}

/// The hits of the example, or of both sides of it, in order.
struct Answer<'a> {
    found: Found<'a, Matched>,
    /// What each side asked.
    asked: Vec<Asked>,
    plan: Vec<PlanStep>,
}

fn find<'a>(
    library: &'a Library,
    sides: &[(Example, bool)],
    what: &What<'_>,
) -> Result<Answer<'a>, Failure> {
    let set = &library.features.set;
    let changes = Changes::read(what.segments, set, sides[0].0.care)?;
    let mut answer = Answer {
        found: Found::new(library),
        asked: Vec::new(),
        plan: Vec::new(),
    };
    for &(ref example, mirrored) in sides {
        let changes = if mirrored {
            changes.mirrored(set)
        } else {
            changes.clone()
        };
        let asked = Asked::new(example, what, &changes, library)?;
        let (hits, steps) = asked.find(library)?;
        let dtw = None;
        let matched = hits.into_iter().map(|(clip, hit)| {
            let matched = Matched { hit, mirrored, dtw };
            (clip, matched)
        });
        answer.found.add(asked.care, matched)?;
        answer.asked.push(asked);
        answer.plan.extend(steps);
    }
    answer.found.settle();
    Ok(answer)
}

fn query_json(library: &Library, example: &Example, asked: &Asked, what: &What<'_>) -> QueryJson {
    let segments = word_ranges(asked.query()).into_iter();
    let segments = segments.map(|words| example.source_span(words, library.rate));
    let [start, end] = example.source_span(0..example.clip.words.len(), library.rate);
    QueryJson {
        clip: example.source.path.display().to_string(),
        start,
        end,
        mode: what.mode.name(),
        features: selection::names(&library.features.set, example.care),
        segments: segments.collect(),
        mirror: what.sides == Sides::Both,
        segment: what.segments.segments.clone(),
        or: what.segments.alternatives.clone(),
        max_mismatches: what.mismatches.map(|m| m.max),
        at: what.mismatches.map_or(Vec::new(), |m| m.at.to_vec()),
    }
}
