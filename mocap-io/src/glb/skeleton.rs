use std::io::Write;
use std::ops::Range;

use nalgebra::{Matrix3, Matrix4, Quaternion, Rotation3, UnitQuaternion, Vector3};

use super::document::{Document, single};
use super::json::{Node, Path, Skin};
use super::mesh::Octahedra;
use crate::local_rotation::{ContinuousSign, LocalRotation};
use crate::{Axis, Channel, Joint, Motion, UpAxis, WriteError};

/// A vertex names its joint by 16 bits.
const JOINTS_PER_SKIN: usize = 1 << 16;

/// Writes a motion as GLB: a node per joint, in metres, Y up, an animation, and a mesh of octahedra, one
/// per bone, that is skinned to the nodes, so that importers see an armature.
///
/// A joint's node has its name and stands where [`forward_kinematics`](crate::forward_kinematics) puts it.
/// An Acclaim motion goes through [`Motion::to_parent_offsets`] first: nodes stand where bones *start*,
/// and the end of bone `b` is the first child of node `b`, which is `b_End` for the last of a chain.
/// Bones that change their length or shift keep their rest length, as there.
///
/// Above the roots stands one node, `skeleton`, that turns [`Motion::up`] to Y. The rest pose, which is the bind
/// pose, has all rotations zero. A joint with rotation channels has a rotation sampler (quaternions without
/// sign flips, `LINEAR`), one with translation channels a translation sampler; frame `i` is at
/// `i / rate` seconds. A motion without frames has no animation.
///
/// The same motion gives the same bytes. O(frames · joints) time and memory.
///
/// # Errors
/// [`WriteError::Layout`] for a skeleton without joints, [`WriteError::NotFinite`] for a missing or infinite
/// value, [`WriteError::Limit`] for a length beyond single precision, for frames so many or so close that
/// single precision cannot tell their times apart and for 4 GiB or more, [`WriteError::Io`] when the sink
/// fails.
pub fn write_glb(motion: &Motion, out: impl Write) -> Result<(), WriteError> {
    if motion.skeleton.joints().is_empty() {
        return Err(WriteError::Layout {
            expected: "non-empty",
        });
    }
    for (frame, row) in motion.rows().enumerate() {
        if let Some(column) = row.iter().position(|v| !v.is_finite()) {
            return Err(WriteError::not_finite(motion, frame, column, row[column]));
        }
    }
    let motion = &motion.to_parent_offsets();
    let to_y_up = motion.up.to_y();
    let mut document = Document::new();
    add_nodes(motion, &to_y_up, &mut document)?;
    let rest = rest_places(motion);
    let mut in_scene = vec![TOP];
    for first in (0..rest.len()).step_by(JOINTS_PER_SKIN) {
        let span = first..rest.len().min(first + JOINTS_PER_SKIN);
        let skin = add_skin(&rest[span.clone()], first, &to_y_up, &mut document)?;
        let mesh = octahedra(motion, &rest, span, &to_y_up).store(&mut document, true)?;
        in_scene.push(document.nodes.len());
        document.nodes.push(Node {
            name: "bones".to_owned(),
            mesh: Some(mesh),
            skin: Some(skin),
            ..Node::default()
        });
    }
    add_animation(motion, &mut document)?;
    document.write(in_scene, out)
}

/// The node above the roots.
const TOP: usize = 0;

fn node_of(joint_idx: usize) -> usize {
    joint_idx + 1
}

fn add_nodes(
    motion: &Motion,
    to_y_up: &Matrix3<f64>,
    document: &mut Document,
) -> Result<(), WriteError> {
    let metres = motion.unit.metres();
    let turn = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(*to_y_up));
    document.nodes.push(Node {
        name: "skeleton".to_owned(),
        rotation: (motion.up != UpAxis::Y).then(|| in_file_order(turn.into_inner())),
        ..Node::default()
    });
    for (joint_idx, joint) in motion.skeleton.joints().iter().enumerate() {
        let parent = joint.parent.map_or(TOP, node_of);
        document.nodes[parent].children.push(node_of(joint_idx));
        let [x, y, z] = joint.offset.map(|v| v * metres);
        document.nodes.push(Node {
            name: joint.name.clone(),
            translation: Some([single(x)?, single(y)?, single(z)?]),
            ..Node::default()
        });
    }
    Ok(())
}

/// Where the joints are before any rotation: metres, along the file's axes.
fn rest_places(motion: &Motion) -> Vec<Vector3<f64>> {
    let mut places: Vec<Vector3<f64>> = Vec::new();
    for joint in motion.skeleton.joints() {
        let from = joint.parent.map_or_else(Vector3::zeros, |p| places[p]);
        places.push(from + Vector3::from(joint.offset) * motion.unit.metres());
    }
    places
}

