//! Which clips there are.

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fs;
use std::io::Read;
use std::ops::Range;
use std::path::{Path, PathBuf};

use walkdir::WalkDir;

use crate::failure::Failure;
use crate::recording::unknown_format;

/// A clip as named on the command line: a file, and perhaps a span of its frames.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct ClipRef {
    /// The file.
    pub path: PathBuf,
    /// Frames of the file, 0-based, end exclusive.
    pub span: Option<Span>,
}

/// Frames of a file, 0-based, end exclusive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Span {
    /// First frame.
    pub start: usize,
    /// One past the last frame.
    pub end: usize,
}

impl Span {
    /// As a range.
    #[must_use]
    pub fn range(self) -> Range<usize> {
        self.start..self.end
    }
}

/// A file format that clips come in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Biovision hierarchy.
    Bvh,
    /// Acclaim motion, with its skeleton in an ASF file.
    Amc,
    /// Markers.
    C3d,
    /// Acclaim skeleton, which has no motion.
    Asf,
}

impl Format {
    /// By the file name's extension, in any case.
    #[must_use]
    pub fn of(path: &Path) -> Option<Format> {
        if has_extension(path, "bvh") {
            Some(Format::Bvh)
        } else if has_extension(path, "amc") {
            Some(Format::Amc)
        } else if has_extension(path, "c3d") {
            Some(Format::C3d)
        } else if has_extension(path, "asf") {
            Some(Format::Asf)
        } else {
            None
        }
    }

    /// By how the file begins, for files that go by another name.
    #[must_use]
    pub fn sniff(bytes: &[u8]) -> Option<Format> {
        if bytes.len() >= C3D_HEADER && bytes[0] > 1 && bytes[1] == C3D_KEY {
            return Some(Format::C3d);
        }
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        let mut lines = bytes
            .split(|b| matches!(b, b'\n' | b'\r'))
            .map(<[u8]>::trim_ascii)
            .filter(|line| !line.is_empty() && !line.starts_with(b"#"));
        let word = lines.next()?.split(u8::is_ascii_whitespace).next()?;
        let is = |keyword: &str| word.eq_ignore_ascii_case(keyword.as_bytes());
        if is("HIERARCHY") {
            Some(Format::Bvh)
        } else if is(":FULLY-SPECIFIED") || is(":DEGREES") || is(":RADIANS") {
            Some(Format::Amc)
        } else if is(":version") || is(":name") || is(":units") {
            Some(Format::Asf)
        } else {
            None
        }
    }

    /// Whether files of this format hold motion.
    #[must_use]
    pub fn is_clip(self) -> bool {
        self != Format::Asf
    }

    /// The usual name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Format::Bvh => "BVH",
            Format::Amc => "ASF/AMC",
            Format::C3d => "C3D",
            Format::Asf => "ASF",
        }
    }
}

/// Length of the header of a C3D file, and the byte that follows the pointer at its start.
const C3D_HEADER: usize = 512;
const C3D_KEY: u8 = 0x50;

fn has_extension(path: &Path, extension: &str) -> bool {
    path.extension()
        .is_some_and(|e| e.eq_ignore_ascii_case(extension))
}

impl ClipRef {
    /// Reads `walk.bvh` or `walk.bvh@120-360`. A file that has the whole text as its name wins.
    ///
    /// # Errors
    /// [`Failure::Usage`] for a span that is no span.
    pub fn parse(text: &OsStr) -> Result<ClipRef, Failure> {
        let whole = |span| ClipRef {
            path: PathBuf::from(text),
            span,
        };
        let Some((path, span)) = text.to_str().and_then(|t| t.rsplit_once('@')) else {
            return Ok(whole(None));
        };
        if Path::new(text).exists() {
            return Ok(whole(None));
        }
        let ends = span
            .split_once('-')
            .and_then(|(a, b)| Some((a.parse().ok()?, b.parse().ok()?)));
        match ends {
            Some((start, end)) if start < end => Ok(ClipRef {
                path: PathBuf::from(path),
                span: Some(Span { start, end }),
            }),
            _ => Err(Failure::Usage(format!(
                "expected a span such as @120-360 (first frame, end), found @{span} in {}",
                Path::new(text).display()
            ))),
        }
    }

