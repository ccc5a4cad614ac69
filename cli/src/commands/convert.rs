//! `motif convert`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use clap::ValueEnum;
use mocap_io::{
    AngleUnit, Asf, LengthUnit, UpAxis, Warning, mirror_pairs, write_amc, write_asf, write_bvh,
    write_csv, write_glb, write_glb_points, write_npy, write_npz, write_npz_points,
};
use serde::Serialize;

use super::{tell_filled, tell_warnings};
use crate::args::{ConvertArgs, Global, MotionFormat};
use crate::failure::{Exit, Failure};
use crate::output::{Outcome, count};
use crate::recording::{ReadOptions, Recording, load};
use crate::source::{ClipRef, Format, Span, find_clips};
use crate::targets;
use crate::wire::check_span;

/// A clip and the files made of it.
#[derive(Clone, Debug, Serialize)]
pub struct ConvertJson {
    /// The file, with its span if one was asked for.
    pub clip: String,
    /// What was written.
    pub files: Vec<String>,
    /// Frames written.
    pub frames: usize,
    /// Frames per second written.
    pub rate: f64,
    /// Gaps of markers that were filled, as asked.
    pub filled: usize,
}

/// Runs the command.
///
/// # Errors
/// [`Failure`] if nothing can be written.
pub fn run(args: &ConvertArgs, global: &Global) -> Result<Exit, Failure> {
    let voice = global.voice();
    let options = global.read_options()?;
    let clips = find_clips(std::slice::from_ref(&args.input))?;
    let (format, paths) = targets_of(args, &clips)?;
    for (clip, path) in clips.iter().zip(&paths) {
        if is_same_file(path, &clip.path) {
            let message = format!("{}: would be written over itself", path.display());
            return Err(Failure::Usage(message));
        }
    }
    let path_of: BTreeMap<&ClipRef, &PathBuf> = clips.iter().zip(&paths).collect();
    let (done, skipped) = voice.batch(&clips, "converting", |clip| {
        let path = path_of.get(clip);
        let path = path.ok_or_else(|| Failure::input(&clip.path, "a clip without a target"))?;
        convert(clip, path, format, args, &options)
    });
    tell_warnings(voice, done.iter().flat_map(|(_, (_, w))| w));
    tell_filled(voice, done.iter().map(|(_, (one, _))| one.filled).sum());
    let outcome = Outcome {
        found: !done.is_empty(),
        result: done
            .into_iter()
            .map(|(_, (one, _))| one)
            .collect::<Vec<_>>(),
        skipped,
    };
    let result = &outcome.result;
    voice.report("convert", &outcome, |out| {
        for one in result {
            writeln!(
                out,
                "{} ({} at {} Hz)",
                one.files.join(", "),
                count(one.frames, "frame"),
                one.rate
            )?;
        }
        Ok(())
    })
}

/// The format to write, and a path per clip.
fn targets_of(
    args: &ConvertArgs,
    clips: &[ClipRef],
) -> Result<(MotionFormat, Vec<PathBuf>), Failure> {
    let out = &args.output;
    let by_extension = || {
        let extension = out.extension()?.to_str()?;
        MotionFormat::from_str(extension, true).ok()
    };
    if targets::is_folder(out) || args.input.is_dir() {
        let format = args.to.ok_or_else(|| {
            Failure::Usage(format!(
                "{}: a folder needs --to bvh, amc, glb, csv, npy or npz",
                out.display()
            ))
        })?;
        let paths = targets::file_per_clip_renamed(out, format.extension(), clips);
        return Ok((format, paths));
    }
    let format = args.to.or_else(by_extension).ok_or_else(|| {
        Failure::Usage(format!(
            "{}: expected .bvh, .amc, .glb, .csv, .npy or .npz, a folder, or --to",
            out.display()
        ))
    })?;
    Ok((format, vec![out.clone(); clips.len()]))
}

/// A rate so many times the file's is a slip of the keyboard, and would fill the memory.
const MAX_UPSAMPLING: f64 = 100.0;

type Converted = (ConvertJson, Vec<(PathBuf, Warning)>);

