//! How joints are turned within their parents, as quaternions.

use nalgebra::{Quaternion, UnitQuaternion};
use ndarray::Array3;

use crate::kinematics::rotations;
use crate::rotation::about;
use crate::{Axis, AxisFrame, Joint, Motion};

/// How each joint is turned within its parent: unit quaternions w, x, y, z in the file's axes, shape
/// `(frames, joints, 4)`.
///
/// A quaternion and its opposite are the same rotation; of the two the one nearer to the frame before
/// is given, and at first the one with a positive real part. Missing values are NaN. Computed in
/// `f64`, rounded once. O(frames · joints).
#[must_use]
pub fn local_rotations(motion: &Motion) -> Array3<f32> {
    let joints = motion.skeleton.joints();
    let mut first = 0;
    let mut turns: Vec<_> = joints
        .iter()
        .map(|joint| {
            let turn = LocalRotation::new(joint, first);
            first += joint.channels.len();
            (turn, ContinuousSign::default())
        })
        .collect();
    let mut numbers = Vec::with_capacity(motion.n_frames() * joints.len() * 4);
    for values in motion.rows() {
        for (turn, sign) in &mut turns {
            let q = sign.next(turn.at(&values));
            numbers.extend([q.w, q.i, q.j, q.k].map(|v| v as f32));
        }
    }
    Array3::from_shape_vec((motion.n_frames(), joints.len(), 4), numbers)
        .expect("the loop pushed four numbers per frame and joint")
}

/// What turns one joint: `C·M·C⁻¹` for an Acclaim bone, the product of the channels otherwise.
pub(crate) struct LocalRotation {
    axis_frame: Option<UnitQuaternion<f64>>,
    /// Leftmost factor first: axis and column.
    factors: Vec<(Axis, usize)>,
}

impl LocalRotation {
    /// Of a joint whose first channel is column `first`.
    pub(crate) fn new(joint: &Joint, first: usize) -> Self {
        LocalRotation {
            axis_frame: joint.axis.map(axis_quaternion),
            factors: rotations(joint, first),
        }
    }

    /// Whether no channel turns the joint.
    pub(crate) fn is_rigid(&self) -> bool {
        self.factors.is_empty()
    }

    /// The rotation at the given channel values; NaN where one of its values is.
    pub(crate) fn at(&self, values: &[f64]) -> UnitQuaternion<f64> {
        let factors = self.factors.iter();
        let turn = factors.fold(UnitQuaternion::identity(), |turn, &(axis, column)| {
            turn * about(axis, values[column])
        });
        match self.axis_frame {
            Some(frame) => frame * turn * frame.inverse(),
            None => turn,
        }
    }
}

/// `C = R(order[2]) · R(order[1]) · R(order[0])`.
fn axis_quaternion(frame: AxisFrame) -> UnitQuaternion<f64> {
    let factors = frame.order.into_iter().zip(frame.degrees);
    factors.fold(UnitQuaternion::identity(), |turn, (axis, degrees)| {
        about(axis, degrees) * turn
    })
}

/// A quaternion and its opposite are the same rotation. Picks the one nearer to the frame before, and
/// at first the one with a positive real part.
#[derive(Default)]
pub(crate) struct ContinuousSign(Option<Quaternion<f64>>);

impl ContinuousSign {
    pub(crate) fn next(&mut self, rotation: UnitQuaternion<f64>) -> Quaternion<f64> {
        let rotation = rotation.into_inner();
        let before = self.0.unwrap_or(Quaternion::identity());
        let picked = if rotation.dot(&before) < 0.0 {
            -rotation
        } else {
            rotation
        };
        if picked.w.is_finite() {
            self.0 = Some(picked);
        }
        picked
    }
}
