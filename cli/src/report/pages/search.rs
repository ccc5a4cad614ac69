//! Results of searches.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::PathBuf;

use relfeat::FeatureSet;
use serde_json::Value;

use crate::commands::search::explain::{Agreement, Stretch};
use crate::commands::search::scene::SceneAgreement;
use crate::report::document::{Fact, PageHit, Picture, Place, SearchPage};
use crate::report::make::Maker;
use crate::report::pictures;
use crate::report::results::{HitRead, SearchRead};
use crate::scene::{SceneText, parse};
use crate::source::ClipRef;
use crate::take::{Take, TakeWords};
use crate::wire::available;

/// Hits that are shown feature by feature at most.
const MOST_AGREEMENTS: usize = 24;

/// A search; hits in clips that cannot be read are left out.
pub fn page(maker: &mut Maker<'_>, read: &SearchRead) -> SearchPage {
    let example = example(read);
    let names = read.hits.iter().map(|hit| hit.clip.as_str());
    let ids = maker.clips_of(names.chain(example.iter().map(|(name, _)| *name)));
    let example = example.and_then(|(name, frames)| {
        let clip = maker.builder.id(name)?;
        Some(Place::new(clip, frames, maker.rate(clip)))
    });
    let segments = read.segments();
    let mut compared = Compared::new(maker, read);
    let hits = read.hits.iter().zip(&ids).filter_map(|(hit, id)| {
        let clip = (*id)?;
        let is_shown = hit.rank <= MOST_AGREEMENTS;
        let shown = PageHit {
            place: Place::new(clip, hit.start..hit.end, maker.rate(clip)),
            rank: hit.rank,
            cost: hit.cost,
            mirrored: hit.mirrored,
            segments: hit.segments.clone(),
            path: Vec::new(),
            agreement: compared
                .as_mut()
                .filter(|_| is_shown)
                .and_then(|compared| compared.picture(hit)),
            ask: None,
        };
        let path = example
            .as_ref()
            .map(|example| shown.path_to(example, &segments));
        Some(PageHit {
            path: path.unwrap_or_default(),
            ..shown
        })
    });
    let hits = hits.collect();
    SearchPage {
        title: title(read),
        query: facts(read),
        example,
        n_hits: read.n_hits,
        hits,
    }
}

fn text<'a>(read: &'a SearchRead, name: &str) -> Option<&'a str> {
    read.query.get(name)?.as_str()
}

fn title(read: &SearchRead) -> String {
    match (text(read, "clip"), text(read, "template")) {
        (Some(clip), _) => {
            let path = PathBuf::from(clip);
            let stem = path.file_stem().unwrap_or_default().to_string_lossy();
            format!("like {stem}")
        }
        (None, Some(template)) => format!("template {template}"),
        (None, None) => "scene".to_owned(),
    }
}

/// The example's clip and frames.
fn example(read: &SearchRead) -> Option<(&str, Range<usize>)> {
    let frame = |name: &str| {
        let frame = read.query.get(name)?.as_u64()?;
        usize::try_from(frame).ok()
    };
    Some((text(read, "clip")?, frame("start")?..frame("end")?))
}

/// What was asked, whatever it was: lists of objects are told by how many there are.
fn facts(read: &SearchRead) -> Vec<Fact> {
    let plain = |value: &Value| match value {
        Value::String(text) => Some(text.clone()),
        Value::Number(number) => Some(number.to_string()),
        Value::Bool(flag) => Some(if *flag { "yes" } else { "no" }.to_owned()),
        _ => None,
    };
    let value = |value: &Value| match value {
        Value::Array(many) => {
            let texts: Option<Vec<String>> = many.iter().map(plain).collect();
            Some(texts.map_or_else(|| many.len().to_string(), |texts| texts.join(", ")))
        }
        one => plain(one),
    };
    // Where the example is, is said once.
    let is_told = |name: &str| example(read).is_some() && ["clip", "start", "end"].contains(&name);
    let clip = example(read).map(|(clip, frames)| Fact {
        name: "example".to_owned(),
        value: format!("{clip}@{}-{}", frames.start, frames.end),
    });
    let others = read.query.iter().filter(|(name, _)| !is_told(name));
    let facts = others.filter_map(|(name, said)| {
        Some(Fact {
            name: name.replace('_', " "),
            value: value(said)?,
        })
    });
    clip.into_iter().chain(facts).collect()
}

/// What it takes to hold hits against what was asked, word by word.
struct Compared<'a> {
    maker: HowRead<'a>,
    asked: Asked,
    known: BTreeMap<String, Option<Words>>,
}

