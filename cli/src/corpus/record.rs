use mocap_io::{Axis, ChannelCountError, FrameRate, LengthUnit, Motion, SkeletonError};
use ndarray::Array2;

use super::body::Body;
use super::class::{Class, Side};
use super::curve::SensorNoise;
use super::dice::Dice;
use super::gait::{Route, WALK, go};
use super::performer::Performer;
use super::pose::{Actor, Place};
use super::solve::Solver;
use super::take::{Restlessness, Take};
use super::{Clip, Label};

/// Repetitions of each class by each performer.
const N_REPETITIONS: usize = 3;
/// Root mean square of the sensor noise on angles, degrees.
const ANGLE_NOISE: f64 = 0.15;
/// Root mean square of the sensor noise on the root's place, metres.
const PLACE_NOISE: f64 = 0.0006;
/// Corner frequency of the sensor noise, hertz; low, so that noise moves joints by millimetres but
/// does not make them fast.
const NOISE_CORNER: f64 = 4.0;

/// Why a clip could not be made: a slip in this module, as nothing of it comes from outside.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CorpusError {
    /// The bones do not make a skeleton.
    #[error("the corpus skeleton of {performer} is broken")]
    Skeleton {
        /// Whose.
        performer: &'static str,
        /// What is wrong with it.
        source: SkeletonError,
    },
    /// The channels do not fit the skeleton.
    #[error("the corpus channels of {performer} do not fit the skeleton")]
    Channels {
        /// Whose.
        performer: &'static str,
        /// What is wrong with them.
        source: ChannelCountError,
    },
    /// A performer's frame rate is no rate.
    #[error("the frame rate of {performer} is not positive")]
    Rate {
        /// Whose.
        performer: &'static str,
    },
}

/// One clip to be made: who does what.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    performer_idx: usize,
    /// Counts from 0.
    repetition: usize,
    script: Script,
}

#[derive(Clone, Debug, PartialEq)]
enum Script {
    Single(Class),
    Take(&'static [Scene]),
}

/// What happens in a take.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Scene {
    /// A pause, then a class.
    Do(Class),
    /// A class without a pause before it.
    Next(Class),
    /// An unlabelled walk along a curve: steps, and degrees turned to the left.
    Stroll(usize, f64),
}

use Class as C;
use Scene::{Do, Next, Stroll};

/// The takes of each performer. A right kick directly followed by a left punch, the scene of
/// Müller, Röder and Clausen 2005, section 6.3, is in the first take of anna and of dan and nowhere else.
#[rustfmt::skip]
const TAKES: [&[&[Scene]]; 5] = [
    &[
        &[
            Do(C::Walk), Do(C::Wave), Do(C::KickRight), Next(C::PunchLeft), Stroll(4, 35.0),
            Do(C::Squat), Do(C::JumpingJack), Do(C::SitDown), Do(C::Hop),
        ],
        &[
            Do(C::RotateArmsForward), Do(C::Jog), Do(C::PunchRight), Do(C::KickLeft),
            Stroll(5, -40.0), Do(C::WalkBackwards), Do(C::LieDown),
        ],
    ],
    &[&[
        Do(C::Jog), Do(C::KickLeft), Next(C::PunchRight), Do(C::Squat), Stroll(4, -30.0),
        Do(C::RotateArmsBackward), Do(C::Wave), Do(C::LieDown),
    ]],
    &[&[
        Do(C::Hop), Do(C::Hop), Do(C::WalkBackwards), Do(C::PunchLeft), Next(C::KickRight),
        Do(C::Walk), Do(C::JumpingJack), Stroll(5, 45.0), Do(C::RotateArmsForward), Do(C::SitDown),
    ]],
    &[&[
        Do(C::Squat), Do(C::Walk), Do(C::KickRight), Next(C::PunchLeft), Do(C::RotateArmsBackward),
        Stroll(4, -35.0), Do(C::Wave), Do(C::SitDown), Do(C::Jog),
    ]],
    &[&[
        Do(C::JumpingJack), Do(C::PunchRight), Do(C::PunchLeft), Stroll(6, 50.0), Do(C::KickLeft),
        Do(C::Jog), Do(C::Hop), Do(C::Squat), Do(C::LieDown),
    ]],
];

/// What the corpus consists of: every class by every performer, three times, then the takes.
#[must_use]
pub fn plan() -> Vec<Recording> {
    let mut recordings = Vec::new();
    for performer_idx in 0..Performer::ALL.len() {
        for class in Class::ALL {
            recordings.extend((0..N_REPETITIONS).map(|repetition| Recording {
                performer_idx,
                repetition,
                script: Script::Single(class),
            }));
        }
    }
    for (performer_idx, takes) in TAKES.iter().enumerate() {
        recordings.extend(
            takes
                .iter()
                .enumerate()
                .map(|(repetition, scenes)| Recording {
                    performer_idx,
                    repetition,
                    script: Script::Take(scenes),
                }),
        );
    }
    recordings
}

impl Recording {
    /// Who moves.
    #[must_use]
    pub fn performer(&self) -> Performer {
        Performer::ALL[self.performer_idx % Performer::ALL.len()]
    }

    /// What is shown; `None` for a take of several classes.
    #[must_use]
    pub fn class(&self) -> Option<Class> {
        match self.script {
            Script::Single(class) => Some(class),
            Script::Take(_) => None,
        }
    }

    /// Performer and what is shown, such as `anna/kick_left_02` or `anna/take_01`.
    #[must_use]
    pub fn name(&self) -> String {
        let what = self.class().map_or("take", Class::name);
        format!(
            "{}/{what}_{:02}",
            self.performer().name,
            self.repetition + 1
        )
    }

