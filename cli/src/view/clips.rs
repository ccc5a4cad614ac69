//! The clips of the library as the page asks for them: by their number, never by a path.
//!
//! Files are those that the library names, and are drawn only while they are, byte for byte, what was indexed: a link
//! that leads elsewhere since then, or a file that was changed, shows nothing.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::sync::Arc;

use axum::body::Bytes;
use axum::http::StatusCode;

use super::answer::Refusal;
use super::cache::Cache;
use crate::failure::Failure;
use crate::library::{self, Library};
use crate::recording::{Files, ReadOptions};
use crate::report::clip::Drawn;
use crate::report::document::{Clip, Figure};
use crate::source::{ClipRef, Format, find_asf};
use crate::take::Take;

/// Bytes of motions that are kept.
const MOTIONS: usize = 64 << 20;

/// Bytes of strips that are kept: some ten thousand of them.
const STRIPS: usize = 32 << 20;

/// No file of a clip is larger; one that is is not what was indexed, unless somebody records for days.
const MAX_FILE: u64 = 1 << 30;

/// What a strip takes beside its text and the names of its points.
const STRIP_BYTES: usize = 1024;

/// Clips by their number, and what was read of them lately.
#[derive(Debug)]
pub(super) struct Clips {
    rows: Vec<Row>,
    by_name: BTreeMap<String, u32>,
    /// All labels, in order.
    pub(super) labels: Vec<String>,
    options: ReadOptions,
    /// Poses per second.
    rate: f64,
    strips: Cache<Sketch>,
    motions: Cache<Moving>,
}

/// A clip of the library.
#[derive(Debug)]
pub(super) struct Row {
    pub(super) clip: library::Clip,
    pub(super) label: Option<String>,
    pub(super) seconds: f64,
}

/// A clip with its strip, and its figure.
#[derive(Debug)]
pub(super) struct Sketch {
    pub(super) clip: Clip,
    pub(super) figure: Figure,
}

/// What is played of a clip.
#[derive(Debug)]
pub(super) struct Moving {
    pub(super) rate: f64,
    pub(super) frames: usize,
    pub(super) points: usize,
    pub(super) origin: [i32; 3],
    /// Little-endian 16-bit integers, shape `(frames, points, 3)`, millimetres.
    pub(super) bytes: Bytes,
    /// Of the file.
    pub(super) content: u64,
}

impl Clips {
    pub(super) fn new(library: &Library, options: ReadOptions) -> Result<Clips, Failure> {
        let rows: Vec<Row> = library.clips()?.into_iter().map(Row::new).collect();
        let names = rows.iter().map(|row| row.clip.name.clone());
        let mut labels: Vec<String> = rows.iter().filter_map(|row| row.label.clone()).collect();
        labels.sort_unstable();
        labels.dedup();
        Ok(Clips {
            by_name: names.zip(0..).collect(),
            rows,
            labels,
            options,
            rate: library.rate,
            strips: Cache::new(STRIPS),
            motions: Cache::new(MOTIONS),
        })
    }

    /// In the order of the library; a clip's place is its number.
    pub(super) fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// The clip of a number.
    pub(super) fn row(&self, id: u32) -> Result<&Row, Refusal> {
        let row = self.rows.get(id as usize);
        row.ok_or_else(|| {
            let n = self.rows.len();
            Refusal::missing(format!("expected a clip below {n}, found {id}"))
        })
    }

    /// The number of a clip of this name.
    pub(super) fn id(&self, name: &str) -> Option<u32> {
        self.by_name.get(name).copied()
    }

    pub(super) fn options(&self) -> &ReadOptions {
        &self.options
    }

    /// A clip with its strip.
    pub(super) fn sketch(&self, id: u32) -> Result<Arc<Sketch>, Refusal> {
        match self.strips.get(id) {
            Some(sketch) => Ok(sketch),
            None => Ok(self.draw(id)?.0),
        }
    }

    /// What is played of a clip.
    pub(super) fn moving(&self, id: u32) -> Result<Arc<Moving>, Refusal> {
        match self.motions.get(id) {
            Some(moving) => Ok(moving),
            None => Ok(self.draw(id)?.1),
        }
    }

