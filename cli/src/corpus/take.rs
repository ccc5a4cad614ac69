use std::ops::Range;

use nalgebra::Vector3;

use super::action::Action;
use super::arms::{Circling, rotate_arms, wave};
use super::class::{Class, Side};
use super::curve::Drift;
use super::dice::Dice;
use super::gait::{JOG, Route, WALK, WALK_BACKWARDS, go};
use super::jump::{hop, jumping_jack};
use super::pose::{Actor, Place, Pose};
use super::settle::{lie_down, sit_down, squat};
use super::strike::{kick, punch};

/// One repetition of `class`.
pub(crate) fn perform(actor: &Actor, class: Class, dice: &mut Dice) -> Action {
    let straight = |n_steps: usize| Route {
        n_steps,
        turn: 0.0,
        first: Side::Right,
    };
    let action = match class {
        Class::Walk => go(actor, WALK, straight(4), dice),
        Class::WalkBackwards => go(actor, WALK_BACKWARDS, straight(4), dice),
        Class::Jog => go(actor, JOG, straight(5), dice),
        Class::Squat => squat(actor, dice),
        Class::JumpingJack => jumping_jack(actor, dice),
        Class::KickLeft => kick(actor, Side::Left, dice),
        Class::KickRight => kick(actor, Side::Right, dice),
        Class::PunchLeft => punch(actor, Side::Left, dice),
        Class::PunchRight => punch(actor, Side::Right, dice),
        Class::Wave => wave(actor, dice),
        Class::RotateArmsForward => rotate_arms(actor, Circling::Forward, dice),
        Class::RotateArmsBackward => rotate_arms(actor, Circling::Backward, dice),
        Class::Hop => hop(actor, dice),
        Class::SitDown => sit_down(actor, dice),
        Class::LieDown => lie_down(actor, dice),
    };
    action.warped(dice.between(-0.08, 0.08))
}

/// Actions one after the other, each where the last one ended.
#[derive(Debug)]
pub(crate) struct Take {
    scenes: Vec<Scene>,
    place: Place,
    duration: f64,
}

#[derive(Debug)]
struct Scene {
    class: Option<Class>,
    start: f64,
    place: Place,
    action: Action,
}

impl Take {
    pub(crate) fn new(place: Place) -> Take {
        Take {
            scenes: Vec::new(),
            place,
            duration: 0.0,
        }
    }

    /// Appends an action, with the class that labels it.
    pub(crate) fn then(&mut self, class: Option<Class>, action: Action) {
        let end = self.place.then(&action.end);
        let duration = action.duration;
        self.scenes.push(Scene {
            class,
            start: self.duration,
            place: self.place,
            action,
        });
        self.place = end;
        self.duration += duration;
    }

    /// Stays in the pose in which the last action ended.
    pub(crate) fn wait(&mut self, actor: &Actor, seconds: f64) {
        let pose = self.last_pose(actor);
        self.then(None, Action::shift(pose, pose, seconds));
    }

    /// The pose in which the last action ended, seen from where it ended.
    fn last_pose(&self, actor: &Actor) -> Pose {
        match self.scenes.last() {
            Some(scene) => leave(scene.action.pose(scene.action.duration), &scene.action.end),
            None => actor.stand(),
        }
    }

    /// Appends a performance of `class` and, if it ends on the floor or a seat, getting up again.
    pub(crate) fn perform(&mut self, actor: &Actor, class: Class, dice: &mut Dice) {
        self.then(Some(class), perform(actor, class, dice));
        if ends_down(class) {
            let rise = perform(actor, class, dice).reversed();
            // No two repetitions end alike; the body shifts from the one's end to the other's.
            let shift = Action::shift(
                self.last_pose(actor),
                rise.pose(0.0),
                dice.between(0.8, 1.4),
            );
            self.then(None, shift);
            self.then(None, rise);
        }
    }

    pub(crate) fn duration(&self) -> f64 {
        self.duration
    }

    /// Labelled spans in seconds.
    pub(crate) fn labels(&self) -> impl Iterator<Item = (Class, Range<f64>)> + '_ {
        self.scenes.iter().filter_map(|scene| {
            Some((
                scene.class?,
                scene.start..scene.start + scene.action.duration,
            ))
        })
    }

    /// The pose at time `t`.
    pub(crate) fn pose(&self, t: f64) -> Pose {
        let after = self.scenes.partition_point(|scene| scene.start <= t);
        match self.scenes.get(after.saturating_sub(1)) {
            Some(scene) => scene.action.pose(t - scene.start).moved_to(&scene.place),
            None => Pose::default(),
        }
    }
}

/// Whether a performance of `class` ends seated or lying.
fn ends_down(class: Class) -> bool {
    matches!(class, Class::SitDown | Class::LieDown)
}

/// The pose seen from `place`, the inverse of [`Pose::moved_to`].
fn leave(pose: Pose, place: &Place) -> Pose {
    let back = Place {
        heading: -place.heading,
        ..Place::default()
    };
    let origin = back.point(Vector3::new(-place.x, 0.0, -place.z));
    pose.moved_to(&Place {
        x: origin.x,
        z: origin.z,
        heading: -place.heading,
    })
}

/// The restlessness of a living body, on top of what it does: slow drift of trunk and arms. Feet
/// stay where they are.
#[derive(Debug)]
pub(crate) struct Restlessness {
    drifts: Vec<Drift>,
}

impl Restlessness {
    pub(crate) fn new(dice: &mut Dice) -> Restlessness {
        const SLOW: f64 = 0.6;
        let mut drifts = Vec::new();
        for amplitude in [0.005, 0.0015, 0.005, 0.8, 0.6, 0.5] {
            drifts.push(Drift::new(dice, amplitude, SLOW));
        }
        for amplitude in [1.2, 0.8, 1.2, 2.0, 1.2, 2.5] {
            drifts.push(Drift::new(dice, amplitude, SLOW));
        }
        for amplitude in [2.0, 1.2, 2.0, 2.0, 2.0, 1.2, 2.0, 2.0] {
            drifts.push(Drift::new(dice, amplitude, SLOW));
        }
        Restlessness { drifts }
    }

    pub(crate) fn disturb(&self, mut pose: Pose, t: f64) -> Pose {
        let mut drifts = self.drifts.iter().map(|drift| drift.at(t));
        let mut add = |slot: &mut f64| *slot += drifts.next().unwrap_or(0.0);
        pose.root.iter_mut().for_each(&mut add);
        for slot in [&mut pose.yaw, &mut pose.lean, &mut pose.tilt] {
            add(slot);
        }
        for bend in [&mut pose.spine, &mut pose.head] {
            for slot in [&mut bend.flex, &mut bend.side, &mut bend.twist] {
                add(slot);
            }
        }
        for arm in &mut pose.arms {
            for slot in [
                &mut arm.flex,
                &mut arm.spread,
                &mut arm.twist,
                &mut arm.elbow,
            ] {
                add(slot);
            }
        }
        pose
    }
}
