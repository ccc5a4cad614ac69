use nalgebra::{Matrix3, Vector3};
use ndarray::Array3;

use crate::{Axis, AxisFrame, Channel, Joint, Motion, OffsetFrame};

/// Joint positions of every frame, shape `(frames, joints, 3)`, in metres, Y up.
///
/// A rotation by BVH channels is their product in file order; the offset leads from the parent to
/// the joint and turns with the parent; a translation channel replaces its component of the offset.
/// An Acclaim bone turns by `C · M · C⁻¹` with `M = Rz·Ry·Rx` for the axis order XYZ, its offset turns
/// with it, and the joint is the bone's *end* (spec.md f). The translations of an Acclaim root add to
/// its place; those of a bone are part of `M`: they shift the bone along the axes of its axis frame.
///
/// Everything is turned so that [`Motion::up`] becomes Y. Computed in `f64`, rounded once.
/// O(frames · joints).
#[must_use]
pub fn forward_kinematics(motion: &Motion) -> Array3<f32> {
    let plan = Plan::new(motion);
    let n_joints = plan.joints.len();
    let mut positions = Vec::with_capacity(motion.n_frames() * n_joints * 3);
    let mut pose = vec![Placed::default(); n_joints];
    for values in motion.rows() {
        plan.place(&values, &mut pose);
        for joint in &pose {
            positions.extend(joint.position.iter().map(|&v| v as f32));
        }
    }
    Array3::from_shape_vec((motion.n_frames(), n_joints, 3), positions)
        .expect("the loop pushed three numbers per frame and joint")
}

/// Where a joint is and how its bone is turned. The rotation is `R·C`: the bone's axis frame is
/// undone together with the child's, in one constant matrix per bone.
#[derive(Clone, Default)]
struct Placed {
    position: Vector3<f64>,
    turned: Matrix3<f64>,
}

/// What one frame does to one joint.
struct JointPlan {
    parent: Option<usize>,
    /// `C_parent⁻¹ · C`; `None` where this is the identity.
    into_axis: Option<Matrix3<f64>>,
    /// Rotation channels, leftmost factor first: axis and column.
    rotations: Vec<(Axis, usize)>,
    /// Offset in metres; for Acclaim bones `C⁻¹ · offset`.
    offset: Vector3<f64>,
    /// Translation channels: axis and column.
    translations: Vec<(Axis, usize)>,
    /// Column of the bone's length channel, with the bone's direction in its axis frame.
    length: Option<(usize, Vector3<f64>)>,
}

struct Plan {
    joints: Vec<JointPlan>,
    offset_frame: OffsetFrame,
    metres: f64,
    /// From the file's axes to Y up; what roots inherit.
    to_y_up: Matrix3<f64>,
}

impl Plan {
    fn new(motion: &Motion) -> Plan {
        let skeleton = &motion.skeleton;
        let metres = motion.unit.metres();
        let axis = |joint: &Joint| joint.axis.map_or_else(Matrix3::identity, axis_matrix);
        let all = skeleton.joints();
        let mut first_channel = 0;
        let joints = all
            .iter()
            .map(|joint| {
                let own = axis(joint);
                let parent = joint
                    .parent
                    .map_or_else(Matrix3::identity, |p| axis(&all[p]));
                let into_axis = parent.transpose() * own;
                let place = Vector3::from(joint.offset);
                // The offset of an Acclaim root is a place, which its axis frame does not turn.
                let is_place = joint.parent.is_none();
                let offset = if is_place {
                    place
                } else {
                    own.transpose() * place
                };
                let columns = || joint.channels.iter().zip(first_channel..);
                let plan = JointPlan {
                    parent: joint.parent,
                    into_axis: (into_axis != Matrix3::identity()).then_some(into_axis),
                    rotations: rotations(joint, first_channel),
                    offset: offset * metres,
                    translations: columns()
                        .filter_map(|(&channel, column)| match channel {
                            Channel::Translation(axis) => Some((axis, column)),
                            _ => None,
                        })
                        .collect(),
                    length: columns()
                        .find(|&(&channel, _)| channel == Channel::Length && !is_place)
                        .and_then(|(_, column)| {
                            Some((column, offset.try_normalize(f64::MIN_POSITIVE)? * metres))
                        }),
                };
                first_channel += joint.channels.len();
                plan
            })
            .collect();
        Plan {
            joints,
            offset_frame: skeleton.offset_frame(),
            metres,
            to_y_up: motion.up.to_y(),
        }
    }

