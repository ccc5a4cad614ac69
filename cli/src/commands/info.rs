//! `motif info`: the doctor.

mod checkup;
mod explain;
mod markers;
mod text;

use std::path::{Path, PathBuf};

use mocap_io::{RateSource, UnitSource, UpSource};
use ndarray::s;
use relfeat::{BodyMap, BodyPoint, FeatureSet};
use serde::Serialize;

use super::WarningJson;
use crate::args::{Global, InfoArgs};
use crate::failure::{Exit, Failure};
use crate::output::Outcome;
use crate::recording::{ReadOptions, body_map, load};
use crate::selection;
use crate::source::{ClipRef, find_clips};
use crate::targets;
use crate::wire::{available, check_span};
pub use checkup::{Checkup, Floor, Jumps};
pub use markers::{EventJson, Gaps, MarkerGaps, MarkersJson};

/// What a file is.
#[derive(Clone, Debug, Serialize)]
pub struct InfoJson {
    /// The file, with its span if one was asked for.
    pub clip: String,
    /// `BVH`, `ASF/AMC`, `ASF` or `C3D`.
    pub format: &'static str,
    /// The skeleton file, for AMC.
    pub asf: Option<String>,
    /// Frames of the file, or of the span.
    pub frames: usize,
    /// Frames per second.
    pub rate: f64,
    /// `file`, `default` or `given`.
    pub rate_source: &'static str,
    /// Frames divided by the rate.
    pub duration_s: f64,
    /// Joints, End Sites included.
    pub joints: usize,
    /// Numbers per frame, if there is a skeleton.
    pub channels: Option<usize>,
    /// Metres per unit of length.
    pub unit_m: f64,
    /// What the unit is called.
    pub unit: String,
    /// `file`, `guessed` or `given`.
    pub unit_source: &'static str,
    /// For a guess: the largest extent of the rest pose in metres that it leads to.
    pub rest_extent_m: Option<f64>,
    /// For a guess: whether that is the size of a person.
    pub unit_plausible: Option<bool>,
    /// Axis that points up in the file.
    pub up: String,
    /// `file`, `default`, `guessed` or `given`.
    pub up_source: &'static str,
    /// For a guess: from 0, a toss-up, to 1, no doubt.
    pub up_confidence: Option<f64>,
    /// What the motion itself says.
    #[serde(flatten)]
    pub checkup: Checkup,
    /// What only files of markers have.
    pub markers: Option<MarkersJson>,
    /// Where the body points are.
    pub body_map: Option<BodyMapJson>,
    /// The rigs that find most of their names in the file, the best first.
    pub rig_candidates: Vec<RigJson>,
    /// Features of the default set that cannot be computed.
    pub unavailable_features: Vec<String>,
    /// What is odd.
    pub warnings: Vec<WarningJson>,
}

/// Where the body points are.
#[derive(Clone, Debug, Serialize)]
pub struct BodyMapJson {
    /// The rig recognised.
    pub rig: String,
    /// Share of the body points that the rig found by name, 0 to 1.
    pub score: f64,
    /// Body points that are placed, found or derived.
    pub placed: usize,
    /// Body points in all.
    pub of: usize,
    /// The body points that are placed.
    pub points: Vec<PointJson>,
    /// Body points that are not placed.
    pub missing: Vec<MissingJson>,
}

/// A body point that is not placed.
#[derive(Clone, Debug, Serialize)]
pub struct MissingJson {
    /// The body point.
    pub point: &'static str,
    /// Joints or markers whose names are nearest to what it is usually called.
    pub nearest: Vec<String>,
}

/// A rig and how much of it a file has.
#[derive(Clone, Debug, Serialize)]
pub struct RigJson {
    /// The rig.
    pub rig: &'static str,
    /// Share of the body points that it finds by name, 0 to 1.
    pub score: f64,
}

/// A body point and the joints that it is made of.
#[derive(Clone, Debug, Serialize)]
pub struct PointJson {
    /// The body point.
    pub point: &'static str,
    /// The joints; mostly one.
    pub joints: Vec<JointJson>,
    /// How it was made of other body points, if the rig has no name for it.
    pub derived: Option<String>,
}

/// A joint's part in a body point.
#[derive(Clone, Debug, Serialize)]
pub struct JointJson {
    /// Name in the file.
    pub name: String,
    /// The weights of a body point sum to 1.
    pub weight: f64,
}

