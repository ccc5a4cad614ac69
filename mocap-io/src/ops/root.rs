use std::f64::consts::PI;

use nalgebra::{Matrix3, Vector3};

use super::interpolate::frame_by_frame;
use crate::kinematics::{axis_matrix, rotate_columns, rotations};
use crate::rotation::Euler;
use crate::{Axis, Channel, Joint, Motion, OffsetFrame};

/// A +Z axis whose floor part is shorter than this points straight up or down: its direction on the
/// floor would be rounding noise.
const VERTICAL: f64 = 1e-9;

/// A place on the floor and a direction to face; also the rigid motion on the floor that takes the
/// origin, facing +Z, there.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Facing {
    /// Radians about Y.
    pub(super) yaw: f64,
    /// X and Z in metres.
    pub(super) at: [f64; 2],
}

impl Facing {
    /// Where this motion takes `inner`.
    pub(super) fn then(self, inner: Facing) -> Facing {
        let (sin, cos) = self.yaw.sin_cos();
        let ([x, z], [to_x, to_z]) = (inner.at, self.at);
        Facing {
            yaw: self.yaw + inner.yaw,
            at: [cos * x + sin * z + to_x, cos * z - sin * x + to_z],
        }
    }

    pub(super) fn inverse(self) -> Facing {
        let back = Facing {
            yaw: -self.yaw,
            at: [0.0; 2],
        };
        let at = self.at.map(|v| -v);
        back.then(Facing { yaw: 0.0, at })
    }

    /// `self` as seen from `before`, turned the shorter way round.
    pub(super) fn step_from(self, before: Facing) -> Facing {
        let step = before.inverse().then(self);
        let turns = (step.yaw / (2.0 * PI)).round();
        Facing {
            yaw: step.yaw - 2.0 * PI * turns,
            ..step
        }
    }

    /// The step at `t` of the way from one step to another.
    pub(super) fn mix(self, other: Facing, t: f64) -> Facing {
        let line = |a: f64, b: f64| a + t * (b - a);
        Facing {
            yaw: line(self.yaw, other.yaw),
            at: [0, 1].map(|i| line(self.at[i], other.at[i])),
        }
    }
}

/// The channels that place and turn a root.
struct Root {
    /// Column of the translation along each of the file's axes.
    translations: [Option<usize>; 3],
    /// Rotation channels, leftmost factor first.
    factors: Vec<(Axis, usize)>,
    /// Set where these are three different axes.
    euler: Option<Euler>,
    /// `C`; `None` where there is no axis frame or it is the identity.
    axis: Option<Matrix3<f64>>,
    /// What a translation adds to; where there is none, the place.
    offset: Vector3<f64>,
    /// Translations replace the offset (BVH) instead of adding to it (Acclaim).
    replaces: bool,
}

impl Root {
    fn new(joint: &Joint, first: usize, frame: OffsetFrame) -> Root {
        let mut translations = [None; 3];
        for (channel, column) in joint.channels.iter().zip(first..) {
            if let Channel::Translation(axis) = channel {
                translations[axis.idx()] = Some(column);
            }
        }
        let factors = rotations(joint, first);
        Root {
            translations,
            euler: Euler::new(&factors),
            factors,
            axis: joint
                .axis
                .map(axis_matrix)
                .filter(|&c| c != Matrix3::identity()),
            offset: Vector3::from(joint.offset),
            replaces: frame == OffsetFrame::Parent,
        }
    }

    /// In file units and axes.
    fn place(&self, row: &[f64]) -> [f64; 3] {
        [0, 1, 2].map(|i| match self.translations[i] {
            Some(column) if self.replaces => row[column],
            Some(column) => self.offset[i] + row[column],
            None => self.offset[i],
        })
    }

    fn set_place(&self, place: [f64; 3], row: &mut [f64]) {
        for (i, place) in place.into_iter().enumerate() {
            let origin = if self.replaces { 0.0 } else { self.offset[i] };
            if let Some(column) = self.translations[i] {
                row[column] = place - origin;
            }
        }
    }

