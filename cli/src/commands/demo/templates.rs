//! Every class of the tour learned from its single clips, and looked for in the takes.

use std::io::{self, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

use mtemplate::LearnConfig;
use serde::Serialize;

use crate::annotation::Labeller;
use crate::args::Tau;
use crate::commands::index::{DEFAULT_RATE, DEFAULT_SET};
use crate::commands::learn::{Class as Lesson, Clips, What, learn_all};
use crate::corpus::Class;
use crate::corpus_files::ClipFile;
use crate::failure::Failure;
use crate::library::NamedSet;
use crate::output::{Voice, count};
use crate::picture::Image;
use crate::picture::template::template_heatmap;
use crate::recording::ReadOptions;
use crate::source::ClipRef;
use crate::take::Take;
use crate::templates;

/// What templates of all classes found in the takes.
#[derive(Debug, Serialize)]
pub struct DemoAnnotation {
    /// The folder of the templates.
    pub templates: String,
    /// The takes.
    pub takes: Vec<DemoTake>,
}

/// A take, and what was found in it.
#[derive(Debug, Serialize)]
pub struct DemoTake {
    /// The file.
    pub clip: String,
    /// Its labelled performances.
    pub performances: usize,
    /// How many of them some span of their class covers.
    pub found: usize,
    /// Spans that cover no performance of theirs.
    pub wrong: usize,
    /// Labels and source frames of the spans.
    pub spans: Vec<(String, Range<usize>)>,
}

/// The share of an example that is quantised away (2006 paper, section 5.2).
const DELTA: f64 = 0.1;

impl DemoAnnotation {
    pub(super) fn new(
        files: &[ClipFile],
        folder: &Path,
        voice: Voice,
    ) -> Result<DemoAnnotation, Failure> {
        let classes = Class::ALL.map(|class| Lesson {
            name: class.name().to_owned(),
            clips: single_clips(files, class),
            file: template_file(folder, class),
        });
        let lessons = Clips {
            classes: classes.to_vec(),
            negatives: Vec::new(),
        };
        let named = NamedSet::find(DEFAULT_SET)?;
        let what = What {
            set: &named.set,
            rate: DEFAULT_RATE,
            config: LearnConfig::default(),
            tau: Some(Tau::Learned),
            keyframes: true,
        };
        learn_all(&lessons, &what, &ReadOptions::default(), voice)?;
        let learned = templates::load_all(&[folder.to_owned()])?;
        let learned = learned.into_iter().map(|(path, template)| {
            let lacking = || Failure::input(&path, "a template without a threshold");
            let tau = template.tau.ok_or_else(lacking)?;
            Ok((template, tau))
        });
        let learned: Result<Vec<_>, Failure> = learned.collect();
        let labeller = Labeller::new(&learned?, DELTA, Some(&named))?;
        let takes = files.iter().filter(|file| file.class.is_none());
        let takes = takes.map(|take| DemoTake::new(take, &labeller));
        Ok(DemoAnnotation {
            templates: folder.display().to_string(),
            takes: takes.collect::<Result<_, _>>()?,
        })
    }

    /// The template of a class, drawn.
    pub(super) fn picture(folder: &Path, class: Class) -> Result<Image, Failure> {
        let template = templates::load(&template_file(folder, class))?;
        let values = template.template.values();
        Ok(template_heatmap(&template.features, values, template.rate))
    }

    pub(super) fn tell(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(
            out,
            "\nA template of each class, learned from its single clips ({}), labels the takes:",
            self.templates
        )?;
        let sum = |part: fn(&DemoTake) -> usize| self.takes.iter().map(part).sum::<usize>();
        let wrong = match sum(|take| take.wrong) {
            0 => "no other span".to_owned(),
            n => count(n, "other span"),
        };
        writeln!(
            out,
            "  {} of {} performances found, {wrong}",
            sum(|take| take.found),
            sum(|take| take.performances),
        )
    }
}

impl DemoTake {
    fn new(take: &ClipFile, labeller: &Labeller) -> Result<DemoTake, Failure> {
        let annotation = labeller.annotate(&Take::load(&clip(take), &ReadOptions::default())?)?;
        let spans = annotation.exclusive().spans.into_iter();
        let name = |label: usize| labeller.labels()[label].clone();
        let spans: Vec<(String, Range<usize>)> =
            spans.map(|span| (name(span.label), span.frames)).collect();
        let is_of = |(name, span): &(String, Range<usize>), label: &crate::corpus::Label| {
            name == label.class.name() && covers(span, &label.span)
        };
        let labels = take.labels.iter();
        Ok(DemoTake {
            clip: take.path.display().to_string(),
            performances: take.labels.len(),
            found: labels
                .filter(|label| spans.iter().any(|span| is_of(span, label)))
                .count(),
            wrong: spans
                .iter()
                .filter(|span| !take.labels.iter().any(|label| is_of(span, label)))
                .count(),
            spans,
        })
    }
}

fn clip(file: &ClipFile) -> ClipRef {
    ClipRef {
        path: file.path.clone(),
        span: None,
    }
}

fn single_clips(files: &[ClipFile], class: Class) -> Vec<ClipRef> {
    let of_class = files.iter().filter(|file| file.class == Some(class));
    of_class.map(clip).collect()
}

fn template_file(folder: &Path, class: Class) -> PathBuf {
    folder.join(format!("{}.{}", class.name(), templates::TEXT_EXTENSION))
}

/// Whether they share at least half of the shorter one.
fn covers(span: &Range<usize>, label: &Range<usize>) -> bool {
    let shared = span
        .end
        .min(label.end)
        .saturating_sub(span.start.max(label.start));
    2 * shared >= span.len().min(label.len()).max(1)
}
