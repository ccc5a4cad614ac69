//! From templates and clips to labelled spans.

mod eaf;
mod exclusive;
mod stream;

use std::ops::Range;

use mtemplate::{ClassTemplate, MatchConfig, QuantizedTemplate};
use relfeat::FeatureSet;

pub use eaf::{Tier, write_eaf};
pub use stream::Live;

use crate::failure::Failure;
use crate::library::NamedSet;
use crate::take::Take;
use crate::templates;
use crate::wire::available;

/// A stretch of a clip that fits a template.
#[derive(Clone, Debug, PartialEq)]
pub struct Span {
    /// Number of the label.
    pub label: usize,
    /// Source frames.
    pub frames: Range<usize>,
    /// What it costs.
    pub cost: f64,
    /// What it might have cost at most.
    pub tau: f64,
}

/// What was found in a clip.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Annotation {
    /// In order of their frames, then of their labels.
    pub spans: Vec<Span>,
    /// Labels that could not be looked for, as the clip's rig lacks features that they ask for.
    pub lacking: Vec<usize>,
}

/// The templates to label with.
#[derive(Debug)]
pub struct Labeller {
    labels: Vec<String>,
    groups: Vec<Group>,
}

/// The templates over one kind of words.
#[derive(Debug)]
pub(crate) struct Group {
    pub(crate) set: FeatureSet,
    pub(crate) rate: f64,
    pub(crate) templates: Vec<Labelled>,
}

/// A template that is ready to be matched.
#[derive(Debug)]
pub(crate) struct Labelled {
    pub(crate) label: usize,
    pub(crate) template: QuantizedTemplate,
    pub(crate) tau: f64,
    /// Features that some column asks for.
    care: u64,
}

impl Labeller {
    /// Templates, each with its threshold τ, to be quantised with δ. `set` is taken for templates of
    /// a set of its name, before the built-in sets.
    ///
    /// # Errors
    /// [`Failure::Usage`] for a template whose feature set is not known or has other features.
    pub fn new(
        templates: &[(ClassTemplate, f64)],
        delta: f64,
        set: Option<&NamedSet>,
    ) -> Result<Labeller, Failure> {
        let mut labeller = Labeller {
            labels: Vec::new(),
            groups: Vec::new(),
        };
        for (class, tau) in templates {
            let group = labeller.group(class, set)?;
            let class = templates::for_set(class, &labeller.groups[group].set)?;
            let template = class
                .template
                .quantize(delta)
                .map_err(|e| Failure::Usage(format!("--delta: {e}")))?;
            let labelled = Labelled {
                label: labeller.labels.len(),
                care: (0..template.n_columns()).fold(0, |care, column| {
                    care | template.words(column).map_or(0, |(asked, _)| asked)
                }),
                template,
                tau: *tau,
            };
            labeller.labels.push(class.name);
            labeller.groups[group].templates.push(labelled);
        }
        Ok(labeller)
    }

    /// The group that a template belongs to.
    fn group(&mut self, class: &ClassTemplate, set: Option<&NamedSet>) -> Result<usize, Failure> {
        let is_its = |g: &Group| g.set.name() == class.feature_set && g.rate == class.rate;
        if let Some(group) = self.groups.iter().position(is_its) {
            return Ok(group);
        }
        let set = match set.filter(|named| named.set.name() == class.feature_set) {
            Some(named) => named.set.clone(),
            None => {
                let found = NamedSet::find(&class.feature_set);
                let about = |e| Failure::Usage(format!("template {:?}: {e}", class.name));
                found.map_err(about)?.set
            }
        };
        self.groups.push(Group {
            set,
            rate: class.rate,
            templates: Vec::new(),
        });
        Ok(self.groups.len() - 1)
    }

    /// Names of the labels, by number.
    #[must_use]
    pub fn labels(&self) -> &[String] {
        &self.labels
    }

    pub(crate) fn groups(&self) -> &[Group] {
        &self.groups
    }

    /// All matches of all templates in a clip.
    ///
    /// # Errors
    /// [`Failure::Input`] if features cannot be computed.
    pub fn annotate(&self, take: &Take) -> Result<Annotation, Failure> {
        let mut found = Annotation::default();
        for group in &self.groups {
            let words = take.words(&group.set, group.rate)?;
            let frame = |word: usize| match words.frames.get(word) {
                _ if word == 0 => take.span.start,
                Some(&frame) => frame,
                None => take.span.end,
            };
            let available = available(&group.set, &take.map);
            for labelled in &group.templates {
                if labelled.care & !available != 0 {
                    found.lacking.push(labelled.label);
                    continue;
                }
                let matches = labelled
                    .template
                    .find_matches(&words.words, &MatchConfig::up_to(labelled.tau));
                found.spans.extend(matches.into_iter().map(|found| Span {
                    label: labelled.label,
                    frames: frame(found.span.start)..frame(found.span.end),
                    cost: found.cost,
                    tau: labelled.tau,
                }));
            }
        }
        found.lacking.sort_unstable();
        let key = |span: &Span| (span.frames.start, span.frames.end, span.label);
        found.spans.sort_by_key(key);
        Ok(found)
    }
}

impl Annotation {
    /// The same with one label a frame at most: that of the span which costs least for its
    /// threshold, the earliest among equals.
    #[must_use]
    pub fn exclusive(self) -> Annotation {
        let spans = exclusive::exclusive(self.spans);
        Annotation { spans, ..self }
    }
}
