//! `motif library`.

use std::collections::BTreeSet;
use std::io;
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::index::Totals;
use crate::args::{Global, LibraryArgs, LibraryCommand};
use crate::failure::{Exit, Failure};
use crate::library::{ClipId, Library, OpenPart, OpenShard, Verified, Writer, verify};
use crate::output::{Outcome, Voice, count, table};
use crate::source::ClipRef;

/// What a library holds.
#[derive(Clone, Debug, Serialize)]
pub struct InfoResult {
    /// The library's folder.
    pub library: String,
    /// Name of the feature set.
    pub feature_set: String,
    /// Words per second.
    pub rate: f64,
    /// The clips that count.
    pub total: Totals,
    /// Bytes of all shards and their parts.
    pub bytes: u64,
    /// The shards in order.
    pub shards: Vec<ShardJson>,
}

/// A shard, with the clips that no longer count.
#[derive(Clone, Debug, Serialize)]
pub struct ShardJson {
    /// The file.
    pub file: String,
    /// Its length.
    pub bytes: u64,
    /// Clips.
    pub clips: usize,
    /// How many of them were removed or replaced.
    pub removed: usize,
    /// Segments.
    pub segments: usize,
    /// Different words.
    pub words: usize,
    /// The shards of the same clips under the features of one part each.
    pub parts: Vec<PartJson>,
}

/// The index of a part of the features.
#[derive(Clone, Debug, Serialize)]
pub struct PartJson {
    /// Name of the part.
    pub part: String,
    /// The file.
    pub file: String,
    /// Its length.
    pub bytes: u64,
    /// Segments.
    pub segments: usize,
    /// Different words.
    pub words: usize,
}

impl PartJson {
    fn new(open: &OpenPart) -> PartJson {
        PartJson {
            part: open.entry.name.clone(),
            file: open.entry.file.clone(),
            bytes: open.entry.len,
            segments: open.shard.n_segments(),
            words: open.shard.n_lists(),
        }
    }
}

impl ShardJson {
    fn new(open: &OpenShard) -> ShardJson {
        ShardJson {
            file: open.entry.file.clone(),
            bytes: open.entry.len,
            clips: open.shard.n_documents(),
            removed: open.entry.removed.len(),
            segments: open.shard.n_segments(),
            words: open.shard.n_lists(),
            parts: open.parts.iter().map(PartJson::new).collect(),
        }
    }
}

/// What was changed.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct ChangeResult {
    /// Clips that were removed.
    pub removed: usize,
    /// What is left.
    pub total: Totals,
    /// Shards before.
    pub shards_before: usize,
    /// Shards now.
    pub shards: usize,
    /// Bytes of all shards and their parts before.
    pub bytes_before: u64,
    /// Bytes of all shards and their parts now.
    pub bytes: u64,
}

/// Runs the command.
///
/// # Errors
/// [`Failure`].
pub fn run(args: &LibraryArgs, global: &Global) -> Result<Exit, Failure> {
    let voice = global.voice();
    match &args.command {
        LibraryCommand::Info(args) => {
            let outcome = outcome(info(&args.library)?);
            voice.report("library info", &outcome, |out| {
                write_info(out, &outcome.result)
            })
        }
        LibraryCommand::Verify(args) => report_verified(voice, verify(&args.library)?),
        LibraryCommand::Compact(args) => report_change(voice, "compact", compact(&args.library)?),
        LibraryCommand::Remove(args) => {
            let result = remove(&args.library, &args.clips)?;
            report_change(voice, "remove", result)
        }
    }
}

fn outcome<R>(result: R) -> Outcome<R> {
    Outcome {
        result,
        skipped: Vec::new(),
        found: true,
    }
}

/// What the library in `dir` holds.
///
/// # Errors
/// [`Failure`] if it is missing or damaged.
pub fn info(dir: &Path) -> Result<InfoResult, Failure> {
    let library = Library::open(dir)?;
    Ok(InfoResult {
        library: dir.display().to_string(),
        feature_set: library.features.set.name().to_owned(),
        rate: library.rate,
        total: Totals::of(&library.clips()?),
        bytes: bytes_of(&library),
        shards: library.shards().iter().map(ShardJson::new).collect(),
    })
}

fn bytes_of(library: &Library) -> u64 {
    let shards = library.shards().iter().map(|open| &open.entry);
    shards
        .map(|entry| entry.len + entry.restrictions.iter().map(|part| part.len).sum::<u64>())
        .sum()
}