/// A skin of the joints that start with joint `first` and rest at `rest`.
fn add_skin(
    rest: &[Vector3<f64>],
    first: usize,
    to_y_up: &Matrix3<f64>,
    document: &mut Document,
) -> Result<usize, WriteError> {
    // At rest a joint's node is at U · T(place); the inverse is T(-place) · U⁻¹.
    let turn = to_y_up.transpose().to_homogeneous();
    let inverse_bind = rest.iter().map(|place| {
        let matrix = Matrix4::new_translation(&-place) * turn;
        std::array::from_fn(|i| matrix.as_slice()[i] as f32)
    });
    let inverse_bind: Vec<[f32; 16]> = inverse_bind.collect();
    let inverse_bind_matrices = document.add(&inverse_bind, None)?;
    document.skins.push(Skin {
        inverse_bind_matrices,
        joints: (first..first + rest.len()).map(node_of).collect(),
    });
    Ok(document.skins.len() - 1)
}

/// The bones that start at the joints of `span`, and a marker for each root among them: at least one
/// shape, or importers would not take the joints for a skeleton.
fn octahedra(
    motion: &Motion,
    rest: &[Vector3<f64>],
    span: Range<usize>,
    to_y_up: &Matrix3<f64>,
) -> Octahedra {
    let mut octahedra = Octahedra::default();
    let first = span.start;
    for (joint_idx, joint) in motion.skeleton.joints().iter().enumerate() {
        let from = joint.parent.unwrap_or(joint_idx);
        if !span.contains(&from) {
            continue;
        }
        let in_skin = (from - first) as u16;
        let at = to_y_up * rest[joint_idx];
        match joint.parent {
            None => octahedra.add_marker(at, in_skin),
            Some(parent) => octahedra.add_bone(to_y_up * rest[parent], at, in_skin),
        }
    }
    if octahedra.is_empty() {
        octahedra.add_marker(to_y_up * rest[first], 0);
    }
    octahedra
}

fn add_animation(motion: &Motion, document: &mut Document) -> Result<(), WriteError> {
    if motion.n_frames() == 0 || motion.skeleton.n_channels() == 0 {
        return Ok(());
    }
    let mut first = 0;
    let mut tracks = Vec::new();
    for joint in motion.skeleton.joints() {
        tracks.push(Track::new(joint, first, motion));
        first += joint.channels.len();
    }
    for values in motion.rows() {
        tracks.iter_mut().for_each(|track| track.push(&values));
    }
    let times = document.add_times(0..motion.n_frames(), motion.rate)?;
    for (joint_idx, track) in tracks.iter().enumerate() {
        let node = node_of(joint_idx);
        if !track.rotations.is_empty() {
            document.animate(node, Path::Rotation, times, &track.rotations)?;
        }
        if !track.places.is_empty() {
            document.animate(node, Path::Translation, times, &track.places)?;
        }
    }
    Ok(())
}

/// The keys of one joint; none of a kind that no channel moves.
struct Track {
    turn: LocalRotation,
    sign: ContinuousSign,
    rotations: Vec<[f32; 4]>,
    metres: f64,
    rest: [f64; 3],
    /// Axis and column. A translation channel replaces its component of the offset.
    translations: Vec<(Axis, usize)>,
    places: Vec<[f32; 3]>,
}

impl Track {
    /// Of a joint whose first channel is column `first`.
    fn new(joint: &Joint, first: usize, motion: &Motion) -> Self {
        let translations = joint.channels.iter().zip(first..);
        let translations = translations.filter_map(|(&channel, column)| match channel {
            Channel::Translation(axis) => Some((axis, column)),
            _ => None,
        });
        Track {
            turn: LocalRotation::new(joint, first),
            sign: ContinuousSign::default(),
            rotations: Vec::new(),
            metres: motion.unit.metres(),
            rest: joint.offset,
            translations: translations.collect(),
            places: Vec::new(),
        }
    }

    fn push(&mut self, values: &[f64]) {
        if !self.turn.is_rigid() {
            let rotation = self.sign.next(self.turn.at(values));
            self.rotations.push(in_file_order(rotation));
        }
        if !self.translations.is_empty() {
            let mut place = self.rest;
            for &(axis, column) in &self.translations {
                place[axis.idx()] = values[column];
            }
            self.places.push(place.map(|v| (v * self.metres) as f32));
        }
    }
}

/// x, y, z, w.
fn in_file_order(rotation: Quaternion<f64>) -> [f32; 4] {
    [rotation.i, rotation.j, rotation.k, rotation.w].map(|v| v as f32)
}
