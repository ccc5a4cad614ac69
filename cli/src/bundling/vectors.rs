//! Poses as vectors, for motion bundles.

use mocap_io::{Axis, Channel, Joint, Motion, OffsetFrame, UpAxis};
use nalgebra::{Matrix3, Rotation3, Vector3};
use ndarray::{Array2, Axis as Dim};
use thiserror::Error;

/// Numbers of the root: height, pitch, roll, yaw rate, velocity to the left and to the front.
const ROOT_DIMS: [&str; 6] = [
    "height",
    "pitch",
    "roll",
    "yaw rate",
    "velocity left",
    "velocity front",
];

/// Below this horizontal length the root's front is vertical, and tells no heading.
const VERTICAL: f64 = 1e-9;

/// Why a motion has no pose vectors.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum VectorError {
    /// The figure is none, or several.
    #[error("expected one root, found {found}")]
    Roots {
        /// How many there are.
        found: usize,
    },
    /// No joint but the root moves, or the root does not turn.
    #[error("expected rotations of the root and of joints below it, found none")]
    Rigid,
    /// A number is missing.
    #[error("frame {frame}: expected a number for {name}, found none")]
    Missing {
        /// The frame, from 0.
        frame: usize,
        /// The dimension, as in [`layout`].
        name: String,
    },
}

/// What the dimensions of the pose vectors of a motion are: `lfemur rx` for each degree of freedom
/// below the root, in the order of the channels, then the numbers of the root.
#[must_use]
pub fn layout(motion: &Motion) -> Vec<String> {
    let below = channels(motion).map(|(joint, channel, _)| {
        let name = match channel {
            Channel::Translation(axis) => format!("t{}", letter(axis)),
            Channel::Rotation(axis) => format!("r{}", letter(axis)),
            Channel::Length => "length".to_owned(),
        };
        format!("{} {name}", joint.name)
    });
    below.chain(ROOT_DIMS.map(str::to_owned)).collect()
}

fn letter(axis: Axis) -> char {
    ['x', 'y', 'z'][axis.idx()]
}

/// Channels below the root, with their joints and columns.
fn channels(motion: &Motion) -> impl Iterator<Item = (&Joint, Channel, usize)> {
    let joints = motion.skeleton.joints().iter();
    let all = joints.flat_map(|joint| joint.channels.iter().map(move |&channel| (joint, channel)));
    let numbered = all
        .zip(0..)
        .map(|((joint, channel), column)| (joint, channel, column));
    numbered.filter(|(joint, ..)| joint.parent.is_some())
}

/// The pose vectors of all frames, of shape `(frames, dims)`, the dimensions being those of
/// [`layout`]: degrees, metres and seconds.
///
/// After Beaudoin, van de Panne and Poulin (2007), section 3.1: all degrees of freedom below the root,
/// its height, pitch and roll, and where it goes as seen from itself, so that place and heading do not
/// matter. The heading is the yaw of the root's +Z axis (of positions, Y up); where that is vertical,
/// it is the one before. Pitch about X and then roll about Z are what remains of the root's rotation
/// without the yaw. Rates are central differences, one-sided at the ends. Angles go on smoothly, by
/// whole turns; of these, each column has the one whose mean is nearest to 0. With the 56 degrees of
/// freedom of the skeletons of CMU that makes the paper's 62 dimensions.
///
/// # Errors
///
/// [`VectorError`] if there is not one root, nothing turns, or a number is missing.
pub fn pose_vectors(motion: &Motion) -> Result<Array2<f64>, VectorError> {
    let root = Root::new(motion)?;
    let n_below = channels(motion).count();
    let mut vectors = Array2::zeros((motion.n_frames(), n_below + ROOT_DIMS.len()));
    for (dim, (_, channel, column)) in channels(motion).enumerate() {
        let is_angle = matches!(channel, Channel::Rotation(_));
        let factor = if is_angle { 1.0 } else { motion.unit.metres() };
        for (to, row) in vectors
            .column_mut(dim)
            .iter_mut()
            .zip(motion.channels.rows())
        {
            *to = factor * row.get(column).copied().unwrap_or(f64::NAN);
        }
    }
    root.write(&mut vectors, n_below);
    if let Some(((frame, dim), _)) = vectors.indexed_iter().find(|(_, x)| !x.is_finite()) {
        let name = layout(motion).swap_remove(dim);
        return Err(VectorError::Missing { frame, name });
    }
    // Only now, since a missing angle would be missing from all of its column.
    for (dim, (_, channel, _)) in channels(motion).enumerate() {
        if matches!(channel, Channel::Rotation(_)) {
            unwrap(&mut vectors.column_mut(dim));
        }
    }
    Ok(vectors)
}

/// Adds whole turns to angles in degrees, so that none is more than half a turn from the one before,
/// and their mean is at most half a turn from 0.
fn unwrap(angles: &mut ndarray::ArrayViewMut1<'_, f64>) {
    let mut before: Option<f64> = None;
    for angle in angles.iter_mut() {
        let near = before.unwrap_or(*angle);
        *angle -= 360.0 * ((*angle - near) / 360.0).round();
        before = Some(*angle);
    }
    let turns = angles.mean().map_or(0.0, |mean| (mean / 360.0).round());
    if turns != 0.0 {
        *angles -= 360.0 * turns;
    }
}

/// Where the root is, and how it is turned.
struct Root<'a> {
    motion: &'a Motion,
    joint: &'a Joint,
    to_y_up: Matrix3<f64>,
}

