use nalgebra::Vector3;

use super::action::Action;
use super::class::Side;
use super::curve::{Spline, ease, track};
use super::dice::Dice;
use super::pose::{Actor, Footing, Place, Pose};

/// A way of going. Lengths in legs, angles in degrees, times in shares of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Gait {
    /// Negative to go backward.
    pub(crate) step_length: f64,
    /// Seconds per step at average tempo.
    pub(crate) step_time: f64,
    /// Time a foot is in the air, in steps: above 1 there is a flight phase.
    pub(crate) swing: f64,
    /// How much less than half of its way a foot on the floor is ahead of the pelvis, in steps.
    pub(crate) trail: f64,
    /// How high the foot is lifted.
    pub(crate) clearance: f64,
    /// Pitch of the foot where it meets the floor; negative on the heel.
    pub(crate) strike: f64,
    /// Pitch of the foot where it leaves the floor.
    pub(crate) push_off: f64,
    /// Largest pitch of the foot in the air.
    pub(crate) trailing: f64,
    /// How far the pelvis is below standing height on average.
    pub(crate) sink: f64,
    /// Half the rise and fall of the pelvis: positive if highest in the middle of a stance (as in
    /// walking), negative if highest between two stances (as in running).
    pub(crate) vault: f64,
    pub(crate) sway: f64,
    pub(crate) lean: f64,
    pub(crate) hip_turn: f64,
    pub(crate) chest_turn: f64,
    pub(crate) arm_swing: f64,
    pub(crate) elbow: f64,
}

pub(crate) const WALK: Gait = Gait {
    step_length: 0.74,
    step_time: 0.54,
    swing: 0.76,
    trail: 0.07,
    clearance: 0.048,
    strike: -18.0,
    push_off: 38.0,
    trailing: 50.0,
    sink: 0.056,
    vault: 0.026,
    sway: 0.022,
    lean: 2.0,
    hip_turn: 6.0,
    chest_turn: 11.0,
    arm_swing: 24.0,
    elbow: 24.0,
};

pub(crate) const WALK_BACKWARDS: Gait = Gait {
    step_length: -0.56,
    step_time: 0.60,
    swing: 0.74,
    trail: 0.0,
    clearance: 0.05,
    strike: 16.0,
    push_off: -4.0,
    trailing: 22.0,
    sink: 0.040,
    vault: 0.014,
    sway: 0.030,
    lean: 1.0,
    hip_turn: 4.0,
    chest_turn: 7.0,
    arm_swing: 13.0,
    elbow: 22.0,
};

pub(crate) const JOG: Gait = Gait {
    step_length: 0.99,
    step_time: 0.36,
    swing: 1.36,
    trail: 0.0,
    clearance: 0.20,
    strike: -8.0,
    push_off: 40.0,
    trailing: 78.0,
    sink: 0.076,
    vault: -0.036,
    sway: 0.010,
    lean: 7.0,
    hip_turn: 8.0,
    chest_turn: 17.0,
    arm_swing: 38.0,
    elbow: 88.0,
};

/// How many steps, and how far the path turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Route {
    pub(crate) n_steps: usize,
    /// Degrees to the left over the whole way.
    pub(crate) turn: f64,
    pub(crate) first: Side,
}

/// Goes from standing to standing. The last step closes the feet.
pub(crate) fn go(actor: &Actor, gait: Gait, route: Route, dice: &mut Dice) -> Action {
    let n_steps = route.n_steps.max(2);
    let style = actor.performer.style;
    let length = gait.step_length * actor.body.leg() * style.amplitude * dice.about_one(0.05);
    let step_time = gait.step_time * dice.about_one(0.05) / style.tempo.sqrt();
    let path = Path {
        length: length * (n_steps as f64 - 1.0),
        turn: route.turn,
    };
    let plan = Plan::new(n_steps, length, step_time, &gait, dice);
    let feet = [Side::Left, Side::Right]
        .map(|side| FootTrack::new(&plan, &gait, side == route.first, actor.body.leg(), length));
    let duration = plan.duration;
    let end = path.at(path.length);
    let actor = actor.clone();
    let swing = dice.about_one(0.1);
    Action::new(duration, end, move |t| {
        let mut pose = carriage(&actor, &gait, &plan, &path, t, route.first, swing);
        for side in Side::BOTH {
            let footing = feet[side.idx()].at(t, &path, &actor.footing(side));
            *pose.leg(side) = footing.leg(&actor.body);
            pose.leg(side).load = feet[side.idx()].load.at(t)[0];
        }
        pose
    })
}

