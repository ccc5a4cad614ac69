//! Searches by a template.

use mtemplate::ClassTemplate;
use serde::Deserialize;

use super::View;
use super::agreement::{OfHit, OfTemplate};
use super::answer::Refusal;
use super::fragment::fragment;
use super::routes::Question;
use super::search::{fact, top, unsearched};
use crate::args::{MatchingArgs, Tau};
use crate::commands::search::template::{Places, What, search};
use crate::output::Voice;
use crate::report::document::{Document, Page, PageHit, Place, SearchPage};
use crate::report::make::template_page;
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

impl Question for Asked {
    type Answer = Document;

    fn answer(&self, view: &View) -> Result<Document, Refusal> {
        let template = named(view, &self.name)?;
        let what = What {
            matching: matching(self.tau)?,
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
                path: Vec::new(),
                agreement: None,
                ask: OfTemplate::new(&result.query, clip).ask(),
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
}

/// The template of a name.
pub(super) fn named<'v>(view: &'v View, name: &str) -> Result<&'v ClassTemplate, Refusal> {
    let mut known = view.templates.iter();
    let found = known.find(|template| template.name == name);
    found.ok_or_else(|| Refusal::missing(format!("there is no template {name:?}")))
}

/// How well a hit has to fit; by what was learned with the template if `tau` is missing.
pub(super) fn matching(tau: Option<f64>) -> Result<MatchingArgs, Refusal> {
    match tau {
        Some(found) if !(0.0..=1.0).contains(&found) => Err(Refusal::question(format!(
            "tau: expected a number from 0 to 1, found {found}"
        ))),
        _ => Ok(MatchingArgs {
            tau: tau.map(Tau::Value),
            delta: None,
        }),
    }
}
