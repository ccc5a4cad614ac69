//! Template files: class templates as text (`.mtpl`) and in binary form (`.mtpb`).

use std::fs;
use std::path::{Path, PathBuf};

use mocap_io::Position;
use mtemplate::{ClassTemplate, FileError, Place};
use relfeat::FeatureSet;
use walkdir::WalkDir;

use crate::failure::Failure;
use crate::selection;
use crate::targets;

/// The usual ending of templates as text.
pub const TEXT_EXTENSION: &str = "mtpl";
/// The usual ending of templates in binary form.
pub const BINARY_EXTENSION: &str = "mtpb";

/// Reads a template, in either form; which one it is shows in its bytes. The features are those of the
/// built-in set that it names; of another set they are those that the file has.
///
/// # Errors
/// [`Failure`] with the path: a file that cannot be read, or is no template.
pub fn load(path: &Path) -> Result<ClassTemplate, Failure> {
    let bytes = fs::read(path).map_err(|e| Failure::io(path, e))?;
    ClassTemplate::from_bytes(&bytes, features_of).map_err(|error| refused(path, &error))
}

/// The features of a built-in set.
fn features_of(set: &str) -> Option<Vec<String>> {
    let set = FeatureSet::builtin(set)?;
    Some(selection::names(&set, set.all()))
}

fn refused(path: &Path, error: &FileError) -> Failure {
    let at = match error.at {
        Place::Text { line, column, byte } => Position::Text { line, column, byte },
        Place::Binary { byte } => Position::Binary { byte },
    };
    Failure::Input {
        path: path.to_owned(),
        at: Some(at),
        message: error.kind.to_string(),
    }
}

/// Reads templates: in the order of `paths`, those of a folder by file name. In a folder, files count
/// that end as template files do.
///
/// # Errors
/// As [`load`], for the first that fails; [`Failure::Usage`] if there are none.
pub fn load_all(paths: &[PathBuf]) -> Result<Vec<(PathBuf, ClassTemplate)>, Failure> {
    let mut templates = Vec::new();
    for path in paths {
        for file in files(path)? {
            let template = load(&file)?;
            templates.push((file, template));
        }
    }
    if templates.is_empty() {
        let paths: Vec<String> = paths.iter().map(|p| p.display().to_string()).collect();
        return Err(Failure::Usage(format!(
            "expected templates (.{TEXT_EXTENSION} or .{BINARY_EXTENSION}) in {}, found none",
            paths.join(", ")
        )));
    }
    Ok(templates)
}

/// Reads the templates of a folder, by file name; there may be none.
///
/// # Errors
/// As [`load`], for the first that fails.
pub fn load_folder(folder: &Path) -> Result<Vec<(PathBuf, ClassTemplate)>, Failure> {
    let files = files(folder)?.into_iter();
    let load = |file: PathBuf| load(&file).map(|template| (file, template));
    files.map(load).collect()
}

fn files(path: &Path) -> Result<Vec<PathBuf>, Failure> {
    let about = fs::metadata(path).map_err(|e| Failure::io(path, e))?;
    if !about.is_dir() {
        return Ok(vec![path.to_owned()]);
    }
    let mut files = Vec::new();
    for entry in WalkDir::new(path).follow_links(true).sort_by_file_name() {
        let entry = entry.map_err(|e| {
            let at = e.path().unwrap_or(path).to_owned();
            Failure::io(&at, e.into())
        })?;
        let is_template = has_extension(entry.path(), TEXT_EXTENSION)
            || has_extension(entry.path(), BINARY_EXTENSION);
        if entry.file_type().is_file() && is_template {
            files.push(entry.into_path());
        }
    }
    Ok(files)
}

/// Writes a template: in binary form if the path ends with `.mtpb`, else as text.
///
/// # Errors
/// [`Failure`] with the path: a template whose parts do not fit, or a file that cannot be written.
pub fn save(template: &ClassTemplate, path: &Path) -> Result<(), Failure> {
    let bytes = if has_extension(path, BINARY_EXTENSION) {
        template.to_bytes()
    } else {
        template.to_text().map(String::into_bytes)
    };
    let bytes = bytes.map_err(|error| Failure::input(path, error))?;
    targets::write(path, &bytes)
}

/// Checks that a template is for the words of `set`, and lays it out over its features.
///
/// # Errors
/// [`Failure::Usage`] if it is for another set.
pub fn for_set(template: &ClassTemplate, set: &FeatureSet) -> Result<ClassTemplate, Failure> {
    if template.feature_set != set.name() {
        return Err(Failure::Usage(format!(
            "template {:?} is for the features of {}, not for those of {}",
            template.name,
            template.feature_set,
            set.name()
        )));
    }
    let names = selection::names(set, set.all());
    let laid_out = template.over(&names);
    laid_out.map_err(|e| Failure::Usage(format!("template {:?}: {e}", template.name)))
}

fn has_extension(path: &Path, extension: &str) -> bool {
    path.extension()
        .is_some_and(|e| e.eq_ignore_ascii_case(extension))
}

/// The name that a template has if it is given none: that of its file, without the extension.
#[must_use]
pub fn name_of(path: &Path) -> String {
    let stem = path.file_stem();
    stem.map_or_else(String::new, |stem| stem.to_string_lossy().into_owned())
}
