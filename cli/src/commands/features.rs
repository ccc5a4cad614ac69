//! `motif features`.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::ValueEnum;
use ndarray::Array2;
use ndarray_npy::WriteNpyExt;
use relfeat::{FeatureSet, source_frame};
use serde::Serialize;

use super::index::{DEFAULT_RATE, DEFAULT_SET};
use super::{tell_filled, tell_warnings};
use crate::args::{FeatureFormat, FeaturesArgs, Global};
use crate::failure::{Exit, Failure};
use crate::library::NamedSet;
use crate::output::{Outcome, count, table};
use crate::picture::heatmap::feature_heatmap;
use crate::selection;
use crate::source::{ClipRef, find_clips};
use crate::targets;
use crate::wire::{ClipWords, clip_words};

/// The words of a clip, as design.md §4 lays it down.
#[derive(Clone, Debug, Serialize)]
pub struct FeaturesJson {
    /// The file, with its span if one was asked for.
    pub clip: String,
    /// Words per second.
    pub rate: f64,
    /// Names of the features; name `i` is bit `i`.
    pub names: Vec<String>,
    /// One word per frame, in hexadecimal.
    pub words: Vec<String>,
    /// Features that the clip's rig lacks a body point for; their bits are 0.
    pub unavailable: Vec<String>,
    /// Gaps of markers that were filled, as asked.
    pub filled: usize,
}

/// Runs the command.
///
/// # Errors
/// [`Failure`] if nothing can be written.
pub fn run(args: &FeaturesArgs, global: &Global) -> Result<Exit, Failure> {
    let voice = global.voice();
    let named = NamedSet::find(args.set.set.as_deref().unwrap_or(DEFAULT_SET))?;
    let set = &named.set;
    let rate = args.set.rate.unwrap_or(DEFAULT_RATE);
    if !(rate > 0.0 && rate.is_finite()) {
        return Err(Failure::Usage(format!(
            "expected a positive --rate, found {rate}"
        )));
    }
    let clips = find_clips(&args.paths)?;
    let target = args
        .output
        .as_deref()
        .map(|path| Target::new(path, args.format, &clips));
    let target = target.transpose()?;
    let options = global.read_options()?;
    let (done, skipped) = voice.batch(&clips, "computing", |clip| {
        clip_words(clip, &options, set, rate)
    });
    tell_warnings(voice, done.iter().flat_map(|(_, c)| &c.warnings));
    tell_filled(voice, done.iter().map(|(_, c)| c.filled).sum());
    let matrices: Vec<Matrix<'_>> = done
        .iter()
        .map(|(clip, words)| Matrix {
            set,
            rate,
            clip,
            words,
        })
        .collect();
    let written = match target {
        Some(target) => target.write(&matrices)?,
        None => Vec::new(),
    };
    let outcome = Outcome {
        found: !done.is_empty(),
        result: matrices.iter().map(Matrix::to_json).collect::<Vec<_>>(),
        skipped,
    };
    voice.report("features", &outcome, |out| match written.as_slice() {
        [] => write_summary(out, set, &matrices),
        files => {
            for path in files {
                writeln!(out, "{}", path.display())?;
            }
            Ok(())
        }
    })
}

/// The features of one clip.
struct Matrix<'a> {
    set: &'a FeatureSet,
    rate: f64,
    clip: &'a ClipRef,
    words: &'a ClipWords,
}

impl Matrix<'_> {
    fn names(&self) -> Vec<String> {
        selection::names(self.set, self.set.all())
    }

    fn to_json(&self) -> FeaturesJson {
        FeaturesJson {
            clip: self.clip.display(),
            rate: self.rate,
            names: self.names(),
            words: self.words.words.iter().map(|w| format!("{w:#x}")).collect(),
            unavailable: selection::names(self.set, self.set.all() & !self.words.meta.available),
            filled: self.words.filled,
        }
    }

    /// Source frame of word `k` of the clip.
    fn frame(&self, k: usize) -> usize {
        let meta = &self.words.meta;
        source_frame(k + meta.first_word as usize, meta.source_rate, self.rate)
    }

    fn write_csv_rows(&self, csv: &mut csv::Writer<&mut dyn Write>) -> csv::Result<()> {
        let clip = self.clip.display();
        for (k, word) in self.words.words.iter().enumerate() {
            let frame = self.frame(k);
            let seconds = frame as f64 / self.words.meta.source_rate;
            csv.write_field(&clip)?;
            csv.write_field(frame.to_string())?;
            csv.write_field(format!("{seconds:.6}"))?;
            for bit in 0..self.set.features().len() {
                csv.write_field(if word >> bit & 1 == 1 { "1" } else { "0" })?;
            }
            csv.write_record(None::<&[u8]>)?;
        }
        Ok(())
    }

    fn to_array(&self) -> Array2<u8> {
        let words = &self.words.words;
        Array2::from_shape_fn((words.len(), self.set.features().len()), |(t, bit)| {
            u8::from(words[t] >> bit & 1 == 1)
        })
    }
}

