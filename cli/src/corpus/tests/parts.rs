//! Poses, actions and the solver.

use super::SEED;
use crate::corpus::class::Side;
use crate::corpus::dice::Dice;
use crate::corpus::pose::{Actor, POSE_LEN, Place, Pose};
use crate::corpus::solve::Solver;
use crate::corpus::take::perform;
use crate::corpus::{Class, Performer};

#[test]
fn a_mirrored_pose_has_mirrored_angles() {
    /// Twenty roundings of numbers up to 180.
    const ROUNDING: f64 = 1e-9;
    let actor = Actor::new(Performer::ALL[1]);
    let body = &actor.body;
    let (mut solver, mut mirrored) = (Solver::new(body), Solver::new(body));
    let kick = perform(&actor, Class::KickLeft, &mut Dice::new(SEED, &[0]));
    for k in 0..40 {
        let pose = kick.pose(0.05 * f64::from(k));
        assert_eq!(pose.mirrored().mirrored(), pose);
        let (_, angles) = solver.solve(&pose);
        let (_, others) = mirrored.solve(&pose.mirrored());
        for (bone, angles) in body.bones.iter().zip(angles) {
            let twin = match bone.name.split_at(1) {
                ("l", rest) => body.find(&format!("r{rest}")),
                _ => None,
            };
            if let Some(twin) = twin {
                let expected = [angles[0], -angles[1], -angles[2]];
                for (a, b) in expected.iter().zip(others[twin]) {
                    assert!(
                        (a - b).abs() < ROUNDING,
                        "{} {expected:?} {:?}",
                        bone.name,
                        others[twin]
                    );
                }
            }
        }
    }
}

#[test]
fn a_pose_survives_its_array() {
    let values = std::array::from_fn(|i| i as f64 + 1.0);
    assert_eq!(Pose::from_array(&values).to_array(), values);
}

#[test]
fn places_chain() {
    let start = Place {
        x: 1.0,
        z: 2.0,
        heading: 90.0,
    };
    let end = start.then(&Place {
        x: 0.0,
        z: 3.0,
        heading: -30.0,
    });
    assert!((end.x - 4.0).abs() < 1e-12 && (end.z - 2.0).abs() < 1e-12);
    assert_eq!(end.heading, 60.0);
}

/// The numbers of a pose without what does not show: full turns of the arms, and where a hand would
/// reach while it does not.
fn visible(mut pose: Pose) -> [f64; POSE_LEN] {
    for side in Side::BOTH {
        let arm = pose.arm(side);
        arm.flex -= 360.0 * (arm.flex / 360.0).round();
        arm.twist -= 360.0 * (arm.twist / 360.0).round();
        arm.reach *= arm.reach_weight;
    }
    pose.to_array()
}

#[test]
fn actions_start_and_end_where_they_say() {
    /// Splines and arcs reproduce their ends to rounding.
    const ROUNDING: f64 = 1e-9;
    let check = |class: Class, found: Pose, expected: Pose| {
        for (a, b) in visible(found).iter().zip(visible(expected)) {
            assert!((a - b).abs() < ROUNDING, "{class}: {a} instead of {b}");
        }
    };
    let actor = Actor::new(Performer::ALL[0]);
    for class in Class::ALL {
        let action = perform(&actor, class, &mut Dice::new(SEED, &[1]));
        check(class, action.pose(0.0), actor.stand());
        if !matches!(class, Class::SitDown | Class::LieDown) {
            let end = actor.stand().moved_to(&action.end);
            check(class, action.pose(action.duration), end);
        }
    }
}
