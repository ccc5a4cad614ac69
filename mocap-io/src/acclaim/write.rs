use std::io::Write;

use super::amc::DEFAULT_HZ;
use super::asf::Asf;
use crate::cursor::is_space;
use crate::{Axis, AxisFrame, Channel, Joint, LengthUnit, Motion, OffsetFrame, WriteError};

/// Writes a skeleton as ASF, in degrees, with numbers that read back to the same bits wherever a
/// bone's direction and length do.
///
/// # Errors
/// [`WriteError::Layout`] for a BVH skeleton, [`WriteError::Unsupported`] for several roots, a
/// skeleton of one bone, a name with blanks or a reserved one, [`WriteError::Io`] when the sink
/// fails.
pub fn write_asf(asf: &Asf, mut out: impl Write) -> Result<(), WriteError> {
    let (root, bones) = check(asf)?;
    let length = LengthUnit::INCH.metres() / asf.unit.metres();
    writeln!(
        out,
        ":version 1.10\n:name {}",
        asf.name.replace(['\n', '\r'], " ")
    )?;
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
    let mut children = vec![Vec::new(); joints.len()];
    for (parent_idx, child_idx) in asf.skeleton.bones() {
        children[parent_idx].push(child_idx);
    }
    for (parent, children) in joints.iter().zip(&children).filter(|(_, c)| !c.is_empty()) {
        write!(out, "    {}", parent.name)?;
        for &child_idx in children {
            write!(out, " {}", joints[child_idx].name)?;
        }
        writeln!(out)?;
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
    let Some((root, bones)) = asf.skeleton.joints().split_first() else {
        return Err(WriteError::Layout {
            expected: "non-empty",
        });
    };
    if bones.is_empty() {
        return Err(unsupported(root, "a root without bones"));
    }
    if root.name != "root" {
        return Err(unsupported(root, "the root of an ASF file is called root"));
    }
    for bone in bones {
        if bone.parent.is_none() {
            return Err(unsupported(bone, "a second root"));
        }
    }
    let joints = asf.skeleton.joints();
    joints.iter().try_for_each(check_joint)?;
    Ok((root, bones))
}

/// What a reader of ASF or AMC would refuse or misread.
fn check_joint(joint: &Joint) -> Result<(), WriteError> {
    let name = joint.name.as_bytes();
    let reserved = matches!(name, b"begin" | b"end" | [] | [b'#' | b':', ..]);
    let channels = &joint.channels;
    if reserved || name.iter().any(|&b| is_space(b)) {
        return Err(unsupported(joint, "a name that Acclaim files cannot hold"));
    }
    if (1..channels.len()).any(|i| channels[..i].contains(&channels[i])) {
        return Err(unsupported(joint, "a degree of freedom that appears twice"));
    }
    Ok(())
}

fn unsupported(joint: &Joint, what: &'static str) -> WriteError {
    WriteError::Unsupported {
        joint: joint.name.clone(),
        what,
    }
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
/// same bits. The rate is written where it is not the 120 Hz that readers assume.
///
/// # Errors
/// [`WriteError::Layout`] for a BVH skeleton, [`WriteError::Unsupported`] for a joint and
/// [`WriteError::NotFinite`] for a number that a reader would refuse, [`WriteError::Io`] when the
/// sink fails.
pub fn write_amc(motion: &Motion, mut out: impl Write) -> Result<(), WriteError> {
    let skeleton = &motion.skeleton;
    if skeleton.offset_frame() != OffsetFrame::Own {
        return Err(WriteError::Layout {
            expected: "Acclaim",
        });
    }
    skeleton.joints().iter().try_for_each(check_joint)?;
    writeln!(out, "#!OML:ASF\n:FULLY-SPECIFIED\n:DEGREES")?;
    let hz = motion.rate.hz();
    if hz != DEFAULT_HZ {
        writeln!(out, ":SAMPLES-PER-SECOND {hz}")?;
    }
    // A frame needs a bone to be one, even if nothing in the skeleton can move.
    let is_written = |joint: &&Joint| !joint.channels.is_empty() || skeleton.n_channels() == 0;
    for (frame, row) in motion.rows().enumerate() {
        writeln!(out, "{}", frame + 1)?;
        if let Some(column) = row.iter().position(|v| !v.is_finite()) {
            return Err(WriteError::not_finite(motion, frame, column, row[column]));
        }
        let mut values = row.iter();
        for joint in skeleton.joints().iter().filter(is_written) {
            write!(out, "{}", joint.name)?;
            for value in values.by_ref().take(joint.channels.len()) {
                write!(out, " {value}")?;
            }
            writeln!(out)?;
        }
    }
    Ok(())
}