enum Asked {
    Example(Example),
    Scene(SceneText),
}

/// The example's words and the features compared.
struct Example {
    care: u64,
    words: Words,
    span: Range<usize>,
    segments: Vec<[usize; 2]>,
}

/// The features and how clips are read.
struct HowRead<'a> {
    set: &'a FeatureSet,
    rate: f64,
    options: &'a crate::recording::ReadOptions,
}

/// The words of a clip.
struct Words {
    words: TakeWords,
    source_rate: f64,
    available: u64,
}

impl HowRead<'_> {
    fn words(&self, name: &str) -> Option<Words> {
        let clip = ClipRef::parse(name.as_ref()).ok()?;
        let take = Take::load(&clip, self.options).ok()?;
        Some(Words {
            words: take.words(self.set, self.rate).ok()?,
            source_rate: take.rate(),
            available: available(self.set, &take.map),
        })
    }
}

impl Words {
    /// The words that some source frames hold.
    fn range(&self, [start, end]: [usize; 2]) -> Range<usize> {
        let first = self.words.frames.partition_point(|&frame| frame < start);
        let end = self.words.frames.partition_point(|&frame| frame < end);
        first..end.max(first)
    }
}

impl<'a> Compared<'a> {
    /// `None` if neither an example nor a scene was asked, or their features are not those of the report.
    fn new(maker: &Maker<'a>, read: &SearchRead) -> Option<Compared<'a>> {
        let how = HowRead {
            set: &maker.how.features.set,
            rate: maker.how.rate,
            options: maker.how.options,
        };
        let asked = match text(read, "scene") {
            Some(scene) => Asked::Scene(parse(scene, how.set).ok()?),
            None => Asked::Example(Example::new(&how, read)?),
        };
        Some(Compared {
            asked,
            maker: how,
            known: BTreeMap::new(),
        })
    }

    fn picture(&mut self, hit: &HitRead) -> Option<Picture> {
        let (set, rate) = (self.maker.set, self.maker.rate);
        if !self.known.contains_key(&hit.clip) {
            let words = self.maker.words(&hit.clip);
            self.known.insert(hit.clip.clone(), words);
        }
        let found = self.known.get(&hit.clip)?.as_ref()?;
        let span = found.range([hit.start, hit.end]);
        let from = *found.words.frames.get(span.start)? as f64 / found.source_rate;
        match &self.asked {
            Asked::Example(example) => {
                let agreement = example.agreement(set, hit, (found, span))?;
                pictures::agreement(set, &agreement, rate, from)
            }
            Asked::Scene(scene) if hit.lines.len() == scene.lines.len() => {
                let runs = hit.lines.iter().map(|line| {
                    let runs = line.segments.iter().map(|&frames| found.range(frames));
                    runs.collect()
                });
                let runs: Vec<Vec<Range<usize>>> = runs.collect();
                let agreement = SceneAgreement::new(set, scene, &runs, (&found.words.words, span));
                pictures::scene(&agreement, rate, from)
            }
            Asked::Scene(_) => None,
        }
    }
}

impl Example {
    fn new(how: &HowRead<'_>, read: &SearchRead) -> Option<Example> {
        let (name, frames) = example(read)?;
        let features = read.query.get("features")?.as_array()?;
        let mut bits = features.iter().map(|name| how.set.select(name.as_str()?));
        let care = bits.try_fold(0, |all, bit| Some(all | bit?))?;
        let segments = read.query.get("segments")?.clone();
        let words = how.words(name)?;
        Some(Example {
            span: words.range([frames.start, frames.end]),
            segments: serde_json::from_value(segments).ok()?,
            care,
            words,
        })
    }

    fn agreement(
        &self,
        set: &FeatureSet,
        hit: &HitRead,
        (found, span): (&Words, Range<usize>),
    ) -> Option<Agreement> {
        // A mirrored example has other words.
        if hit.mirrored || hit.segments.len() != self.segments.len() {
            return None;
        }
        let within = |range: Range<usize>, of: &Range<usize>| {
            let [start, end] =
                [range.start, range.end].map(|at| at.clamp(of.start, of.end) - of.start);
            start..end
        };
        let pairs = self.segments.iter().zip(&hit.segments);
        let stretches = pairs.map(|(&asked, &answered)| Stretch {
            query: within(self.words.range(asked), &self.span),
            hit: within(found.range(answered), &span),
            compared: self.care,
        });
        Some(Agreement::new(
            self.words.words.words.get(self.span.clone())?,
            found.words.words.get(span.clone())?,
            stretches.collect(),
            set.all() & self.words.available & found.available,
        ))
    }
}
