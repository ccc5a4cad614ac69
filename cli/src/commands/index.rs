//! `motif index`.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use mocap_io::Warning;
use rayon::prelude::*;
use serde::Serialize;

use super::{WarningJson, tell_filled, tell_warnings};
use crate::args::{Global, IndexArgs, SetArgs};
use crate::failure::{Exit, Failure, Skipped};
use crate::library::{Clip, ClipId, Library, NamedSet, Writer};
use crate::output::{Outcome, Voice, count};
use crate::recording::{Files, ReadOptions};
use crate::source::{ClipRef, find_clips};
use crate::wire::{ClipWords, StageTimes, words_of};

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
    /// Clips that were left as they are, since neither they nor the way they are read changed.
    pub unchanged: usize,
    /// Clips that were forgotten, since their files are gone.
    pub forgotten: usize,
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

/// Size of a library, without removed clips.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Totals {
    /// Clips.
    pub clips: usize,
    /// Words, one per frame of the library's rate.
    pub words: u64,
    /// Segments: runs of equal words.
    pub segments: usize,
}

impl Totals {
    /// Counts clips.
    #[must_use]
    pub fn of(clips: &[Clip]) -> Totals {
        Totals {
            clips: clips.len(),
            words: clips.iter().map(|clip| clip.n_words as u64).sum(),
            segments: clips.iter().map(|clip| clip.n_segments).sum(),
        }
    }
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
    /// Segments, inverted lists, and writing the library.
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
    let what = What {
        set: &args.set,
        sync: args.sync,
    };
    let outcome = index(
        &args.paths,
        &args.output,
        &what,
        &global.read_options()?,
        voice,
    )?;
    let done = &outcome.result;
    voice.report("index", &outcome, |out| {
        let mut notes = String::new();
        for (n, what) in [
            (done.replaced, "of them again"),
            (done.unchanged, "unchanged"),
            (done.forgotten, "forgotten"),
        ] {
            if n > 0 {
                notes.push_str(&format!(", {n} {what}"));
            }
        }
        writeln!(
            out,
            "{} with {} frames indexed{notes} in {:.2} s",
            count(done.clips, "clip"),
            done.frames,
            done.seconds.total
        )?;
        let t = done.total;
        writeln!(
            out,
            "{}: {}, {} words, {} segments",
            done.library,
            count(t.clips, "clip"),
            t.words,
            t.segments,
        )?;
        let s = done.seconds;
        writeln!(
            out,
            "seconds: read {:.3}, kinematics {:.3}, features {:.3}, write {:.3}",
            s.read, s.kinematics, s.features, s.write
        )
    })
}

/// How to index.
#[derive(Clone, Copy, Debug)]
pub struct What<'a> {
    /// Which features and how often.
    pub set: &'a SetArgs,
    /// Whether clips are forgotten whose files are gone.
    pub sync: bool,
}

/// Clips that are read in parallel before they are handed to the writer in their order: many enough
/// that threads seldom wait for each other, few enough to be in memory together.
const BATCH: usize = 256;

/// Builds or extends the library in `dir`: clips that are new or changed go into new shards, in the
/// order of [`find_clips`].
///
/// Memory: the words of some hundred clips and of one shard, whatever the number of clips.
///
/// # Errors
/// [`Failure`] if the library as a whole cannot be made; clips that cannot be read are listed in the
/// outcome.
pub fn index(
    paths: &[PathBuf],
    dir: &Path,
    what: &What<'_>,
    options: &ReadOptions,
    voice: Voice,
) -> Result<Outcome<IndexResult>, Failure> {
    let start = Instant::now();
    let mut writer = open_or_new(dir, what.set)?;
    let known = writer.library().clips()?;
    let gone = match what.sync {
        true => gone(paths, &known)?,
        false => BTreeSet::new(),
    };
    let there: Vec<PathBuf> = match gone.is_empty() {
        true => paths.to_vec(),
        // A file that is given and gone is no reason to stop: that is what is to be noticed.
        false => paths.iter().filter(|path| exists(path)).cloned().collect(),
    };
    let clips = find_clips(&there)?;
    let known: BTreeMap<&str, &Clip> = known.iter().map(|c| (c.name.as_str(), c)).collect();
    let mut tally = Tally::default();
    let bar = voice.progress(clips.len(), "indexing");
    for clips in clips.chunks(BATCH) {
        let library = writer.library();
        let read = |clip| {
            let words = read(clip, known.get(clip.display().as_str()), library, options);
            bar.inc(1);
            words
        };
        let batch: Vec<Result<Option<ClipWords>, Failure>> =
            clips.par_iter().with_max_len(1).map(read).collect();
        for (clip, words) in clips.iter().zip(batch) {
            tally.add(clip, words, &known, &mut writer)?;
        }
    }
    bar.finish_and_clear();
    let warnings = tell_warnings(voice, tally.warnings.iter());
    tell_filled(voice, tally.filled);

    let n_done = tally.clips + tally.unchanged;
    if n_done > 0 || !gone.is_empty() {
        let removed = tally.replaced.union(&gone).copied().collect();
        let write_start = Instant::now();
        writer.commit(&removed)?;
        tally.write += write_start.elapsed();
    }

    let result = IndexResult {
        library: dir.display().to_string(),
        clips: tally.clips,
        replaced: tally.replaced.len(),
        unchanged: tally.unchanged,
        forgotten: gone.len(),
        frames: tally.frames,
        total: Totals::of(&writer.library().clips()?),
        seconds: Seconds {
            read: tally.stages.read.as_secs_f64(),
            kinematics: tally.stages.kinematics.as_secs_f64(),
            features: tally.stages.features.as_secs_f64(),
            write: tally.write.as_secs_f64(),
            total: start.elapsed().as_secs_f64(),
        },
        filled: tally.filled,
        warnings,
    };
    Ok(Outcome {
        found: n_done > 0 || result.forgotten > 0,
        result,
        skipped: tally.skipped,
    })
}

