//! What `motif align` writes.

use std::io;
use std::path::{Path, PathBuf};

use clap::ValueEnum;
use mocap_io::{LengthUnit, Motion, UpAxis, blend_along};

use super::{AlignResult, AlignmentJson};
use crate::align::blend::positions;
use crate::args::{AlignArgs, MotionFormat};
use crate::commands::convert::{encode, is_same_file};
use crate::failure::Failure;
use crate::recording::Recording;
use crate::source::Format;
use crate::take::Take;
use crate::targets;

/// The files to write.
#[derive(Debug)]
pub(super) struct Outputs {
    files: Vec<(PathBuf, Form)>,
}

#[derive(Clone, Copy, Debug)]
enum Form {
    /// The path as a table.
    Csv,
    /// The path and all about it.
    Json,
    /// The blend, with the weight of the second clip.
    Blend(MotionFormat, f64),
}

impl Outputs {
    /// What the command line asks for.
    pub(super) fn new(args: &AlignArgs) -> Result<Outputs, Failure> {
        let form = |path: &PathBuf| {
            let extension = path
                .extension()
                .and_then(|e| e.to_str())
                .unwrap_or_default();
            let extension = extension.to_ascii_lowercase();
            let motion = MotionFormat::from_str(&extension, true).ok();
            let form = match (extension.as_str(), motion, args.blend) {
                ("csv", ..) => Form::Csv,
                ("json", ..) => Form::Json,
                (_, Some(format), Some(weight)) => Form::Blend(format, weight),
                (_, Some(_), None) => {
                    return Err(refused(path, "a motion needs --blend WEIGHT, such as 0.5"));
                }
                (_, None, _) => {
                    return Err(refused(
                        path,
                        "expected .csv or .json for the path, .bvh, .amc, .glb, .npy or .npz for the blend",
                    ));
                }
            };
            Ok((path.clone(), form))
        };
        let files: Vec<(PathBuf, Form)> = args.output.iter().map(form).collect::<Result<_, _>>()?;
        let has_blend = files
            .iter()
            .any(|(_, form)| matches!(form, Form::Blend(..)));
        if args.blend.is_some() && !has_blend {
            let message = "--blend needs a file to write: -o OUT.bvh, .amc, .glb, .npy or .npz";
            return Err(Failure::Usage(message.to_owned()));
        }
        Ok(Outputs { files })
    }

    /// Writes everything, and gives the files written. Nothing is written if the blend cannot be made, or
    /// if a file would be written over what was read.
    pub(super) fn write(
        &self,
        result: &AlignResult,
        alignment: &AlignmentJson,
        takes: (&Take, &Take),
    ) -> Result<Vec<String>, Failure> {
        let mut all = Vec::new();
        for (path, form) in &self.files {
            match form {
                Form::Csv => {
                    let bytes = csv(result, alignment).map_err(|e| Failure::io(path, e))?;
                    all.push((path.clone(), bytes));
                }
                Form::Json => {
                    let mut bytes =
                        serde_json::to_vec(result).map_err(|e| Failure::io(path, e.into()))?;
                    bytes.push(b'\n');
                    all.push((path.clone(), bytes));
                }
                Form::Blend(format, weight) => {
                    let motion = blend(alignment, takes, *weight)?;
                    let unit = match (takes.0.loaded.format, format) {
                        (Format::Bvh, MotionFormat::Bvh) | (Format::Amc, MotionFormat::Amc) => {
                            motion.unit
                        }
                        // As `motif convert` does.
                        _ => LengthUnit::CENTIMETRE,
                    };
                    let files = encode(&Recording::Joints(motion), *format, path, unit);
                    all.extend(files.map_err(|e| Failure::input(&takes.0.clip.path, e))?);
                }
            }
        }
        let read: Vec<&Path> = [takes.0, takes.1]
            .iter()
            .flat_map(|take| take.loaded.asf.iter().chain([&take.clip.path]))
            .map(PathBuf::as_path)
            .collect();
        for (path, _) in &all {
            if read.iter().any(|read| is_same_file(path, read)) {
                return Err(refused(path, "would be written over what is read"));
            }
        }
        for (path, bytes) in &all {
            targets::write(path, bytes)?;
        }
        Ok(all
            .iter()
            .map(|(path, _)| path.display().to_string())
            .collect())
    }
}

fn refused(path: &Path, what: &str) -> Failure {
    Failure::Usage(format!("{}: {what}", path.display()))
}

fn csv(result: &AlignResult, alignment: &AlignmentJson) -> io::Result<Vec<u8>> {
    let mut csv = csv::Writer::from_writer(Vec::new());
    let heads = ["a_frame", "b_frame", "a_s", "b_s", "cost"];
    csv.write_record(heads.iter().chain(&result.points))?;
    for step in &alignment.path {
        let fixed = [
            step.a.to_string(),
            step.b.to_string(),
            format!("{:.6}", step.a_s),
            format!("{:.6}", step.b_s),
            format!("{:.6}", step.cost),
        ];
        let point = |distance: &Option<f64>| distance.map_or(String::new(), |d| format!("{d:.6}"));
        csv.write_record(fixed.into_iter().chain(step.points.iter().map(point)))?;
    }
    csv.into_inner().map_err(|e| e.into_error())
}

/// The blend along the path, `weight` of the way from the first clip to the second, at the rate and
/// on the skeleton of the first.
fn blend(
    alignment: &AlignmentJson,
    (a, b): (&Take, &Take),
    weight: f64,
) -> Result<Motion, Failure> {
    let (motion_a, motion_b) = (motion_of(a)?, motion_of(b)?);
    let motion_b = motion_b.resample(motion_a.rate);
    let ratio = motion_a.rate.hz() / b.rate();
    let last_b = motion_b.n_frames().saturating_sub(1) as f64;
    let steps = alignment.path.iter().map(|step| {
        let b_frame = (step.b - b.span.start) as f64 * ratio;
        ((step.a - a.span.start) as f64, b_frame.min(last_b))
    });
    let steps: Vec<(f64, f64)> = steps.collect();
    let path = positions(&steps, weight, motion_a.rate.hz());
    let weights = vec![weight; path.len()];
    blend_along(&motion_a, &motion_b, &path, &weights).map_err(|e| {
        let message = format!("cannot be blended with {}: {e}", a.clip.display());
        Failure::input(&b.clip.path, message)
    })
}

/// The frames asked for, Y up.
fn motion_of(take: &Take) -> Result<Motion, Failure> {
    let motion = take.loaded.recording.motion().ok_or_else(|| {
        Failure::input(
            &take.clip.path,
            "markers have no skeleton and cannot be blended",
        )
    })?;
    let cut = motion.slice(take.span.range());
    let cut = cut.ok_or_else(|| Failure::input(&take.clip.path, "a span beyond the end"))?;
    Ok(cut.to_up(UpAxis::Y))
}
