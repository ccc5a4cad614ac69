use nalgebra::Vector3;

use super::action::{Action, Keys};
use super::class::Side;
use super::dice::Dice;
use super::pose::{Actor, Pose};

/// One deep knee bend, arms stretched forward for balance.
pub(crate) fn squat(actor: &Actor, dice: &mut Dice) -> Action {
    let body = &actor.body;
    let leg = body.leg();
    let depth = (0.52 * actor.performer.style.amplitude * dice.about_one(0.05)).clamp(0.46, 0.58);
    let back = 0.24 * leg * dice.about_one(0.05);
    let squatted = move |pose: &mut Pose, share: f64| {
        pose.root.y -= depth * leg * share;
        pose.root.z -= back * (share * (2.0 - share));
        pose.lean = 27.0 * share;
        pose.spine.flex += 18.0 * share;
        pose.legs
            .iter_mut()
            .for_each(|leg| leg.knee_out = 12.0 * share);
        pose.both_arms(|arm| {
            arm.flex += (128.0 - arm.flex) * share;
            arm.spread += (10.0 - arm.spread) * share;
            arm.elbow += (8.0 - arm.elbow) * share;
        });
    };
    Keys::new(actor, dice)
        .at(0.45, |pose| squatted(pose, 0.42))
        .at(0.95, |pose| squatted(pose, 1.0))
        .hold(1.12)
        .at(1.65, |pose| squatted(pose, 0.40))
        .stand(2.15)
        .build(dice)
}

/// Sitting down on a seat of knee height; ends seated.
pub(crate) fn sit_down(actor: &Actor, dice: &mut Dice) -> Action {
    let body = &actor.body;
    let leg = body.leg();
    let seat = body.ankle_height + 0.99 * body.shank * dice.about_one(0.02) - body.hip.y;
    let back = -0.93 * body.thigh;
    let drop = actor.standing_height() - seat;
    let bow = dice.about_one(0.1);
    let slump = dice.between(4.0, 12.0);
    let lap = |pose: &mut Pose, weight: f64| {
        for side in Side::BOTH {
            let arm = pose.arm(side);
            arm.flex = 26.0;
            arm.spread = 12.0;
            arm.twist = 22.0;
            arm.elbow = 52.0;
            arm.reach = Vector3::new(
                side.sign() * (body.hip.x + 0.02),
                seat + body.hip.y + 0.075,
                back + 0.66 * body.thigh,
            );
            arm.reach_weight = weight;
        }
    };
    Keys::new(actor, dice)
        .at(0.40, |pose| {
            lap(pose, 0.0);
            pose.root.y -= 0.07 * leg;
            pose.root.z -= 0.06 * leg;
            pose.lean = 20.0 * bow;
            pose.spine.flex += 12.0;
        })
        .at(0.90, |pose| {
            lap(pose, 0.0);
            pose.both_arms(|arm| {
                arm.flex = 62.0;
                arm.elbow = 30.0;
            });
            pose.root.y -= 0.62 * drop;
            pose.root.z += 0.70 * back;
            pose.lean = 36.0 * bow;
            pose.spine.flex += 16.0;
        })
        .at(1.35, |pose| {
            lap(pose, 0.9);
            pose.root.y = seat;
            pose.root.z += back;
            pose.lean = 20.0 * bow;
            pose.spine.flex += 14.0;
        })
        .at(1.90, |pose| {
            lap(pose, 1.0);
            pose.root.y = seat;
            pose.root.z += back;
            pose.lean = -7.0;
            pose.spine.flex += slump;
        })
        .hold(2.25)
        .build(dice)
}

/// Over a crouch and a seat on the floor onto the back; ends lying.
pub(crate) fn lie_down(actor: &Actor, dice: &mut Dice) -> Action {
    let body = &actor.body;
    let leg = body.leg();
    let seat = 0.08;
    let seat_z = -0.46 * leg * dice.about_one(0.04);
    let shoulder = body.shoulder();
    let hands = move |pose: &mut Pose, weight: f64, out: f64, z: f64| {
        for side in Side::BOTH {
            let arm = pose.arm(side);
            arm.reach = Vector3::new(side.sign() * (shoulder.x + out * leg), 0.03, z);
            arm.reach_weight = weight;
        }
    };
    let crouch = move |pose: &mut Pose, depth: f64, back: f64| {
        pose.root.y -= depth * leg;
        pose.root.z -= back * leg;
        hands(pose, 0.0, 0.10, seat_z - 0.24 * leg);
    };
    let seated = move |pose: &mut Pose| {
        pose.root.y = seat;
        pose.root.z = seat_z;
        pose.legs.iter_mut().for_each(|leg| leg.load = 0.0);
    };
    // Lying, the hands are beside the thighs, arms nearly straight.
    let arm = 0.97 * (body.upper_arm + body.forearm);
    let beside = seat_z - shoulder.y + (arm * arm - (0.14 * leg).powi(2)).sqrt();
    let heels = seat_z + 0.992 * leg - body.hip.y;
    let far = dice.between(0.30, 0.42);
    Keys::new(actor, dice)
        .at(0.45, |pose| {
            crouch(pose, 0.30, 0.16);
            pose.lean = 22.0;
            pose.spine.flex += 22.0;
            pose.both_arms(|arm| arm.flex = 45.0);
        })
        .at(0.95, |pose| {
            crouch(pose, 0.66, 0.28);
            pose.lean = 20.0;
            pose.spine.flex += 34.0;
            pose.both_arms(|arm| {
                arm.flex = 20.0;
                arm.spread = 34.0;
            });
        })
        .at(1.55, |pose| {
            seated(pose);
            hands(pose, 1.0, 0.10, seat_z - 0.24 * leg);
            pose.lean = -12.0;
            pose.spine.flex += 26.0;
            sideways_elbows(pose);
        })
        .hold(1.80)
        .at(2.55, |pose| {
            seated(pose);
            hands(pose, 1.0, 0.14, seat_z - 0.12 * leg);
            pose.lean = -46.0;
            pose.spine.flex += 34.0;
            pose.head.flex = 12.0;
            pose.gaze = 0.25;
            sideways_elbows(pose);
            for side in Side::BOTH {
                let mut footing = actor.footing(side);
                footing.z = far * leg;
                footing.pitch = -14.0;
                *pose.leg(side) = footing.leg(body);
                pose.leg(side).load = 0.0;
            }
        })
        .at(3.45, |pose| {
            seated(pose);
            hands(pose, 1.0, 0.14, beside);
            pose.lean = -88.0;
            pose.spine.flex = 0.0;
            pose.gaze = 0.0;
            sideways_elbows(pose);
            for side in Side::BOTH {
                let leg = pose.leg(side);
                leg.ankle = Vector3::new(1.3 * leg.ankle.x, 0.05, heels);
                leg.pitch = -68.0;
                leg.yaw *= 1.8;
            }
        })
        .hold(3.9)
        .build(dice)
}

/// Turns bent elbows outward, so that they stay off the floor when the hands are on it.
fn sideways_elbows(pose: &mut Pose) {
    pose.both_arms(|arm| {
        arm.flex = -30.0;
        arm.spread = 34.0;
        arm.twist = 80.0;
        arm.elbow = 30.0;
    });
}