fn convert(
    clip: &ClipRef,
    path: &Path,
    format: MotionFormat,
    args: &ConvertArgs,
    options: &ReadOptions,
) -> Result<Converted, Failure> {
    let loaded = load(&clip.path, options)?;
    let span = check_span(clip, loaded.recording.n_frames())?;
    let hz = loaded.recording.rate().0.hz();
    if let Some(rate) = args.rate.filter(|rate| rate.hz() > MAX_UPSAMPLING * hz) {
        let message = format!(
            "--rate {} is more than {MAX_UPSAMPLING} times the file's {hz}",
            rate.hz()
        );
        return Err(Failure::input(&clip.path, message));
    }
    let recording = edited(loaded.recording, span, args).map_err(|e| refused(clip, &e))?;
    let unit = match (loaded.format, format) {
        (Format::Bvh, MotionFormat::Bvh) => recording.unit().0,
        (Format::Amc | Format::Asf, MotionFormat::Amc) => recording.unit().0,
        // Which most programs expect of a BVH file.
        _ => LengthUnit::CENTIMETRE,
    };
    let unit = args.to_unit.unwrap_or(unit);
    let files = encode(&recording, format, path, unit).map_err(|e| refused(clip, &e))?;
    let read: Vec<&Path> = loaded
        .asf
        .iter()
        .map(PathBuf::as_path)
        .chain([clip.path.as_path()])
        .collect();
    for (file, _) in &files {
        if read.iter().any(|read| is_same_file(file, read)) {
            let message = format!("{}: would be written over what is read", file.display());
            return Err(Failure::input(&clip.path, message));
        }
    }
    for (file, bytes) in &files {
        targets::write(file, bytes)?;
    }
    let one = ConvertJson {
        clip: clip.display(),
        files: files.iter().map(|(f, _)| f.display().to_string()).collect(),
        frames: recording.n_frames(),
        rate: recording.rate().0.hz(),
        filled: loaded.filled.len(),
    };
    Ok((one, loaded.warnings))
}

pub(crate) type AnyError = Box<dyn std::error::Error>;

fn refused(clip: &ClipRef, error: &AnyError) -> Failure {
    Failure::input(&clip.path, error)
}

pub(crate) fn is_same_file(a: &Path, b: &Path) -> bool {
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

/// The frames of `span`, Y up, as the options want them.
fn edited(recording: Recording, span: Span, args: &ConvertArgs) -> Result<Recording, AnyError> {
    const BEYOND: &str = "a span beyond the end";
    match recording {
        Recording::Joints(motion) => {
            let mut motion = motion.slice(span.range()).ok_or(BEYOND)?.to_up(UpAxis::Y);
            if args.mirror {
                motion = motion.mirror(&mirror_pairs(&motion.skeleton))?;
            }
            if let Some(rate) = args.rate {
                motion = motion.resample(rate);
            }
            Ok(Recording::Joints(motion))
        }
        Recording::Markers(_) if args.mirror => Err("markers cannot be mirrored".into()),
        Recording::Markers(mut c3d) => {
            c3d.markers = c3d.markers.slice(span.range()).ok_or(BEYOND)?;
            if let Some(rate) = args.rate {
                c3d.markers = c3d.markers.resample(rate);
            }
            Ok(Recording::Markers(c3d))
        }
    }
}

/// The bytes of `path`, and of the skeleton beside it where the format wants one.
pub(crate) fn encode(
    recording: &Recording,
    format: MotionFormat,
    path: &Path,
    unit: LengthUnit,
) -> Result<Vec<(PathBuf, Vec<u8>)>, AnyError> {
    let (names, rate) = (recording.names(), recording.rate().0);
    let positions = || recording.positions();
    let mut out = Vec::new();
    let mut files = Vec::new();
    match (format, recording.motion()) {
        (MotionFormat::Bvh, Some(motion)) => {
            write_bvh(&motion.to_parent_offsets().in_unit(unit), &mut out)?;
        }
        (MotionFormat::Amc, Some(motion)) => {
            let motion = motion.to_own_offsets()?.in_unit(unit);
            let stem = path.file_stem().unwrap_or_default().to_string_lossy();
            let asf = Asf {
                name: stem.into_owned(),
                skeleton: motion.skeleton.clone(),
                unit,
                angle_unit: AngleUnit::Degrees,
                warnings: Vec::new(),
            };
            let mut skeleton = Vec::new();
            write_asf(&asf, &mut skeleton)?;
            files.push((path.with_extension("asf"), skeleton));
            write_amc(&motion, &mut out)?;
        }
        (MotionFormat::Bvh | MotionFormat::Amc, None) => {
            return Err("markers have no skeleton; they can become csv, npy, npz or glb".into());
        }
        (MotionFormat::Glb, Some(motion)) => write_glb(motion, &mut out)?,
        (MotionFormat::Glb, None) => write_glb_points(&names, positions().view(), rate, &mut out)?,
        (MotionFormat::Csv, _) => write_csv(&names, positions().view(), rate, &mut out)?,
        (MotionFormat::Npy, _) => write_npy(positions().view(), &mut out)?,
        (MotionFormat::Npz, Some(motion)) => write_npz(motion, &mut out)?,
        (MotionFormat::Npz, None) => write_npz_points(&names, positions().view(), rate, &mut out)?,
    }
    files.push((path.to_owned(), out));
    Ok(files)
}
