//! From what is given to the document of a page.

use std::collections::BTreeMap;

use mtemplate::ClassTemplate;

use super::build::Builder;
use super::clip::Drawn;
use super::document::{ClipPage, Document, Page, TemplatePage};
use super::given::Given;
use super::pages::{alignment, annotation, bundles, library, search};
use super::pictures;
use super::results::{AlignRead, Read};
use crate::annotation::Labeller;
use crate::args::MatchingArgs;
use crate::commands::align::{How as AlignHow, align_takes};
use crate::failure::{Failure, Skipped};
use crate::library::NamedSet;
use crate::output::Voice;
use crate::recording::ReadOptions;
use crate::source::ClipRef;
use crate::take::Take;

/// How a report is made.
#[derive(Debug)]
pub struct How<'a> {
    /// How files are read.
    pub options: &'a ReadOptions,
    /// The features shown.
    pub features: NamedSet,
    /// Poses and words per second, where no library has its own.
    pub rate: f64,
    /// The most bytes of motion.
    pub budget: usize,
    /// How well spans have to fit templates.
    pub matching: MatchingArgs,
    /// What clips show, by their names; of others the folders of a library tell.
    pub labels: BTreeMap<String, String>,
    /// How to speak.
    pub voice: Voice,
}

/// A document in the making, and what it takes to read clips.
#[derive(Debug)]
pub struct Maker<'a> {
    /// How it is made.
    pub how: &'a How<'a>,
    /// What is there.
    pub builder: Builder,
    /// Clips that could not be read.
    pub skipped: Vec<Skipped>,
}

/// A motion file that was read.
#[derive(Debug)]
struct Shown {
    drawn: Drawn,
    /// Unless no rig fits.
    take: Option<Take>,
}

impl Shown {
    fn load(clip: &ClipRef, how: &How<'_>) -> Result<Shown, Failure> {
        match Take::load(clip, how.options) {
            Ok(take) => Ok(Shown {
                drawn: Drawn::of_take(&take, how.rate),
                take: Some(take),
            }),
            // Perhaps no rig fits: then it is drawn by its own joints.
            Err(failure) => match Drawn::load(clip, how.options, how.rate) {
                Ok(drawn) => Ok(Shown { drawn, take: None }),
                Err(_) => Err(failure),
            },
        }
    }
}

/// The document of everything given, and what was left out. Motion is put in until the budget is spent: first that of
/// motion files, then of results and bundles, then of libraries.
///
/// # Errors
/// [`Failure`] for templates, bundles and libraries that cannot be shown; clips that cannot be read are left out.
pub fn document(
    given: &Given,
    title: String,
    how: &How<'_>,
) -> Result<(Document, Vec<Skipped>), Failure> {
    let mut maker = Maker {
        how,
        builder: Builder::new(title, how.budget),
        skipped: Vec::new(),
    };
    let clips = maker.clips(given)?;
    let mut results = Vec::new();
    for (_, read) in &given.results {
        results.extend(maker.results(read));
    }
    let mut graphs = Vec::new();
    for (path, bundled) in &given.bundles {
        graphs.push(Page::Bundles(bundles::page(&mut maker, path, bundled)?));
    }
    let mut pages = Vec::new();
    for one in &given.libraries {
        pages.push(Page::Library(library::page(&mut maker, one)?));
    }
    pages.extend(results);
    pages.extend(clips);
    let templates = given.templates.iter();
    pages.extend(templates.filter_map(|(_, template)| template_page(template)));
    pages.extend(graphs);
    for (name, label) in &how.labels {
        if let Some(id) = maker.builder.id(name) {
            maker.builder.label(id, label.clone());
        }
    }
    Ok((maker.builder.finish(pages), maker.skipped))
}