/// An arc on the floor, starting at the origin toward +Z.
#[derive(Clone, Copy, Debug)]
struct Path {
    length: f64,
    turn: f64,
}

impl Path {
    fn at(&self, along: f64) -> Place {
        let heading = self.turn * along / self.length;
        let half = 0.5 * heading.to_radians();
        // The chord of an arc: its length shrinks by sin(half)/half, its direction is the mean.
        let chord = along
            * if half.abs() < 1e-6 {
                1.0
            } else {
                half.sin() / half
            };
        Place {
            x: chord * half.sin(),
            z: chord * half.cos(),
            heading,
        }
    }
}

/// When feet leave and land, and where the pelvis is in between.
#[derive(Clone, Debug)]
struct Plan {
    n_steps: usize,
    step_time: f64,
    start: f64,
    duration: f64,
    swing: f64,
    /// Distance by which a foot lands ahead of the pelvis.
    ahead: f64,
    length: f64,
    /// Distance of the pelvis along the path.
    progress: Spline<1>,
}

/// Seconds of shifting weight before the first and after the last step.
const SETTLE: f64 = 0.26;

impl Plan {
    fn new(n_steps: usize, length: f64, step_time: f64, gait: &Gait, dice: &mut Dice) -> Plan {
        let start = SETTLE * dice.about_one(0.1);
        let boundary = |k: usize| start + step_time * k as f64;
        let duration = boundary(n_steps) + SETTLE * dice.about_one(0.1);
        // The first and the last step take the pelvis half as far as the others. It slows down
        // late, so that the last foot but one lands in reach.
        let mut keys = vec![(0.0, 0.0), (boundary(0), 0.06 * length)];
        keys.extend((1..n_steps).map(|k| (boundary(k), length * (k as f64 - 0.5))));
        if let Some(last) = keys.last_mut() {
            last.1 += 0.08 * length;
        }
        let way = length * (n_steps as f64 - 1.0);
        keys.push((boundary(n_steps), way - 0.06 * length));
        keys.push((duration, way));
        Plan {
            n_steps,
            step_time,
            start,
            duration,
            swing: gait.swing,
            ahead: length * (1.0 - 0.5 * gait.swing - gait.trail),
            length,
            progress: track(&keys),
        }
    }

    /// When step `k` lifts its foot and puts it down.
    fn airborne(&self, k: usize) -> (f64, f64) {
        let middle = self.start + self.step_time * (k as f64 + 0.5);
        // Out of and into standing there is no flight.
        let half = |standing: bool| {
            let swing = if standing {
                self.swing.min(0.8)
            } else {
                self.swing
            };
            0.5 * swing * self.step_time
        };
        (
            middle - half(k == 0),
            middle + half(k == 0 || k + 1 == self.n_steps),
        )
    }

    /// Distance along the path at which step `k` lands. The last two steps bring the feet together.
    fn landing(&self, k: usize) -> f64 {
        let way = self.length * (self.n_steps as f64 - 1.0);
        if k + 2 >= self.n_steps {
            return way;
        }
        let landing = self.progress.at(self.airborne(k).1)[0] + self.ahead;
        // Going backward, distances are negative.
        if way < 0.0 {
            landing.max(way)
        } else {
            landing.min(way)
        }
    }

    /// Phase in steps, and how much of the gait is in force: 0 in standing, 1 under way.
    fn phase(&self, t: f64) -> (f64, f64) {
        let phase = (t - self.start) / self.step_time;
        let before = self.start / self.step_time;
        let after = (self.duration - t) / self.step_time;
        let tail = self.duration / self.step_time - before - self.n_steps as f64;
        (
            phase,
            ease(-before, 0.7, phase) * ease(0.0, 0.7 + tail, after),
        )
    }
}

/// Where one foot is over time.
#[derive(Clone, Debug)]
struct FootTrack {
    along: Spline<1>,
    pitch: Spline<1>,
    lift: Spline<1>,
    /// 1 on the floor, 0 in the air.
    load: Spline<1>,
}

