use std::fmt;

use super::class::Side;
use super::curve::Spline;
use super::dice::Dice;
use super::pose::{Actor, POSE_LEN, Place, Pose};

/// Something an actor does, from time 0 to `duration` seconds; it starts in neutral standing at the
/// origin, facing +Z.
pub(crate) struct Action {
    pub(crate) duration: f64,
    /// Where the actor is at the end. An action that ends standing ends in the neutral pose there.
    pub(crate) end: Place,
    pose: Box<dyn Fn(f64) -> Pose + Send + Sync>,
}

impl fmt::Debug for Action {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Action")
            .field("duration", &self.duration)
            .field("end", &self.end)
            .finish_non_exhaustive()
    }
}

impl Action {
    pub(crate) fn new(
        duration: f64,
        end: Place,
        pose: impl Fn(f64) -> Pose + Send + Sync + 'static,
    ) -> Action {
        Action {
            duration,
            end,
            pose: Box::new(pose),
        }
    }

    /// The pose at time `t`; that of the start or the end outside of the action.
    pub(crate) fn pose(&self, t: f64) -> Pose {
        (self.pose)(t.clamp(0.0, self.duration))
    }

    /// From one pose to another one in `seconds`, on the spot.
    pub(crate) fn shift(from: Pose, to: Pose, seconds: f64) -> Action {
        let spline = Spline::new(vec![0.0, seconds], vec![from.to_array(), to.to_array()]);
        Action::new(seconds, Place::default(), move |t| {
            Pose::from_array(&spline.at(t))
        })
    }

    /// Changes every pose.
    pub(crate) fn map(self, change: impl Fn(f64, Pose) -> Pose + Send + Sync + 'static) -> Action {
        let pose = self.pose;
        Action {
            pose: Box::new(move |t| change(t, pose(t))),
            ..self
        }
    }

    /// The same to the other side. Only for an action that ends where it started.
    pub(crate) fn on_side(self, side: Side) -> Action {
        match side {
            Side::Left => self,
            Side::Right => self.map(|_, pose| pose.mirrored()),
        }
    }

    /// Played backward. Only for an action that ends where it started.
    pub(crate) fn reversed(self) -> Action {
        let (pose, duration) = (self.pose, self.duration);
        Action::new(duration, self.end, move |t| pose(duration - t))
    }

    /// Hurries through one half and takes its time in the other: `skew` within ±0.3, positive for a
    /// slow start.
    pub(crate) fn warped(self, skew: f64) -> Action {
        let (pose, duration) = (self.pose, self.duration);
        // u − skew/(2π) · sin(2πu) has slope 1 − skew·cos(2πu): it rises, and keeps the ends.
        let warp = move |t: f64| {
            let u = t / duration;
            duration * (u - skew / std::f64::consts::TAU * (std::f64::consts::TAU * u).sin())
        };
        Action::new(duration, self.end, move |t| pose(warp(t)))
    }
}

/// Builds an action from key poses.
#[derive(Debug)]
pub(crate) struct Keys<'a> {
    actor: &'a Actor,
    /// Seconds per second of the written times.
    pace: f64,
    keys: Vec<(f64, Pose)>,
}

impl<'a> Keys<'a> {
    /// Starts in neutral standing at time 0.
    pub(crate) fn new(actor: &'a Actor, dice: &mut Dice) -> Keys<'a> {
        Keys {
            actor,
            pace: dice.about_one(0.06) / actor.performer.style.tempo,
            keys: vec![(0.0, actor.stand())],
        }
    }

    /// A key at time `t` (at average tempo) that differs from the last one by `change`.
    pub(crate) fn then(mut self, t: f64, change: impl FnOnce(&mut Pose)) -> Keys<'a> {
        let mut pose = self.last();
        change(&mut pose);
        self.keys.push((t, pose));
        self
    }

    /// A key at time `t` that differs from neutral standing by `change`.
    pub(crate) fn at(mut self, t: f64, change: impl FnOnce(&mut Pose)) -> Keys<'a> {
        let mut pose = self.actor.stand();
        change(&mut pose);
        self.keys.push((t, pose));
        self
    }

    /// Neutral standing at time `t`.
    pub(crate) fn stand(self, t: f64) -> Keys<'a> {
        self.at(t, |_| {})
    }

    /// A key at time `t` with the same pose as the last one.
    pub(crate) fn hold(self, t: f64) -> Keys<'a> {
        self.then(t, |_| {})
    }

    fn last(&self) -> Pose {
        self.keys.last().map_or_else(Pose::default, |key| key.1)
    }

    /// The action through the keys, each a little off in time and posture, as no two repetitions
    /// of a person are the same.
    pub(crate) fn build(self, dice: &mut Dice) -> Action {
        let n_keys = self.keys.len();
        let mut times: Vec<f64> = self.keys.iter().map(|key| key.0 * self.pace).collect();
        let gaps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let mut poses: Vec<[f64; POSE_LEN]> = Vec::with_capacity(n_keys);
        for (k, (_, mut pose)) in self.keys.into_iter().enumerate() {
            if k > 0 && k + 1 < n_keys {
                times[k] += 0.12 * gaps[k - 1].min(gaps[k]) * dice.between(-1.0, 1.0);
                loosen(&mut pose, dice);
            }
            poses.push(pose.to_array());
        }
        let duration = times.last().copied().unwrap_or(0.0);
        let spline = Spline::new(times, poses);
        Action::new(duration, Place::default(), move |t| {
            Pose::from_array(&spline.at(t))
        })
    }
}

/// Moves the trunk and the arms of a key pose by a few degrees. Legs stay: feet stand where they are.
fn loosen(pose: &mut Pose, dice: &mut Dice) {
    for bend in [&mut pose.spine, &mut pose.head] {
        bend.flex += 1.5 * dice.normal();
        bend.side += 1.0 * dice.normal();
        bend.twist += 1.5 * dice.normal();
    }
    for arm in &mut pose.arms {
        arm.flex += 2.5 * dice.normal();
        arm.spread += 2.0 * dice.normal();
        arm.twist += 3.0 * dice.normal();
        arm.elbow = (arm.elbow + 2.5 * dice.normal()).max(4.0);
    }
}