    /// A clip as a page has it when its file cannot be drawn: what the library knows.
    pub(super) fn bare(&self, id: u32) -> Result<Sketch, Refusal> {
        let Row { clip, label, .. } = self.row(id)?;
        let meta = &clip.meta;
        Ok(Sketch {
            clip: Clip {
                id,
                name: clip.name.clone(),
                label: label.clone(),
                rate: meta.source_rate,
                start: meta.first_frame as usize,
                end: meta.end_frame as usize,
                rig: Some(meta.rig.clone()),
                figure: 0,
                strip: None,
                motion: None,
            },
            figure: Figure {
                points: Vec::new(),
                bones: Vec::new(),
            },
        })
    }

    /// Reads a clip, if its file is what was indexed.
    ///
    /// # Errors
    /// 404 if the file is gone, 409 if it is another one.
    pub(super) fn take(&self, id: u32) -> Result<Take, Refusal> {
        let library::Clip { name, meta, .. } = &self.row(id)?.clip;
        let changed = || {
            let error =
                format!("{name}: the file is not what was indexed; motif index reads it again");
            Refusal::new(StatusCode::CONFLICT, error)
        };
        let of_file = |failure: Failure| match failure {
            Failure::Io { .. } => Refusal::missing(format!("{name}: the file cannot be read")),
            // Whatever it says may come from another file.
            _ => changed(),
        };
        let clip = ClipRef::parse(name.as_ref()).map_err(of_file)?;
        let is_file = |path: &Path| match fs::metadata(path) {
            Ok(about) if about.is_file() && about.len() <= MAX_FILE => Ok(()),
            Ok(_) => Err(changed()),
            Err(e) => Err(of_file(Failure::io(path, e))),
        };
        is_file(&clip.path)?;
        if Format::of(&clip.path) == Some(Format::Amc) {
            let skeleton = find_asf(&clip.path, self.options.asf.as_deref()).map_err(of_file)?;
            is_file(&skeleton)?;
        }
        let files = Files::read(&clip.path, &self.options).map_err(of_file)?;
        if files.content(&self.options) != meta.content {
            return Err(changed());
        }
        Ok(Take::new(&clip, files, &self.options)?)
    }

    fn draw(&self, id: u32) -> Result<(Arc<Sketch>, Arc<Moving>), Refusal> {
        let row = self.row(id)?;
        let drawn = Drawn::of_take(&self.take(id)?, self.rate);
        let sketch = Sketch {
            // The figure is numbered where the clip is answered.
            clip: Clip {
                name: row.clip.name.clone(),
                ..drawn.to_clip(id, 0, row.label.clone())
            },
            figure: drawn.figure.clone(),
        };
        let millimetres = drawn.millimetres();
        let bytes = millimetres.values.iter().flat_map(|v| v.to_le_bytes());
        let (frames, points, _) = drawn.positions.dim();
        let moving = Moving {
            rate: drawn.rate,
            frames,
            points,
            origin: millimetres.origin,
            bytes: bytes.collect::<Vec<u8>>().into(),
            content: row.clip.meta.content,
        };
        let (sketch, moving) = (Arc::new(sketch), Arc::new(moving));
        self.strips
            .insert(id, Arc::clone(&sketch), sketch.n_bytes());
        let n_bytes = moving.bytes.len();
        self.motions.insert(id, Arc::clone(&moving), n_bytes);
        Ok((sketch, moving))
    }
}

impl Row {
    fn new(clip: library::Clip) -> Row {
        let meta = &clip.meta;
        Row {
            label: label(&clip.name),
            seconds: (meta.end_frame - meta.first_frame) as f64 / meta.source_rate,
            clip,
        }
    }
}

impl Sketch {
    fn n_bytes(&self) -> usize {
        let strip = self
            .clip
            .strip
            .as_ref()
            .map_or(0, |strip| strip.bytes.len());
        let points = &self.figure.points;
        let names: usize = points
            .iter()
            .map(|name| name.len() + size_of::<String>())
            .sum();
        let bones = size_of_val(&self.figure.bones[..]);
        STRIP_BYTES + self.clip.name.len() + strip + names + bones
    }
}

/// The folder that the file of a clip is in.
fn label(name: &str) -> Option<String> {
    let folder = Path::new(name).parent()?.file_name()?;
    Some(folder.to_string_lossy().into_owned())
}
