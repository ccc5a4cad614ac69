use nalgebra::{Rotation3, Vector3};

use super::body::Body;
use super::class::Side;
use super::curve::ease;
use super::performer::Performer;

/// A bend of the trunk or the neck, degrees: forward, to the left, turned to the left.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Bend {
    pub(crate) flex: f64,
    pub(crate) side: f64,
    pub(crate) twist: f64,
}

/// Where a foot is; the knee follows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Leg {
    pub(crate) ankle: Vector3<f64>,
    /// Toes down, degrees.
    pub(crate) pitch: f64,
    /// Toes to the left, degrees.
    pub(crate) yaw: f64,
    /// Knee outward from where the pelvis points, degrees.
    pub(crate) knee_out: f64,
    /// 1 if the pelvis sinks so that this leg reaches its foot, 0 if the foot gives way instead.
    pub(crate) load: f64,
}

/// How an arm is held relative to the chest, degrees. At zero it hangs down, palm inward.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Arm {
    /// Raised forward: 90 points to the front, 180 up. Applied after `spread`.
    pub(crate) flex: f64,
    /// Raised to the side: 90 points outward.
    pub(crate) spread: f64,
    /// The bent forearm turned inward about the upper arm.
    pub(crate) twist: f64,
    pub(crate) elbow: f64,
    /// The wrist bent palmward.
    pub(crate) wrist: f64,
    /// 0 open hand, 1 fist.
    pub(crate) fist: f64,
    /// A place for the wrist that replaces the angles as far as `reach_weight` says.
    pub(crate) reach: Vector3<f64>,
    pub(crate) reach_weight: f64,
}

/// A whole-body pose: what motions are written in. Metres and degrees, +Y up; a figure at zero yaw
/// faces +Z. Index 0 of limbs is left.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Pose {
    pub(crate) root: Vector3<f64>,
    /// Pelvis turned to the left.
    pub(crate) yaw: f64,
    /// Pelvis tipped forward.
    pub(crate) lean: f64,
    /// Pelvis tipped to the left.
    pub(crate) tilt: f64,
    pub(crate) spine: Bend,
    pub(crate) head: Bend,
    /// How far the head stays level when the trunk bends: 0 not at all, 1 fully.
    pub(crate) gaze: f64,
    pub(crate) legs: [Leg; 2],
    pub(crate) arms: [Arm; 2],
}

/// Numbers in a [`Pose`].
pub(crate) const POSE_LEN: usize = 47;

impl Pose {
    pub(crate) fn to_array(self) -> [f64; POSE_LEN] {
        let mut out = [0.0; POSE_LEN];
        let mut slots = out.iter_mut();
        self.for_each(|v| {
            if let Some(slot) = slots.next() {
                *slot = v;
            }
        });
        out
    }

    pub(crate) fn from_array(values: &[f64; POSE_LEN]) -> Pose {
        let mut pose = Pose::default();
        let mut values = values.iter();
        pose.for_each_mut(|slot| {
            if let Some(&value) = values.next() {
                *slot = value;
            }
        });
        pose
    }

    fn for_each(mut self, mut visit: impl FnMut(f64)) {
        self.for_each_mut(|v| visit(*v));
    }

    fn for_each_mut(&mut self, mut visit: impl FnMut(&mut f64)) {
        self.root.iter_mut().for_each(&mut visit);
        for v in [
            &mut self.yaw,
            &mut self.lean,
            &mut self.tilt,
            &mut self.gaze,
        ] {
            visit(v);
        }
        for bend in [&mut self.spine, &mut self.head] {
            for v in [&mut bend.flex, &mut bend.side, &mut bend.twist] {
                visit(v);
            }
        }
        for leg in &mut self.legs {
            leg.ankle.iter_mut().for_each(&mut visit);
            for v in [
                &mut leg.pitch,
                &mut leg.yaw,
                &mut leg.knee_out,
                &mut leg.load,
            ] {
                visit(v);
            }
        }
        for arm in &mut self.arms {
            for v in [
                &mut arm.flex,
                &mut arm.spread,
                &mut arm.twist,
                &mut arm.elbow,
            ] {
                visit(v);
            }
            arm.reach.iter_mut().for_each(&mut visit);
            for v in [&mut arm.wrist, &mut arm.fist, &mut arm.reach_weight] {
                visit(v);
            }
        }
    }