    fn place(&self, values: &[f64], pose: &mut [Placed]) {
        for (joint_idx, joint) in self.joints.iter().enumerate() {
            let (before, rest) = pose.split_at_mut(joint_idx);
            let placed = &mut rest[0];
            let parent = joint.parent.map(|p| &before[p]);
            let inherited = parent.map_or(self.to_y_up, |p| p.turned);
            let mut turned = match &joint.into_axis {
                Some(into_axis) => inherited * into_axis,
                None => inherited,
            };
            let own_axes = turned;
            for &(axis, column) in &joint.rotations {
                rotate_columns(&mut turned, axis, values[column].to_radians());
            }
            let mut offset = joint.offset;
            let from = parent.map_or_else(Vector3::zeros, |p| p.position);
            placed.position = match self.offset_frame {
                OffsetFrame::Parent => {
                    for &(axis, column) in &joint.translations {
                        offset[axis.idx()] = values[column] * self.metres;
                    }
                    from + inherited * offset
                }
                OffsetFrame::Own => {
                    if let Some((column, direction)) = joint.length {
                        offset += direction * values[column];
                    }
                    let mut moved = Vector3::zeros();
                    for &(axis, column) in &joint.translations {
                        moved[axis.idx()] = values[column] * self.metres;
                    }
                    match parent {
                        // The root's offset is a place, not a bone.
                        None => self.to_y_up * (offset + moved),
                        Some(_) => from + own_axes * moved + turned * offset,
                    }
                }
            };
            placed.turned = turned;
        }
    }
}

/// `C = R(order[2]) · R(order[1]) · R(order[0])`.
pub(crate) fn axis_matrix(axis: AxisFrame) -> Matrix3<f64> {
    let mut matrix = Matrix3::identity();
    for i in [2, 1, 0] {
        rotate_columns(&mut matrix, axis.order[i], axis.degrees[i].to_radians());
    }
    matrix
}

/// The rotation channels of a joint whose first channel is column `first`, leftmost factor first.
pub(crate) fn rotations(joint: &Joint, first: usize) -> Vec<(Axis, usize)> {
    let mut found: Vec<(Axis, usize)> = joint
        .channels
        .iter()
        .zip(first..)
        .filter_map(|(&channel, column)| match channel {
            Channel::Rotation(axis) => Some((axis, column)),
            _ => None,
        })
        .collect();
    if let Some(frame) = joint.axis {
        // Acclaim applies the axes in the bone's axis order, whatever the order of its dof line.
        let rank = |axis: Axis| frame.order.iter().position(|&a| a == axis);
        found.sort_by_key(|&(axis, _)| std::cmp::Reverse(rank(axis)));
    }
    found
}

/// `matrix ← matrix · R(axis, angle)`: a rotation about a coordinate axis mixes two columns only.
#[inline]
pub(crate) fn rotate_columns(matrix: &mut Matrix3<f64>, axis: Axis, radians: f64) {
    let (sin, cos) = radians.sin_cos();
    let (a, b) = match axis {
        Axis::X => (1, 2),
        Axis::Y => (2, 0),
        Axis::Z => (0, 1),
    };
    for row in 0..3 {
        let (u, v) = (matrix[(row, a)], matrix[(row, b)]);
        matrix[(row, a)] = u * cos + v * sin;
        matrix[(row, b)] = v * cos - u * sin;
    }
}