    /// The path and the span as on the command line.
    #[must_use]
    pub fn display(&self) -> String {
        match self.span {
            None => self.path.display().to_string(),
            Some(s) => format!("{}@{}-{}", self.path.display(), s.start, s.end),
        }
    }
}

/// All clips below the given files and folders: in the given order, folders in order of file names,
/// each clip once.
///
/// # Errors
/// [`Failure::Usage`] for a file of an unknown format or a folder with a span; [`Failure::Io`] for a
/// path that does not exist or a folder that cannot be listed.
pub fn find_clips(paths: &[PathBuf]) -> Result<Vec<ClipRef>, Failure> {
    let mut clips = Vec::new();
    let mut seen = BTreeSet::new();
    for path in paths {
        let clip = ClipRef::parse(path.as_os_str())?;
        let file_type = fs::metadata(&clip.path).map_err(|e| Failure::io(&clip.path, e))?;
        if file_type.is_dir() {
            if clip.span.is_some() {
                let message = format!(
                    "{} is a folder; only a file can have a span",
                    clip.path.display()
                );
                return Err(Failure::Usage(message));
            }
            for entry in WalkDir::new(&clip.path)
                .follow_links(true)
                .sort_by_file_name()
            {
                let entry = entry.map_err(|e| {
                    let at = e.path().unwrap_or(&clip.path).to_owned();
                    Failure::io(&at, e.into())
                })?;
                if entry.file_type().is_file()
                    && Format::of(entry.path()).is_some_and(Format::is_clip)
                {
                    let (path, span) = (entry.into_path(), None);
                    if seen.insert((path.clone(), span)) {
                        clips.push(ClipRef { path, span });
                    }
                }
            }
        } else if Format::of(&clip.path).is_none() && sniff_file(&clip.path)?.is_none() {
            return Err(Failure::Usage(unknown_format(&clip.path)));
        } else if seen.insert((clip.path.clone(), clip.span)) {
            clips.push(clip);
        }
    }
    Ok(clips)
}

/// Bytes in which a file that goes by another name must show what it is.
const HEAD_LEN: u64 = 4096;

fn sniff_file(path: &Path) -> Result<Option<Format>, Failure> {
    let file = fs::File::open(path).map_err(|e| Failure::io(path, e))?;
    let mut head = Vec::new();
    file.take(HEAD_LEN)
        .read_to_end(&mut head)
        .map_err(|e| Failure::io(path, e))?;
    Ok(Format::sniff(&head))
}

/// The skeleton of an AMC file: `given`, else in its folder the ASF file of the same stem, the one
/// that shares the longest beginning of its name, or the only one.
///
/// # Errors
/// [`Failure::Input`] if there is none, or if several fit equally well.
pub fn find_asf(amc: &Path, given: Option<&Path>) -> Result<PathBuf, Failure> {
    if let Some(given) = given {
        return Ok(given.to_owned());
    }
    let folder = match amc.parent() {
        Some(p) if !p.as_os_str().is_empty() => p,
        _ => Path::new("."),
    };
    let entries = fs::read_dir(folder).map_err(|e| Failure::io(folder, e))?;
    let mut skeletons: Vec<PathBuf> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| has_extension(path, "asf"))
        .collect();
    skeletons.sort();
    let stem = stem(amc);
    let shared = |path: &PathBuf| {
        let other = self::stem(path);
        let n = stem
            .iter()
            .zip(&other)
            .take_while(|(a, b)| a.eq_ignore_ascii_case(b))
            .count();
        // The same stem beats any longer one that begins with it.
        (n, n == stem.len() && n == other.len())
    };
    match skeletons.as_slice() {
        [] => {
            return Err(Failure::input(
                amc,
                "expected an .asf file in the same folder, found none",
            ));
        }
        [only] => return Ok(only.clone()),
        _ => {}
    }
    let best = skeletons.iter().map(shared).max().unwrap_or_default();
    if best.0 == 0 {
        let n = skeletons.len();
        let message = format!(
            "no name of the {n} .asf files beside it begins alike; name the skeleton with --asf"
        );
        return Err(Failure::input(amc, message));
    }
    let mut fitting = skeletons.iter().filter(|s| shared(s) == best);
    match (fitting.next(), fitting.next()) {
        (Some(skeleton), None) => Ok(skeleton.clone()),
        (Some(a), Some(b)) => Err(Failure::input(
            amc,
            format!(
                "{} and {} fit equally well; name the skeleton with --asf",
                a.display(),
                b.display()
            ),
        )),
        _ => Err(Failure::input(amc, "expected an .asf file, found none")),
    }
}