fn write_info(out: &mut dyn io::Write, info: &InfoResult) -> io::Result<()> {
    let InfoResult {
        library,
        feature_set,
        rate,
        total,
        bytes,
        shards,
    } = info;
    writeln!(out, "{library}: {feature_set}, {rate} words per second")?;
    writeln!(
        out,
        "{}, {} words, {} segments; {bytes} bytes in {}",
        count(total.clips, "clip"),
        total.words,
        total.segments,
        count(shards.len(), "shard")
    )?;
    let mut rows = table(&["shard", "bytes", "clips", "removed", "segments", "words"]);
    for shard in shards {
        let numbers = [shard.clips, shard.removed, shard.segments, shard.words];
        let mut row = vec![shard.file.clone(), shard.bytes.to_string()];
        row.extend(numbers.map(|n| n.to_string()));
        rows.add_row(row);
        for part in &shard.parts {
            let none = String::new;
            let (segments, words) = (part.segments.to_string(), part.words.to_string());
            let bytes = part.bytes.to_string();
            rows.add_row([part.file.clone(), bytes, none(), none(), segments, words]);
        }
    }
    match shards.is_empty() {
        true => Ok(()),
        false => writeln!(out, "{rows}"),
    }
}

fn report_verified(voice: Voice, result: Verified) -> Result<Exit, Failure> {
    let outcome = outcome(result);
    let verified = &outcome.result;
    let exit = voice.report("library verify", &outcome, |out| {
        for damage in &verified.damage {
            writeln!(out, "{}: {}", damage.path, damage.error)?;
        }
        let found = match verified.damage.len() {
            0 => "no damage".to_owned(),
            n => format!("{} damaged", count(n, "file")),
        };
        let files = count(verified.files, "file");
        writeln!(out, "{files} of {} bytes checked: {found}", verified.bytes)
    })?;
    Ok(match verified.damage.is_empty() {
        true => exit,
        false => Exit::Input,
    })
}

fn report_change(voice: Voice, command: &str, result: ChangeResult) -> Result<Exit, Failure> {
    let outcome = outcome(result);
    voice.report(&format!("library {command}"), &outcome, |out| {
        if result.removed > 0 {
            writeln!(out, "{} removed", count(result.removed, "clip"))?;
        }
        writeln!(
            out,
            "{} in {} of {} bytes; before: {} of {} bytes",
            count(result.total.clips, "clip"),
            count(result.shards, "shard"),
            result.bytes,
            count(result.shards_before, "shard"),
            result.bytes_before
        )
    })
}

/// Puts all shards into as few as the clips that count need.
///
/// # Errors
/// [`Failure`] if the library is missing, damaged, or being written.
pub fn compact(dir: &Path) -> Result<ChangeResult, Failure> {
    change(dir, |writer| writer.compact().map(|_| 0))
}

/// Removes the clips of these names, and those in folders of these names.
///
/// # Errors
/// [`Failure::Usage`] for a name that is no clip and no folder of clips; nothing is removed then.
pub fn remove(dir: &Path, names: &[PathBuf]) -> Result<ChangeResult, Failure> {
    change(dir, |writer| {
        let clips = writer.library().clips()?;
        let mut removed: BTreeSet<ClipId> = BTreeSet::new();
        for name in names {
            let is_named = |clip: &str| {
                let path = ClipRef::parse(clip.as_ref()).map(|clip| clip.path);
                Path::new(clip) == name || path.is_ok_and(|path| path.starts_with(name))
            };
            let named = clips.iter().filter(|clip| is_named(&clip.name));
            let ids: Vec<ClipId> = named.map(|clip| clip.id).collect();
            if ids.is_empty() {
                let message = format!("{} has no clip {}", dir.display(), name.display());
                return Err(Failure::Usage(message));
            }
            removed.extend(ids);
        }
        writer.commit(&removed)?;
        Ok(removed.len())
    })
}

/// Does `work`, which says how many clips it removed, and compares the library before and after.
fn change(
    dir: &Path,
    work: impl FnOnce(&mut Writer) -> Result<usize, Failure>,
) -> Result<ChangeResult, Failure> {
    let mut writer = Writer::open(dir)?;
    let before = writer.library();
    let (shards_before, bytes_before) = (before.shards().len(), bytes_of(before));
    let removed = work(&mut writer)?;
    let library = writer.library();
    Ok(ChangeResult {
        removed,
        total: Totals::of(&library.clips()?),
        shards_before,
        shards: library.shards().len(),
        bytes_before,
        bytes: bytes_of(library),
    })
}
