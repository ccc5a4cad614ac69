//! Searches by a template.

use mtemplate::ClassTemplate;
use serde::Deserialize;

use super::View;
use super::answer::Refusal;
use super::fragment::fragment;
use super::search::{fact, top, unsearched};
use crate::args::{MatchingArgs, Tau};
use crate::commands::search::template::{Places, What, search};
use crate::output::Voice;
use crate::report::document::{Document, Page, PageHit, Place, SearchPage};

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
        let hits = result.hits.iter().map(|hit| {
            Ok(PageHit {
                place: Place {
                    clip: view.id_of(&hit.clip)?,
                    start: hit.start,
                    end: hit.end,
                    start_s: hit.start_s,
                    end_s: hit.end_s,
                },
                rank: hit.rank,
                cost: hit.cost,
                mirrored: false,
                segments: Vec::new(),
                agreement: None,
            })
        });
        let hits: Vec<PageHit> = hits.collect::<Result<_, Refusal>>()?;
        let ids: Vec<u32> = hits.iter().map(|hit| hit.place.clip).collect();
        let page = SearchPage {
            title: format!("template {}", template.name),
            query,
            example: None,
            n_hits: result.n_hits,
            hits,
        };
        fragment(view, &ids, vec![Page::Search(page)])
    }

    fn template<'v>(&self, view: &'v View) -> Result<&'v ClassTemplate, Refusal> {
        let mut known = view.templates.iter();
        let found = known.find(|template| template.name == self.name);
        found.ok_or_else(|| Refusal::missing(format!("there is no template {:?}", self.name)))
    }
}
