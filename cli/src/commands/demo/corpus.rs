//! The files of the tour and what they show.

use std::path::{Path, PathBuf};

use super::{DemoSearch, Stop};
use crate::commands::search::{HitJson, What, search};
use crate::corpus::{Class, Label};
use crate::corpus_files::ClipFile;
use crate::failure::Failure;
use crate::library::Library;
use crate::output::Voice;
use crate::recording::ReadOptions;
use crate::source::ClipRef;

/// The files of the tour with their labels.
pub(super) struct Corpus {
    pub(super) dir: PathBuf,
    pub(super) files: Vec<ClipFile>,
}

impl Corpus {
    pub(super) fn ask(
        &self,
        library: &Library,
        stop: &Stop,
        voice: Voice,
    ) -> Result<DemoSearch, Failure> {
        let example = self.files.iter().find(|f| f.class == Some(stop.class));
        let example = example.ok_or_else(|| Failure::input(&self.dir, "a class without a clip"))?;
        let features: Vec<String> = stop.features.iter().map(|&f| f.to_owned()).collect();
        let what = What::new(&features);
        let clip = ClipRef {
            path: example.path.clone(),
            span: None,
        };
        let search = search(library, &clip, &what, &ReadOptions::default(), voice)?;
        let performances: Vec<(&Path, &Label)> = self
            .files
            .iter()
            .flat_map(|f| f.labels.iter().map(|label| (f.path.as_path(), label)))
            .filter(|(_, label)| label.class == stop.class)
            .collect();
        let is_found = |path: &Path, label: &Label| {
            search
                .hits
                .iter()
                .any(|h| Path::new(&h.clip) == path && covers(h, label))
        };
        let found = performances
            .iter()
            .filter(|(path, label)| is_found(path, label))
            .count();
        let wrong = search
            .hits
            .iter()
            .filter(|h| self.label(h, stop.class).is_none())
            .count();
        Ok(DemoSearch {
            class: stop.class.name(),
            performances: performances.len(),
            found,
            wrong,
            search,
        })
    }

    pub(super) fn file(&self, clip: &str) -> Option<&ClipFile> {
        self.files.iter().find(|f| f.path == Path::new(clip))
    }

    /// The label of this class that the hit covers.
    fn label(&self, hit: &HitJson, class: Class) -> Option<&Label> {
        let labels = &self.file(&hit.clip)?.labels;
        labels.iter().find(|l| l.class == class && covers(hit, l))
    }

    /// What the hit shows: the label that it shares most frames with.
    pub(super) fn shows(&self, hit: &HitJson) -> &'static str {
        let labels = self.file(&hit.clip).map_or(&[][..], |f| &f.labels);
        let best = labels.iter().max_by_key(|l| shared(hit, l));
        best.filter(|l| shared(hit, l) > 0)
            .map_or("-", |l| l.class.name())
    }

    /// The clip's path as it is read in tables.
    pub(super) fn short(&self, clip: &str) -> String {
        let path = Path::new(clip);
        path.strip_prefix(&self.dir)
            .unwrap_or(path)
            .display()
            .to_string()
    }
}

/// Frames that hit and label share.
fn shared(hit: &HitJson, label: &Label) -> usize {
    let start = hit.start.max(label.span.start);
    hit.end.min(label.span.end).saturating_sub(start)
}

/// Whether hit and label share at least half of the shorter one.
fn covers(hit: &HitJson, label: &Label) -> bool {
    let shorter = (hit.end - hit.start).min(label.span.len());
    2 * shared(hit, label) >= shorter.max(1)
}
