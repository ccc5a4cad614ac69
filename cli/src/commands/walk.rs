//! `motif walk`.

mod way;

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

use bundles::{Piece, Submotion, Walk, WalkError};
use clap::ValueEnum;
use mocap_io::{FrameRate, LengthUnit, Motion, UpAxis, Warning};
use serde::Serialize;

use super::convert::{encode, is_same_file};
use super::tell_warnings;
use crate::args::{Global, MotionFormat, WalkArgs};
use crate::bundling::{BundleClip, Bundled, load as load_bundles};
use crate::failure::{Exit, Failure};
use crate::output::{Outcome, count};
use crate::recording::{Files, Loaded, ReadOptions, Recording, body_map, parse};
use crate::source::Format;
use crate::targets;
use crate::walking::{Contacts, WalkClip, WalkClips, footlock, play, sides, skate};

pub use way::ReachJson;

/// A walk that was written.
#[derive(Clone, Debug, Serialize)]
pub struct WalkJson {
    /// The bundles on the way.
    pub bundles: Vec<usize>,
    /// Frames written.
    pub frames: usize,
    /// From the first frame to the last one.
    pub seconds: f64,
    /// Where it stays; none where the way was named, dead ends were asked for, or every way ends.
    pub reach: Option<ReachJson>,
    /// What is played, one after the other.
    pub pieces: Vec<PieceJson>,
    /// Mean speed over the floor of ankles and toes in contact, in metres per second; none if there is no
    /// contact.
    pub skate_before: Option<f64>,
    /// That of the file, with its feet locked; none if that was not asked for.
    pub skate_after: Option<f64>,
    /// The file.
    pub file: String,
    /// All files: an AMC file has its skeleton beside it.
    pub files: Vec<String>,
}

/// A part of a walk.
#[derive(Clone, Debug, Serialize)]
pub struct PieceJson {
    /// The bundle it is in; none on the way between two.
    pub bundle: Option<usize>,
    /// What is played at the start.
    #[serde(flatten)]
    pub entry: SubmotionJson,
    /// What is played at the end, if that is another submotion.
    pub into: Option<SubmotionJson>,
    /// Its first frame in the file.
    pub at: usize,
    /// Its frames; the pose after the last one is the next piece's first.
    pub frames: usize,
}

/// Frames of a clip.
#[derive(Clone, Debug, Serialize)]
pub struct SubmotionJson {
    /// The clip's file.
    pub clip: String,
    /// First frame.
    pub start: usize,
    /// The frame whose pose what follows begins with.
    pub end: usize,
}

/// Runs the command.
///
/// # Errors
/// [`Failure`] if bundles or clips cannot be read, or the motion cannot be made or written.
pub fn run(args: &WalkArgs, global: &Global) -> Result<Exit, Failure> {
    let voice = global.voice();
    let format = format_of(&args.output)?;
    let bundled = load_bundles(&args.bundles)?;
    let walk = match way::find(args, &bundled) {
        Ok(walk) => walk,
        Err(error @ WalkError::Unreachable { .. }) => {
            voice.note(&error.to_string());
            let outcome = Outcome {
                found: false,
                result: None::<WalkJson>,
                skipped: Vec::new(),
            };
            return voice.report("walk", &outcome, |_| Ok(()));
        }
        Err(error) => {
            let message = format!("{}: {error}", args.bundles.display());
            return Err(Failure::Usage(message));
        }
    };
    let is_random = args.random.is_some() || args.seconds.is_some();
    let start = walk
        .bundles
        .first()
        .filter(|_| is_random && !args.dead_ends);
    let reach = start.and_then(|&start| ReachJson::of(bundled.model.graph(), start));
    if let Some(last) = way::dead_end(args, &bundled, &walk) {
        voice.note(&format!("the walk ends early: nothing follows B{last}"));
    }
    let mut takes = Takes::read(&walk, &bundled, args, &global.read_options()?)?;
    tell_warnings(voice, takes.warnings.iter());
    let refused = |error: &dyn std::error::Error| Failure::input(&args.bundles, error);
    let mut motion = play(&walk, &takes.clips).map_err(|e| refused(&e))?;
    let contacts = Contacts::of_walk(&walk, &takes.clips).map_err(|e| refused(&e))?;
    let first = walk.pieces.first().map_or(0, |piece| sides(piece).0.clip);
    let map = takes.clips.remove(&first).and_then(|clip| clip.map);
    let skate = |motion: &Motion| skate(motion, map.as_ref()?, &contacts);
    let skate_before = skate(&motion);
    if let Some(map) = map.as_ref().filter(|_| args.footlock) {
        motion = footlock(&motion, map, &contacts);
    }
    let skate_after = args.footlock.then(|| skate(&motion)).flatten();
    let (frames, seconds) = (
        motion.n_frames(),
        (motion.n_frames() - 1) as f64 / motion.rate.hz(),
    );
    let files = takes.write(motion, format, &args.output)?;
    let result = WalkJson {
        bundles: walk.bundles.clone(),
        frames,
        seconds,
        reach,
        pieces: pieces(&walk, &bundled),
        skate_before,
        skate_after,
        file: args.output.display().to_string(),
        files,
    };
    let outcome = Outcome {
        found: true,
        result,
        skipped: Vec::new(),
    };
    voice.report("walk", &outcome, |out| tell(out, &outcome.result))
}

