//! Contact sheets of libraries.

use std::collections::BTreeSet;
use std::path::{Component, Path};

use crate::failure::Failure;
use crate::library::Library;
use crate::output::count;
use crate::report::document::LibraryPage;
use crate::report::make::Maker;

/// All clips of a library as strips, with their motion while there is room.
///
/// # Errors
/// [`Failure::Input`] where the library is damaged.
pub fn page(maker: &mut Maker<'_>, library: &Library) -> Result<LibraryPage, Failure> {
    let clips = library.clips()?;
    let without = maker.builder.without_motion();
    let ids = maker.clips_of(clips.iter().map(|clip| clip.name.as_str()));
    let names: Vec<&str> = clips.iter().map(|clip| clip.name.as_str()).collect();
    let mut labels = BTreeSet::new();
    let folders = folder_labels(&names);
    for ((name, id), folder) in names.iter().zip(&ids).zip(folders) {
        let label = maker.how.labels.get(*name).cloned().or(folder);
        if let (Some(id), Some(label)) = (id, label) {
            maker.builder.label(*id, label.clone());
            labels.insert(label);
        }
    }
    let seconds = clips.iter().map(|clip| {
        let meta = &clip.meta;
        (meta.end_frame - meta.first_frame) as f64 / meta.source_rate
    });
    Ok(LibraryPage {
        path: library.dir.display().to_string(),
        set: library.features.set.name().to_owned(),
        rate: library.rate,
        n_clips: clips.len(),
        seconds: seconds.sum(),
        labels: labels.into_iter().collect(),
        note: note(
            ids.iter().filter(|id| id.is_none()).count(),
            maker.builder.without_motion() - without,
            maker.how.budget,
        ),
    })
}

/// Why clips cannot be played.
fn note(n_unread: usize, n_without: usize, budget: usize) -> Option<String> {
    let mut notes = Vec::new();
    if n_without > 0 {
        let megabytes = budget as f64 / 1e6;
        notes.push(format!(
            "{} shown by poses alone: more motion than --budget {megabytes} would be in this file; \
            motif view plays all",
            count(n_without, "clip")
        ));
    }
    if n_unread > 0 {
        notes.push(format!("{} could not be read", count(n_unread, "clip")));
    }
    (!notes.is_empty()).then(|| notes.join("; "))
}

/// For each clip the folder that tells it apart: the one below the folder that all have in common, if there are
/// several and every clip lies in one.
fn folder_labels(names: &[&str]) -> Vec<Option<String>> {
    let folders = names.iter().map(|name| {
        let parent = Path::new(name).parent().unwrap_or(Path::new(""));
        parent.components().collect::<Vec<Component<'_>>>()
    });
    let folders: Vec<Vec<Component<'_>>> = folders.collect();
    let Some(first) = folders.first() else {
        return Vec::new();
    };
    let shared = folders.iter().fold(first.len(), |shared, folder| {
        let pairs = folder.iter().zip(first).take(shared);
        pairs.take_while(|(a, b)| a == b).count()
    });
    let label = |folder: &Vec<Component<'_>>| {
        let own = folder.get(shared)?;
        Some(own.as_os_str().to_string_lossy().into_owned())
    };
    let labels: Vec<Option<String>> = folders.iter().map(label).collect();
    match labels.iter().all(Option::is_some) {
        true => labels,
        false => vec![None; names.len()],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_are_labels_where_every_clip_has_one() {
        let labels = folder_labels(&["d/walk/a.bvh", "d/walk/x/b.bvh", "d/run/c.bvh"]);
        let expected = ["walk", "walk", "run"].map(|label| Some(label.to_owned()));
        assert_eq!(labels, expected);
        assert_eq!(folder_labels(&["d/walk/a.bvh", "d/b.bvh"]), [None, None]);
        assert_eq!(
            folder_labels(&["d/walk/a.bvh", "d/walk/b.bvh"]),
            [None, None]
        );
        assert_eq!(folder_labels(&["a.bvh"]), [None]);
        assert!(folder_labels(&[]).is_empty());
    }
}