/// The words of a clip, `None` if they are those that the library has already.
fn read(
    clip: &ClipRef,
    before: Option<&&Clip>,
    library: &Library,
    options: &ReadOptions,
) -> Result<Option<ClipWords>, Failure> {
    let start = Instant::now();
    let files = Files::read(&clip.path, options)?;
    let read = start.elapsed();
    if before.is_some_and(|before| before.meta.content == files.content(options)) {
        return Ok(None);
    }
    let mut words = words_of(clip, files, options, &library.features.set, library.rate)?;
    words.times.read += read;
    Ok(Some(words))
}

/// What became of the clips so far.
#[derive(Default)]
struct Tally {
    clips: usize,
    unchanged: usize,
    replaced: BTreeSet<ClipId>,
    frames: u64,
    filled: usize,
    warnings: Vec<(PathBuf, Warning)>,
    skipped: Vec<Skipped>,
    stages: StageTimes,
    write: Duration,
}

impl Tally {
    /// Hands the words of a clip to the writer.
    fn add(
        &mut self,
        clip: &ClipRef,
        words: Result<Option<ClipWords>, Failure>,
        known: &BTreeMap<&str, &Clip>,
        writer: &mut Writer,
    ) -> Result<(), Failure> {
        let words = match words {
            Ok(Some(words)) => words,
            Ok(None) => {
                self.unchanged += 1;
                return Ok(());
            }
            Err(failure) => {
                self.skipped.push(Skipped::new(&clip.path, &failure));
                return Ok(());
            }
        };
        let name = clip.display();
        self.clips += 1;
        self.replaced.extend(known.get(name.as_str()).map(|c| c.id));
        self.frames += words.meta.end_frame - words.meta.first_frame;
        self.filled += words.filled;
        self.stages.read += words.times.read;
        self.stages.kinematics += words.times.kinematics;
        self.stages.features += words.times.features;
        self.warnings.extend(words.warnings);
        let start = Instant::now();
        writer.push(&name, &words.meta, &words.words)?;
        self.write += start.elapsed();
        Ok(())
    }
}

/// The clips at or below `paths` whose files are not there any more.
fn gone(paths: &[PathBuf], known: &[Clip]) -> Result<BTreeSet<ClipId>, Failure> {
    let roots: Result<Vec<ClipRef>, Failure> = paths
        .iter()
        .map(|path| ClipRef::parse(path.as_os_str()))
        .collect();
    let roots = roots?;
    let is_below = |clip: &ClipRef| {
        let mut roots = roots.iter();
        roots.any(|root| match root.span {
            None => clip.path.starts_with(&root.path),
            Some(_) => clip == root,
        })
    };
    let mut gone = BTreeSet::new();
    for clip in known {
        let of_clip = ClipRef::parse(clip.name.as_ref())?;
        if is_below(&of_clip) && !of_clip.path.exists() {
            gone.insert(clip.id);
        }
    }
    Ok(gone)
}

/// Whether the file of a path on the command line is there.
fn exists(path: &Path) -> bool {
    ClipRef::parse(path.as_os_str()).is_ok_and(|clip| clip.path.exists())
}

/// The library in `dir`, or a new one if the folder is empty, missing, or was left unfinished.
fn open_or_new(dir: &Path, args: &SetArgs) -> Result<Writer, Failure> {
    let asked = args.set.as_deref().map(NamedSet::find).transpose()?;
    if let Some(rate) = args.rate.filter(|r| !(*r > 0.0 && r.is_finite())) {
        return Err(Failure::Usage(format!(
            "expected a positive --rate, found {rate}"
        )));
    }
    if Library::exists(dir) {
        let writer = Writer::open(dir)?;
        let library = writer.library();
        let other_set = asked.is_some_and(|set| set != library.features);
        if other_set || args.rate.is_some_and(|rate| rate != library.rate) {
            return Err(Failure::Usage(format!(
                "{} was built with {} at {} words per second; another set or rate needs another library",
                dir.display(),
                library.features.set.name(),
                library.rate
            )));
        }
        return Ok(writer);
    }
    if !Writer::may_create(dir) {
        let message = format!("{} is neither empty nor a library", dir.display());
        return Err(Failure::Usage(message));
    }
    let features = match asked {
        Some(set) => set,
        None => NamedSet::find(DEFAULT_SET)?,
    };
    Writer::create(dir, features, args.rate.unwrap_or(DEFAULT_RATE))
}
