//! Labelled folders: a sub-folder for each class.

use std::fs;
use std::path::Path;

use crate::failure::Failure;
use crate::source::{ClipRef, find_clips};

/// A clip and the class that it shows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LabelledFile {
    /// The clip.
    pub file: ClipRef,
    /// 0-based index into the classes.
    pub class: usize,
}

/// Classes by name, and the clips of each.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Folders {
    /// Names of the sub-folders that hold clips, in alphabetical order.
    pub classes: Vec<String>,
    /// In order of class, then path.
    pub files: Vec<LabelledFile>,
}

impl Folders {
    /// The sub-folders of `dir` and the clips at any depth below them. Folders without clips are no
    /// classes; files beside them have no label and are left out.
    ///
    /// # Errors
    /// [`Failure::Io`] for a folder that cannot be listed, [`Failure::Usage`] if there are no clips in
    /// sub-folders.
    pub fn find(dir: &Path) -> Result<Folders, Failure> {
        let entries = fs::read_dir(dir).map_err(|e| Failure::io(dir, e))?;
        let mut below = Vec::new();
        for entry in entries {
            let path = entry.map_err(|e| Failure::io(dir, e))?.path();
            if path.is_dir() {
                below.push(path);
            }
        }
        below.sort();
        let mut folders = Folders::default();
        for path in below {
            let class = folders.classes.len();
            let clips = find_clips(std::slice::from_ref(&path))?;
            if clips.is_empty() {
                continue;
            }
            let name = path.file_name().unwrap_or_default();
            folders.classes.push(name.to_string_lossy().into_owned());
            let labelled = clips.into_iter().map(|file| LabelledFile { file, class });
            folders.files.extend(labelled);
        }
        if folders.files.is_empty() {
            return Err(Failure::Usage(format!(
                "{}: expected a sub-folder with clips for each class, found none",
                dir.display()
            )));
        }
        Ok(folders)
    }
}