impl FootTrack {
    fn new(plan: &Plan, gait: &Gait, goes_first: bool, leg: f64, length: f64) -> FootTrack {
        let mut along = vec![(0.0, 0.0)];
        let mut pitch = vec![(0.0, 0.0)];
        let mut lift = vec![(0.0, 0.0)];
        let mut load = vec![(0.0, 1.0)];
        let mut from = 0.0;
        for k in (usize::from(!goes_first)..plan.n_steps).step_by(2) {
            let (off, on) = plan.airborne(k);
            let air = on - off;
            let to = plan.landing(k);
            // A closing step is shorter and flatter.
            let size = ((to - from) / (2.0 * length)).clamp(0.3, 1.0);
            let last = to >= plan.landing(plan.n_steps - 1) - 1e-9 || k + 2 >= plan.n_steps;
            let strike = if last { 0.2 } else { 1.0 } * gait.strike;
            let roll = (0.55 * plan.step_time).min(off - pitch.last().map_or(0.0, |p| p.0) - 0.02);
            let way = |share: f64| from + share * (to - from);
            along.extend([
                (off, from),
                (off + 0.08 * air, way(0.015)),
                (off + 0.26 * air, way(0.17)),
                (off + 0.54 * air, way(0.55)),
                (on - 0.20 * air, way(0.92)),
                (on - 0.03 * air, to),
            ]);
            load.extend([
                (off, 1.0),
                (off + 0.2 * air, 0.0),
                (on - 0.1 * air, 0.0),
                (on + 0.02 * air, 1.0),
            ]);
            pitch.push((off - roll.max(0.02), 0.0));
            pitch.push((off, gait.push_off * size));
            pitch.push((off + 0.25 * air, gait.trailing * size));
            pitch.push((off + 0.72 * air, 0.25 * strike));
            pitch.push((on - 0.02 * air, strike));
            pitch.push((on + 0.22 * plan.step_time, 0.0));
            let high = gait.clearance * leg * size;
            lift.extend([
                (off, 0.0),
                (off + 0.14 * air, 0.45 * high),
                (off + 0.42 * air, high),
                (on - 0.14 * air, 0.25 * high),
                (on, 0.0),
            ]);
            from = to;
        }
        along.push((plan.duration + 1.0, from));
        pitch.push((plan.duration + 1.0, 0.0));
        lift.push((plan.duration + 1.0, 0.0));
        load.push((plan.duration + 1.0, 1.0));
        FootTrack {
            along: track(&along),
            pitch: track(&pitch),
            lift: track(&lift),
            load: track(&load),
        }
    }

    fn at(&self, t: f64, path: &Path, neutral: &Footing) -> Footing {
        let place = path.at(self.along.at(t)[0]);
        let at = place.point(Vector3::new(neutral.x, 0.0, neutral.z));
        Footing {
            x: at.x,
            z: at.z,
            yaw: neutral.yaw + place.heading,
            pitch: self.pitch.at(t)[0],
            lift: self.lift.at(t)[0],
        }
    }
}

/// Pelvis, trunk and arms at time `t`; the legs are those of standing.
fn carriage(
    actor: &Actor,
    gait: &Gait,
    plan: &Plan,
    path: &Path,
    t: f64,
    first: Side,
    swing: f64,
) -> Pose {
    let (phase, active) = plan.phase(t);
    let leg = actor.body.leg();
    let amplitude = active * actor.performer.style.amplitude;
    // +1 in the middle of a step of the left foot, −1 in that of the right one.
    let stepping = first.sign() * (std::f64::consts::PI * phase).sin();
    // +1 when the left foot is foremost at the end of its step, −1 for the right one.
    let leading = -first.sign() * (std::f64::consts::PI * phase).cos() * gait.step_length.signum();
    let vault = -(std::f64::consts::TAU * phase).cos();
    let mut pose = actor.stand();
    pose.root.y += active * leg * (gait.vault * vault - gait.sink);
    pose.root.x -= active * leg * gait.sway * stepping;
    pose.yaw -= amplitude * gait.hip_turn * leading;
    pose.tilt += active * 3.0 * stepping;
    pose.lean += active * gait.lean;
    pose.spine.twist += amplitude * gait.chest_turn * leading;
    pose.spine.side -= active * 3.0 * stepping;
    pose.head.twist -= amplitude * (gait.chest_turn - gait.hip_turn) * leading;
    for side in Side::BOTH {
        let forward = -side.sign() * leading;
        let reach = amplitude * swing * actor.vigour(side) * gait.arm_swing * forward;
        let arm = pose.arm(side);
        arm.flex += reach - active * 0.1 * gait.arm_swing;
        arm.elbow += active * (gait.elbow - arm.elbow) + (0.35 * reach).max(-10.0);
        arm.twist += active * 0.1 * gait.elbow;
        arm.fist += active * 0.25;
    }
    pose.moved_to(&path.at(plan.progress.at(t)[0]))
}
