//! `motif search`.

mod asked;
mod example;
pub mod explain;
mod hits;
mod mismatch;
mod rank;
pub mod scene;

use self::asked::Asked;
use self::example::Example;
use self::explain::{Explainer, word_ranges, write_picture};
pub(crate) use self::hits::write_hits;
use self::hits::{Found, Matched, Place};
pub use self::hits::{HitJson, QueryJson, SearchResult};
pub use self::mismatch::Mismatches;
use self::mismatch::from_one;
use self::rank::Comparison;
pub use self::rank::{DEFAULT_REFINED, MAX_POSE_RATE, Ranking};
use crate::args::{Global, Mode, SearchArgs};
use crate::failure::{Exit, Failure};
use crate::library::Library;
use crate::output::{Outcome, Voice};
use crate::recording::ReadOptions;
use crate::selection;
use crate::source::ClipRef;

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
        sides: if args.mirror {
            Sides::Both
        } else {
            Sides::AsGiven
        },
        ranking: args.rank.ranking()?,
        explain: args.explain.is_asked(),
        top: args.top,
    };
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
    /// What counts as the same.
    pub mode: Mode,
    /// What may be wrong all the same.
    pub mismatches: Option<Mismatches<'a>>,
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
            mode: Mode::Adaptive,
            mismatches: None,
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
    let clip = Example::read(example, library, what.features, (options, voice))?;
    let mut sides = vec![(clip, false)];
    if what.sides == Sides::Both {
        sides.push((sides[0].0.mirrored(library)?, true));
    }
    let clips = library.clips()?;
    let mut found = Found::new(&clips);
    let mut queries = Vec::new();
    for (example, mirrored) in &sides {
        let asked = Asked::new(example, what)?;
        let matched = asked.find(library)?.into_iter().map(|(clip, hit)| {
            let mirrored = *mirrored;
            let dtw = None;
            (clip, Matched { hit, mirrored, dtw })
        });
        found.add(example.care, matched);
        queries.push(asked);
    }
    found.settle();
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
    let (example, asked) = (&sides[0].0, &queries[0]);
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
            asked: &queries,
        };
        explainer.explain(found.listed(what.top), &mut hits)?;
    }
    Ok(SearchResult {
        n_hits: found.hits.len(),
        n_clips: found.n_clips(),
        n_unsearched: found.n_unsearched(),
        hits,
        query: query_json(library, example, asked, what),
        skipped,
    })
}

fn query_json(library: &Library, example: &Example, asked: &Asked, what: &What<'_>) -> QueryJson {
    let segments = word_ranges(asked.query()).into_iter();
    let segments = segments.map(|words| example.source_span(words, library.rate));
    let [start, end] = example.source_span(0..example.clip.words.len(), library.rate);
    QueryJson {
        clip: example.take.clip.path.display().to_string(),
        start,
        end,
        mode: what.mode.name(),
        features: selection::names(&library.features.set, example.care),
        segments: segments.collect(),
        mirror: what.sides == Sides::Both,
        max_mismatches: what.mismatches.map(|m| m.max),
        at: what.mismatches.map_or(Vec::new(), |m| m.at.to_vec()),
    }
}
