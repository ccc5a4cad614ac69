//! The doctor's findings as text.

use std::io::{self, Write};

use super::{BodyMapJson, Floor, InfoJson, MarkersJson, PointJson};
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
    if let Some(markers) = &info.markers {
        write_markers(&mut line, markers, verbose)?;
    }
    match &info.body_map {
        None => line(
            "rig",
            "no known rig has these names; --rig FILE says which is where".to_owned(),
        )?,
        Some(map) => write_map(&mut line, map, verbose)?,
    }
    if info.body_map.is_none() && !info.rig_candidates.is_empty() {
        let all = info.rig_candidates.iter();
        let all: Vec<String> = all
            .map(|c| format!("{} {:.0} %", c.rig, 100.0 * c.score))
            .collect();
        line("nearest", all.join(", "))?;
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

/// Markers with gaps, and events, that are listed without `--verbose`.
const LISTED: usize = 5;

fn write_markers(
    line: &mut impl FnMut(&str, String) -> io::Result<()>,
    markers: &MarkersJson,
    verbose: bool,
) -> io::Result<()> {
    let listed = if verbose { usize::MAX } else { LISTED };
    let dots = |n: usize| if n > listed { ", …" } else { "" };
    let mut beside = vec![markers.storage.clone()];
    beside.push(format!(
        "first frame is number {}",
        markers.first_frame_number
    ));
    if markers.other_points > 0 {
        beside.push(format!(
            "{} that are no positions",
            count(markers.other_points, "point")
        ));
    }
    if let Some(rate) = markers.analog_rate {
        let channels = count(markers.analog_channels, "analog channel");
        beside.push(format!("{channels} at {rate} Hz"));
    }
    line("c3d", beside.join(", "))?;
    if markers.filled > 0 {
        let frames = count(markers.filled_frames, "frame");
        line(
            "filled",
            format!(
                "{} of {frames} in all, as asked",
                count(markers.filled, "gap")
            ),
        )?;
    }
    let gaps = &markers.gaps;
    if gaps.count > 0 {
        let worst = gaps.markers.iter().take(listed);
        let worst: Vec<String> = worst
            .map(|m| format!("{} {}", m.marker, count(m.frames, "frame")))
            .collect();
        line(
            "gaps",
            format!(
                "{}, {:.1} % of all positions, the longest {:.2} s: {}{}",
                gaps.count,
                100.0 * gaps.share,
                gaps.longest_s,
                worst.join(", "),
                dots(gaps.markers.len())
            ),
        )?;
    }
    if !markers.events.is_empty() {
        let events = markers.events.iter().take(listed).map(|event| {
            let context = event
                .context
                .as_ref()
                .map_or(String::new(), |c| format!("{c} "));
            format!("{context}{} {:.2} s", event.label, event.seconds)
        });
        let events: Vec<String> = events.collect();
        line(
            "events",
            format!("{}{}", events.join(", "), dots(markers.events.len())),
        )?;
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
        format!(
            "{}, {:.0} % of the body points by name, {} of {} with derived ones",
            map.rig,
            100.0 * map.score,
            map.placed,
            map.of
        ),
    )?;
    for point in &map.points {
        match &point.derived {
            Some(how) => line("derived", format!("{}: {how}", point.point))?,
            None if verbose => line("", format!("{:<10} {}", point.point, formula(point)))?,
            None => {}
        }
    }
    for missing in &map.missing {
        let nearest = if missing.nearest.is_empty() {
            String::new()
        } else {
            format!("; nearest names: {}", missing.nearest.join(", "))
        };
        line("missing", format!("{}{nearest}", missing.point))?;
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
        "default" => "assumed; the file names none that could be meant",
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
            format!("guessed from the motion, confidence {confidence:.2}; --up overrules it")
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
