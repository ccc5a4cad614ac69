use super::action::{Action, Keys};
use super::class::Side;
use super::dice::Dice;
use super::pose::{Actor, Pose};

/// A front kick: weight on the other leg, knee up, shin out, and back the same way.
pub(crate) fn kick(actor: &Actor, side: Side, dice: &mut Dice) -> Action {
    let body = &actor.body;
    let leg = body.leg();
    // Near the horizontal a few degrees make a great difference in height.
    let skill = 0.5 + 0.5 * actor.vigour(side);
    let reach = actor.performer.style.amplitude.sqrt() * skill * dice.about_one(0.03);
    let height = (88.0 * reach).clamp(74.0, 104.0);
    let out = dice.between(-3.0, 4.0);
    let shift = -0.9 * actor.half_stance();
    let balance = move |pose: &mut Pose, share: f64| {
        pose.root.x = shift * share;
        pose.root.y -= 0.015 * leg * share;
        pose.tilt = -3.0 * share;
        pose.spine.side = -2.0 * share;
        pose.both_arms(|arm| {
            arm.flex += 22.0 * share;
            arm.spread += 16.0 * share;
            arm.elbow += 42.0 * share;
        });
    };
    Keys::new(actor, dice)
        .at(0.30, |pose| {
            balance(pose, 0.8);
            let mut footing = actor.footing(Side::Left);
            footing.pitch = 18.0;
            *pose.leg(Side::Left) = footing.leg(body);
            pose.leg(Side::Left).load = 0.3;
        })
        .at(0.58, |pose| {
            balance(pose, 1.0);
            pose.lean = -6.0;
            pose.spine.flex += 9.0;
            pose.swing_leg(body, Side::Left, height * 0.9, out, 108.0, 25.0);
        })
        .at(0.80, |pose| {
            balance(pose, 1.15);
            pose.lean = -17.0;
            pose.yaw = -9.0;
            pose.root.z += 0.03 * leg;
            pose.spine.flex += 14.0;
            pose.spine.twist = 8.0;
            pose.swing_leg(body, Side::Left, height, out, 9.0, 42.0);
            pose.arm(Side::Left).flex -= 34.0;
            pose.arm(Side::Right).flex += 22.0;
        })
        .hold(0.85)
        .at(1.11, |pose| {
            balance(pose, 1.0);
            pose.lean = -7.0;
            pose.spine.flex += 8.0;
            pose.swing_leg(body, Side::Left, height * 0.82, out, 100.0, 28.0);
        })
        .at(1.43, |pose| {
            balance(pose, 0.7);
            let mut footing = actor.footing(Side::Left);
            footing.pitch = 12.0;
            footing.z = 0.03 * leg;
            footing.lift = 0.035;
            *pose.leg(Side::Left) = footing.leg(body);
            pose.leg(Side::Left).load = 0.2;
        })
        .at(1.60, |pose| balance(pose, 0.35))
        .stand(2.0)
        .build(dice)
        .on_side(side)
}

/// A straight punch out of a guard.
pub(crate) fn punch(actor: &Actor, side: Side, dice: &mut Dice) -> Action {
    let body = &actor.body;
    let leg = body.leg();
    let reach = actor.performer.style.amplitude * actor.vigour(side) * dice.about_one(0.05);
    let level = dice.between(-5.0, 6.0);
    let guard = move |pose: &mut Pose| {
        pose.root.y -= 0.035 * leg;
        pose.spine.flex += 6.0;
        pose.both_arms(|arm| {
            arm.flex = 38.0;
            arm.spread = 14.0;
            arm.twist = 24.0;
            arm.elbow = 122.0;
            arm.fist = 1.0;
            arm.wrist = 0.0;
        });
    };
    Keys::new(actor, dice)
        .at(0.42, guard)
        .at(0.62, |pose| {
            guard(pose);
            pose.yaw = 7.0 * reach;
            pose.spine.twist = 14.0 * reach;
            pose.root.z -= 0.02 * leg;
            let arm = pose.arm(Side::Left);
            arm.flex = 20.0;
            arm.elbow = 128.0;
        })
        .at(0.82, |pose| {
            guard(pose);
            pose.root.z += 0.06 * leg;
            pose.root.y -= 0.01 * leg;
            pose.lean = 4.0;
            pose.yaw = -13.0 * reach;
            pose.spine.twist = -26.0 * reach;
            pose.head.twist = 30.0 * reach;
            let mut footing = actor.footing(Side::Left);
            footing.pitch = 10.0;
            *pose.leg(Side::Left) = footing.leg(body);
            let arm = pose.arm(Side::Left);
            arm.flex = 92.0 + level;
            // Outward of the turned chest, so that the fist meets the middle line.
            arm.spread = 16.0;
            arm.twist = 46.0;
            arm.elbow = 6.0;
            let other = pose.arm(Side::Right);
            other.elbow = 130.0;
            other.flex = 24.0;
        })
        .then(0.90, |pose| pose.root.z += 0.004 * leg)
        .at(1.14, |pose| {
            guard(pose);
            pose.spine.twist = 3.0;
        })
        .stand(1.62)
        .build(dice)
        .on_side(side)
}
