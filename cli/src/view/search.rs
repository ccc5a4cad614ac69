//! Searches: by example, by scene.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::View;
use super::agreement::{OfExample, OfHit, OfScene};
use super::answer::Refusal;
use super::fragment::fragment;
use super::routes::Question;
use crate::args::Mode;
use crate::commands::search::scene::search_scene_text;
use crate::commands::search::{
    HitJson, Mismatches, SearchResult, Sides, What, search_indexed, search_take,
};
use crate::library::Clip;
use crate::report::document::{Document, Fact, Page, PageHit, Place, SearchPage};
use crate::scene::{self, SceneText};
use crate::selection;
use crate::source::{ClipRef, Span};
use crate::take::Take;

/// Most hits of an answer.
const MOST: usize = 200;

/// Hits of an answer unless asked otherwise.
const USUAL: usize = 20;

/// The longest scene description, in bytes.
const LONGEST_SCENE: usize = 8 << 10;

/// How many hits to list.
pub(super) fn top(asked: Option<usize>) -> Result<usize, Refusal> {
    let top = asked.unwrap_or(USUAL);
    match (1..=MOST).contains(&top) {
        true => Ok(top),
        false => Err(Refusal::question(format!(
            "top: expected 1 to {MOST}, found {top}"
        ))),
    }
}

/// `/api/search`: motions like some frames of a clip.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Example {
    pub(super) clip: u32,
    /// First source frame; the clip's if it is missing.
    pub(super) start: Option<usize>,
    /// One past the last source frame; the clip's if it is missing.
    pub(super) end: Option<usize>,
    /// Names, numbers or parts of the set, with commas between them; all if there are none.
    #[serde(default)]
    pub(super) features: String,
    #[serde(default)]
    pub(super) mode: ModeName,
    #[serde(default)]
    pub(super) mismatches: usize,
    /// 1 to look for the left/right mirrored example as well.
    #[serde(default)]
    pub(super) mirror: u8,
    pub(super) top: Option<usize>,
}

#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum ModeName {
    Exact,
    Fuzzy,
    #[default]
    Adaptive,
}

impl From<ModeName> for Mode {
    fn from(name: ModeName) -> Mode {
        match name {
            ModeName::Exact => Mode::Exact,
            ModeName::Fuzzy => Mode::Fuzzy,
            ModeName::Adaptive => Mode::Adaptive,
        }
    }
}

impl Question for Example {
    type Answer = Document;

    fn answer(&self, view: &View) -> Result<Document, Refusal> {
        let clip = &view.clips.row(self.clip)?.clip;
        let frames = self.frames(clip);
        let names = self.names();
        let what = What {
            top: top(self.top)?,
            ..self.what(&names)
        };
        let result = match self.mirror {
            0 => search_indexed(&view.library, clip, frames, &what)?,
            _ => {
                let what = What {
                    sides: Sides::Both,
                    ..what
                };
                let take = self.take(view, frames)?;
                search_take(&view.library, take, &what, view.clips.options())?
            }
        };
        let page = self.page(view, &result, frames)?;
        let hits = page.hits.iter().map(|hit| hit.place.clip);
        let ids: Vec<u32> = std::iter::once(self.clip).chain(hits).collect();
        fragment(view, &ids, vec![Page::Search(page)])
    }
}

impl Example {
    fn frames(&self, clip: &Clip) -> Span {
        Span {
            start: self.start.unwrap_or(clip.meta.first_frame as usize),
            end: self.end.unwrap_or(clip.meta.end_frame as usize),
        }
    }

    pub(super) fn names(&self) -> Vec<String> {
        let names = self.features.split(',').map(str::trim);
        let names = names.filter(|name| !name.is_empty()).map(str::to_owned);
        names.collect()
    }

