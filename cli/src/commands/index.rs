//! `motif index`.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use serde::Serialize;

use super::{WarningJson, tell_filled, tell_warnings};
use crate::args::{Global, IndexArgs, SetArgs};
use crate::failure::{Exit, Failure};
use crate::library::{Library, NamedSet};
use crate::output::{Outcome, Voice, count};
use crate::recording::ReadOptions;
use crate::source::find_clips;
use crate::wire::{ClipWords, StageTimes, clip_words};

/// Feature set and words per second of a new library.
pub(crate) const DEFAULT_SET: &str = relfeat::BUILTIN_SETS[0];
/// Words per second: the rate that the papers index at (spec.md a.1).
pub(crate) const DEFAULT_RATE: f64 = 30.0;

/// What was indexed.
#[derive(Clone, Debug, Serialize)]
pub struct IndexResult {
    /// The library's folder.
    pub library: String,
    /// Clips that were read now.
    pub clips: usize,
    /// How many of them replaced one of the same path.
    pub replaced: usize,
    /// Frames of the clips that were read now.
    pub frames: u64,
    /// The whole library.
    pub total: Totals,
    /// Where the time went.
    pub seconds: Seconds,
    /// Gaps of markers that were filled, as asked.
    pub filled: usize,
    /// What was odd in the files.
    pub warnings: Vec<WarningJson>,
}

/// Size of a library.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Totals {
    /// Clips.
    pub clips: usize,
    /// Words, one per frame of the library's rate.
    pub words: u64,
    /// Segments: runs of equal words.
    pub segments: usize,
    /// Inverted lists: different words.
    pub lists: usize,
}

/// Where the time went. The first three are summed over threads; `total` is time on the clock.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Seconds {
    /// Reading and parsing files.
    pub read: f64,
    /// Forward kinematics.
    pub kinematics: f64,
    /// Body maps, features, words.
    pub features: f64,
    /// Segments and inverted lists.
    pub segments: f64,
    /// Writing the library.
    pub write: f64,
    /// All of it.
    pub total: f64,
}

/// Runs the command.
///
/// # Errors
/// [`Failure`] if the library as a whole cannot be made.
pub fn run(args: &IndexArgs, global: &Global) -> Result<Exit, Failure> {
    let voice = global.voice();
    let outcome = index(
        &args.paths,
        &args.output,
        &args.set,
        &global.read_options()?,
        voice,
    )?;
    let done = &outcome.result;
    voice.report("index", &outcome, |out| {
        let replaced = match done.replaced {
            0 => String::new(),
            n => format!(", {n} of them again"),
        };
        writeln!(
            out,
            "{} with {} frames indexed{replaced} in {:.2} s",
            count(done.clips, "clip"),
            done.frames,
            done.seconds.total
        )?;
        let t = done.total;
        writeln!(
            out,
            "{}: {}, {} words, {} segments, {} different words",
            done.library,
            count(t.clips, "clip"),
            t.words,
            t.segments,
            t.lists
        )?;
        let s = done.seconds;
        writeln!(
            out,
            "seconds: read {:.3}, kinematics {:.3}, features {:.3}, segments {:.3}, write {:.3}",
            s.read, s.kinematics, s.features, s.segments, s.write
        )
    })
}

/// Builds or extends the library in `dir`.
///
/// # Errors
/// [`Failure`] if the library as a whole cannot be made; clips that cannot be read are listed in the
/// outcome.
pub fn index(
    paths: &[PathBuf],
    dir: &Path,
    set: &SetArgs,
    options: &ReadOptions,
    voice: Voice,
) -> Result<Outcome<IndexResult>, Failure> {
    let start = Instant::now();
    let clips = find_clips(paths)?;
    let mut library = open_or_new(dir, set)?;
    let (features, rate) = (&library.features.set, library.rate);
    let (done, skipped) = voice.batch(&clips, "indexing", |clip| {
        clip_words(clip, options, features, rate)
    });
    let warnings = tell_warnings(voice, done.iter().flat_map(|(_, c)| &c.warnings));
    let filled = done.iter().map(|(_, c)| c.filled).sum();
    tell_filled(voice, filled);
    let named: Vec<(String, ClipWords)> = done
        .into_iter()
        .map(|(clip, words)| (clip.display(), words))
        .collect();
    let mut stages = StageTimes::default();
    for (_, clip) in &named {
        stages.read += clip.times.read;
        stages.kinematics += clip.times.kinematics;
        stages.features += clip.times.features;
    }

    let segments_start = Instant::now();
    let (index, replaced) = library.with_clips(&named)?;
    let segments = segments_start.elapsed();

    let write_start = Instant::now();
    if !named.is_empty() {
        library.save(index)?;
    }
    let write = write_start.elapsed();

    let index = &library.index;
    let result = IndexResult {
        library: dir.display().to_string(),
        clips: named.len(),
        replaced,
        frames: named
            .iter()
            .map(|(_, c)| c.meta.end_frame - c.meta.first_frame)
            .sum(),
        total: Totals {
            clips: index.n_documents(),
            words: index.n_frames(),
            segments: index.n_segments(),
            lists: index.n_lists(),
        },
        seconds: Seconds {
            read: stages.read.as_secs_f64(),
            kinematics: stages.kinematics.as_secs_f64(),
            features: stages.features.as_secs_f64(),
            segments: segments.as_secs_f64(),
            write: write.as_secs_f64(),
            total: start.elapsed().as_secs_f64(),
        },
        filled,
        warnings,
    };
    Ok(Outcome {
        found: result.clips > 0,
        result,
        skipped,
    })
}

/// The library in `dir`, or a new one if the folder is empty, missing, or was left unfinished.
fn open_or_new(dir: &Path, args: &SetArgs) -> Result<Library, Failure> {
    let asked = args.set.as_deref().map(NamedSet::find).transpose()?;
    if let Some(rate) = args.rate.filter(|r| !(*r > 0.0 && r.is_finite())) {
        return Err(Failure::Usage(format!(
            "expected a positive --rate, found {rate}"
        )));
    }
    if Library::exists(dir) {
        let library = Library::open(dir)?;
        let other_set = asked.is_some_and(|set| set != library.features);
        if other_set || args.rate.is_some_and(|rate| rate != library.rate) {
            return Err(Failure::Usage(format!(
                "{} was built with {} at {} words per second; another set or rate needs another library",
                dir.display(),
                library.features.set.name(),
                library.rate
            )));
        }
        return Ok(library);
    }
    let is_foreign = fs::read_dir(dir).is_ok_and(|mut entries| entries.next().is_some())
        && !dir.join("library.toml").exists();
    if is_foreign {
        let message = format!("{} is neither empty nor a library", dir.display());
        return Err(Failure::Usage(message));
    }
    let features = match asked {
        Some(set) => set,
        None => NamedSet::find(DEFAULT_SET)?,
    };
    Ok(Library::new(
        dir,
        features,
        args.rate.unwrap_or(DEFAULT_RATE),
    ))
}
