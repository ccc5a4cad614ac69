use std::io::Write;

use super::asf::Asf;
use crate::{Axis, AxisFrame, Channel, Joint, LengthUnit, Motion, OffsetFrame, WriteError};

/// Writes a skeleton as ASF, in degrees, with numbers that read back to the same bits wherever a
/// bone's direction and length do.
///
/// # Errors
/// [`WriteError::Layout`] for a BVH skeleton, [`WriteError::Unsupported`] for several roots, a name
/// with blanks or a reserved one, [`WriteError::Io`] when the sink fails.
pub fn write_asf(asf: &Asf, mut out: impl Write) -> Result<(), WriteError> {
    let (root, bones) = check(asf)?;
    let length = LengthUnit::INCH.metres() / asf.unit.metres();
    writeln!(out, ":version 1.10\n:name {}", asf.name)?;
    writeln!(out, ":units\n  mass 1.0\n  length {length}\n  angle deg")?;
    let axis = root.axis.unwrap_or(AxisFrame::xyz([0.0; 3]));
    write!(out, ":root\n  order")?;
    for channel in &root.channels {
        write!(out, " {}", dof(*channel).to_ascii_uppercase())?;
    }
    let [x, y, z] = root.offset;
    let [a, b, c] = axis.degrees;
    writeln!(out, "\n  axis {}", letters(axis.order))?;
    writeln!(out, "  position {x} {y} {z}\n  orientation {a} {b} {c}")?;
    writeln!(out, ":bonedata")?;
    for (bone_idx, bone) in bones.iter().enumerate() {
        write_bone(&mut out, bone_idx + 1, bone)?;
    }
    writeln!(out, ":hierarchy\n  begin")?;
    let joints = asf.skeleton.joints();
    for (parent_idx, parent) in joints.iter().enumerate() {
        let mut children = bones.iter().filter(|b| b.parent == Some(parent_idx)).peekable();
        if children.peek().is_some() {
            write!(out, "    {}", parent.name)?;
            for child in children {
                write!(out, " {}", child.name)?;
            }
            writeln!(out)?;
        }
    }
    writeln!(out, "  end")?;
    Ok(())
}

fn check(asf: &Asf) -> Result<(&Joint, &[Joint]), WriteError> {
    if asf.skeleton.offset_frame() != OffsetFrame::Own {
        return Err(WriteError::Layout {
            expected: "Acclaim",
        });
    }
    let unsupported = |joint: &Joint, what| WriteError::Unsupported {
        joint: joint.name.clone(),
        what,
    };
    let Some((root, bones)) = asf.skeleton.joints().split_first() else {
        return Err(WriteError::Layout {
            expected: "non-empty",
        });
    };
    if root.name != "root" {
        return Err(unsupported(root, "the root of an ASF file is called root"));
    }
    for bone in bones {
        if bone.parent.is_none() {
            return Err(unsupported(bone, "a second root"));
        }
        let reserved = matches!(bone.name.as_str(), "" | "begin" | "end");
        if reserved || bone.name.contains(|c: char| c.is_whitespace() || c == '#') {
            return Err(unsupported(bone, "a name that ASF cannot hold"));
        }
    }
    Ok((root, bones))
}

fn write_bone(out: &mut impl Write, id: usize, bone: &Joint) -> std::io::Result<()> {
    let length = bone.offset.iter().map(|v| v * v).sum::<f64>().sqrt();
    let [x, y, z] = match length {
        0.0 => [0.0, 1.0, 0.0],
        _ => bone.offset.map(|v| v / length),
    };
    let axis = bone.axis.unwrap_or(AxisFrame::xyz([0.0; 3]));
    let [a, b, c] = axis.degrees;
    writeln!(out, "  begin\n     id {id}\n     name {}", bone.name)?;
    writeln!(out, "     direction {x} {y} {z}\n     length {length}")?;
    writeln!(out, "     axis {a} {b} {c} {}", letters(axis.order))?;
    if !bone.channels.is_empty() {
        let dofs: Vec<String> = bone.channels.iter().map(|&c| dof(c)).collect();
        writeln!(out, "    dof {}", dofs.join(" "))?;
    }
    writeln!(out, "  end")
}

fn letters(order: [Axis; 3]) -> String {
    order.iter().map(|a| a.letter()).collect()
}

fn dof(channel: Channel) -> String {
    match channel {
        Channel::Translation(axis) => format!("t{}", axis.letter().to_ascii_lowercase()),
        Channel::Rotation(axis) => format!("r{}", axis.letter().to_ascii_lowercase()),
        Channel::Length => "l".to_owned(),
    }
}

/// Writes a motion as AMC, in degrees, frames numbered from 1, with numbers that read back to the
/// same bits. The rate is not written: AMC has no place for it.
///
/// # Errors
/// [`WriteError::Layout`] for a BVH skeleton, [`WriteError::Io`] when the sink fails.
pub fn write_amc(motion: &Motion, mut out: impl Write) -> Result<(), WriteError> {
    let skeleton = &motion.skeleton;
    if skeleton.offset_frame() != OffsetFrame::Own {
        return Err(WriteError::Layout {
            expected: "Acclaim",
        });
    }
    writeln!(out, "#!OML:ASF\n:FULLY-SPECIFIED\n:DEGREES")?;
    for (frame, row) in motion.channels.rows().into_iter().enumerate() {
        writeln!(out, "{}", frame + 1)?;
        let mut values = row.iter();
        for joint in skeleton.joints().iter().filter(|j| !j.channels.is_empty()) {
            write!(out, "{}", joint.name)?;
            for value in values.by_ref().take(joint.channels.len()) {
                write!(out, " {value}")?;
            }
            writeln!(out)?;
        }
    }
    Ok(())
}
