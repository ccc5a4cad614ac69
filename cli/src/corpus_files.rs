//! The built-in corpus as real files.
//!
//! Performers recorded at 120 Hz, the rate of Acclaim files, become ASF/AMC, the others BVH in
//! centimetres: `anna/anna.asf`, `anna/walk_01.amc`, `eva/walk_01.bvh`. `labels.csv` says which
//! frames show what.

use std::fs;
use std::path::{Path, PathBuf};

use mocap_io::{AngleUnit, Asf, LengthUnit, Motion, WriteError, write_amc, write_asf, write_bvh};
use rayon::prelude::*;

use crate::corpus::{Class, Label, Performer, Recording, plan};
use crate::failure::Failure;
use crate::output::Voice;

/// Steps per degree and unit of length in the files: a ten-thousandth is far below the sensor noise,
/// and real files have no more digits.
const STEPS: f64 = 1e4;

/// The rate that readers take an AMC file to have, since it cannot say.
const ACCLAIM_HZ: f64 = 120.0;

/// A file of the corpus and its ground truth.
#[derive(Clone, Debug)]
pub struct ClipFile {
    /// The motion file.
    pub path: PathBuf,
    /// What it shows; `None` for a take of several classes.
    pub class: Option<Class>,
    /// Which frames show what.
    pub labels: Vec<Label>,
}

/// Makes the corpus of a seed and writes it below `dir`, in parallel. The same seed gives the same
/// bytes.
///
/// # Errors
/// [`Failure::Io`].
pub fn write_corpus(dir: &Path, seed: u64, voice: Voice) -> Result<Vec<ClipFile>, Failure> {
    let recordings = plan();
    for performer in Performer::ALL {
        let folder = dir.join(performer.name);
        fs::create_dir_all(&folder).map_err(|e| Failure::io(&folder, e))?;
        let mut clips = recordings.iter().filter(|r| r.performer() == performer);
        if let (true, Some(first)) = (performer.rate_hz == ACCLAIM_HZ, clips.next()) {
            let clip = first.clip(seed).map_err(|e| Failure::input(dir, e))?;
            write_skeleton(dir, performer, &clip.motion)?;
        }
    }
    let bar = voice.progress(recordings.len(), "performing");
    let files: Result<Vec<ClipFile>, Failure> = recordings
        .par_iter()
        .with_max_len(1)
        .map(|recording| {
            let file = write_clip(dir, recording, seed);
            bar.inc(1);
            file
        })
        .collect();
    bar.finish_and_clear();
    let files = files?;
    write_labels(dir, &files)?;
    Ok(files)
}

fn write_clip(dir: &Path, recording: &Recording, seed: u64) -> Result<ClipFile, Failure> {
    let clip = recording.clip(seed).map_err(|e| Failure::input(dir, e))?;
    let stem = dir.join(&clip.name);
    let path = if clip.performer.rate_hz == ACCLAIM_HZ {
        let path = stem.with_extension("amc");
        write(&path, |bytes| write_amc(&rounded(&clip.motion), bytes))?;
        path
    } else {
        let path = stem.with_extension("bvh");
        let motion = clip
            .motion
            .to_parent_offsets()
            .in_unit(LengthUnit::CENTIMETRE);
        write(&path, |bytes| write_bvh(&rounded(&motion), bytes))?;
        path
    };
    Ok(ClipFile {
        path,
        class: clip.class,
        labels: clip.labels,
    })
}

fn write_skeleton(dir: &Path, performer: Performer, motion: &Motion) -> Result<(), Failure> {
    let asf = Asf {
        name: performer.name.to_owned(),
        skeleton: motion.skeleton.clone(),
        unit: motion.unit,
        angle_unit: AngleUnit::Degrees,
        warnings: Vec::new(),
    };
    let path = dir
        .join(performer.name)
        .join(performer.name)
        .with_extension("asf");
    write(&path, |bytes| write_asf(&asf, bytes))
}

fn rounded(motion: &Motion) -> Motion {
    let mut motion = motion.clone();
    motion
        .channels
        .mapv_inplace(|v| (v * STEPS).round() / STEPS);
    motion
}

fn write(
    path: &Path,
    encode: impl FnOnce(&mut Vec<u8>) -> Result<(), WriteError>,
) -> Result<(), Failure> {
    let mut bytes = Vec::new();
    encode(&mut bytes).map_err(|e| match e {
        WriteError::Io(source) => Failure::io(path, source),
        other => Failure::input(path, other),
    })?;
    fs::write(path, bytes).map_err(|e| Failure::io(path, e))
}

/// A row per label: clip, class, first frame, end.
fn write_labels(dir: &Path, files: &[ClipFile]) -> Result<(), Failure> {
    let path = dir.join("labels.csv");
    let fail = |e: csv::Error| Failure::io(&path, e.into());
    let mut csv = csv::Writer::from_path(&path).map_err(fail)?;
    csv.write_record(["clip", "class", "start", "end"])
        .map_err(fail)?;
    for file in files {
        let clip = file
            .path
            .strip_prefix(dir)
            .unwrap_or(&file.path)
            .display()
            .to_string();
        for label in &file.labels {
            let (start, end) = (label.span.start.to_string(), label.span.end.to_string());
            csv.write_record([&clip, label.class.name(), &start, &end])
                .map_err(fail)?;
        }
    }
    csv.flush().map_err(|e| Failure::io(&path, e))
}