    /// `M`, the product of the rotation channels.
    fn turned(&self, row: &[f64]) -> Matrix3<f64> {
        let mut turned = Matrix3::identity();
        for &(axis, column) in &self.factors {
            rotate_columns(&mut turned, axis, row[column].to_radians());
        }
        turned
    }

    /// `C · M · C⁻¹` in the file's axes.
    fn rotation(&self, row: &[f64]) -> Matrix3<f64> {
        let turned = self.turned(row);
        match &self.axis {
            Some(c) => c * turned * c.transpose(),
            None => turned,
        }
    }

    /// Turns the root by `degrees` about `up` in the file's axes.
    fn turn(&self, up: Axis, degrees: f64, near: &[f64], row: &mut [f64]) {
        let Some(euler) = &self.euler else { return };
        match &self.axis {
            // Outermost is the rotation about the up axis: its angle says it all.
            None if euler.order[0] == up => {
                let [first, second, third] = euler.degrees(row);
                euler.write_degrees([first + degrees, second, third], near, row);
            }
            axis => {
                let mut turn = Matrix3::identity();
                rotate_columns(&mut turn, up, degrees.to_radians());
                let turned = turn * self.rotation(row);
                let rotation = match axis {
                    Some(c) => c.transpose() * turned * c,
                    None => turned,
                };
                euler.write(&rotation, near, row);
            }
        }
    }
}

/// The roots of a motion. All of them can be moved if the motion comes from
/// [`Motion::with_free_roots`].
pub(super) struct Roots {
    roots: Vec<Root>,
    up: [(Axis, f64); 3],
    metres: f64,
}

impl Roots {
    pub(super) fn new(motion: &Motion) -> Roots {
        let frame = motion.skeleton.offset_frame();
        let mut roots = Vec::new();
        let mut first = 0;
        for joint in motion.skeleton.joints() {
            if joint.parent.is_none() {
                roots.push(Root::new(joint, first, frame));
            }
            first += joint.channels.len();
        }
        Roots {
            roots,
            up: motion.up.axes(),
            metres: motion.unit.metres(),
        }
    }

    /// The yaw of the first root's +Z axis (of positions, Y up); `None` if that is vertical or missing.
    pub(super) fn yaw(&self, row: &[f64]) -> Option<f64> {
        let rotation = self.roots.first()?.rotation(row);
        let [(side, side_sign), _, (front, front_sign)] = self.up;
        let z = rotation.column(front.idx()) * front_sign;
        let (x, z) = (z[side.idx()] * side_sign, z[front.idx()] * front_sign);
        (x.hypot(z) >= VERTICAL).then(|| x.atan2(z))
    }

    /// Where the first root stands on the floor, facing `yaw`; `None` if its place is missing.
    pub(super) fn facing(&self, row: &[f64], yaw: f64) -> Option<Facing> {
        let place = self.roots.first()?.place(row);
        let [x, _, z] = self
            .up
            .map(|(axis, sign)| place[axis.idx()] * sign * self.metres);
        (x + z).is_finite().then_some(Facing { yaw, at: [x, z] })
    }

    /// Whether the first root's rotation is there.
    pub(super) fn is_turned(&self, row: &[f64]) -> bool {
        let root = self.roots.first();
        root.is_some_and(|r| r.factors.iter().all(|&(_, column)| row[column].is_finite()))
    }

    /// Makes all roots missing.
    pub(super) fn clear(&self, row: &mut [f64]) {
        for root in &self.roots {
            let rotations = root.factors.iter().map(|&(_, column)| column);
            for column in rotations.chain(root.translations.into_iter().flatten()) {
                row[column] = f64::NAN;
            }
        }
    }

    /// Moves all roots, with angles near those of `near`.
    pub(super) fn shift(&self, by: Facing, near: &[f64], row: &mut [f64]) {
        let [(x, x_sign), (up, up_sign), (z, z_sign)] = self.up;
        for root in &self.roots {
            let mut place = root.place(row);
            let at = [
                place[x.idx()] * x_sign * self.metres,
                place[z.idx()] * z_sign * self.metres,
            ];
            let [to_x, to_z] = by.then(Facing { yaw: 0.0, at }).at;
            place[x.idx()] = to_x * x_sign / self.metres;
            place[z.idx()] = to_z * z_sign / self.metres;
            root.set_place(place, row);
            if by.yaw != 0.0 {
                root.turn(up, by.yaw.to_degrees() * up_sign, near, row);
            }
        }
    }
}