/// Where the matrices go.
enum Target {
    /// All into one file.
    File(PathBuf, FeatureFormat),
    /// One file per clip, with these paths.
    Folder(Vec<(ClipRef, PathBuf)>, FeatureFormat),
}

impl Target {
    fn new(
        path: &Path,
        format: Option<FeatureFormat>,
        clips: &[ClipRef],
    ) -> Result<Target, Failure> {
        if targets::is_folder(path) {
            let format = format.unwrap_or(FeatureFormat::Csv);
            let paths = targets::file_per_clip(path, format.extension(), clips);
            let files = clips.iter().cloned().zip(paths).collect();
            return Ok(Target::Folder(files, format));
        }
        let format = format.or_else(|| by_extension(path)).ok_or_else(|| {
            Failure::Usage(format!(
                "{}: expected .csv, .npy, .json or .png, a folder, or --format",
                path.display()
            ))
        })?;
        let holds_one = matches!(format, FeatureFormat::Npy | FeatureFormat::Png);
        if holds_one && clips.len() > 1 {
            return Err(Failure::Usage(format!(
                "{} can hold one clip, there are {}; name a folder (with / at its end) and --format",
                path.display(),
                clips.len()
            )));
        }
        Ok(Target::File(path.to_owned(), format))
    }

    /// Writes everything and gives the files written.
    fn write(&self, matrices: &[Matrix<'_>]) -> Result<Vec<PathBuf>, Failure> {
        match self {
            Target::File(path, format) => {
                write_file(path, *format, matrices)?;
                Ok(vec![path.clone()])
            }
            Target::Folder(files, format) => {
                let mut written = Vec::new();
                for matrix in matrices {
                    let file = files.iter().find(|(clip, _)| clip == matrix.clip);
                    if let Some((_, path)) = file {
                        write_file(path, *format, std::slice::from_ref(matrix))?;
                        written.push(path.clone());
                    }
                }
                Ok(written)
            }
        }
    }
}

fn by_extension(path: &Path) -> Option<FeatureFormat> {
    let extension = path.extension()?.to_str()?;
    FeatureFormat::from_str(extension, true).ok()
}

fn write_file(path: &Path, format: FeatureFormat, matrices: &[Matrix<'_>]) -> Result<(), Failure> {
    let mut bytes: Vec<u8> = Vec::new();
    encode(&mut bytes, format, matrices).map_err(|e| Failure::io(path, e))?;
    targets::write(path, &bytes)
}

fn encode(out: &mut Vec<u8>, format: FeatureFormat, matrices: &[Matrix<'_>]) -> io::Result<()> {
    match (format, matrices) {
        (FeatureFormat::Csv, _) => {
            let mut csv = csv::Writer::from_writer(out as &mut dyn Write);
            if let Some(first) = matrices.first() {
                csv.write_record(
                    ["clip", "frame", "seconds"]
                        .into_iter()
                        .map(str::to_owned)
                        .chain(first.names()),
                )?;
            }
            for matrix in matrices {
                matrix.write_csv_rows(&mut csv)?;
            }
            csv.flush()
        }
        (FeatureFormat::Json, _) => {
            let all: Vec<FeaturesJson> = matrices.iter().map(Matrix::to_json).collect();
            serde_json::to_writer(&mut *out, &all)?;
            out.push(b'\n');
            Ok(())
        }
        (FeatureFormat::Npy, [one]) => one.to_array().write_npy(out).map_err(io::Error::other),
        (FeatureFormat::Png, [one]) => {
            let picture = feature_heatmap(&one.names(), &one.words.words, one.rate);
            out.extend(picture.to_png().map_err(io::Error::other)?);
            Ok(())
        }
        // The only clip could not be read.
        (FeatureFormat::Npy | FeatureFormat::Png, _) => {
            Err(io::Error::other("there is no clip to write"))
        }
    }
}

/// The share of the time that each feature is on.
fn write_summary(out: &mut dyn Write, set: &FeatureSet, matrices: &[Matrix<'_>]) -> io::Result<()> {
    let words = || matrices.iter().flat_map(|m| &m.words.words);
    let n_words = words().count();
    let clips = count(matrices.len(), "clip");
    writeln!(
        out,
        "{} in {clips}; share of the time that a feature is on:",
        count(n_words, "word")
    )?;
    let mut rows = table(&["number", "feature", "part", "on"]);
    for (bit, feature) in set.features().iter().enumerate() {
        let n_on = words().filter(|&w| w >> bit & 1 == 1).count();
        let share = 100.0 * n_on as f64 / n_words.max(1) as f64;
        rows.add_row([
            format!("F{}", bit + 1),
            feature.name.clone(),
            feature.set.clone(),
            format!("{share:.1} %"),
        ]);
    }
    writeln!(out, "{}", rows.trim_fmt())
}
