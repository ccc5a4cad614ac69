use std::io::Write;

use crate::{Channel, Joint, Motion, OffsetFrame, WriteError};

/// Writes a motion as BVH, with numbers that read back to the same bits.
///
/// The unit is not written: BVH has no place for it. O(frames · channels).
///
/// # Errors
/// [`WriteError::Layout`] for an Acclaim skeleton (convert with [`Motion::to_parent_offsets`]),
/// [`WriteError::Io`] when the sink fails.
pub fn write_bvh(motion: &Motion, mut out: impl Write) -> Result<(), WriteError> {
    let skeleton = &motion.skeleton;
    if skeleton.offset_frame() != OffsetFrame::Parent {
        return Err(WriteError::Layout { expected: "BVH" });
    }
    let joints = skeleton.joints();
    writeln!(out, "HIERARCHY")?;
    let mut open: Vec<usize> = Vec::new();
    for (joint_idx, joint) in joints.iter().enumerate() {
        while open.last().copied() != joint.parent {
            // Joints stand in depth-first order, so the parent is open unless the order is broken.
            if open.pop().is_none() {
                return Err(unsupported(joint, "its parent's children do not stand together"));
            }
            writeln!(out, "{}}}", "\t".repeat(open.len()))?;
        }
        write_joint_head(&mut out, joint, open.len())?;
        open.push(joint_idx);
    }
    while open.pop().is_some() {
        writeln!(out, "{}}}", "\t".repeat(open.len()))?;
    }
    writeln!(out, "MOTION")?;
    writeln!(out, "Frames: {}", motion.n_frames())?;
    writeln!(out, "Frame Time: {}", motion.rate.frame_time())?;
    for row in motion.channels.rows() {
        for (i, value) in row.iter().enumerate() {
            let blank = if i == 0 { "" } else { " " };
            write!(out, "{blank}{value}")?;
        }
        writeln!(out)?;
    }
    Ok(())
}

fn write_joint_head(out: &mut impl Write, joint: &Joint, depth: usize) -> Result<(), WriteError> {
    let indent = "\t".repeat(depth);
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
        if *channel == Channel::Length {
            return Err(unsupported(joint, "a length channel"));
        }
        write!(out, " {channel}")?;
    }
    writeln!(out)?;
    Ok(())
}

fn unsupported(joint: &Joint, what: &'static str) -> WriteError {
    WriteError::Unsupported {
        joint: joint.name.clone(),
        what,
    }
}
