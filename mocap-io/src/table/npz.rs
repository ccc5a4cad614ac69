use std::io::Write;

use ndarray::ArrayView3;

use super::npy::{array, text_array};
use super::zip::ZipWriter;
use crate::error::check_shape;
use crate::{FrameRate, Motion, WriteError, forward_kinematics, local_rotations};

/// Writes a motion as a NumPy archive (`numpy.load`), not compressed.
///
/// | array | type and shape | what |
/// |---|---|---|
/// | `positions` | f32 (frames, joints, 3) | metres, Y up: [`forward_kinematics`] |
/// | `rotations` | f32 (frames, joints, 4) | quaternion w, x, y, z of each joint within its parent, in the file's axes, without sign flips from frame to frame |
/// | `names` | str (joints) | |
/// | `parents` | i64 (joints) | 0-based, -1 for a root, as SMPL and AMASS have it |
/// | `offsets` | f64 (joints, 3) | rest offsets in file units, in the frame of [`Skeleton::offset_frame`](crate::Skeleton::offset_frame) |
/// | `channels` | f64 (frames, channels) | degrees and file units |
/// | `channel_names` | str (channels) | `Hips_Xposition` |
/// | `rate` | f64 () | frames per second |
/// | `unit` | f64 () | metres per file unit |
/// | `up` | str (1) | which way is up in `rotations`, `offsets` and `channels` |
///
/// Missing values stay NaN. O(frames · joints) time and memory.
///
/// # Errors
/// [`WriteError::Limit`] if an array or the archive has 4 GiB or more, [`WriteError::Io`] when the sink
/// fails.
pub fn write_npz(motion: &Motion, out: impl Write) -> Result<(), WriteError> {
    let skeleton = &motion.skeleton;
    let joints = skeleton.joints();
    let (n_frames, n_joints) = (motion.n_frames(), joints.len());
    let mut zip = ZipWriter::new(out);
    add_positions(&mut zip, forward_kinematics(motion).view())?;
    let rotations = local_rotations(motion);
    let rotations = rotations.iter().map(|v| v.to_le_bytes());
    let shape = [n_frames, n_joints, 4];
    zip.add("rotations.npy", &array("<f4", &shape, rotations))?;
    let names: Vec<&str> = skeleton.names().collect();
    zip.add("names.npy", &text_array(&names))?;
    let parents = joints.iter().map(|j| j.parent.map_or(-1, |p| p as i64));
    let parents = parents.map(i64::to_le_bytes);
    zip.add("parents.npy", &array("<i8", &[n_joints], parents))?;
    let offsets = joints.iter().flat_map(|j| j.offset.map(f64::to_le_bytes));
    zip.add("offsets.npy", &array("<f8", &[n_joints, 3], offsets))?;
    let n_channels = skeleton.n_channels();
    let mut channels = Vec::with_capacity(n_frames * n_channels);
    for row in motion.rows() {
        channels.extend(row.iter().map(|v| v.to_le_bytes()));
    }
    let shape = [n_frames, n_channels];
    zip.add("channels.npy", &array("<f8", &shape, channels))?;
    let names: Vec<String> = joints
        .iter()
        .flat_map(|j| j.channels.iter().map(|c| format!("{}_{c}", j.name)))
        .collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    zip.add("channel_names.npy", &text_array(&names))?;
    add_number(&mut zip, "rate.npy", motion.rate.hz())?;
    add_number(&mut zip, "unit.npy", motion.unit.metres())?;
    zip.add("up.npy", &text_array(&[&motion.up.to_string()]))?;
    zip.finish()
}

/// Writes markers, or any points, as a NumPy archive (`numpy.load`), not compressed: `positions`, f32
/// (frames, names, 3), with NaN where a point is missing; `names`; `rate`, f64, frames per second.
///
/// `positions` has shape `(frames, names, 3)`. O(frames · names) time and memory.
///
/// # Errors
/// [`WriteError::Shape`] if names and positions do not fit, [`WriteError::Limit`] if the archive has
/// 4 GiB or more, [`WriteError::Io`] when the sink fails.
pub fn write_npz_points(
    names: &[&str],
    positions: ArrayView3<'_, f32>,
    rate: FrameRate,
    out: impl Write,
) -> Result<(), WriteError> {
    check_shape(names, positions)?;
    let mut zip = ZipWriter::new(out);
    add_positions(&mut zip, positions)?;
    zip.add("names.npy", &text_array(names))?;
    add_number(&mut zip, "rate.npy", rate.hz())?;
    zip.finish()
}

fn add_positions<W: Write>(
    zip: &mut ZipWriter<W>,
    positions: ArrayView3<'_, f32>,
) -> Result<(), WriteError> {
    let values = positions.iter().map(|v| v.to_le_bytes());
    zip.add("positions.npy", &array("<f4", positions.shape(), values))
}

fn add_number<W: Write>(
    zip: &mut ZipWriter<W>,
    name: &'static str,
    value: f64,
) -> Result<(), WriteError> {
    zip.add(name, &array("<f8", &[], [value.to_le_bytes()]))
}
