use mocap_io::{Axis, AxisFrame, Channel, Joint, LengthUnit, OffsetFrame, Skeleton, SkeletonError};
use nalgebra::{Matrix3, Rotation3, Vector3};

use super::class::Side;
use super::performer::Performer;

/// Angle of the legs from the vertical in the rest pose, degrees.
const LEG_SPREAD: f64 = 20.0;
/// How far the elbow's rest plane is turned up from the horizontal, degrees. With the bone along Y
/// of its axis frame, the arm's Euler angles are singular only when the elbow's axis points down
/// and forward, which no motion needs.
const ELBOW_PLANE: f64 = 40.0;

/// A rotational degree of freedom and its range in degrees.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dof {
    pub(crate) axis: Axis,
    pub(crate) low: f64,
    pub(crate) high: f64,
}

/// An Acclaim bone.
#[derive(Clone, Debug)]
pub(crate) struct Bone {
    pub(crate) name: String,
    /// Index of the parent; `None` for the root.
    pub(crate) parent: Option<usize>,
    /// From the start to the end of the bone in the rest pose, metres.
    pub(crate) offset: Vector3<f64>,
    /// Degrees about X, Y, Z.
    pub(crate) axis: [f64; 3],
    pub(crate) dofs: Vec<Dof>,
}

impl Bone {
    /// C = Rz·Ry·Rx.
    pub(crate) fn axis_frame(&self) -> Matrix3<f64> {
        let [x, y, z] = self.axis.map(f64::to_radians);
        Rotation3::from_euler_angles(x, y, z).into_inner()
    }
}

/// A performer's skeleton and the lengths that motions are measured in, metres.
#[derive(Clone, Debug)]
pub(crate) struct Body {
    /// Depth first, the root at index 0.
    pub(crate) bones: Vec<Bone>,
    pub(crate) thigh: f64,
    pub(crate) shank: f64,
    /// From the root to the left hip joint; mirrored for the right one.
    pub(crate) hip: Vector3<f64>,
    pub(crate) upper_arm: f64,
    /// Elbow to wrist.
    pub(crate) forearm: f64,
    /// Height of the ankle above the floor when the foot is flat.
    pub(crate) ankle_height: f64,
    /// Height of the ball of the foot and of the toes when the foot is flat.
    pub(crate) sole: f64,
    /// Ankle to ball, forward.
    pub(crate) instep: f64,
    /// Ankle to the back of the heel.
    pub(crate) heel: f64,
}

// Segment lengths of the average figure, relative to its height, close to those of
// Winter, Biomechanics and Motor Control of Human Movement, fig. 4.1.
const THIGH: f64 = 0.245;
const SHANK: f64 = 0.235;
const ANKLE: f64 = 0.045;
const HIP: [f64; 3] = [0.052, -0.045, 0.015];
const SPINE_BONE: f64 = 0.245 / 3.0;
const NECK_BONES: [f64; 3] = [0.060, 0.055, 0.070];
const CLAVICLE: [f64; 3] = [0.112, 0.012, -0.005];
const UPPER_ARM: f64 = 0.165;
const FOREARM: f64 = 0.148;
/// The Acclaim rig splits the forearm: this share belongs to `radius`, the rest to `wrist`.
const RADIUS_SHARE: f64 = 0.67;
const HAND: f64 = 0.028;
const FINGERS: f64 = 0.024;
const THUMB: f64 = 0.030;
const INSTEP: f64 = 0.075;
const TOES: f64 = 0.038;
const SOLE: f64 = 0.009;
const HEEL: f64 = 0.025;

impl Body {
    pub(crate) fn new(performer: &Performer) -> Body {
        let (height, build) = (performer.height, &performer.build);
        let leg = height * build.legs;
        let arm = height * build.arms;
        // The trunk takes what the legs leave, so that the height is exact.
        let legs_share = (THIGH + SHANK) * build.legs + ANKLE - HIP[1];
        let trunk =
            height * (1.0 - legs_share) / (3.0 * SPINE_BONE + NECK_BONES.iter().sum::<f64>());
        let mut body = Body {
            bones: Vec::with_capacity(31),
            thigh: THIGH * leg,
            shank: SHANK * leg,
            hip: Vector3::new(HIP[0] * build.hips, HIP[1], HIP[2]) * height,
            upper_arm: UPPER_ARM * arm,
            forearm: FOREARM * arm,
            ankle_height: ANKLE * height,
            sole: SOLE * height,
            instep: INSTEP * height,
            heel: HEEL * height,
        };
        let root = body.push("root", None, Vector3::zeros(), [0.0; 3], &[]);
        body.push_leg(root, Side::Left);
        body.push_leg(root, Side::Right);
        let up = |length: f64| Vector3::new(0.0, length * trunk, 0.0);
        let mut tip = root;
        for name in ["lowerback", "upperback", "thorax"] {
            tip = body.push(name, Some(tip), up(SPINE_BONE), [0.0; 3], &TRUNK);
        }
        let thorax = tip;
        for (name, length) in ["lowerneck", "upperneck", "head"]
            .into_iter()
            .zip(NECK_BONES)
        {
            tip = body.push(name, Some(tip), up(length), [0.0; 3], &TRUNK);
        }
        let clavicle = Vector3::new(CLAVICLE[0] * build.shoulders, CLAVICLE[1], CLAVICLE[2]);
        body.push_arm(thorax, Side::Left, clavicle * height);
        body.push_arm(thorax, Side::Right, clavicle * height);
        body
    }