    /// The same pose with left and right exchanged.
    pub(crate) fn mirrored(mut self) -> Pose {
        self.root.x = -self.root.x;
        for bend in [&mut self.spine, &mut self.head] {
            bend.side = -bend.side;
            bend.twist = -bend.twist;
        }
        self.yaw = -self.yaw;
        self.tilt = -self.tilt;
        self.legs.swap(0, 1);
        self.arms.swap(0, 1);
        for leg in &mut self.legs {
            leg.ankle.x = -leg.ankle.x;
            leg.yaw = -leg.yaw;
        }
        for arm in &mut self.arms {
            arm.reach.x = -arm.reach.x;
        }
        self
    }

    /// The pose seen from the frame in which `place` is where it stood.
    pub(crate) fn moved_to(mut self, place: &Place) -> Pose {
        self.root = place.point(self.root);
        self.yaw += place.heading;
        for leg in &mut self.legs {
            leg.ankle = place.point(leg.ankle);
            leg.yaw += place.heading;
        }
        for arm in &mut self.arms {
            arm.reach = place.point(arm.reach);
        }
        self
    }

    pub(crate) fn leg(&mut self, side: Side) -> &mut Leg {
        &mut self.legs[side.idx()]
    }

    pub(crate) fn arm(&mut self, side: Side) -> &mut Arm {
        &mut self.arms[side.idx()]
    }

    /// Does the same to both arms.
    pub(crate) fn both_arms(&mut self, change: impl Fn(&mut Arm)) {
        self.arms.iter_mut().for_each(change);
    }

    /// Rotation of the pelvis.
    pub(crate) fn pelvis(&self) -> Rotation3<f64> {
        let yaw = Rotation3::from_axis_angle(&Vector3::y_axis(), self.yaw.to_radians());
        let lean = Rotation3::from_axis_angle(&Vector3::x_axis(), self.lean.to_radians());
        let tilt = Rotation3::from_axis_angle(&Vector3::z_axis(), -self.tilt.to_radians());
        yaw * lean * tilt
    }

    /// Places a leg by the angle of its thigh (forward from straight down, in the world), its
    /// outward angle and the bend of the knee. The foot is pointed by `point` degrees.
    pub(crate) fn swing_leg(
        &mut self,
        body: &Body,
        side: Side,
        thigh: f64,
        out: f64,
        knee: f64,
        point: f64,
    ) {
        let hip = self.root + self.pelvis() * body.hip_of(side);
        let down = |angle: f64, length: f64| {
            let (sin, cos) = angle.to_radians().sin_cos();
            Vector3::new(0.0, -cos * length, sin * length)
        };
        let outward =
            Rotation3::from_axis_angle(&Vector3::z_axis(), side.sign() * out.to_radians());
        let heading = Rotation3::from_axis_angle(&Vector3::y_axis(), self.yaw.to_radians());
        let reach = down(thigh, body.thigh) + down(thigh - knee, body.shank);
        let yaw = self.yaw;
        let leg = self.leg(side);
        leg.ankle = hip + heading * (outward * reach);
        leg.pitch = knee - thigh + point;
        leg.yaw = yaw + side.sign() * 2.0;
        leg.load = 0.0;
    }
}

/// A place on the floor and the direction faced there.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Place {
    pub(crate) x: f64,
    pub(crate) z: f64,
    /// Degrees to the left of +Z.
    pub(crate) heading: f64,
}

impl Place {
    pub(crate) fn point(&self, local: Vector3<f64>) -> Vector3<f64> {
        let turn = Rotation3::from_axis_angle(&Vector3::y_axis(), self.heading.to_radians());
        turn * local + Vector3::new(self.x, 0.0, self.z)
    }