impl Maker<'_> {
    /// The number of a clip, which is read if it is not there yet; `None` if that cannot be done.
    pub(super) fn clip(&mut self, name: &str) -> Option<u32> {
        self.clips_of([name]).pop().flatten()
    }

    /// As [`clip`](Self::clip), for many at once.
    pub(super) fn clips_of<'n>(
        &mut self,
        names: impl IntoIterator<Item = &'n str>,
    ) -> Vec<Option<u32>> {
        let names: Vec<&str> = names.into_iter().collect();
        let mut missing: Vec<ClipRef> = Vec::new();
        for name in &names {
            // What is no span is a name.
            let clip = ClipRef::parse(name.as_ref()).unwrap_or(ClipRef {
                path: name.into(),
                span: None,
            });
            let is_known = self.builder.id(name).is_some() || missing.contains(&clip);
            if !is_known {
                missing.push(clip);
            }
        }
        let how = self.how;
        let (read, skipped) = how.voice.batch(&missing, "reading", |clip| {
            Drawn::load(clip, how.options, how.rate)
        });
        for (_, drawn) in read {
            self.builder.add(&drawn);
        }
        for one in skipped {
            if !self.skipped.contains(&one) {
                self.skipped.push(one);
            }
        }
        names.iter().map(|name| self.builder.id(name)).collect()
    }

    /// Frames per second of a clip's file.
    pub(super) fn rate(&self, id: u32) -> f64 {
        self.builder
            .clip(id)
            .map_or(self.how.rate, |clip| clip.rate)
    }

    fn clips(&mut self, given: &Given) -> Result<Vec<Page>, Failure> {
        let how = self.how;
        let (shown, skipped) = how
            .voice
            .batch(&given.clips, "reading", |clip| Shown::load(clip, how));
        self.skipped.extend(skipped);
        let shown: Vec<Shown> = shown.into_iter().map(|(_, shown)| shown).collect();
        let mut pages = Vec::new();
        for one in &shown {
            let clip = self.builder.add(&one.drawn);
            let features = match &one.take {
                Some(take) => self.features(take)?,
                None => None,
            };
            pages.push(Page::Clip(ClipPage { clip, features }));
        }
        if !given.templates.is_empty() {
            let templates = given.templates.iter().map(|(_, template)| {
                let tau = how.matching.tau_of(template)?;
                Ok((template.clone(), tau))
            });
            let templates = templates.collect::<Result<Vec<_>, Failure>>()?;
            let labeller = Labeller::new(&templates, how.matching.delta(), Some(&how.features))?;
            for take in shown.iter().filter_map(|one| one.take.as_ref()) {
                let page = annotation::of_take(self, take, &labeller)?;
                pages.extend(page.map(Page::Annotation));
            }
        }
        if let [Shown { take: Some(a), .. }, Shown { take: Some(b), .. }] = shown.as_slice() {
            let lower = a.rate().min(b.rate());
            let align = AlignHow {
                rate: Some(how.rate.min(lower)),
                max_distance: f64::INFINITY,
                ..AlignHow::new(how.features.set.clone())
            };
            let read = AlignRead::of(&align_takes(a, b, &align)?);
            let page = read.and_then(|read| alignment::page(self, &read));
            pages.extend(page.map(Page::Alignment));
        }
        Ok(pages)
    }

    fn features(&self, take: &Take) -> Result<Option<super::document::Picture>, Failure> {
        let (set, rate) = (&self.how.features.set, self.how.rate);
        let words = take.words(set, rate)?;
        let from = take.span.start as f64 / take.rate();
        Ok(pictures::features(set, &words.words, rate, from))
    }

    fn results(&mut self, read: &Read) -> Vec<Page> {
        match read {
            Read::Searches(searches) => {
                let pages = searches.iter().map(|one| search::page(self, one));
                pages.map(Page::Search).collect()
            }
            Read::Annotations(clips) => {
                let pages = clips.iter().filter_map(|one| annotation::page(self, one));
                pages.map(Page::Annotation).collect()
            }
            Read::Alignment(read) => {
                let page = alignment::page(self, read);
                page.map(Page::Alignment).into_iter().collect()
            }
        }
    }
}

/// A template; `None` for one that no picture can hold.
#[must_use]
pub fn template_page(class: &ClassTemplate) -> Option<Page> {
    Some(Page::Template(TemplatePage {
        name: class.name.clone(),
        set: class.feature_set.clone(),
        rate: class.rate,
        tau: class.tau,
        examples: class.n_motions,
        matrix: pictures::template(class)?,
    }))
}