    fn push(
        &mut self,
        name: &str,
        parent: Option<usize>,
        offset: Vector3<f64>,
        axis: [f64; 3],
        dofs: &[Dof],
    ) -> usize {
        self.bones.push(Bone {
            name: name.to_owned(),
            parent,
            offset,
            axis,
            dofs: dofs.to_vec(),
        });
        self.bones.len() - 1
    }

    fn push_leg(&mut self, root: usize, side: Side) {
        let s = side.sign();
        let prefix = prefix(side);
        let name = |part: &str| format!("{prefix}{part}");
        let (sin, cos) = LEG_SPREAD.to_radians().sin_cos();
        // In the frame of the spread leg: forward and down.
        let spread = |forward: f64, down: f64| Vector3::new(s * sin * down, -cos * down, forward);
        let tilt = [0.0, 0.0, s * LEG_SPREAD];
        let foot_tilt = [-90.0, 0.0, s * LEG_SPREAD];
        let joint = mirror(self.hip, side);
        let hip = self.push(&name("hipjoint"), Some(root), joint, [0.0; 3], &[]);
        let thigh = spread(0.0, self.thigh);
        let femur = self.push(&name("femur"), Some(hip), thigh, tilt, &dofs(&FEMUR, side));
        let shank = spread(0.0, self.shank);
        let tibia = self.push(&name("tibia"), Some(femur), shank, tilt, &TIBIA);
        let instep = spread(self.instep, self.ankle_height - self.sole);
        let foot_dofs = dofs(&FOOT, side);
        let foot = self.push(&name("foot"), Some(tibia), instep, foot_tilt, &foot_dofs);
        let toes = spread(TOES / INSTEP * self.instep, 0.0);
        self.push(&name("toes"), Some(foot), toes, foot_tilt, &TOE);
    }

    fn push_arm(&mut self, thorax: usize, side: Side, clavicle: Vector3<f64>) {
        let s = side.sign();
        let prefix = prefix(side);
        let name = |part: &str| format!("{prefix}{part}");
        let along = |length: f64| Vector3::new(s * length, 0.0, 0.0);
        let arm_axis = [180.0, -s * ELBOW_PLANE, -s * 90.0];
        let hand_axis = [0.0, s * 90.0, s * 90.0];
        let scale = self.forearm / FOREARM;
        let shoulder = mirror(clavicle, side);
        let clavicle_dofs = dofs(&CLAVICLE_DOFS, side);
        let clavicle = self.push(
            &name("clavicle"),
            Some(thorax),
            shoulder,
            [0.0; 3],
            &clavicle_dofs,
        );
        let upper_arm = along(self.upper_arm);
        let humerus = self.push(
            &name("humerus"),
            Some(clavicle),
            upper_arm,
            arm_axis,
            &dofs(&HUMERUS, side),
        );
        let (radius, wrist) = self.forearm_bones();
        let radius = self.push(
            &name("radius"),
            Some(humerus),
            along(radius),
            arm_axis,
            &RADIUS,
        );
        let wrist = self.push(
            &name("wrist"),
            Some(radius),
            along(wrist),
            hand_axis,
            &WRIST,
        );
        let hand = self.push(
            &name("hand"),
            Some(wrist),
            along(HAND * scale),
            hand_axis,
            &HAND_DOFS,
        );
        self.push(
            &name("fingers"),
            Some(hand),
            along(FINGERS * scale),
            hand_axis,
            &FINGER,
        );
        let thumb = Vector3::new(s, 0.0, 1.0).normalize() * THUMB * scale;
        let thumb_axis = [-90.0, s * 45.0, 0.0];
        self.push(&name("thumb"), Some(wrist), thumb, thumb_axis, &THUMB_DOFS);
    }

    fn forearm_bones(&self) -> (f64, f64) {
        (
            self.forearm * RADIUS_SHARE,
            self.forearm * (1.0 - RADIUS_SHARE),
        )
    }