fn format_of(path: &Path) -> Result<MotionFormat, Failure> {
    let extension = path.extension().and_then(|e| e.to_str());
    let format = extension.and_then(|e| MotionFormat::from_str(e, true).ok());
    format.ok_or_else(|| {
        let message = "expected .bvh, .amc, .glb, .csv, .npy or .npz";
        Failure::Usage(format!("{}: {message}", path.display()))
    })
}

/// The clips of a walk as they were read.
struct Takes {
    clips: WalkClips,
    /// How each is stored.
    formats: BTreeMap<usize, Format>,
    first: usize,
    /// Files that must not be written over.
    read: Vec<PathBuf>,
    warnings: Vec<(PathBuf, Warning)>,
}

impl Takes {
    fn read(
        walk: &Walk,
        bundled: &Bundled,
        args: &WalkArgs,
        options: &ReadOptions,
    ) -> Result<Takes, Failure> {
        let both = walk.pieces.iter().flat_map(|piece| {
            let (entry, exit) = sides(piece);
            [entry.clip, exit.clip]
        });
        let mut takes = Takes {
            clips: BTreeMap::new(),
            formats: BTreeMap::new(),
            first: walk.pieces.first().map_or(0, |piece| sides(piece).0.clip),
            read: vec![args.bundles.clone()],
            warnings: Vec::new(),
        };
        for index in both.collect::<BTreeSet<usize>>() {
            let missing = || Failure::input(&args.bundles, format!("clip {index} is not there"));
            let clip = bundled.clips.get(index).ok_or_else(missing)?;
            let graph = bundled.model.graph().clips();
            let first = graph.get(index).ok_or_else(missing)?.start;
            let (loaded, motion) = read_clip(clip, FrameRate::from_hz(bundled.rate), options)?;
            // Where no foot is to be locked, a skeleton that no rig fits only has no skate.
            let map = match body_map(&clip.path, &loaded.recording, options) {
                Err(failure) if args.footlock => return Err(failure),
                map => map.ok(),
            };
            takes.clips.insert(index, WalkClip { motion, map, first });
            takes.formats.insert(index, loaded.format);
            takes.read.push(clip.path.clone());
            takes.read.extend(loaded.asf);
            takes.warnings.extend(loaded.warnings);
        }
        Ok(takes)
    }