    /// The place that is at `next` seen from here.
    pub(crate) fn then(&self, next: &Place) -> Place {
        let at = self.point(Vector3::new(next.x, 0.0, next.z));
        Place {
            x: at.x,
            z: at.z,
            heading: self.heading + next.heading,
        }
    }
}

/// How a foot meets the floor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Footing {
    /// Where the ankle is above when the foot is flat.
    pub(crate) x: f64,
    pub(crate) z: f64,
    /// Toes to the left, degrees.
    pub(crate) yaw: f64,
    /// Positive: rolled onto the ball, heel up. Negative: on the heel, toes up. Degrees.
    pub(crate) pitch: f64,
    /// Height of the sole above the floor.
    pub(crate) lift: f64,
}

impl Footing {
    /// The leg that stands like this.
    pub(crate) fn leg(&self, body: &Body) -> Leg {
        let heel = Vector3::new(0.0, -body.ankle_height, -body.heel);
        let ball = body.to_ball();
        let pitch = Rotation3::from_axis_angle(&Vector3::x_axis(), self.pitch.to_radians());
        let yaw = Rotation3::from_axis_angle(&Vector3::y_axis(), self.yaw.to_radians());
        // Where the ankle goes when the foot rolls about a point of the sole. Both points count
        // near the flat foot, so that the ankle moves smoothly from one to the other.
        let rolled = |pivot: Vector3<f64>| pivot - pitch * pivot;
        let on_ball = ease(-BOTH_PIVOTS, BOTH_PIVOTS, self.pitch);
        let shift = rolled(ball) * on_ball + rolled(heel) * (1.0 - on_ball);
        let flat = Vector3::new(self.x, body.ankle_height + self.lift, self.z);
        Leg {
            ankle: flat + yaw * shift,
            pitch: self.pitch,
            yaw: self.yaw,
            knee_out: 0.0,
            load: 1.0,
        }
    }
}

/// Pitch in degrees up to which ball and heel share the roll of a foot.
const BOTH_PIVOTS: f64 = 8.0;

/// A body with the habits of its owner.
#[derive(Clone, Debug)]
pub(crate) struct Actor {
    pub(crate) performer: Performer,
    pub(crate) body: Body,
}

impl Actor {
    pub(crate) fn new(performer: Performer) -> Actor {
        Actor {
            performer,
            body: Body::new(&performer),
        }
    }

    /// Distance of each ankle from the middle in neutral standing.
    pub(crate) fn half_stance(&self) -> f64 {
        self.body.hip.x * self.performer.style.stance
    }

    /// Height of the root when standing with the legs nearly straight.
    pub(crate) fn standing_height(&self) -> f64 {
        self.body.ankle_height + 0.9995 * self.body.leg() - self.body.hip.y
    }

    /// The neutral footing of `side`.
    pub(crate) fn footing(&self, side: Side) -> Footing {
        Footing {
            x: side.sign() * self.half_stance(),
            yaw: side.sign() * self.performer.style.toe_out,
            ..Footing::default()
        }
    }

    /// How much `side` moves relative to both sides' mean.
    pub(crate) fn vigour(&self, side: Side) -> f64 {
        1.0 - side.sign() * self.performer.style.handedness
    }

    /// Neutral standing at the origin.
    pub(crate) fn stand(&self) -> Pose {
        let style = &self.performer.style;
        let arm = Arm {
            flex: 1.0,
            spread: style.arm_spread,
            twist: 12.0,
            elbow: style.elbow,
            wrist: 6.0,
            fist: 0.25,
            ..Arm::default()
        };
        Pose {
            root: Vector3::new(0.0, self.standing_height(), 0.0),
            spine: Bend {
                flex: style.stoop,
                ..Bend::default()
            },
            gaze: 0.7,
            legs: Side::BOTH.map(|side| self.footing(side).leg(&self.body)),
            arms: [arm; 2],
            ..Pose::default()
        }
    }
}