/// Whether a root has translations and rotations for every rigid motion.
fn is_free(root: &Root) -> bool {
    root.euler.is_some() && root.translations.iter().all(Option::is_some)
}

impl Motion {
    /// The same motion with roots that can be anywhere: each has translations along all three axes and
    /// rotations about three different ones.
    ///
    /// Missing translations come first and keep the root where it was. Rotation channels that cannot
    /// hold every rotation give way to three new ones at the end: up axis outermost in BVH, the order of
    /// the axis frame in Acclaim. Channels that suffice stay as they are, and all other joints do.
    ///
    /// O(frames · channels).
    #[must_use]
    pub fn with_free_roots(&self) -> Motion {
        let skeleton = &self.skeleton;
        let frame = skeleton.offset_frame();
        let (mut joints, mut sources, mut rewritten) = (Vec::new(), Vec::new(), Vec::new());
        let mut first = 0;
        for joint in skeleton.joints() {
            let root = Root::new(joint, first, frame);
            let columns = || joint.channels.iter().copied().zip((first..).map(Some));
            let mut pairs: Vec<(Channel, Option<usize>)> = Vec::new();
            if joint.parent.is_some() || is_free(&root) {
                pairs.extend(columns());
            } else {
                let missing = Axis::ALL
                    .into_iter()
                    .filter(|a| root.translations[a.idx()].is_none());
                pairs.extend(missing.map(|axis| (Channel::Translation(axis), None)));
                let is_kept =
                    |c: Channel| root.euler.is_some() || !matches!(c, Channel::Rotation(_));
                pairs.extend(columns().filter(|&(channel, _)| is_kept(channel)));
                if root.euler.is_none() {
                    let order = free_order(joint, self.up.axis());
                    pairs.extend(order.map(|axis| (Channel::Rotation(axis), None)));
                }
                rewritten.push((joints.len(), root));
            }
            first += joint.channels.len();
            joints.push(Joint {
                channels: pairs.iter().map(|&(channel, _)| channel).collect(),
                ..joint.clone()
            });
            sources.extend(pairs.into_iter().map(|(_, source)| source));
        }
        if rewritten.is_empty() {
            return self.clone();
        }
        let skeleton = crate::Skeleton::new(joints, frame).expect("only channels were added");
        let new_root = |&(j, _): &(usize, Root)| {
            let first = skeleton.first_channel(j).unwrap_or(0);
            Root::new(&skeleton.joints()[j], first, frame)
        };
        let new_roots: Vec<Root> = rewritten.iter().map(new_root).collect();
        let (n_frames, n_channels) = (self.n_frames(), sources.len());
        let channels = frame_by_frame(n_frames, n_channels, self.rows(), |old, near, new| {
            for (value, source) in new.iter_mut().zip(&sources) {
                *value = source.map_or(0.0, |column: usize| old[column]);
            }
            for ((_, old_root), root) in rewritten.iter().zip(&new_roots) {
                root.set_place(old_root.place(&old), new);
                if let (None, Some(euler)) = (&old_root.euler, &root.euler) {
                    let near = near.map_or([0.0; 3], |near| euler.degrees(near));
                    euler.write_near(&old_root.turned(&old), near, new);
                }
            }
        });
        Motion {
            skeleton,
            channels,
            ..self.without_frames()
        }
    }
}

/// New rotation channels, leftmost factor first. Where there is an axis frame, its order counts.
fn free_order(joint: &Joint, up: Axis) -> [Axis; 3] {
    match (joint.axis, up) {
        (Some(_), _) | (None, Axis::X) => Axis::ALL,
        (None, Axis::Y) => [Axis::Y, Axis::X, Axis::Z],
        (None, Axis::Z) => [Axis::Z, Axis::X, Axis::Y],
    }
}
