//! Searches by a template.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use mtemplate::ClassTemplate;
use rayon::prelude::*;
use serde::Deserialize;

use super::View;
use super::answer::Refusal;
use super::fragment::fragment;
use super::search::{MOST_PICTURES, fact, top, unsearched};
use crate::args::{MatchingArgs, Tau};
use crate::commands::search::template::{Places, TemplateHitJson, TemplateResult, What, search};
use crate::output::Voice;
use crate::report::document::{Document, Page, PageHit, Picture, Place, SearchPage};
use crate::report::make::template_page;
use crate::report::pictures;
use crate::templates;

/// `/api/template`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Asked {
    name: String,
    /// The most that a hit may cost; what was learned with the template if it is missing.
    tau: Option<f64>,
    top: Option<usize>,
}

impl Asked {
    pub(super) fn answer(&self, view: &View) -> Result<Document, Refusal> {
        let template = self.template(view)?;
        if let Some(found) = self.tau.filter(|tau| !(0.0..=1.0).contains(tau)) {
            return Err(Refusal::question(format!(
                "tau: expected a number from 0 to 1, found {found}"
            )));
        }
        let what = What {
            matching: MatchingArgs {
                tau: self.tau.map(Tau::Value),
                delta: None,
            },
            places: Places::Everywhere,
            top: top(self.top)?,
            ..What::default()
        };
        let quiet = Voice {
            quiet: true,
            ..Voice::default()
        };
        let result = search(&view.library, template, &what, quiet)?;
        let mut query = vec![
            fact("template", &result.query.template),
            fact("columns", result.query.columns),
            fact("τ", result.query.tau),
        ];
        query.extend(unsearched(result.n_unsearched));
        let template = templates::for_set(template, &view.library.features.set)?;
        let curves = Curves::new(view, &template, &result, what.matching.delta())?;
        let hits = result.hits.iter().map(|hit| {
            let clip = view.id_of(&hit.clip)?;
            Ok(PageHit {
                place: Place {
                    clip,
                    start: hit.start,
                    end: hit.end,
                    start_s: hit.start_s,
                    end_s: hit.end_s,
                },
                rank: hit.rank,
                cost: hit.cost,
                mirrored: false,
                segments: Vec::new(),
                agreement: curves.of(hit),
            })
        });
        let hits: Vec<PageHit> = hits.collect::<Result<_, Refusal>>()?;
        let ids: Vec<u32> = hits.iter().map(|hit| hit.place.clip).collect();
        let search = SearchPage {
            title: format!("template {}", template.name),
            query,
            example: None,
            n_hits: result.n_hits,
            hits,
        };
        let pages = template_page(&template).into_iter();
        fragment(view, &ids, pages.chain([Page::Search(search)]).collect())
    }

    fn template<'v>(&self, view: &'v View) -> Result<&'v ClassTemplate, Refusal> {
        let mut known = view.templates.iter();
        let found = known.find(|template| template.name == self.name);
        found.ok_or_else(|| Refusal::missing(format!("there is no template {:?}", self.name)))
    }
}

/// The curves Δ of the clips of the first hits, each with all listed hits of its clip.
struct Curves(BTreeMap<String, Option<Picture>>);

impl Curves {
    fn new(
        view: &View,
        template: &ClassTemplate,
        result: &TemplateResult,
        delta: f64,
    ) -> Result<Curves, Refusal> {
        let quantized = template.template.quantize(delta);
        let quantized = quantized.map_err(|e| Refusal::question(e.to_string()))?;
        let first = result.hits.iter().take(MOST_PICTURES);
        let names: BTreeSet<&String> = first.map(|hit| &hit.clip).collect();
        let names: Vec<&String> = names.into_iter().collect();
        let curves = names.par_iter().map(|&name| {
            let of_clip = result.hits.iter().filter(|hit| hit.clip == *name);
            let found: Vec<Range<f64>> = of_clip.map(|hit| hit.start_s..hit.end_s).collect();
            let clip = &view.clips.row(view.id_of(name)?)?.clip;
            let words = view.library.words(clip.id)?;
            let curve = quantized.distance_curve(&words);
            let costs: Vec<Option<f32>> = curve.costs().map(|c| c.map(|c| c as f32)).collect();
            let first_word = clip.meta.first_word as f64;
            let seconds = [first_word, first_word + words.len() as f64];
            let seconds = seconds.map(|word| word / view.library.rate);
            let limit = Some(result.query.tau as f32);
            let picture = pictures::curve(&costs, "cost Δ", limit, (seconds, &found));
            Ok((name.clone(), picture))
        });
        let curves: Vec<Result<(String, Option<Picture>), Refusal>> = curves.collect();
        Ok(Curves(curves.into_iter().collect::<Result<_, _>>()?))
    }

    fn of(&self, hit: &TemplateHitJson) -> Option<Picture> {
        let picture = self.0.get(&hit.clip).filter(|_| hit.rank <= MOST_PICTURES);
        picture.cloned().flatten()
    }
}