    /// Makes the clip. It depends on the seed and on nothing else that was made before.
    ///
    /// O(frames).
    ///
    /// # Errors
    /// [`CorpusError`] if the constants of this module contradict each other.
    pub fn clip(&self, seed: u64) -> Result<Clip, CorpusError> {
        let class_idx = match self.script {
            Script::Single(class) => class as u64,
            Script::Take(_) => Class::ALL.len() as u64,
        };
        let item = [self.performer_idx as u64, class_idx, self.repetition as u64];
        let mut dice = Dice::new(seed, &item);
        let performer = self.performer();
        let actor = Actor::new(performer);
        let take = self.stage(&actor, &mut dice);
        let hz = performer.rate_hz;
        let n_frames = (take.duration() * hz).floor() as usize;
        let frame = |seconds: f64| ((seconds * hz).round() as usize).min(n_frames);
        let labels = take
            .labels()
            .map(|(class, span)| Label {
                class,
                span: frame(span.start)..frame(span.end),
            })
            .collect();
        Ok(Clip {
            name: self.name(),
            performer,
            class: self.class(),
            labels,
            motion: film(&actor, &take, n_frames, &mut dice)?,
        })
    }

    /// Everything that happens in the clip, at a random place and in a random direction.
    fn stage(&self, actor: &Actor, dice: &mut Dice) -> Take {
        // Near ±90° the root's Euler angles are singular. The figure faces +Z or −Z, more or less,
        // and turns by less than the rest in a take.
        let room = match self.script {
            Script::Single(_) => 55.0,
            Script::Take(_) => 15.0,
        };
        let back = if dice.unit() < 0.5 { 0.0 } else { 180.0 };
        let mut take = Take::new(Place {
            x: dice.between(-1.0, 1.0),
            z: dice.between(-1.0, 1.0),
            heading: back + dice.between(-room, room),
        });
        match self.script {
            Script::Single(class) => {
                take.wait(actor, dice.between(0.35, 0.6));
                take.then(Some(class), super::take::perform(actor, class, dice));
                take.wait(actor, dice.between(0.35, 0.6));
            }
            Script::Take(scenes) => {
                for scene in scenes {
                    play(&mut take, actor, *scene, dice);
                }
                take.wait(actor, dice.between(0.6, 1.0));
            }
        }
        take
    }
}

fn play(take: &mut Take, actor: &Actor, scene: Scene, dice: &mut Dice) {
    match scene {
        Do(class) => {
            take.wait(actor, dice.between(0.5, 1.1));
            take.perform(actor, class, dice);
        }
        Next(class) => take.perform(actor, class, dice),
        Stroll(n_steps, turn) => {
            let route = Route {
                n_steps,
                turn: turn * dice.about_one(0.1),
                first: Side::Left,
            };
            take.wait(actor, dice.between(0.3, 0.6));
            take.then(None, go(actor, WALK, route, dice));
        }
    }
}

/// Samples a take: inverse kinematics, then sensor noise on every channel.
fn film(
    actor: &Actor,
    take: &Take,
    n_frames: usize,
    dice: &mut Dice,
) -> Result<Motion, CorpusError> {
    let performer = actor.performer;
    let unit = LengthUnit::ACCLAIM_CMU;
    let name = performer.name;
    let rate =
        FrameRate::from_hz(performer.rate_hz).ok_or(CorpusError::Rate { performer: name })?;
    let skeleton = actor
        .body
        .skeleton(unit)
        .map_err(|source| CorpusError::Skeleton {
            performer: name,
            source,
        })?;
    let unrest = Restlessness::new(dice);
    let mut noise: Vec<SensorNoise> = (0..skeleton.n_channels())
        .map(|_| SensorNoise::new(dice, NOISE_CORNER, rate.hz()))
        .collect();
    let mut solver = Solver::new(&actor.body);
    let mut channels = Array2::zeros((n_frames, skeleton.n_channels()));
    for (frame, mut row) in channels.rows_mut().into_iter().enumerate() {
        let t = frame as f64 / rate.hz();
        let (root, angles) = solver.solve(&unrest.disturb(take.pose(t), t));
        let values = root
            .iter()
            .map(|v| (*v, PLACE_NOISE))
            .chain(turns(&actor.body, angles));
        for (column, ((slot, (value, deviation)), noise)) in
            row.iter_mut().zip(values).zip(&mut noise).enumerate()
        {
            let noisy = value + deviation * noise.next(dice);
            *slot = if column < 3 {
                noisy / unit.metres()
            } else {
                noisy
            };
        }
    }
    clamp(&actor.body, &mut channels);
    Motion::new(skeleton, channels, rate, unit).map_err(|source| CorpusError::Channels {
        performer: name,
        source,
    })
}

/// Every angle with its noise, in channel order.
fn turns<'a>(body: &'a Body, angles: &'a [[f64; 3]]) -> impl Iterator<Item = (f64, f64)> + 'a {
    let root = angles.iter().take(1).flatten().map(|&v| (v, ANGLE_NOISE));
    let rest = body
        .bones
        .iter()
        .zip(angles)
        .skip(1)
        .flat_map(|(bone, angles)| {
            bone.dofs
                .iter()
                .map(|dof| (angles[dof.axis.idx()], ANGLE_NOISE))
        });
    root.chain(rest)
}

/// Keeps every joint within its range.
fn clamp(body: &Body, channels: &mut Array2<f64>) {
    let ranges = body.bones.iter().skip(1).flat_map(|bone| &bone.dofs);
    let first = 2 * Axis::ALL.len();
    for (mut column, dof) in channels.columns_mut().into_iter().skip(first).zip(ranges) {
        column.mapv_inplace(|v| v.clamp(dof.low, dof.high));
    }
}