    /// What is looked for, by the features of these names.
    pub(super) fn what<'n>(&self, names: &'n [String]) -> What<'n> {
        let mismatches = Mismatches {
            max: self.mismatches,
            at: &[],
        };
        What {
            mode: self.mode.into(),
            mismatches: (self.mismatches > 0).then_some(mismatches),
            ..What::new(names)
        }
    }

    /// The example as it is in its file: words do not tell those of the mirrored body.
    pub(super) fn take(&self, view: &View, frames: Span) -> Result<Take, Refusal> {
        let set = &view.library.features.set;
        let asked = selection::select(set, &self.names())?;
        let available = view.clips.row(self.clip)?.clip.meta.available;
        let lacking = (asked | set.mirrored(asked)) & !available;
        if lacking != 0 {
            let gone = selection::names(set, lacking).join(", ");
            let error = format!("the clip's rig lacks {gone}, on one side or the other");
            return Err(Refusal::question(error));
        }
        let mut take = view.clips.take(self.clip)?;
        if frames.start >= frames.end
            || frames.start < take.span.start
            || frames.end > take.span.end
        {
            return Err(Refusal::question(format!(
                "expected frames within {}-{}, found {}-{}",
                take.span.start, take.span.end, frames.start, frames.end
            )));
        }
        take.span = frames;
        take.clip.span = Some(frames);
        Ok(take)
    }

    fn page(
        &self,
        view: &View,
        result: &SearchResult,
        frames: Span,
    ) -> Result<SearchPage, Refusal> {
        let asked = &result.query;
        let mut query = vec![
            fact(
                "example",
                format!("{} {}-{}", asked.clip, asked.start, asked.end),
            ),
            fact("features", asked.features.join(", ")),
            fact("mode", asked.mode),
            fact("segments", asked.segments.len()),
        ];
        query.extend(asked.max_mismatches.map(|max| fact("mismatches", max)));
        if asked.mirror {
            query.push(fact("mirror", "left and right exchanged as well"));
        }
        query.extend(unsearched(result.n_unsearched));
        let clip = &view.clips.row(self.clip)?.clip;
        let example = Place::new(self.clip, frames.start..frames.end, clip.meta.source_rate);
        let hits = result.hits.iter().map(|hit| {
            let hit = page_hit(view, hit)?;
            let ask = OfExample::new(self, frames, &hit).ask();
            let path = hit.path_to(&example, &asked.segments);
            Ok(PageHit { ask, path, ..hit })
        });
        let hits: Vec<PageHit> = hits.collect::<Result<_, Refusal>>()?;
        Ok(SearchPage {
            title: format!("like {}", short(clip, frames)),
            query,
            example: Some(example),
            n_hits: result.n_hits,
            hits,
        })
    }
}

/// The name of the file alone, with the frames unless they are the whole clip.
fn short(clip: &Clip, frames: Span) -> String {
    let last = |name: &Path| {
        let last = name.file_name().unwrap_or(name.as_os_str());
        last.to_string_lossy().into_owned()
    };
    let whole = clip.meta.first_frame as usize..clip.meta.end_frame as usize;
    match ClipRef::parse(clip.name.as_ref()) {
        Ok(source) if frames.range() != whole => {
            format!("{}@{}-{}", last(&source.path), frames.start, frames.end)
        }
        _ => last(clip.name.as_ref()),
    }
}

/// `/api/scene`: a scene description.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Scene {
    text: String,
    top: Option<usize>,
}

/// What a scene description says.
pub(super) fn scene_of(view: &View, text: &str) -> Result<SceneText, Refusal> {
    if text.len() > LONGEST_SCENE {
        let found = text.len();
        return Err(Refusal::question(format!(
            "text: expected up to {LONGEST_SCENE} bytes, found {found}"
        )));
    }
    let scene = scene::parse(text, &view.library.features.set);
    scene.map_err(|e| Refusal::of_scene(&e, text))
}

impl Question for Scene {
    type Answer = Document;

    fn answer(&self, view: &View) -> Result<Document, Refusal> {
        let top = top(self.top)?;
        let scene = scene_of(view, &self.text)?;
        // Never by its name: a text that is that of a file would be read.
        let result = search_scene_text(&view.library, &scene, &self.text, top)?;
        let lines = result.query.lines.iter();
        let mut query: Vec<Fact> = lines
            .map(|line| fact(&line.name, &line.progression))
            .collect();
        query.extend(
            scene
                .notes
                .iter()
                .map(|(at, note)| fact(&format!("note {at}"), note)),
        );
        query.extend(unsearched(result.n_unsearched));
        let hits = result.hits.iter().map(|hit| {
            let hit = page_hit(view, &hit.hit)?;
            let ask = OfScene::new(&self.text, &hit).ask();
            Ok(PageHit { ask, ..hit })
        });
        let page = SearchPage {
            title: "scene".to_owned(),
            query,
            example: None,
            n_hits: result.n_hits,
            hits: hits.collect::<Result<_, Refusal>>()?,
        };
        let ids: Vec<u32> = page.hits.iter().map(|hit| hit.place.clip).collect();
        fragment(view, &ids, vec![Page::Search(page)])
    }
}

pub(super) fn fact(name: &str, value: impl ToString) -> Fact {
    Fact {
        name: name.to_owned(),
        value: value.to_string(),
    }
}

/// How many clips could not be searched, if there are any.
pub(super) fn unsearched(n: usize) -> Option<Fact> {
    let value = format!("{n} clips, whose rigs lack some of the features");
    (n > 0).then(|| fact("not searched", value))
}

fn page_hit(view: &View, hit: &HitJson) -> Result<PageHit, Refusal> {
    Ok(PageHit {
        place: Place {
            clip: view.id_of(&hit.clip)?,
            start: hit.start,
            end: hit.end,
            start_s: hit.start_s,
            end_s: hit.end_s,
        },
        rank: hit.rank,
        cost: hit.cost as f64,
        mirrored: hit.mirrored,
        segments: hit.segments.clone(),
        path: Vec::new(),
        agreement: None,
        ask: None,
    })
}
