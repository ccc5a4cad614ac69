use std::sync::OnceLock;

use mocap_io::forward_kinematics;
use ndarray::Array3;

use super::body::Body;
use super::*;

mod classes;
mod parts;

const SEED: u64 = 20_060_620;

/// Joint centres of feet and hands on the floor are 1 to 4 cm above it; noise and rounded corners
/// of the kinematics take another centimetre either way.
const FLOOR: std::ops::RangeInclusive<f32> = -0.01..=0.045;
/// The highest jump of the tallest performer, with the toes pointed, in metres.
const HIGHEST_FLIGHT: f32 = 0.16;
/// Sensor noise moves a foot by up to 1 cm, and the roll from heel to ball shares its pivots.
const SLIDE: f32 = 0.03;
/// A stooped neutral posture and knees that are not quite straight cost up to 2.5 % of the height.
const HEIGHT_LOSS: f64 = 0.025;

struct Shot {
    clip: Clip,
    positions: Array3<f32>,
}

impl Shot {
    fn joint(&self, name: &str) -> usize {
        self.clip.motion.skeleton.find(name).unwrap()
    }

    fn height(&self, frame: usize, name: &str) -> f32 {
        self.positions[[frame, self.joint(name), 1]]
    }

    fn at(&self, frame: usize, name: &str) -> [f32; 3] {
        let joint = self.joint(name);
        [0, 1, 2].map(|axis| self.positions[[frame, joint, axis]])
    }

    fn highest(&self, name: &str) -> f32 {
        let heights = (0..self.positions.dim().0).map(|frame| self.height(frame, name));
        heights.fold(f32::MIN, f32::max)
    }

    fn lowest_joint(&self, frame: usize) -> f32 {
        let joints = 0..self.positions.dim().1;
        joints
            .map(|j| self.positions[[frame, j, 1]])
            .fold(f32::MAX, f32::min)
    }
}

/// Every clip with its positions, made once for all tests.
fn shots() -> &'static [Shot] {
    static SHOTS: OnceLock<Vec<Shot>> = OnceLock::new();
    SHOTS.get_or_init(|| {
        let film = |clip: Clip| Shot {
            positions: forward_kinematics(&clip.motion),
            clip,
        };
        corpus(SEED).unwrap().into_iter().map(film).collect()
    })
}

fn of_class(class: Class) -> impl Iterator<Item = &'static Shot> {
    shots()
        .iter()
        .filter(move |shot| shot.clip.class == Some(class))
}

fn distance(a: [f32; 3], b: [f32; 3]) -> f32 {
    (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f32>().sqrt()
}

#[test]
fn the_same_seed_gives_the_same_corpus() {
    // In reverse order: a clip does not depend on what was made before it.
    for (recording, shot) in plan().iter().zip(shots()).rev().step_by(7) {
        assert_eq!(recording.clip(SEED).unwrap(), shot.clip);
    }
}

#[test]
fn another_seed_gives_another_corpus() {
    let recording = &plan()[0];
    assert_ne!(
        recording.clip(1).unwrap().motion,
        recording.clip(2).unwrap().motion
    );
}

#[test]
fn every_performer_does_every_class() {
    for performer in Performer::ALL {
        for class in Class::ALL {
            let n = of_class(class)
                .filter(|shot| shot.clip.performer == performer)
                .count();
            assert!(n >= 2, "{} does {class} {n} times", performer.name);
        }
        let takes = shots().iter().filter(|shot| shot.clip.class.is_none());
        let long =
            |shot: &&Shot| shot.clip.performer == performer && shot.clip.motion.duration() >= 20.0;
        assert!(takes.filter(long).count() >= 1, "{}", performer.name);
    }
}

#[test]
fn names_are_unique_and_classes_have_names() {
    let mut names: Vec<&str> = shots().iter().map(|shot| shot.clip.name.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), shots().len());
    for class in Class::ALL {
        assert_eq!(Class::from_name(class.name()), Some(class));
    }
    assert_eq!(Class::from_name("cartwheel"), None);
}

#[test]
fn recordings_announce_their_clips() {
    for (recording, shot) in plan().iter().zip(shots()) {
        assert_eq!(recording.name(), shot.clip.name);
        assert_eq!(recording.class(), shot.clip.class);
        assert_eq!(recording.performer(), shot.clip.performer);
    }
}

#[test]
fn labels_are_in_order_and_in_range() {
    for Shot { clip, .. } in shots() {
        let mut end = 0;
        assert!(!clip.labels.is_empty(), "{}", clip.name);
        for label in &clip.labels {
            assert!(
                label.span.start >= end && label.span.start < label.span.end,
                "{}",
                clip.name
            );
            end = label.span.end;
        }
        assert!(end <= clip.motion.n_frames(), "{}", clip.name);
        if let Some(class) = clip.class {
            assert_eq!(clip.labels.len(), 1);
            assert_eq!(clip.labels[0].class, class);
        }
    }
}

#[test]
fn two_takes_have_a_right_kick_directly_before_a_left_punch() {
    let scene = |clip: &Clip| {
        clip.labels.windows(2).any(|pair| {
            pair[0].class == Class::KickRight
                && pair[1].class == Class::PunchLeft
                && pair[0].span.end == pair[1].span.start
        })
    };
    let takes = shots()
        .iter()
        .map(|shot| &shot.clip)
        .filter(|clip| scene(clip));
    let names: Vec<&str> = takes.map(|clip| clip.name.as_str()).collect();
    assert_eq!(names, ["anna/take_01", "dan/take_01"]);
}

