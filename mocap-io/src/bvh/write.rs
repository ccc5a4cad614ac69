use std::io::Write;

use super::hierarchy::comment_in_name;
use super::rate::rate_from_frame_time;
use crate::cursor::{is_blank, is_newline};
use crate::{Channel, FrameRate, Joint, Motion, OffsetFrame, WriteError};

/// Levels that are indented. Deeper ones stay at this indent, or a long chain of joints would take
/// space quadratic in its length.
const MAX_INDENT: usize = 32;

/// Writes a motion as BVH, with numbers that read back to the same bits.
///
/// So does every rate that [`parse_bvh`](crate::parse_bvh) gives, and every whole number from 1 Hz to
/// 10 kHz; not every other rate is the reciprocal of a number, so the nearest that is may be read
/// instead. Rates outside these are written, but not believed when they are read.
/// The unit is not written: BVH has no place for it. O(frames · channels).
///
/// # Errors
/// [`WriteError::Layout`] for an Acclaim skeleton (convert with [`Motion::to_parent_offsets`]) or
/// one without joints, [`WriteError::Unsupported`] for a joint and [`WriteError::NotFinite`] for a
/// number that a reader would refuse, [`WriteError::Io`] when the sink fails.
pub fn write_bvh(motion: &Motion, mut out: impl Write) -> Result<(), WriteError> {
    let skeleton = &motion.skeleton;
    if skeleton.offset_frame() != OffsetFrame::Parent {
        return Err(WriteError::Layout { expected: "BVH" });
    }
    let joints = skeleton.joints();
    if joints.is_empty() {
        return Err(WriteError::Layout {
            expected: "non-empty",
        });
    }
    writeln!(out, "HIERARCHY")?;
    let mut open: Vec<usize> = Vec::new();
    for (joint_idx, joint) in joints.iter().enumerate() {
        while open.last().copied() != joint.parent {
            // Joints stand in depth-first order, so the parent is open unless the order is broken.
            if open.pop().is_none() {
                return Err(unsupported(
                    joint,
                    "its parent's children do not stand together",
                ));
            }
            writeln!(out, "{}}}", indent(open.len()))?;
        }
        if joint.parent.is_some_and(|p| joints[p].end_site) {
            return Err(unsupported(joint, "its parent is an End Site"));
        }
        write_joint_head(&mut out, joint, open.len())?;
        open.push(joint_idx);
    }
    while open.pop().is_some() {
        writeln!(out, "{}}}", indent(open.len()))?;
    }
    writeln!(out, "MOTION")?;
    writeln!(out, "Frames: {}", motion.n_frames())?;
    writeln!(out, "Frame Time: {}", frame_time_text(motion.rate))?;
    for (frame, row) in motion.rows().enumerate() {
        for (i, &value) in row.iter().enumerate() {
            if !value.is_finite() {
                return Err(WriteError::not_finite(motion, frame, i, value));
            }
            let blank = if i == 0 { "" } else { " " };
            write!(out, "{blank}{value}")?;
        }
        writeln!(out)?;
    }
    Ok(())
}

fn indent(depth: usize) -> String {
    "\t".repeat(depth.min(MAX_INDENT))
}

/// A frame time that is read as `rate`.
fn frame_time_text(rate: FrameRate) -> String {
    let seconds = rate.frame_time();
    let short = seconds.to_string();
    let read = rate_from_frame_time(seconds, short.as_bytes());
    let is_read_as_another = |read: FrameRate| (read.hz() / rate.hz() - 1.0).abs() > f64::EPSILON;
    if read.is_some_and(is_read_as_another) {
        // 0.016 could mean 60 Hz. With so many decimals nothing looks like a common rate rounded.
        return format!("{seconds:.20}");
    }
    short
}

fn write_joint_head(out: &mut impl Write, joint: &Joint, depth: usize) -> Result<(), WriteError> {
    check(joint)?;
    let indent = indent(depth);
    match (joint.end_site, joint.parent) {
        (true, _) => writeln!(out, "{indent}End Site")?,
        (false, None) => writeln!(out, "{indent}ROOT {}", joint.name)?,
        (false, Some(_)) => writeln!(out, "{indent}JOINT {}", joint.name)?,
    }
    let [x, y, z] = joint.offset;
    writeln!(out, "{indent}{{\n{indent}\tOFFSET {x} {y} {z}")?;
    if joint.end_site {
        return Ok(());
    }
    write!(out, "{indent}\tCHANNELS {}", joint.channels.len())?;
    for channel in &joint.channels {
        write!(out, " {channel}")?;
    }
    writeln!(out)?;
    Ok(())
}

fn check(joint: &Joint) -> Result<(), WriteError> {
    let name = joint.name.as_bytes();
    let is_edge_blank = |b: Option<&u8>| b.is_none_or(|&b| is_blank(b));
    let breaks = |&b: &u8| is_newline(b) || b == b'{';
    let channels = &joint.channels;
    let repeats = |(i, channel)| channels[..i].contains(channel);
    let what = if joint.end_site && (joint.parent.is_none() || !channels.is_empty()) {
        "an End Site without parent or with channels"
    } else if !joint.end_site
        && (is_edge_blank(name.first())
            || is_edge_blank(name.last())
            || name.iter().any(breaks)
            || comment_in_name(name).is_some())
    {
        "a name that BVH cannot hold"
    } else if joint.axis.is_some() {
        "an axis frame"
    } else if channels.contains(&Channel::Length) {
        "a length channel"
    } else if channels.iter().enumerate().any(repeats) {
        "a channel that appears twice"
    } else {
        return Ok(());
    };
    Err(unsupported(joint, what))
}

fn unsupported(joint: &Joint, what: &'static str) -> WriteError {
    WriteError::Unsupported {
        joint: joint.name.clone(),
        what,
    }
}