impl<'a> Root<'a> {
    fn new(motion: &'a Motion) -> Result<Self, VectorError> {
        let joints = motion.skeleton.joints();
        let mut roots = joints.iter().filter(|joint| joint.parent.is_none());
        let (Some(joint), None) = (roots.next(), roots.next()) else {
            let found = joints.iter().filter(|joint| joint.parent.is_none()).count();
            return Err(VectorError::Roots { found });
        };
        let turns = |channel: &Channel| matches!(channel, Channel::Rotation(_));
        let turns_below = channels(motion).any(|(_, channel, _)| turns(&channel));
        if !(turns_below && joint.channels.iter().any(turns)) {
            return Err(VectorError::Rigid);
        }
        let to_y_up = to_y_up(motion.up);
        Ok(Self {
            motion,
            joint,
            to_y_up,
        })
    }

    /// Fills the six columns from `first` on.
    fn write(&self, vectors: &mut Array2<f64>, first: usize) {
        let n_frames = self.motion.n_frames();
        let mut places = Vec::with_capacity(n_frames);
        let mut yaws = Vec::with_capacity(n_frames);
        let mut yaw = 0.0;
        for (frame, mut row) in vectors.rows_mut().into_iter().enumerate() {
            let turned = self.rotation(frame);
            let front = turned.column(2);
            if front.x.hypot(front.z) >= VERTICAL {
                yaw = front.x.atan2(front.z);
            }
            let level = Rotation3::from_axis_angle(&Vector3::y_axis(), -yaw).into_inner() * turned;
            let place = self.place(frame);
            row[first] = place.y;
            row[first + 1] = (-level[(1, 2)]).atan2(level[(2, 2)]).to_degrees();
            row[first + 2] = (-level[(0, 1)]).atan2(level[(0, 0)]).to_degrees();
            places.push(place);
            yaws.push(yaw.to_degrees());
        }
        let mut yaws = ndarray::Array1::from(yaws);
        unwrap(&mut yaws.view_mut());
        for dim in [first + 1, first + 2] {
            unwrap(&mut vectors.column_mut(dim));
        }
        for (frame, mut row) in vectors.axis_iter_mut(Dim(0)).enumerate() {
            let (a, b) = (frame.saturating_sub(1), (frame + 1).min(n_frames - 1));
            // A clip of one frame does not move.
            let per_second = self.motion.rate.hz() / (b - a).max(1) as f64;
            let moved = (places[b] - places[a]) * per_second;
            let (sin, cos) = yaws[frame].to_radians().sin_cos();
            row[first + 3] = (yaws[b] - yaws[a]) * per_second;
            row[first + 4] = cos * moved.x - sin * moved.z;
            row[first + 5] = sin * moved.x + cos * moved.z;
        }
    }

    fn channels(&self, frame: usize) -> impl Iterator<Item = (Channel, f64)> {
        let index = self.motion.skeleton.joints().iter();
        let idx = index.take_while(|joint| joint.parent.is_some()).count();
        let first = self.motion.skeleton.first_channel(idx).unwrap_or_default();
        let value = move |column| self.motion.channels.get((frame, column)).copied();
        let channels = self.joint.channels.iter().zip(first..);
        channels.map(move |(&channel, column)| (channel, value(column).unwrap_or(f64::NAN)))
    }

    /// In metres, Y up.
    fn place(&self, frame: usize) -> Vector3<f64> {
        let mut place = Vector3::from(self.joint.offset);
        for (channel, value) in self.channels(frame) {
            if let Channel::Translation(axis) = channel {
                match self.motion.skeleton.offset_frame() {
                    OffsetFrame::Parent => place[axis.idx()] = value,
                    OffsetFrame::Own => place[axis.idx()] += value,
                }
            }
        }
        self.to_y_up * place * self.motion.unit.metres()
    }

    /// Of positions, Y up.
    fn rotation(&self, frame: usize) -> Matrix3<f64> {
        let mut turns: Vec<(Axis, f64)> = self
            .channels(frame)
            .filter_map(|(channel, value)| match channel {
                Channel::Rotation(axis) => Some((axis, value)),
                _ => None,
            })
            .collect();
        let mut frame = Matrix3::identity();
        if let Some(axes) = self.joint.axis {
            // Acclaim turns about the axes in the order of its axis frame, the first one first.
            let rank = |axis: Axis| axes.order.iter().position(|&a| a == axis);
            turns.sort_by_key(|&(axis, _)| std::cmp::Reverse(rank(axis)));
            for (axis, degrees) in axes.order.into_iter().zip(axes.degrees) {
                frame = about(axis, degrees) * frame;
            }
        }
        let turned = turns.into_iter().fold(frame, |turned, (axis, degrees)| {
            turned * about(axis, degrees)
        });
        self.to_y_up * turned * frame.transpose() * self.to_y_up.transpose()
    }
}

fn about(axis: Axis, degrees: f64) -> Matrix3<f64> {
    let unit = match axis {
        Axis::X => Vector3::x_axis(),
        Axis::Y => Vector3::y_axis(),
        Axis::Z => Vector3::z_axis(),
    };
    Rotation3::from_axis_angle(&unit, degrees.to_radians()).into_inner()
}

/// The rotation that positions are turned by: up becomes Y by the shortest way.
fn to_y_up(up: UpAxis) -> Matrix3<f64> {
    let sign = if up.is_reversed() { -1.0 } else { 1.0 };
    match up.axis() {
        Axis::X => about(Axis::Z, 90.0 * sign),
        Axis::Y if up.is_reversed() => about(Axis::X, 180.0),
        Axis::Y => Matrix3::identity(),
        Axis::Z => about(Axis::X, -90.0 * sign),
    }
}

#[cfg(test)]
mod tests;
