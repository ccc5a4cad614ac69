//! The doctor's findings as text.

use std::io::{self, Write};

use super::{BodyMapJson, Floor, InfoJson, PointJson};
use crate::output::count;

/// Feet that stand and yet move this fast skate, in metres per second.
const SKATES: f32 = 0.2;

/// Writes one file's findings; every body point's joints if `verbose`.
pub(super) fn write_info(out: &mut dyn Write, info: &InfoJson, verbose: bool) -> io::Result<()> {
    writeln!(out, "{}", info.clip)?;
    let mut line = |head: &str, text: String| writeln!(out, "  {head:<9} {text}");
    let asf = info.asf.as_ref();
    let skeleton = asf.map_or(String::new(), |asf| format!(", skeleton {asf}"));
    line("format", format!("{}{skeleton}", info.format))?;
    line(
        "motion",
        format!(
            "{}, {} Hz ({}), {:.2} s",
            count(info.frames, "frame"),
            info.rate,
            rate_source(info),
            info.duration_s
        ),
    )?;
    line("skeleton", joints(info))?;
    line("unit", format!("{} ({})", info.unit, unit_source(info)))?;
    line("up", format!("{} ({})", info.up, up_source(info)))?;
    if let Some(stature) = info.checkup.stature_m {
        line(
            "size",
            format!("{stature:.2} m from lowest to highest point when most upright"),
        )?;
    }
    if let Some(floor) = &info.checkup.floor {
        line("feet", feet(floor))?;
    }
    let jumps = &info.checkup.jumps;
    if jumps.count > 0 {
        let frames: Vec<String> = jumps.frames.iter().map(usize::to_string).collect();
        let dots = if jumps.count > frames.len() {
            ", …"
        } else {
            ""
        };
        let at = format!("at frame {}{dots}", frames.join(", "));
        let first = if jumps.frames == [1] {
            "; frame 0 looks like a pose put in front: leave it out with @1-"
        } else {
            ""
        };
        line("jumps", format!("{} {at}{first}", jumps.count))?;
    }
    match &info.body_map {
        None => line(
            "rig",
            "no known rig has these names; --rig FILE says which is where".to_owned(),
        )?,
        Some(map) => write_map(&mut line, map, verbose)?,
    }
    match (&info.body_map, info.unavailable_features.as_slice()) {
        (None, _) => line("without", "all features".to_owned())?,
        (Some(_), []) => {}
        (Some(_), without) => line("without", without.join(", "))?,
    }
    for warning in &info.warnings {
        line("warning", warning.to_string())?;
    }
    Ok(())
}

fn write_map(
    line: &mut impl FnMut(&str, String) -> io::Result<()>,
    map: &BodyMapJson,
    verbose: bool,
) -> io::Result<()> {
    line(
        "rig",
        format!("{}, {} of {} body points", map.rig, map.placed, map.of),
    )?;
    if verbose {
        for point in &map.points {
            line("", format!("{:<10} {}", point.point, formula(point)))?;
        }
    }
    if !map.missing.is_empty() {
        line("missing", map.missing.join(", "))?;
    }
    Ok(())
}

/// `LeftLeg`, or `1.5·LeftHand - 0.5·LeftForeArm`.
fn formula(point: &PointJson) -> String {
    let mut text = String::new();
    for (i, joint) in point.joints.iter().enumerate() {
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

fn joints(info: &InfoJson) -> String {
    match info.channels {
        Some(channels) => format!(
            "{}, {}",
            count(info.joints, "joint"),
            count(channels, "channel")
        ),
        None => count(info.joints, "marker"),
    }
}

fn rate_source(info: &InfoJson) -> &'static str {
    match info.rate_source {
        "default" => "the usual rate; the file names none",
        "given" => "as given",
        _ => "from the file",
    }
}

fn unit_source(info: &InfoJson) -> String {
    match (info.unit_source, info.rest_extent_m, info.unit_plausible) {
        (_, Some(extent), Some(true)) => format!("guessed: the figure then spans {extent:.2} m"),
        (_, Some(extent), _) => {
            format!("guessed, but the figure then spans {extent:.2} m; --unit says it better")
        }
        ("given", ..) => "as given".to_owned(),
        _ => "from the file".to_owned(),
    }
}

fn up_source(info: &InfoJson) -> String {
    match (info.up_source, info.up_confidence) {
        (_, Some(confidence)) => {
            format!("guessed from the motion, confidence {confidence:.2}; --up says it better")
        }
        ("file", _) => "from the file".to_owned(),
        ("given", _) => "as given".to_owned(),
        _ => "what the format means".to_owned(),
    }
}

fn feet(floor: &Floor) -> String {
    let verdict = if floor.plausible {
        "on the floor"
    } else {
        "not near zero: unit, up axis or origin may be wrong"
    };
    let skate = match floor.skate_m_s {
        Some(speed) if speed > SKATES => format!(", skating at {speed:.2} m/s while down"),
        Some(speed) => format!(", {speed:.2} m/s while down"),
        None => String::new(),
    };
    format!(
        "lowest at {:.2} m left, {:.2} m right: {verdict}{skate}",
        floor.left_m, floor.right_m
    )
}
