use nalgebra::{Matrix3, Vector3};
use ndarray::Array2;

use crate::kinematics::{axis_matrix, rotate_columns, rotations};
use crate::rotation::euler_degrees;
use crate::{Axis, Channel, Joint, Motion, OffsetFrame, Skeleton};

/// Rotation channels of a converted joint, leftmost factor first.
const ORDER: [Axis; 3] = [Axis::Z, Axis::Y, Axis::X];

impl Motion {
    /// The same motion with the offsets of BVH: an Acclaim bone becomes a joint at the bone's
    /// *start*, with rotation channels Z, Y, X, and each last bone of a chain gets an End Site at
    /// its tip. Joint names stay, and so does the up axis. Angles stay near those of the frame before.
    /// A motion that has these offsets already is returned as it is.
    ///
    /// So the position of Acclaim joint `b` is that of the first child of joint `b`, or of
    /// its End Site. Bones that change their length or shift keep their rest length, since a BVH
    /// joint that starts there could not say otherwise for all its children.
    ///
    /// O(frames · joints).
    #[must_use]
    pub fn to_parent_offsets(&self) -> Motion {
        if self.skeleton.offset_frame() == OffsetFrame::Parent {
            return self.clone();
        }
        let bones = self.skeleton.joints();
        let mut joints = Vec::new();
        let mut joint_of = Vec::with_capacity(bones.len());
        let mut has_child = vec![false; bones.len()];
        for (parent, _) in self.skeleton.bones() {
            has_child[parent] = true;
        }
        for (bone_idx, bone) in bones.iter().enumerate() {
            let start = bone
                .parent
                .filter(|&p| bones[p].parent.is_some())
                .map_or([0.0; 3], |p| bones[p].offset);
            joint_of.push(joints.len());
            joints.push(converted_joint(
                bone,
                bone.parent.map(|p| joint_of[p]),
                start,
            ));
            if !has_child[bone_idx] {
                joints.push(Joint {
                    name: format!("{}_End", bone.name),
                    parent: Some(joint_of[bone_idx]),
                    offset: if bone.parent.is_some() {
                        bone.offset
                    } else {
                        [0.0; 3]
                    },
                    channels: Vec::new(),
                    axis: None,
                    end_site: true,
                });
            }
        }
        let skeleton = Skeleton::new(joints, OffsetFrame::Parent)
            .expect("parents keep their places before their children");
        let mut channels = Array2::zeros((self.n_frames(), skeleton.n_channels()));
        let mut first_channel = 0;
        for (bone_idx, bone) in bones.iter().enumerate() {
            let first = skeleton.first_channel(joint_of[bone_idx]).unwrap_or(0);
            self.convert_channels(bone, first_channel, first, &mut channels);
            first_channel += bone.channels.len();
        }
        Motion {
            skeleton,
            channels,
            ..self.without_frames()
        }
    }

    /// Writes the channels of `bone`, which start at column `from`, to column `to` of `channels`.
    fn convert_channels(&self, bone: &Joint, from: usize, to: usize, channels: &mut Array2<f64>) {
        let axis = bone.axis.map_or_else(Matrix3::identity, axis_matrix);
        let order = rotations(bone, from);
        let first_rotation = if bone.parent.is_none() { to + 3 } else { to };
        let moves = !order.is_empty();
        let mut near = [0.0; 3];
        for (values, mut row) in self.rows().zip(channels.rows_mut()) {
            if bone.parent.is_none() {
                let mut at = Vector3::from(bone.offset);
                for (channel, column) in bone.channels.iter().zip(from..) {
                    if let Channel::Translation(axis) = channel {
                        at[axis.idx()] += values[column];
                    }
                }
                for i in 0..3 {
                    row[to + i] = at[i];
                }
            }
            if !moves && bone.parent.is_some() {
                continue;
            }
            let mut turned = axis;
            for &(axis, column) in &order {
                rotate_columns(&mut turned, axis, values[column].to_radians());
            }
            near = euler_degrees(&(turned * axis.transpose()), ORDER, near);
            for (i, degrees) in near.into_iter().enumerate() {
                row[first_rotation + i] = degrees;
            }
        }
    }
}

fn converted_joint(bone: &Joint, parent: Option<usize>, offset: [f64; 3]) -> Joint {
    let position = Axis::ALL.map(Channel::Translation);
    let rotation = ORDER.map(Channel::Rotation);
    let moves = bone
        .channels
        .iter()
        .any(|c| matches!(c, Channel::Rotation(_)));
    let channels = match parent {
        None => [position, rotation].concat(),
        Some(_) if moves => rotation.to_vec(),
        Some(_) => Vec::new(),
    };
    Joint {
        name: bone.name.clone(),
        parent,
        offset,
        channels,
        axis: None,
        end_site: false,
    }
}
