//! Searches: by example, by scene.

use rayon::prelude::*;
use serde::Deserialize;

use super::View;
use super::answer::Refusal;
use super::fragment::fragment;
use crate::args::Mode;
use crate::commands::search::scene::search_scene_text;
use crate::commands::search::{
    HitJson, Mismatches, SearchResult, Sides, What, search_indexed, search_take,
};
use crate::report::document::{Document, Fact, Page, PageHit, Place, SearchPage};
use crate::report::pictures;
use crate::scene;
use crate::selection;
use crate::source::Span;

/// Most hits of an answer.
const MOST: usize = 200;

/// Hits of an answer unless asked otherwise.
const USUAL: usize = 20;

/// Hits that have a picture, at most: those that are looked at first.
pub(super) const MOST_PICTURES: usize = 6;

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
    clip: u32,
    /// First source frame; the clip's if it is missing.
    start: Option<usize>,
    /// One past the last source frame; the clip's if it is missing.
    end: Option<usize>,
    /// Names, numbers or parts of the set, with commas between them; all if there are none.
    #[serde(default)]
    features: String,
    #[serde(default)]
    mode: ModeName,
    #[serde(default)]
    mismatches: usize,
    /// 1 to look for the left/right mirrored example as well.
    #[serde(default)]
    mirror: u8,
    top: Option<usize>,
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
enum ModeName {
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

impl Example {
    pub(super) fn answer(&self, view: &View) -> Result<Document, Refusal> {
        let top = top(self.top)?;
        let clip = &view.clips.row(self.clip)?.clip;
        let frames = Span {
            start: self.start.unwrap_or(clip.meta.first_frame as usize),
            end: self.end.unwrap_or(clip.meta.end_frame as usize),
        };
        let names = self.features.split(',').map(str::trim);
        let names = names.filter(|name| !name.is_empty()).map(str::to_owned);
        let names: Vec<String> = names.collect();
        let mismatches = Mismatches {
            max: self.mismatches,
            at: &[],
        };
        let what = What {
            mode: self.mode.into(),
            mismatches: (self.mismatches > 0).then_some(mismatches),
            explain: true,
            top,
            ..What::new(&names)
        };
        let result = match self.mirror {
            0 => search_indexed(&view.library, clip, frames, &what)?,
            _ => self.both_sides(view, frames, &what)?,
        };
        let example = Place::new(self.clip, frames.start..frames.end, clip.meta.source_rate);
        let page = page(view, &result, example)?;
        let hits = page.hits.iter().map(|hit| hit.place.clip);
        let ids: Vec<u32> = std::iter::once(self.clip).chain(hits).collect();
        fragment(view, &ids, vec![Page::Search(page)])
    }

    /// Words do not tell those of the mirrored body, so the file is read.
    fn both_sides(
        &self,
        view: &View,
        frames: Span,
        what: &What<'_>,
    ) -> Result<SearchResult, Refusal> {
        let library = &view.library;
        let clip = &view.clips.row(self.clip)?.clip;
        let asked = selection::select(&library.features.set, what.features)?;
        let available = clip.meta.available;
        let lacking = (asked | library.features.set.mirrored(asked)) & !available;
        if lacking != 0 {
            let gone = selection::names(&library.features.set, lacking).join(", ");
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
        let what = What {
            sides: Sides::Both,
            ..*what
        };
        Ok(search_take(library, take, &what, view.clips.options())?)
    }
}

fn page(view: &View, result: &SearchResult, example: Place) -> Result<SearchPage, Refusal> {
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
    let hits = result.hits.par_iter().map(|hit| {
        let explained = hit.explained.as_ref().filter(|_| hit.rank <= MOST_PICTURES);
        let (set, rate) = (&view.library.features.set, view.library.rate);
        Ok(PageHit {
            agreement: explained.and_then(|explained| {
                pictures::agreement(set, &explained.agreement, rate, hit.start_s)
            }),
            ..page_hit(view, hit)?
        })
    });
    let hits: Vec<Result<PageHit, Refusal>> = hits.collect();
    Ok(SearchPage {
        title: format!("like {}", asked.clip),
        query,
        example: Some(example),
        n_hits: result.n_hits,
        hits: hits.into_iter().collect::<Result<_, _>>()?,
    })
}

/// `/api/scene`: a scene description.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Scene {
    text: String,
    top: Option<usize>,
}

impl Scene {
    pub(super) fn answer(&self, view: &View) -> Result<Document, Refusal> {
        let top = top(self.top)?;
        if self.text.len() > LONGEST_SCENE {
            let found = self.text.len();
            return Err(Refusal::question(format!(
                "text: expected up to {LONGEST_SCENE} bytes, found {found}"
            )));
        }
        let scene = scene::parse(&self.text, &view.library.features.set);
        let scene = scene.map_err(|e| Refusal::of_scene(&e, &self.text))?;
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
        let hits = result.hits.iter().map(|hit| page_hit(view, &hit.hit));
        let page = SearchPage {
            title: "scene".to_owned(),
            query,
            example: None,
            n_hits: result.n_hits,
            hits: hits.collect::<Result<_, _>>()?,
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
        agreement: None,
    })
}