/// Runs the command.
///
/// # Errors
/// [`Failure`] if no file can be named.
pub fn run(args: &InfoArgs, global: &Global) -> Result<Exit, Failure> {
    let voice = global.voice();
    if let Some(code) = &args.explain {
        return explain::run(code, voice);
    }
    let options = ReadOptions {
        rate: args.rate.rate.or(global.source_rate),
        ..global.read_options()?
    };
    let clips = find_clips(&args.paths)?;
    let default = relfeat::BUILTIN_SETS[0];
    let set = FeatureSet::builtin(default)
        .ok_or_else(|| Failure::Usage(format!("no feature set {default}")))?;
    if args.save_rig.is_some() && clips.len() != 1 {
        let message = format!("--save-rig wants one file, found {}", clips.len());
        return Err(Failure::Usage(message));
    }
    let (done, skipped) = voice.batch(&clips, "reading", |clip| {
        info(clip, &options, &set, args.save_rig.as_deref())
    });
    let result: Vec<InfoJson> = done.into_iter().map(|(_, info)| info).collect();
    let outcome = Outcome {
        found: !result.is_empty(),
        result,
        skipped,
    };
    let infos = &outcome.result;
    voice.report("info", &outcome, |out| {
        for (i, info) in infos.iter().enumerate() {
            if i > 0 {
                writeln!(out)?;
            }
            text::write_info(out, info, voice.verbose)?;
        }
        Ok(())
    })
}

/// Rigs that are listed with their scores, and names that are offered for a missing body point.
const CANDIDATES: usize = 3;
const NEAREST: usize = 3;

fn info(
    clip: &ClipRef,
    options: &ReadOptions,
    set: &FeatureSet,
    save_rig: Option<&Path>,
) -> Result<InfoJson, Failure> {
    let loaded = load(&clip.path, options)?;
    let recording = &loaded.recording;
    let span = check_span(clip, recording.n_frames())?;
    let n_frames = span.end - span.start;
    let names = recording.names();
    let map = body_map(&clip.path, recording, options).ok();
    let (rate, rate_source) = recording.rate();
    let (unit, unit_source) = recording.unit();
    let (up, up_source) = recording.up();
    let positions = recording.positions();
    let in_span = positions.slice(s![span.range(), .., ..]);
    let (rest_extent_m, unit_plausible) = match unit_source {
        UnitSource::Guessed {
            rest_extent,
            plausible,
        } => (Some(rest_extent * unit.metres()), Some(plausible)),
        _ => (None, None),
    };
    if let (Some(path), Some(map)) = (save_rig, &map) {
        targets::write(path, map.to_rig(&names).to_toml().as_bytes())?;
    }
    let markers = recording
        .c3d()
        .map(|c3d| markers::markers_json(c3d, &loaded.filled, span));
    let candidates = BodyMap::candidates(&names).into_iter().take(CANDIDATES);
    let available = map.as_ref().map_or(0, |map| available(set, map));
    Ok(InfoJson {
        clip: clip.display(),
        format: loaded.format.name(),
        asf: loaded
            .asf
            .as_ref()
            .map(|p: &PathBuf| p.display().to_string()),
        frames: n_frames,
        rate: rate.hz(),
        rate_source: match rate_source {
            RateSource::File => "file",
            RateSource::Default => "default",
            RateSource::Given => "given",
        },
        duration_s: n_frames as f64 / rate.hz(),
        joints: names.len(),
        channels: recording.motion().map(|m| m.skeleton.n_channels()),
        unit_m: unit.metres(),
        unit: unit.to_string(),
        unit_source: match unit_source {
            UnitSource::File => "file",
            UnitSource::Guessed { .. } => "guessed",
            UnitSource::Given => "given",
        },
        rest_extent_m,
        unit_plausible,
        up: up.to_string(),
        up_source: match up_source {
            UpSource::File => "file",
            UpSource::Default => "default",
            UpSource::Guessed { .. } => "guessed",
            UpSource::Given => "given",
        },
        up_confidence: match up_source {
            UpSource::Guessed { confidence } => Some(confidence),
            _ => None,
        },
        checkup: checkup::check_up(in_span, map.as_ref(), rate.hz()),
        markers,
        body_map: map.map(|map| body_map_json(&map, &names)),
        rig_candidates: candidates
            .map(|(rig, score)| RigJson { rig, score })
            .collect(),
        unavailable_features: selection::names(set, set.all() & !available),
        warnings: loaded
            .warnings
            .iter()
            .map(|(p, w)| WarningJson::new(p, w))
            .collect(),
    })
}

fn body_map_json(map: &BodyMap, names: &[&str]) -> BodyMapJson {
    let joint = |&(joint_idx, weight): &(usize, f64)| JointJson {
        name: names[joint_idx].to_owned(),
        weight,
    };
    let placed = BodyPoint::ALL
        .iter()
        .filter(|&&p| map.places(p))
        .map(|&point| PointJson {
            point: point.name(),
            joints: map.sources(point).iter().map(joint).collect(),
            derived: map.derived(point).map(str::to_owned),
        });
    let missing = map.missing().map(|point| MissingJson {
        point: point.name(),
        nearest: BodyMap::nearest(point, names, NEAREST)
            .into_iter()
            .map(str::to_owned)
            .collect(),
    });
    BodyMapJson {
        rig: map.rig().to_owned(),
        score: map.score(),
        placed: map.n_placed(),
        of: BodyPoint::COUNT,
        points: placed.collect(),
        missing: missing.collect(),
    }
}
