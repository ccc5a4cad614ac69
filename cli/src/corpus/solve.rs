use nalgebra::{Matrix3, Rotation3, Vector3};

use super::body::Body;
use super::class::Side;
use super::curve::{ease, soft_positive};
use super::pose::{Arm, Bend, Leg, Pose};

/// A leg is never stretched further than this share of its length: close to straight, the knee
/// angle changes without bound for small movements of the hip.
const MAX_STRETCH: f64 = 0.9992;
/// Metres over which limits of reach set in for a foot on the floor, and for one in the air, which
/// may give way.
const SOFTNESS: [f64; 2] = [0.002, 0.025];
/// Metres by which the sole may sink into the floor before the foot is pushed up.
const SOLE_GIVE: f64 = 0.004;
/// The lowest the wrist's joint centre gets, metres: half a wrist.
const WRIST_CLEARANCE: f64 = 0.033;

/// Turns poses into channel values, frame by frame. Of the many Euler angles of a rotation it takes
/// those nearest to the last frame's, so successive frames never jump.
#[derive(Clone, Debug)]
pub(crate) struct Solver<'a> {
    body: &'a Body,
    /// Axis frame of each bone.
    axes: Vec<Matrix3<f64>>,
    limbs: [Limbs; 2],
    trunk: [usize; 3],
    neck: [usize; 3],
    /// Angles in degrees of every bone, X, Y, Z; zero where there is no degree of freedom.
    angles: Vec<[f64; 3]>,
}

/// Bone indices of one side.
#[derive(Clone, Copy, Debug)]
struct Limbs {
    femur: usize,
    tibia: usize,
    foot: usize,
    toes: usize,
    clavicle: usize,
    humerus: usize,
    radius: usize,
    wrist: usize,
    hand: usize,
    fingers: usize,
    thumb: usize,
}

