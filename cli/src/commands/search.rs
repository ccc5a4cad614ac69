//! `motif search`.

mod asked;
mod auto;
mod batch;
mod example;
mod hits;
mod mismatch;
pub mod scene;

use self::asked::Asked;
pub use self::auto::TrailStep;
use self::auto::relax;
pub use self::batch::{SearchesResult, search_all};
use self::example::Example;
pub(crate) use self::hits::write_hits;
use self::hits::{Found, Matched, Place};
pub use self::hits::{HitJson, QueryJson, SearchResult};
pub use self::mismatch::Mismatches;
use self::mismatch::from_one;
use crate::args::{Global, Mode, SearchArgs};
use crate::failure::{Exit, Failure};
use crate::library::{Clip, Library};
use crate::output::{Outcome, Voice};
use crate::recording::ReadOptions;
use crate::selection;
use crate::source::ClipRef;

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
    let Some(example) = &args.example else {
        return Err(Failure::Usage("expected --example or --scene".to_owned()));
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
        mismatches: args.wrong.mismatches(),
        sides: if args.mirror {
            Sides::Both
        } else {
            Sides::AsGiven
        },
        top: args.top,
    };
    if example.path.is_dir() {
        return batch::run(&library, &example, &what, &options, voice);
    }
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
    /// Features are left out until there are so many hits.
    pub enough: Option<usize>,
    /// What counts as the same.
    pub mode: Mode,
    /// What may be wrong all the same.
    pub mismatches: Option<Mismatches<'a>>,
    /// Which bodies move like the example.
    pub sides: Sides,
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
            mismatches: None,
            sides: Sides::AsGiven,
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
    let clips = library.clips()?;
    let mut example = Example::read(example, library, what.features, (options, voice))?;
    let mut trail = None;
    if let Some(enough) = what.enough {
        let n_hits = |example: &Example| Ok(find(library, &clips, example, what)?.found.hits.len());
        let (relaxed, steps) = relax(example, library, enough, n_hits)?;
        (example, trail) = (relaxed, Some(steps));
    }
    let Answer { found, asked } = find(library, &clips, &example, what)?;
    let is_tolerant = what.mismatches.is_some();
    let hits = found.listed(what.top);
    let hits = hits.map(|(rank, clip, Matched { hit, mirrored })| {
        let place = Place {
            span: hit.span(),
            segments: &hit.segments,
            cost: hit.cost,
        };
        HitJson {
            mirrored: *mirrored,
            mismatches: is_tolerant.then(|| from_one(&hit.mismatches)),
            ..HitJson::new(library, clip, place, rank)
        }
    });
    Ok(SearchResult {
        n_hits: found.hits.len(),
        n_clips: found.n_clips(),
        n_unsearched: found.n_unsearched(),
        hits: hits.collect(),
        query: query_json(library, &example, &asked, what),
        trail,
    })
}

/// The hits of an example, in order, and what was asked for them.
struct Answer<'a> {
    found: Found<'a, Matched>,
    asked: Asked,
}

fn find<'a>(
    library: &Library,
    clips: &'a [Clip],
    example: &Example,
    what: &What<'_>,
) -> Result<Answer<'a>, Failure> {
    let mut found = Found::new(clips);
    let mut ask = |example: &Example, mirrored| {
        let asked = Asked::new(example, what)?;
        let hits = asked.find(library)?.into_iter();
        let matched = hits.map(|(clip, hit)| (clip, Matched { hit, mirrored }));
        found.add(example.care, matched);
        Ok(asked)
    };
    let asked = ask(example, false)?;
    if what.sides == Sides::Both {
        ask(&example.mirrored(library)?, true)?;
    }
    found.settle();
    Ok(Answer { found, asked })
}

fn query_json(library: &Library, example: &Example, asked: &Asked, what: &What<'_>) -> QueryJson {
    let mut segments = Vec::new();
    let mut word = 0;
    for position in asked.query().positions() {
        let next = word + position.n_frames.unwrap_or(0);
        segments.push(example.source_span(word..next, library.rate));
        word = next;
    }
    let [start, end] = example.source_span(0..example.clip.words.len(), library.rate);
    QueryJson {
        clip: example.take.clip.path.display().to_string(),
        start,
        end,
        mode: what.mode.name(),
        features: selection::names(&library.features.set, example.care),
        segments,
        mirror: what.sides == Sides::Both,
        max_mismatches: what.mismatches.map(|m| m.max),
        at: what.mismatches.map_or(Vec::new(), |m| m.at.to_vec()),
    }
}
