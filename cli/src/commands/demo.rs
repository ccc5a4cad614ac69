//! `motif demo`.

mod alignment;
mod corpus;
mod pictures;
mod report;
mod templates;
mod told;

pub use alignment::DemoAlignment;
pub use report::DemoReport;
use report::Toured;
pub use templates::{DemoAnnotation, DemoTake};

use std::fs;
use std::io;
use std::path::Path;

use serde::Serialize;

use self::corpus::Corpus;
use self::pictures::write_picture;
use super::index::{self, IndexResult, index};
use super::search::SearchResult;
use crate::args::{DemoArgs, Global, SetArgs};
use crate::corpus::Class;
use crate::corpus_files::write_corpus;
use crate::failure::{Exit, Failure};
use crate::library::Library;
use crate::output::Outcome;
use crate::recording::ReadOptions;

/// The seed of the corpus unless another is asked for.
pub const SEED: u64 = 2006;

/// A search of the tour: an example, and what about it matters.
struct Stop {
    class: Class,
    features: &'static [&'static str],
    question: &'static str,
}

const STOPS: [Stop; 3] = [
    Stop {
        class: Class::Squat,
        features: &["rknee_bent", "lknee_bent", "vertical_extent_small"],
        question: "who bends both knees, gets low, and comes up again?",
    },
    Stop {
        class: Class::KickLeft,
        features: &["lfoot_raised", "lknee_bent"],
        question: "who bends the left knee and raises the left foot?",
    },
    Stop {
        class: Class::LieDown,
        features: &["spine_horizontal"],
        question: "whose spine becomes horizontal and stays so?",
    },
];

/// What the tour made and found.
#[derive(Debug, Serialize)]
pub struct DemoResult {
    /// Where everything is.
    pub dir: String,
    /// What was indexed.
    pub index: IndexResult,
    /// The searches.
    pub searches: Vec<DemoSearch>,
    /// The takes, labelled by templates.
    pub annotation: DemoAnnotation,
    /// Two walks, aligned.
    pub alignment: DemoAlignment,
    /// The pictures.
    pub pictures: Vec<String>,
    /// All of it on one page.
    pub report: DemoReport,
}

/// A search of the tour, and how it did against the corpus's labels.
#[derive(Debug, Serialize)]
pub struct DemoSearch {
    /// The class of the example.
    pub class: &'static str,
    /// Labelled performances of the class, in single clips and in takes.
    pub performances: usize,
    /// How many of them some hit covers.
    pub found: usize,
    /// Hits that cover none.
    pub wrong: usize,
    /// What was asked and all hits.
    pub search: SearchResult,
}

/// Runs the command.
///
/// # Errors
/// [`Failure`] if the folder cannot be written.
pub fn run(args: &DemoArgs, global: &Global) -> Result<Exit, Failure> {
    let voice = global.voice();
    let dir = match &args.dir {
        Some(dir) => dir.clone(),
        None => std::env::temp_dir().join("motif-demo"),
    };
    prepare(&dir)?;
    let corpus = Corpus {
        files: write_corpus(&dir.join("corpus"), args.seed, voice)?,
        dir: dir.join("corpus"),
    };
    let library_dir = dir.join("library");
    let what = index::What {
        set: &SetArgs::default(),
        sync: false,
    };
    let options = ReadOptions::default();
    let paths = [corpus.dir.clone()];
    let indexed = index(&paths, &library_dir, &what, &options, voice)?;
    let library = Library::open(&library_dir)?;
    let searches: Result<Vec<DemoSearch>, Failure> = STOPS
        .iter()
        .map(|stop| corpus.ask(&library, stop, voice))
        .collect();
    let searches = searches?;
    let strips = dir.join("strips.png");
    write_picture(&strips, &corpus.strips(&searches)?)?;
    let heatmap = dir.join("features.png");
    write_picture(&heatmap, &corpus.heatmap(&library)?)?;
    let templates = dir.join("templates");
    let annotation = DemoAnnotation::new(&corpus.files, &templates, voice)?;
    let template = dir.join("template.png");
    let squat = DemoAnnotation::picture(&templates, Class::Squat)?;
    write_picture(&template, &squat)?;
    let alignment = DemoAlignment::new(&corpus.files)?;
    let toured = Toured {
        files: &corpus.files,
        searches: &searches,
        templates: &templates,
        alignment: &alignment.result,
    };
    let report = DemoReport::new(&dir, library, &toured, voice)?;
    let outcome = Outcome {
        result: DemoResult {
            dir: dir.display().to_string(),
            index: indexed.result,
            report,
            searches,
            annotation,
            alignment,
            pictures: [&strips, &heatmap, &template]
                .map(|p| p.display().to_string())
                .to_vec(),
        },
        skipped: indexed.skipped,
        found: true,
    };
    let result = &outcome.result;
    voice.report("demo", &outcome, |out| corpus.tell(out, result))
}

/// Makes the folder of the tour. What an earlier tour left there is replaced; anything else is not
/// touched.
fn prepare(dir: &Path) -> Result<(), Failure> {
    let library = dir.join("library");
    let is_ours =
        library.join("library.toml").exists() && dir.join("corpus").join("labels.csv").exists();
    let has_content = fs::read_dir(dir).is_ok_and(|mut entries| entries.next().is_some());
    if is_ours {
        for old in [dir.join("corpus"), library, dir.join("templates")] {
            match fs::remove_dir_all(&old) {
                Err(e) if e.kind() != io::ErrorKind::NotFound => return Err(Failure::io(&old, e)),
                _ => {}
            }
        }
    } else if has_content {
        let message = format!(
            "{} is neither empty nor an earlier demo; choose another --dir",
            dir.display()
        );
        return Err(Failure::Usage(message));
    }
    fs::create_dir_all(dir).map_err(|e| Failure::io(dir, e))
}