impl<'a> Solver<'a> {
    pub(crate) fn new(body: &'a Body) -> Solver<'a> {
        // A name that is missing would be a slip in this module's sibling; index 0 is harmless.
        let find = |name: &str| body.find(name).unwrap_or(0);
        let limbs = ["l", "r"].map(|side| {
            let part = |part: &str| find(&format!("{side}{part}"));
            Limbs {
                femur: part("femur"),
                tibia: part("tibia"),
                foot: part("foot"),
                toes: part("toes"),
                clavicle: part("clavicle"),
                humerus: part("humerus"),
                radius: part("radius"),
                wrist: part("wrist"),
                hand: part("hand"),
                fingers: part("fingers"),
                thumb: part("thumb"),
            }
        });
        Solver {
            body,
            axes: body.bones.iter().map(|bone| bone.axis_frame()).collect(),
            limbs,
            trunk: ["lowerback", "upperback", "thorax"].map(find),
            neck: ["lowerneck", "upperneck", "head"].map(find),
            angles: vec![[0.0; 3]; body.bones.len()],
        }
    }

    /// Channel values of `pose`: the root's place in metres, and every bone's angles in degrees.
    pub(crate) fn solve(&mut self, pose: &Pose) -> (Vector3<f64>, &[[f64; 3]]) {
        let pelvis = pose.pelvis();
        let root = pose.root - Vector3::y() * self.sinking(pose, &pelvis);
        self.angles[0] = nearest_euler(pelvis.matrix(), self.angles[0]);
        for side in Side::BOTH {
            self.solve_leg(pose, side, root, pelvis.matrix());
        }
        let chest = self.solve_trunk(pose, &pelvis);
        let neck = root + self.trunk_end(&pelvis);
        for side in Side::BOTH {
            self.solve_arm(&pose.arms[side.idx()], side, neck, &chest);
        }
        (root, &self.angles)
    }

    /// How far the pelvis must sink for both feet that carry load to be in reach.
    fn sinking(&self, pose: &Pose, pelvis: &Rotation3<f64>) -> f64 {
        let longest = MAX_STRETCH * self.body.leg();
        let excess = Side::BOTH.map(|side| {
            let leg = &pose.legs[side.idx()];
            let hip = pose.root + pelvis * self.body.hip_of(side);
            let apart = (leg.ankle - hip).xz().norm();
            let below = (longest * longest - apart * apart).max(0.0).sqrt();
            leg.load * soft_positive(hip.y - leg.ankle.y - below, SOFTNESS[0])
        });
        excess[1] + soft_positive(excess[0] - excess[1], SOFTNESS[0])
    }

    fn solve_leg(&mut self, pose: &Pose, side: Side, root: Vector3<f64>, pelvis: &Matrix3<f64>) {
        let leg = &pose.legs[side.idx()];
        let limbs = self.limbs[side.idx()];
        let hip = root + pelvis * self.body.hip_of(side);
        let (direction, distance) = unit(self.above_floor(leg) - hip);
        let longest = MAX_STRETCH * self.body.leg();
        let softness = SOFTNESS[0] + (SOFTNESS[1] - SOFTNESS[0]) * (1.0 - leg.load);
        let distance = longest - soft_positive(longest - distance, softness);
        // The knee points where it would if the leg had been swung from hanging straight down.
        let swing = shortest_turn(-pelvis.column(1).into_owned(), direction);
        let outward = 0.4 * (leg.yaw - pose.yaw) + side.sign() * leg.knee_out;
        let twist = axis_turn(-direction, outward.to_radians());
        let front = twist * (swing * pelvis.column(2).into_owned());
        let (thigh, shank) = (self.body.thigh, self.body.shank);
        let (at_hip, at_knee) = triangle(thigh, shank, distance);
        let hinge = (-direction).cross(&front).normalize();
        let thigh_direction = axis_turn(-hinge, at_hip) * direction;
        let femur = frame(hinge, -thigh_direction);
        let parent = pelvis * self.axes[limbs.femur];
        self.angles[limbs.femur] =
            nearest_euler(&(parent.transpose() * femur), self.angles[limbs.femur]);
        let knee = std::f64::consts::PI - at_knee;
        self.angles[limbs.tibia] = [knee.to_degrees(), 0.0, 0.0];
        // Thigh and shank have the same axis frame, so the shank's frame is the thigh's, bent.
        let tibia = femur * rotation_x(knee);
        let ankle = hip + thigh_direction * thigh - tibia.column(1) * shank;
        self.solve_foot(
            pose,
            side,
            ankle,
            &(tibia * self.axes[limbs.tibia].transpose()),
        );
    }

    /// The ankle, raised where the ball of the foot would be in the floor.
    fn above_floor(&self, leg: &Leg) -> Vector3<f64> {
        let pitch = axis_turn(Vector3::x(), leg.pitch.to_radians());
        let ball = leg.ankle.y + (pitch * self.body.to_ball()).y;
        let lift = soft_positive(self.body.sole - SOLE_GIVE - ball, SOLE_GIVE);
        leg.ankle + Vector3::y() * lift
    }

    fn solve_foot(&mut self, pose: &Pose, side: Side, ankle: Vector3<f64>, tibia: &Matrix3<f64>) {
        let leg = &pose.legs[side.idx()];
        let limbs = self.limbs[side.idx()];
        let yaw = axis_turn(Vector3::y(), leg.yaw.to_radians());
        let pitch = axis_turn(Vector3::x(), leg.pitch.to_radians());
        let to_ball = yaw * (pitch * self.body.to_ball());
        let axis = self.axes[limbs.foot];
        let rest = axis.transpose() * self.body.bones[limbs.foot].offset;
        let wanted = axis.transpose() * (tibia.transpose() * to_ball);
        let (rx, rz) = aim_xz(rest, wanted);
        let near = self.angles[limbs.foot];
        self.angles[limbs.foot] = [rx.to_degrees(), 0.0, near_turn(rz.to_degrees(), near[2])];
        // Toes stay flat while the ball of the foot is on the floor, and relax in the air.
        let height = ankle.y + to_ball.y - self.body.sole;
        let contact = 1.0 - ease(0.01, 0.14, height);
        let bend = soft_positive(leg.pitch, 3.0) * (0.15 + 0.85 * contact);
        self.angles[limbs.toes] = [-bend.min(70.0), 0.0, 0.0];
    }

    /// Sets spine and neck; returns the rotation of the chest.
    fn solve_trunk(&mut self, pose: &Pose, pelvis: &Rotation3<f64>) -> Matrix3<f64> {
        for bone in self.trunk {
            self.angles[bone] = thirds(&pose.spine);
        }
        let mut head = pose.head;
        head.flex -= pose.gaze * (pose.lean + pose.spine.flex).clamp(-50.0, 60.0);
        for bone in self.neck {
            self.angles[bone] = thirds(&head);
        }
        let third = euler(thirds(&pose.spine));
        pelvis.matrix() * third * third * third
    }

    /// From the root to the base of the neck.
    fn trunk_end(&self, pelvis: &Rotation3<f64>) -> Vector3<f64> {
        let mut turn = *pelvis.matrix();
        let mut end = Vector3::zeros();
        for bone in self.trunk {
            turn *= euler(self.angles[bone]);
            end += turn * self.body.bones[bone].offset;
        }
        end
    }

    fn solve_arm(&mut self, arm: &Arm, side: Side, neck: Vector3<f64>, chest: &Matrix3<f64>) {
        let limbs = self.limbs[side.idx()];
        let s = side.sign();
        let held = chest * arm_rotation(arm, side);
        let down = -held.column(1).into_owned();
        self.angles[limbs.clavicle] = shrug(chest.transpose() * down, s);
        let clavicle = chest * euler(self.angles[limbs.clavicle]);
        let shoulder = neck + clavicle * self.body.bones[limbs.clavicle].offset;
        let front = held.column(2).into_owned();
        let elbow = arm.elbow.to_radians();
        let (upper, fore) = (self.body.upper_arm, self.body.forearm);
        let bent = down * elbow.cos() + front * elbow.sin();
        let free = shoulder + down * upper + bent * fore;
        let mut wrist = free + (arm.reach - free) * arm.reach_weight;
        // The hand continues the arm: the steeper the arm, the higher the wrist above the fingertips.
        let hand = self.body.bones[limbs.hand].offset.norm()
            + self.body.bones[limbs.fingers].offset.norm();
        let lowest = WRIST_CLEARANCE + hand * soft_positive(-unit(wrist - shoulder).0.y, 0.1);
        wrist.y = lowest + soft_positive(wrist.y - lowest, 0.01);
        let (direction, distance) = unit(wrist - shoulder);
        let longest = 0.999 * (upper + fore);
        let softness = 0.001 + 0.04 * arm.reach_weight;
        let distance = longest - soft_positive(longest - distance, softness);
        // Keep the plane of the free arm: the elbow is on the same side of shoulder and wrist.
        let swing = shortest_turn(unit(free - shoulder).0, direction);
        let hinge = swing * down.cross(&front);
        let (at_shoulder, at_elbow) = triangle(upper, fore, distance);
        let upper_direction = axis_turn(-hinge, at_shoulder) * direction;
        let humerus = frame(hinge, -upper_direction);
        let parent = clavicle * self.axes[limbs.humerus];
        self.angles[limbs.humerus] =
            nearest_euler(&(parent.transpose() * humerus), self.angles[limbs.humerus]);
        let bend = (std::f64::consts::PI - at_elbow).to_degrees();
        self.angles[limbs.radius] = [bend, 0.0, 0.0];
        self.angles[limbs.wrist] = [0.0, -s * 20.0, 0.0];
        self.angles[limbs.hand] = [arm.wrist, 0.0, 0.0];
        self.angles[limbs.fingers] = [5.0 + 80.0 * arm.fist, 0.0, 0.0];
        self.angles[limbs.thumb] = [5.0, 0.0, -s * 25.0 * arm.fist];
    }
}

/// The rotation of an arm from hanging down, elbow's bend forward, relative to the chest.
fn arm_rotation(arm: &Arm, side: Side) -> Matrix3<f64> {
    let s = side.sign();
    axis_turn(Vector3::x(), -arm.flex.to_radians())
        * axis_turn(Vector3::z(), s * arm.spread.to_radians())
        * axis_turn(Vector3::y(), -s * arm.twist.to_radians())
}

/// Angles of the clavicle for an upper arm that points along `down` in the chest frame: it rises
/// with the arm and goes forward with it.
fn shrug(down: Vector3<f64>, s: f64) -> [f64; 3] {
    let raise = 20.0 * ease(-0.6, 1.0, down.y);
    let protract = 9.0 * soft_positive(down.z, 0.2);
    [0.0, -s * protract, s * raise]
}

fn thirds(bend: &Bend) -> [f64; 3] {
    [bend.flex / 3.0, bend.twist / 3.0, -bend.side / 3.0]
}

fn unit(v: Vector3<f64>) -> (Vector3<f64>, f64) {
    let length = v.norm().max(1e-9);
    (v / length, length)
}

/// The frame with X along `x` and Y along `y`, which are perpendicular unit vectors.
fn frame(x: Vector3<f64>, y: Vector3<f64>) -> Matrix3<f64> {
    Matrix3::from_columns(&[x, y, x.cross(&y)])
}

fn axis_turn(axis: Vector3<f64>, angle: f64) -> Matrix3<f64> {
    Rotation3::new(axis * angle).into_inner()
}

fn rotation_x(angle: f64) -> Matrix3<f64> {
    axis_turn(Vector3::x(), angle)
}

/// The smallest rotation that takes one unit vector to another.
fn shortest_turn(from: Vector3<f64>, to: Vector3<f64>) -> Matrix3<f64> {
    Rotation3::rotation_between(&from, &to)
        .unwrap_or_else(|| Rotation3::new(Vector3::x() * std::f64::consts::PI))
        .into_inner()
}

/// Angles of the triangle with sides `a`, `b`, `c`: between `a` and `c`, and between `a` and `b`.
fn triangle(a: f64, b: f64, c: f64) -> (f64, f64) {
    let angle = |x: f64, y: f64, opposite: f64| {
        ((x * x + y * y - opposite * opposite) / (2.0 * x * y))
            .clamp(-1.0, 1.0)
            .acos()
    };
    let c = c.max((a - b).abs() + 1e-6);
    (angle(a, c, b), angle(a, b, c))
}

/// Rz·Ry·Rx.
pub(crate) fn euler(degrees: [f64; 3]) -> Matrix3<f64> {
    let [x, y, z] = degrees.map(f64::to_radians);
    Rotation3::from_euler_angles(x, y, z).into_inner()
}

/// Angles in degrees with Rz·Ry·Rx = `m`; of all such triples the one nearest to `near`.
fn nearest_euler(m: &Matrix3<f64>, near: [f64; 3]) -> [f64; 3] {
    let x = m[(2, 1)].atan2(m[(2, 2)]).to_degrees();
    let y = (-m[(2, 0)]).clamp(-1.0, 1.0).asin().to_degrees();
    let z = m[(1, 0)].atan2(m[(0, 0)]).to_degrees();
    let candidates = [[x, y, z], [x + 180.0, 180.0 - y, z + 180.0]]
        .map(|c| std::array::from_fn(|i| near_turn(c[i], near[i])));
    let far = |c: &[f64; 3]| (0..3).map(|i| (c[i] - near[i]).powi(2)).sum::<f64>();
    if far(&candidates[1]) < far(&candidates[0]) {
        candidates[1]
    } else {
        candidates[0]
    }
}

/// `degrees` plus the number of full turns that brings it closest to `near`.
fn near_turn(degrees: f64, near: f64) -> f64 {
    degrees - 360.0 * ((degrees - near) / 360.0).round()
}

/// Angles `x`, `z` with Rz·Rx·`rest` along `wanted`; both have about the same length.
fn aim_xz(rest: Vector3<f64>, wanted: Vector3<f64>) -> (f64, f64) {
    let radius = rest.y.hypot(rest.z).max(1e-9);
    // Rx moves z as radius · cos(x − lead); of the two solutions, y keeps its sign in one.
    let lead = rest.y.atan2(rest.z);
    let turned = rest.y.signum() * (wanted.z / radius).clamp(-1.0, 1.0).acos();
    let z = wanted.y.atan2(wanted.x) - (radius * turned.sin()).atan2(rest.x);
    (lead - turned, z)
}