    /// Thigh and shank in line.
    pub(crate) fn leg(&self) -> f64 {
        self.thigh + self.shank
    }

    /// From the root to a hip joint, in the pelvis frame.
    pub(crate) fn hip_of(&self, side: Side) -> Vector3<f64> {
        mirror(self.hip, side)
    }

    /// From the root to the left shoulder when the trunk is straight.
    pub(crate) fn shoulder(&self) -> Vector3<f64> {
        let parts = ["lowerback", "upperback", "thorax", "lclavicle"];
        let bones = self
            .bones
            .iter()
            .filter(|bone| parts.contains(&bone.name.as_str()));
        bones.map(|bone| bone.offset).sum()
    }

    /// From the ankle to the ball of the foot when the foot is flat and points forward.
    pub(crate) fn to_ball(&self) -> Vector3<f64> {
        Vector3::new(0.0, self.sole - self.ankle_height, self.instep)
    }

    /// Index of a bone; names are those of [`Body::new`].
    pub(crate) fn find(&self, name: &str) -> Option<usize> {
        self.bones.iter().position(|bone| bone.name == name)
    }

    /// The skeleton as an Acclaim file holds it, in units of `unit`.
    pub(crate) fn skeleton(&self, unit: LengthUnit) -> Result<Skeleton, SkeletonError> {
        let joint = |bone: &Bone| Joint {
            name: bone.name.clone(),
            parent: bone.parent,
            offset: (bone.offset / unit.metres()).into(),
            channels: channels(bone),
            axis: Some(AxisFrame::xyz(bone.axis)),
            end_site: false,
        };
        Skeleton::new(self.bones.iter().map(joint).collect(), OffsetFrame::Own)
    }
}

fn channels(bone: &Bone) -> Vec<Channel> {
    if bone.parent.is_some() {
        return bone
            .dofs
            .iter()
            .map(|dof| Channel::Rotation(dof.axis))
            .collect();
    }
    let translations = Axis::ALL.map(Channel::Translation);
    let rotations = Axis::ALL.map(Channel::Rotation);
    translations.into_iter().chain(rotations).collect()
}

fn prefix(side: Side) -> &'static str {
    match side {
        Side::Left => "l",
        Side::Right => "r",
    }
}

/// A vector given for the left side, on `side`.
fn mirror(v: Vector3<f64>, side: Side) -> Vector3<f64> {
    Vector3::new(side.sign() * v.x, v.y, v.z)
}

/// Ranges given for the left side, on `side`: rotations about Y and Z change sign.
fn dofs(left: &[Dof], side: Side) -> Vec<Dof> {
    left.iter()
        .map(|&dof| match (side, dof.axis) {
            (Side::Left, _) | (_, Axis::X) => dof,
            (Side::Right, axis) => Dof {
                axis,
                low: -dof.high,
                high: -dof.low,
            },
        })
        .collect()
}

const fn dof(axis: Axis, low: f64, high: f64) -> Dof {
    Dof { axis, low, high }
}

const TRUNK: [Dof; 3] = [
    dof(Axis::X, -25.0, 45.0),
    dof(Axis::Y, -30.0, 30.0),
    dof(Axis::Z, -30.0, 30.0),
];
const FEMUR: [Dof; 3] = [
    dof(Axis::X, -160.0, 35.0),
    dof(Axis::Y, -70.0, 70.0),
    dof(Axis::Z, -60.0, 70.0),
];
const TIBIA: [Dof; 1] = [dof(Axis::X, -5.0, 165.0)];
const FOOT: [Dof; 2] = [dof(Axis::X, -60.0, 90.0), dof(Axis::Z, -70.0, 70.0)];
const TOE: [Dof; 1] = [dof(Axis::X, -75.0, 30.0)];
const CLAVICLE_DOFS: [Dof; 2] = [dof(Axis::Y, -20.0, 10.0), dof(Axis::Z, -5.0, 25.0)];
/// Wide: arms circle overhead, and support the body from behind.
const HUMERUS: [Dof; 3] = [
    dof(Axis::X, -180.0, 120.0),
    dof(Axis::Y, -85.0, 85.0),
    dof(Axis::Z, -90.0, 215.0),
];
const RADIUS: [Dof; 1] = [dof(Axis::X, -5.0, 160.0)];
const WRIST: [Dof; 1] = [dof(Axis::Y, -100.0, 100.0)];
const HAND_DOFS: [Dof; 2] = [dof(Axis::X, -80.0, 80.0), dof(Axis::Z, -45.0, 45.0)];
const FINGER: [Dof; 1] = [dof(Axis::X, -10.0, 100.0)];
const THUMB_DOFS: [Dof; 2] = [dof(Axis::X, -45.0, 45.0), dof(Axis::Z, -60.0, 60.0)];