    /// Writes the motion, and gives the files written.
    fn write(
        &self,
        motion: Motion,
        format: MotionFormat,
        path: &Path,
    ) -> Result<Vec<String>, Failure> {
        let unit = match (self.formats.get(&self.first), format) {
            (Some(Format::Bvh), MotionFormat::Bvh) | (Some(Format::Amc), MotionFormat::Amc) => {
                motion.unit
            }
            // As `motif convert` does.
            _ => LengthUnit::CENTIMETRE,
        };
        let files = encode(&Recording::Joints(motion), format, path, unit);
        let files = files.map_err(|e| Failure::input(path, e))?;
        for (file, _) in &files {
            if self.read.iter().any(|read| is_same_file(file, read)) {
                let message = format!("{}: would be written over what is read", file.display());
                return Err(Failure::Usage(message));
            }
        }
        for (file, bytes) in &files {
            targets::write(file, bytes)?;
        }
        Ok(files.iter().map(|(f, _)| f.display().to_string()).collect())
    }
}

/// A clip as it was when the bundles were made, Y up.
///
/// Rates differ by what files round away, and count as one.
pub(crate) fn read_clip(
    clip: &BundleClip,
    rate: Option<FrameRate>,
    options: &ReadOptions,
) -> Result<(Loaded, Motion), Failure> {
    let options = ReadOptions {
        asf: clip.asf.clone().or_else(|| options.asf.clone()),
        ..options.clone()
    };
    let files = Files::read(&clip.path, &options)?;
    if files.content(&options) != clip.content {
        let message =
            "the file, or an option to read it by, is not what the bundles were made from";
        return Err(Failure::input(&clip.path, message));
    }
    let loaded = parse(&clip.path, files, &options)?;
    let whole = loaded.recording.motion();
    let motion = whole.and_then(|motion| motion.slice(clip.frames.clone()));
    let motion =
        motion.ok_or_else(|| Failure::input(&clip.path, "has not the frames of its bundles"))?;
    let rate = rate.unwrap_or(motion.rate);
    let motion = Motion { rate, ..motion };
    Ok((loaded, motion.to_up(UpAxis::Y)))
}

fn pieces(walk: &Walk, bundled: &Bundled) -> Vec<PieceJson> {
    let told = |submotion: &Submotion| {
        let (clip, Range { start, end }) = bundled.source(submotion)?;
        let clip = clip.path.display().to_string();
        Some(SubmotionJson { clip, start, end })
    };
    let mut at = 0;
    let pieces = walk.pieces.iter().filter_map(|piece| {
        let (entry, exit) = sides(piece);
        let mut holders = bundled.model.graph().bundles().iter();
        let told = PieceJson {
            bundle: holders.position(|bundle| bundle.submotions.contains(entry)),
            entry: told(entry)?,
            into: match piece {
                Piece::Plain(_) => None,
                Piece::Blend { .. } => Some(told(exit)?),
            },
            at,
            frames: piece.n_frames(),
        };
        at += piece.n_frames();
        Some(told)
    });
    pieces.collect()
}

fn tell(out: &mut dyn Write, walk: &WalkJson) -> io::Result<()> {
    let ids: Vec<String> = walk.bundles.iter().map(|id| format!("B{id}")).collect();
    writeln!(out, "{}", ids.join(" "))?;
    for piece in &walk.pieces {
        let name = piece
            .bundle
            .map_or("between".to_owned(), |id| format!("B{id}"));
        let span = |side: &SubmotionJson| format!("{}@{}-{}", side.clip, side.start, side.end);
        write!(out, "{:6} {name}: {}", piece.at, span(&piece.entry))?;
        match &piece.into {
            Some(into) => writeln!(out, " into {}", span(into))?,
            None => writeln!(out)?,
        }
    }
    if let Some(reach) = &walk.reach {
        let share = 100.0 * reach.frames as f64 / reach.all_frames as f64;
        writeln!(
            out,
            "stays in the {} of {} that all lead to each other, with {share:.1} % of the bundled frames",
            reach.bundles,
            count(reach.all_bundles, "bundle"),
        )?;
    }
    if let Some(before) = walk.skate_before {
        write!(out, "foot skate {before:.3} m/s")?;
        match walk.skate_after {
            Some(after) => writeln!(out, ", {after:.3} m/s with feet locked")?,
            None => writeln!(out)?,
        }
    }
    let frames = count(walk.frames, "frame");
    writeln!(
        out,
        "{}: {frames}, {:.2} s",
        walk.files.join(", "),
        walk.seconds
    )
}
