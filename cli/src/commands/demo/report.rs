//! The tour as one page, with bundles of one performer's motions.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::{DemoSearch, STOPS};
use crate::args::MatchingArgs;
use crate::bundling::{Poses, What, bundle, load, save};
use crate::commands::align::AlignResult;
use crate::commands::report::{ReportResult, write};
use crate::corpus::Class;
use crate::corpus_files::ClipFile;
use crate::failure::Failure;
use crate::library::Library;
use crate::output::Voice;
use crate::recording::ReadOptions;
use crate::report::given::Given;
use crate::report::make::How;
use crate::report::results::{AlignRead, Read, SearchRead};
use crate::source::ClipRef;
use crate::templates;

/// Most bytes of motion in the page: a small one opens at once.
const BUDGET: usize = 4_000_000;

/// Kinds of motion that go over into each other, for bundles.
const BUNDLED: [Class; 4] = [Class::Walk, Class::Jog, Class::WalkBackwards, Class::Squat];

/// The page, and the bundles in it.
#[derive(Debug, Serialize)]
pub struct DemoReport {
    /// The bundles of a performer's motions.
    pub bundles: String,
    /// How many there are.
    pub n_bundles: usize,
    /// The page.
    #[serde(flatten)]
    pub page: ReportResult,
}

/// What the tour found.
pub(super) struct Toured<'a> {
    pub(super) files: &'a [ClipFile],
    pub(super) searches: &'a [DemoSearch],
    pub(super) templates: &'a Path,
    pub(super) alignment: &'a AlignResult,
}

impl DemoReport {
    /// Bundles motions, and writes the page of everything into `dir`.
    pub(super) fn new(
        dir: &Path,
        library: Library,
        toured: &Toured<'_>,
        voice: Voice,
    ) -> Result<DemoReport, Failure> {
        let options = ReadOptions::default();
        let file = dir.join("walks.mbg");
        let n_bundles = bundle_motions(toured.files, &file, &options)?;
        let results = toured.searches.iter();
        let results = results.filter_map(|one| SearchRead::of(&one.search));
        let searches = Read::Searches(results.collect());
        let alignment = AlignRead::of(toured.alignment).map(|read| Read::Alignment(Box::new(read)));
        let takes = toured.files.iter().filter(|file| file.class.is_none());
        let shown = STOPS.map(|stop| stop.class).into_iter().chain([Class::Hop]);
        let shown = shown.map(|class| {
            let name = format!("{}.{}", class.name(), templates::TEXT_EXTENSION);
            let path = toured.templates.join(name);
            templates::load(&path).map(|template| (path, template))
        });
        let results = std::iter::once(searches).chain(alignment);
        let how = How {
            options: &options,
            features: library.features.clone(),
            rate: library.rate,
            budget: BUDGET,
            matching: MatchingArgs::default(),
            labels: labels(toured.files),
            voice,
        };
        let given = Given {
            libraries: vec![library],
            clips: takes.take(1).map(clip).collect(),
            templates: shown.collect::<Result<_, _>>()?,
            bundles: vec![(file.clone(), load(&file)?)],
            results: results.map(|read| (PathBuf::new(), read)).collect(),
        };
        let (page, _) = write(
            &dir.join("report.html"),
            &given,
            "motif demo".to_owned(),
            &how,
        )?;
        Ok(DemoReport {
            bundles: file.display().to_string(),
            n_bundles,
            page,
        })
    }

    pub(super) fn tell(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(
            out,
            "\n{} motion bundles of one performer ({}), and two walks through them",
            self.n_bundles, self.bundles
        )?;
        writeln!(
            out,
            "\nEverything on one page, {:.1} MB; open it in a browser:\n  {}",
            self.page.bytes as f64 / 1e6,
            self.page.file
        )
    }
}

fn clip(file: &ClipFile) -> ClipRef {
    ClipRef {
        path: file.path.clone(),
        span: None,
    }
}

fn labels(files: &[ClipFile]) -> BTreeMap<String, String> {
    let labels = files.iter().map(|file| {
        let label = file.class.map_or("take", Class::name);
        (file.path.display().to_string(), label.to_owned())
    });
    labels.collect()
}

/// Bundles motions of the performer of the first clip, and gives the number of bundles.
fn bundle_motions(
    files: &[ClipFile],
    file: &Path,
    options: &ReadOptions,
) -> Result<usize, Failure> {
    let performer = files.first().and_then(|file| file.path.parent());
    let of_performer = files.iter().filter(|file| {
        let is_bundled = file.class.is_none_or(|class| BUNDLED.contains(&class));
        is_bundled && file.path.parent() == performer
    });
    let poses = of_performer.map(|file| Poses::read(&clip(file), options));
    let poses: Vec<Poses> = poses.collect::<Result<_, _>>()?;
    let bundled = bundle(&poses, &What::new(None))?;
    save(&bundled, file)?;
    Ok(bundled.model.graph().bundles().len())
}
