//! Pictures of where single hits agree with what was asked: no more is computed than is looked at.
//!
//! A hit says what to ask to get its picture. The picture is made of what the library has of the hit's clip; no other
//! clip is searched.

use std::ops::Range;

use mtemplate::MatchConfig;
use serde::{Deserialize, Serialize};

use super::View;
use super::answer::Refusal;
use super::routes::Question;
use super::search::{Example, ModeName, scene_of};
use super::template::{matching, named};
use crate::commands::search::explain::{HitPlace, explain_indexed, explain_take};
use crate::commands::search::scene::explain_scene;
use crate::commands::search::template::TemplateQueryJson;
use crate::report::document::{PageHit, Picture};
use crate::report::pictures;
use crate::source::Span;
use crate::templates;

/// Where a hit agrees with what was asked.
#[derive(Debug, Serialize)]
pub(super) struct Agreement {
    /// `None` for one that no picture can hold.
    agreement: Option<Picture>,
}

/// A question about a hit.
pub(super) trait OfHit: Serialize {
    /// Where it is asked, below `/api/`.
    const PATH: &'static str;

    /// The path with its query.
    fn ask(&self) -> Option<String> {
        let query = serde_urlencoded::to_string(self).ok()?;
        Some(format!("{}?{query}", Self::PATH))
    }
}

/// `/api/agreement`: a hit of an example.
#[derive(Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct OfExample {
    /// The example, as `/api/search` has it.
    clip: u32,
    start: usize,
    end: usize,
    #[serde(default)]
    features: String,
    #[serde(default)]
    mode: ModeName,
    #[serde(default)]
    mismatches: usize,
    /// Whether it is a hit of the left/right mirrored example: 0 or 1.
    #[serde(default)]
    mirrored: u8,
    /// Clip of the hit.
    hit: u32,
    /// Its first source frame.
    from: usize,
    /// One past its last source frame.
    to: usize,
}

impl OfHit for OfExample {
    const PATH: &'static str = "agreement";
}

impl OfExample {
    pub(super) fn new(asked: &Example, frames: Span, hit: &PageHit) -> OfExample {
        OfExample {
            clip: asked.clip,
            start: frames.start,
            end: frames.end,
            features: asked.features.clone(),
            mode: asked.mode,
            mismatches: asked.mismatches,
            mirrored: hit.mirrored.into(),
            hit: hit.place.clip,
            from: hit.place.start,
            to: hit.place.end,
        }
    }

    fn example(&self) -> Example {
        Example {
            clip: self.clip,
            start: Some(self.start),
            end: Some(self.end),
            features: self.features.clone(),
            mode: self.mode,
            mismatches: self.mismatches,
            mirror: self.mirrored,
            top: None,
        }
    }
}

impl Question for OfExample {
    type Answer = Agreement;

    fn answer(&self, view: &View) -> Result<Agreement, Refusal> {
        let library = &view.library;
        let example = self.example();
        let names = example.names();
        let what = example.what(&names);
        let frames = Span {
            start: self.start,
            end: self.end,
        };
        let clip = &view.clips.row(self.hit)?.clip;
        let place = HitPlace {
            clip,
            frames: Span {
                start: self.from,
                end: self.to,
            },
            mirrored: self.mirrored != 0,
        };
        let of = &view.clips.row(self.clip)?.clip;
        let found = match place.mirrored {
            false => explain_indexed(library, (of, frames), &what, place)?,
            true => explain_take(library, example.take(view, frames)?, &what, place)?,
        };
        let found = found.ok_or_else(|| no_hit(place.frames))?;
        let from = self.from as f64 / clip.meta.source_rate;
        Ok(Agreement {
            agreement: pictures::agreement(&library.features.set, &found, library.rate, from),
        })
    }
}

/// `/api/agreement/scene`: a hit of a scene.
#[derive(Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct OfScene {
    /// The scene description.
    text: String,
    /// Clip of the hit.
    hit: u32,
    /// Its first source frame.
    from: usize,
    /// One past its last source frame.
    to: usize,
}

impl OfHit for OfScene {
    const PATH: &'static str = "agreement/scene";
}

impl OfScene {
    pub(super) fn new(text: &str, hit: &PageHit) -> OfScene {
        OfScene {
            text: text.to_owned(),
            hit: hit.place.clip,
            from: hit.place.start,
            to: hit.place.end,
        }
    }
}

impl Question for OfScene {
    type Answer = Agreement;

    fn answer(&self, view: &View) -> Result<Agreement, Refusal> {
        let scene = scene_of(view, &self.text)?;
        let clip = &view.clips.row(self.hit)?.clip;
        let frames = Span {
            start: self.from,
            end: self.to,
        };
        let found = explain_scene(&view.library, &scene, clip, frames)?;
        let found = found.ok_or_else(|| no_hit(frames))?;
        let from = self.from as f64 / clip.meta.source_rate;
        Ok(Agreement {
            agreement: pictures::scene(&found, view.library.rate, from),
        })
    }
}

fn no_hit(frames: Span) -> Refusal {
    let Span { start, end } = frames;
    Refusal::missing(format!("there is no hit {start}-{end} in the clip"))
}

/// `/api/agreement/template`: the curve Δ of a hit's clip with all hits of the clip.
#[derive(Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct OfTemplate {
    name: String,
    tau: Option<f64>,
    /// Clip of the hit.
    hit: u32,
}

impl OfHit for OfTemplate {
    const PATH: &'static str = "agreement/template";
}

impl OfTemplate {
    pub(super) fn new(asked: &TemplateQueryJson, hit: u32) -> OfTemplate {
        OfTemplate {
            name: asked.template.clone(),
            tau: Some(asked.tau),
            hit,
        }
    }
}

impl Question for OfTemplate {
    type Answer = Agreement;

    fn answer(&self, view: &View) -> Result<Agreement, Refusal> {
        let (library, matching) = (&view.library, matching(self.tau)?);
        let template = named(view, &self.name)?;
        let template = templates::for_set(template, &library.features.set)?;
        let tau = matching.tau_of(&template)?;
        let quantized = template.template.quantize(matching.delta());
        let quantized = quantized.map_err(|e| Refusal::question(e.to_string()))?;
        let clip = &view.clips.row(self.hit)?.clip;
        let columns = (0..quantized.n_columns()).filter_map(|column| quantized.words(column));
        if columns.fold(0, |all, column| all | column.0) & !clip.meta.available != 0 {
            let error = "the clip's rig lacks features of the template";
            return Err(Refusal::missing(error));
        }
        let words = library.words(clip.id)?;
        let curve = quantized.distance_curve(&words);
        let matches = quantized.matches_of(&words, &curve, &MatchConfig::up_to(tau));
        let found = matches.into_iter().map(|one| {
            let span = clip.meta.source_span(one.span, words.len(), library.rate);
            let [start, end] = [span.start, span.end].map(|at| at as f64 / clip.meta.source_rate);
            start..end
        });
        let found: Vec<Range<f64>> = found.collect();
        let costs: Vec<Option<f32>> = curve.costs().map(|c| c.map(|c| c as f32)).collect();
        let first_word = clip.meta.first_word as f64;
        let seconds = [first_word, first_word + words.len() as f64];
        let seconds = seconds.map(|word| word / library.rate);
        let limit = Some(tau as f32);
        Ok(Agreement {
            agreement: pictures::curve(&costs, "cost Δ", limit, (seconds, &found)),
        })
    }
}
