//! What a report is made of, told apart.

use std::path::{Path, PathBuf};

use mtemplate::ClassTemplate;

use super::results::{self, Read};
use crate::bundling::{Bundled, load as load_bundles};
use crate::failure::Failure;
use crate::library::Library;
use crate::source::{ClipRef, find_clips};
use crate::templates::{self, BINARY_EXTENSION, TEXT_EXTENSION};

/// Everything named on a command line.
#[derive(Debug, Default)]
pub struct Given {
    /// Libraries.
    pub libraries: Vec<Library>,
    /// Motion files.
    pub clips: Vec<ClipRef>,
    /// Templates, with their files.
    pub templates: Vec<(PathBuf, ClassTemplate)>,
    /// Bundles, with their files.
    pub bundles: Vec<(PathBuf, Bundled)>,
    /// What other commands found, with their files.
    pub results: Vec<(PathBuf, Read)>,
}

impl Given {
    /// Tells paths apart: a folder that holds a library is one, of any other folder the clips and the templates
    /// count; files go by their endings, motion files by their content as well.
    ///
    /// # Errors
    /// [`Failure`] for a path that cannot be read as what it seems to be.
    pub fn read(paths: &[PathBuf]) -> Result<Given, Failure> {
        let mut given = Given::default();
        for path in paths {
            given.add(path)?;
        }
        Ok(given)
    }

    fn add(&mut self, path: &Path) -> Result<(), Failure> {
        let ends = |extension: &str| {
            let own = path.extension();
            own.is_some_and(|own| own.eq_ignore_ascii_case(extension))
        };
        if path.is_dir() && Library::exists(path) {
            self.libraries.push(Library::open(path)?);
        } else if path.is_dir() {
            self.clips.extend(find_clips(&[path.to_owned()])?);
            self.templates.extend(templates::load_folder(path)?);
        } else if ends(TEXT_EXTENSION) || ends(BINARY_EXTENSION) || ends("toml") {
            self.templates
                .push((path.to_owned(), templates::load(path)?));
        } else if ends("mbg") {
            self.bundles.push((path.to_owned(), load_bundles(path)?));
        } else if ends("json") {
            self.results.push((path.to_owned(), results::read(path)?));
        } else {
            self.clips.extend(find_clips(&[path.to_owned()])?);
        }
        Ok(())
    }

    /// What the page is called unless it is given a name.
    #[must_use]
    pub fn title(paths: &[PathBuf]) -> String {
        let name = |path: &PathBuf| {
            let name = path.file_name().unwrap_or(path.as_os_str());
            name.to_string_lossy().into_owned()
        };
        match paths {
            [] => "motif".to_owned(),
            [one] => name(one),
            [first, .., last] if paths.len() == 2 => format!("{} and {}", name(first), name(last)),
            [first, rest @ ..] => format!("{} and {} more", name(first), rest.len()),
        }
    }
}