fn stem(path: &Path) -> Vec<u8> {
    path.file_stem()
        .map_or(Vec::new(), |s| s.as_encoded_bytes().to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(names: &[&str]) -> tempfile::TempDir {
        let dir = tempfile::tempdir().unwrap();
        for name in names {
            fs::write(dir.path().join(name), "").unwrap();
        }
        dir
    }

    #[track_caller]
    fn check_asf(names: &[&str], amc: &str, expected: Option<&str>) {
        let dir = folder(names);
        let found = find_asf(&dir.path().join(amc), None).ok();
        assert_eq!(found, expected.map(|e| dir.path().join(e)));
    }

    #[test]
    fn skeletons_are_found_by_name() {
        check_asf(&["02.asf", "03.asf"], "02_01.amc", Some("02.asf"));
        check_asf(
            &["HDM_bd.asf", "HDM_bk.asf"],
            "HDM_bk_squat.amc",
            Some("HDM_bk.asf"),
        );
        check_asf(
            &["Forrest.ASF", "02.asf"],
            "Forrest.Walking.AMC",
            Some("Forrest.ASF"),
        );
        check_asf(&["walk.asf", "walk_fast.asf"], "walk.amc", Some("walk.asf"));
        check_asf(&["other.asf"], "walk.amc", Some("other.asf"));
        check_asf(&["a_1.asf", "a_2.asf"], "a_3.amc", None);
        check_asf(&[], "walk.amc", None);
    }

    #[test]
    fn spans_are_read_and_refused() {
        let parse = |t: &str| ClipRef::parse(OsStr::new(t)).ok();
        let clip = parse("walk.bvh@120-360").unwrap();
        assert_eq!(clip.path, Path::new("walk.bvh"));
        assert_eq!(
            clip.span,
            Some(Span {
                start: 120,
                end: 360
            })
        );
        assert_eq!(clip.display(), "walk.bvh@120-360");
        assert_eq!(parse("walk.bvh").unwrap().span, None);
        assert_eq!(parse("walk.bvh@360-120"), None);
        assert_eq!(parse("walk.bvh@5-5"), None);
        assert_eq!(parse("walk.bvh@x"), None);
    }

    #[test]
    fn folders_are_walked_in_order_and_each_clip_counts_once() {
        let dir = folder(&["b.bvh", "a.AMC", "a.asf", "notes.txt"]);
        let file = dir.path().join("b.bvh");
        let clips = find_clips(&[file.clone(), dir.path().to_owned()]).unwrap();
        let paths: Vec<PathBuf> = clips.into_iter().map(|c| c.path).collect();
        assert_eq!(paths, [file, dir.path().join("a.AMC")]);
    }

    #[test]
    fn a_file_of_another_kind_is_refused() {
        let dir = folder(&["notes.txt"]);
        let failure = find_clips(&[dir.path().join("notes.txt")]).unwrap_err();
        assert!(matches!(failure, Failure::Usage(_)));
        let failure = find_clips(&[dir.path().join("nowhere")]).unwrap_err();
        assert!(matches!(failure, Failure::Io { .. }));
    }
}
