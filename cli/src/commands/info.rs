//! `motif info`.

use std::path::PathBuf;

use mocap_io::{RateSource, UnitSource};
use relfeat::{BodyMap, BodyPoint, FeatureSet};
use serde::Serialize;

use super::WarningJson;
use crate::args::{Global, InfoArgs};
use crate::failure::{Exit, Failure};
use crate::output::{Outcome, count};
use crate::selection;
use crate::source::{ClipRef, find_clips};
use crate::wire::{ReadOptions, available, check_span, joint_names, load};

/// What a file is.
#[derive(Clone, Debug, Serialize)]
pub struct InfoJson {
    /// The file, with its span if one was asked for.
    pub clip: String,
    /// `BVH` or `ASF/AMC`.
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
    /// Numbers per frame.
    pub channels: usize,
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
    /// Where the body points are.
    pub body_map: Option<BodyMapJson>,
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
    /// Body points that are placed.
    pub placed: usize,
    /// Body points in all.
    pub of: usize,
    /// The body points that are placed.
    pub points: Vec<PointJson>,
    /// Body points that are not placed.
    pub missing: Vec<&'static str>,
}

/// A body point and the joints that it is made of.
#[derive(Clone, Debug, Serialize)]
pub struct PointJson {
    /// The body point.
    pub point: &'static str,
    /// The joints; mostly one.
    pub joints: Vec<JointJson>,
}

/// A joint's part in a body point.
#[derive(Clone, Debug, Serialize)]
pub struct JointJson {
    /// Name in the file.
    pub name: String,
    /// The weights of a body point sum to 1.
    pub weight: f64,
}

impl PointJson {
    /// `LeftLeg`, or `1.5·LeftHand - 0.5·LeftForeArm`.
    fn formula(&self) -> String {
        let mut text = String::new();
        for (i, joint) in self.joints.iter().enumerate() {
            match (i, joint.weight < 0.0) {
                (0, false) => {}
                (0, true) => text.push('-'),
                (_, false) => text.push_str(" + "),
                (_, true) => text.push_str(" - "),
            }
            if joint.weight.abs() != 1.0 {
                text.push_str(&format!("{}·", joint.weight.abs()));
            }
            text.push_str(&joint.name);
        }
        text
    }
}

/// Runs the command.
///
/// # Errors
/// [`Failure`] if no file can be named.
pub fn run(args: &InfoArgs, global: &Global) -> Result<Exit, Failure> {
    let voice = global.voice();
    let clips = find_clips(&args.paths)?;
    let options = global.read_options();
    let default = relfeat::BUILTIN_SETS[0];
    let set = FeatureSet::builtin(default)
        .ok_or_else(|| Failure::Usage(format!("no feature set {default}")))?;
    let (done, skipped) = voice.batch(&clips, "reading", |clip| info(clip, &options, &set));
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
            write_info(out, info, voice.verbose)?;
        }
        Ok(())
    })
}

fn info(clip: &ClipRef, options: &ReadOptions, set: &FeatureSet) -> Result<InfoJson, Failure> {
    let loaded = load(&clip.path, options)?;
    let motion = &loaded.motion;
    let span = check_span(clip, motion.n_frames())?;
    let n_frames = span.end - span.start;
    let names = joint_names(motion);
    let map = BodyMap::recognise(&names);
    let (rest_extent_m, unit_plausible) = match motion.unit_source {
        UnitSource::Guessed {
            rest_extent,
            plausible,
        } => (Some(rest_extent * motion.unit.metres()), Some(plausible)),
        _ => (None, None),
    };
    let available = map.as_ref().map_or(0, |map| available(set, map));
    let unavailable_features = selection::names(set, set.all() & !available);
    Ok(InfoJson {
        clip: clip.display(),
        format: loaded.format.name(),
        asf: loaded
            .asf
            .as_ref()
            .map(|p: &PathBuf| p.display().to_string()),
        frames: n_frames,
        rate: motion.rate.hz(),
        rate_source: match motion.rate_source {
            RateSource::File => "file",
            RateSource::Default => "default",
            RateSource::Given => "given",
        },
        duration_s: n_frames as f64 / motion.rate.hz(),
        joints: names.len(),
        channels: motion.skeleton.n_channels(),
        unit_m: motion.unit.metres(),
        unit: motion.unit.to_string(),
        unit_source: match motion.unit_source {
            UnitSource::File => "file",
            UnitSource::Guessed { .. } => "guessed",
            UnitSource::Given => "given",
        },
        rest_extent_m,
        unit_plausible,
        body_map: map.map(|map| body_map_json(&map, &names)),
        unavailable_features,
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
        });
    BodyMapJson {
        rig: map.rig().to_owned(),
        placed: map.n_placed(),
        of: BodyPoint::COUNT,
        points: placed.collect(),
        missing: map.missing().map(BodyPoint::name).collect(),
    }
}

fn write_info(out: &mut dyn std::io::Write, info: &InfoJson, verbose: bool) -> std::io::Result<()> {
    writeln!(out, "{}", info.clip)?;
    let asf = info
        .asf
        .as_ref()
        .map_or(String::new(), |a| format!(", skeleton {a}"));
    writeln!(out, "  format    {}{asf}", info.format)?;
    let source = match info.rate_source {
        "default" => "the usual rate; the format names none",
        "given" => "as given",
        _ => "from the file",
    };
    writeln!(
        out,
        "  motion    {}, {} Hz ({source}), {:.2} s",
        count(info.frames, "frame"),
        info.rate,
        info.duration_s
    )?;
    writeln!(
        out,
        "  skeleton  {} joints, {} channels",
        info.joints, info.channels
    )?;
    let why = match (info.unit_source, info.rest_extent_m, info.unit_plausible) {
        (_, Some(extent), Some(true)) => format!("guessed: the rest pose then spans {extent:.2} m"),
        (_, Some(extent), _) => {
            format!("guessed, but the rest pose then spans {extent:.2} m; --unit says it better")
        }
        ("given", ..) => "as given".to_owned(),
        _ => "from the file".to_owned(),
    };
    writeln!(out, "  unit      {} ({why})", info.unit)?;
    match &info.body_map {
        None => writeln!(out, "  body map  no known rig has these joints")?,
        Some(map) => {
            writeln!(
                out,
                "  body map  {}, {} of {} body points",
                map.rig, map.placed, map.of
            )?;
            if verbose {
                for p in &map.points {
                    writeln!(out, "            {:<10} {}", p.point, p.formula())?;
                }
            }
            if !map.missing.is_empty() {
                writeln!(out, "  missing   {}", map.missing.join(", "))?;
            }
        }
    }
    if !info.unavailable_features.is_empty() {
        writeln!(out, "  without   {}", info.unavailable_features.join(", "))?;
    }
    for w in &info.warnings {
        writeln!(out, "  warning   {w}")?;
    }
    Ok(())
}
