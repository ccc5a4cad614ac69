//! Where output files go.

use std::collections::BTreeSet;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

use crate::failure::Failure;
use crate::source::ClipRef;

/// Whether `path` names a folder: it is one, or ends with a slash.
#[must_use]
pub fn is_folder(path: &Path) -> bool {
    path.is_dir() || path.as_os_str().as_encoded_bytes().ends_with(b"/")
}

/// A path per clip below `folder`, in their order: the part of the clip's path behind what all clips
/// share, so that clips of the same name in different folders stay apart, with its span behind it.
/// `extension` is added.
#[must_use]
pub fn file_per_clip(folder: &Path, extension: &str, clips: &[ClipRef]) -> Vec<PathBuf> {
    let names = names_below(folder, clips).map(|mut name| {
        name.push(".");
        name.push(extension);
        PathBuf::from(name)
    });
    names.collect()
}

/// As [`file_per_clip`], but `extension` replaces the clip's own wherever that leaves all paths
/// different.
#[must_use]
pub fn file_per_clip_renamed(folder: &Path, extension: &str, clips: &[ClipRef]) -> Vec<PathBuf> {
    let stems = clips.iter().map(|clip| ClipRef {
        path: clip.path.with_extension(""),
        span: clip.span,
    });
    let stems: Vec<ClipRef> = stems.collect();
    let renamed = file_per_clip(folder, extension, &stems);
    let distinct: BTreeSet<&PathBuf> = renamed.iter().collect();
    if distinct.len() == renamed.len() {
        renamed
    } else {
        file_per_clip(folder, extension, clips)
    }
}

fn names_below(folder: &Path, clips: &[ClipRef]) -> impl Iterator<Item = OsString> {
    let mut shared = clips
        .first()
        .and_then(|c| c.path.parent())
        .unwrap_or(Path::new(""));
    while !clips.iter().all(|c| c.path.starts_with(shared)) {
        shared = shared.parent().unwrap_or(Path::new(""));
    }
    clips.iter().map(move |clip| {
        let below = clip.path.strip_prefix(shared).unwrap_or(&clip.path);
        let mut name = folder.join(below).into_os_string();
        if let Some(span) = clip.span {
            name.push(format!("@{}-{}", span.start, span.end));
        }
        name
    })
}

/// Writes a file whole, making its folder if need be.
///
/// # Errors
/// [`Failure::Io`].
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    if let Some(parent) = path.parent().filter(|p| !p.as_os_str().is_empty()) {
        fs::create_dir_all(parent).map_err(|e| Failure::io(parent, e))?;
    }
    fs::write(path, bytes).map_err(|e| Failure::io(path, e))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn clips(paths: &[&str]) -> Vec<ClipRef> {
        let clip = |path: &&str| ClipRef {
            path: PathBuf::from(path),
            span: None,
        };
        paths.iter().map(clip).collect()
    }

    #[test]
    fn clips_of_one_name_stay_apart() {
        let folder = Path::new("out");
        let found = file_per_clip(folder, "csv", &clips(&["in/a/x.bvh", "in/b/x.bvh"]));
        assert_eq!(
            found,
            [Path::new("out/a/x.bvh.csv"), Path::new("out/b/x.bvh.csv")]
        );
        let found = file_per_clip_renamed(folder, "csv", &clips(&["in/x.bvh", "in/y.1.amc"]));
        assert_eq!(found, [Path::new("out/x.csv"), Path::new("out/y.1.csv")]);
        let found = file_per_clip_renamed(folder, "csv", &clips(&["in/x.bvh", "in/x.amc"]));
        assert_eq!(
            found,
            [Path::new("out/x.bvh.csv"), Path::new("out/x.amc.csv")]
        );
        assert!(file_per_clip(folder, "csv", &[]).is_empty());
    }
}