#[test]
fn performers_differ_in_height_and_rate_as_specified() {
    for performer in Performer::ALL {
        let shot = of_class(Class::Squat)
            .find(|shot| shot.clip.performer == performer)
            .unwrap();
        let height = f64::from(shot.height(0, "head"));
        let lowest = performer.height * (1.0 - HEIGHT_LOSS);
        assert!(
            (lowest..=performer.height + 0.005).contains(&height),
            "{} {height}",
            performer.name
        );
        assert_eq!(shot.clip.motion.rate.hz(), performer.rate_hz);
    }
}

#[test]
fn joints_stay_within_their_ranges() {
    for Shot { clip, .. } in shots() {
        let body = Body::new(&clip.performer);
        let dofs = body
            .bones
            .iter()
            .skip(1)
            .flat_map(|bone| bone.dofs.iter().map(move |dof| (bone, dof)));
        for ((bone, dof), column) in dofs.zip(clip.motion.channels.columns().into_iter().skip(6)) {
            let range = dof.low..=dof.high;
            assert!(
                column.iter().all(|v| range.contains(v)),
                "{} {}",
                clip.name,
                bone.name
            );
        }
    }
}

#[test]
fn nothing_is_clamped_but_noise() {
    // An angle that sits on its limit for a tenth of a second wanted to go further.
    for Shot { clip, .. } in shots() {
        let body = Body::new(&clip.performer);
        let dofs = body
            .bones
            .iter()
            .skip(1)
            .flat_map(|bone| bone.dofs.iter().map(move |dof| (bone, dof)));
        for ((bone, dof), column) in dofs.zip(clip.motion.channels.columns().into_iter().skip(6)) {
            let held = column
                .iter()
                .filter(|&&v| v == dof.low || v == dof.high)
                .count();
            let allowed = clip.motion.rate.hz() / 10.0;
            assert!(
                (held as f64) < allowed,
                "{} {} {held}",
                clip.name,
                bone.name
            );
        }
    }
}

#[test]
fn feet_are_on_the_floor_except_in_flight() {
    for shot in shots() {
        let flies = |class: &Class| matches!(class, Class::Jog | Class::Hop | Class::JumpingJack);
        for frame in 0..shot.clip.motion.n_frames() {
            let low = shot.lowest_joint(frame);
            let label = shot
                .clip
                .labels
                .iter()
                .find(|label| label.span.contains(&frame));
            let highest = if label.is_some_and(|label| flies(&label.class)) {
                HIGHEST_FLIGHT
            } else {
                *FLOOR.end()
            };
            let fine = (*FLOOR.start()..=highest).contains(&low);
            assert!(fine, "{} frame {frame}: {low}", shot.clip.name);
        }
    }
}

#[test]
fn jumps_leave_the_floor() {
    for class in [Class::Jog, Class::Hop, Class::JumpingJack] {
        for shot in of_class(class) {
            let frames = 0..shot.clip.motion.n_frames();
            let high = frames
                .map(|frame| shot.lowest_joint(frame))
                .fold(0.0, f32::max);
            assert!(high > *FLOOR.end(), "{} {high}", shot.clip.name);
        }
    }
}

#[test]
fn planted_feet_do_not_slide() {
    for shot in of_class(Class::Walk).chain(of_class(Class::WalkBackwards)) {
        let sole = Body::new(&shot.clip.performer).sole as f32;
        for ball in ["lfoot", "rfoot"] {
            let mut since: Option<[f32; 3]> = None;
            for frame in 0..shot.clip.motion.n_frames() {
                let at = shot.at(frame, ball);
                // Half a centimetre above where it stands, the foot is about to leave.
                since = (at[1] < sole + 0.005).then(|| since.unwrap_or(at));
                if let Some(start) = since {
                    let slid = (at[0] - start[0]).hypot(at[2] - start[2]);
                    assert!(
                        slid < SLIDE,
                        "{} {ball} frame {frame}: {slid}",
                        shot.clip.name
                    );
                }
            }
        }
    }
}

/// No joint is faster than a hand or foot of a trained person, and none jumps between two frames.
#[test]
fn motions_are_smooth() {
    /// Metres per second: the foot of a fast front kick.
    const FASTEST: f32 = 13.0;
    /// Metres per second squared: a knee that gives in to the ground in running. A jump by 4 cm
    /// between two frames at 120 Hz is 580.
    const HARDEST: f32 = 500.0;
    for shot in shots() {
        let (n_frames, n_joints, _) = shot.positions.dim();
        let hz = shot.clip.motion.rate.hz() as f32;
        for frame in 2..n_frames {
            for joint in 0..n_joints {
                let [a, b, c] = [frame - 2, frame - 1, frame]
                    .map(|f| [0, 1, 2].map(|axis| shot.positions[[f, joint, axis]]));
                let ahead = [0, 1, 2].map(|axis| 2.0 * b[axis] - a[axis]);
                let (speed, push) = (distance(b, c) * hz, distance(ahead, c) * hz * hz);
                let fine = speed < FASTEST && push < HARDEST;
                let name = &shot.clip.name;
                assert!(
                    fine,
                    "{name} frame {frame} joint {joint}: {speed} m/s, {push} m/s²"
                );
            }
        }
    }
}
