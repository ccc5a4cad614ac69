use super::action::{Action, Keys};
use super::class::Side;
use super::curve::ease;
use super::dice::Dice;
use super::pose::{Actor, Place};

/// Degrees by which circling arms pass outside of the shoulder, in front and behind.
const CIRCLE_SPREAD: [f64; 2] = [14.0, 50.0];

/// Which way the hands go when they are overhead.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Circling {
    Forward,
    Backward,
}

/// Two circles of both straight arms.
pub(crate) fn rotate_arms(actor: &Actor, circling: Circling, dice: &mut Dice) -> Action {
    let style = actor.performer.style;
    let stand = actor.stand();
    let leg = actor.body.leg();
    let period = 1.05 * dice.about_one(0.07) / style.tempo;
    let duration = 2.0 * period + 0.5;
    let wide = style.amplitude * dice.about_one(0.08);
    let lag = [0.0, 0.02 + 0.02 * dice.unit()];
    let direction = match circling {
        Circling::Forward => -1.0,
        Circling::Backward => 1.0,
    };
    Action::new(duration, Place::default(), move |t| {
        let mut pose = stand;
        let active = ease(0.0, 0.35, t) * ease(0.0, 0.35, duration - t);
        for side in Side::BOTH {
            let turned = 720.0 * glide((t - lag[side.idx()]) / (duration - lag[side.idx()]));
            let angle = (direction * turned).to_radians();
            let behind = 0.5 * (1.0 - angle.sin());
            let spread = CIRCLE_SPREAD[0] + (CIRCLE_SPREAD[1] - CIRCLE_SPREAD[0]) * behind;
            let arm = pose.arm(side);
            arm.flex += direction * turned;
            // The upper arm rolls along, as a shoulder must: after a full circle it is back where
            // it was and not wound up by a turn.
            arm.twist += direction * turned;
            arm.spread += active * (wide * spread - arm.spread);
            arm.elbow += active * (7.0 - arm.elbow);
        }
        let angle = (direction * 720.0 * glide(t / duration)).to_radians();
        pose.spine.flex += active * (3.0 * angle.sin() - 2.0 + 2.0 * angle.cos());
        pose.lean += active * 2.0 * angle.sin();
        pose.root.z -= active * 0.012 * angle.sin();
        pose.root.y -= active * 0.010 * leg * (1.0 + angle.cos());
        pose
    })
}

/// From 0 to 1 with constant speed in the middle and a soft start and stop.
fn glide(u: f64) -> f64 {
    const RAMP: f64 = 0.16;
    let u = u.clamp(0.0, 1.0);
    // Integral of a speed that rises as a smoothstep, stays at 1, and falls as a smoothstep.
    let ramped = |u: f64| {
        if u >= RAMP {
            return u - 0.5 * RAMP;
        }
        let v = u / RAMP;
        RAMP * (v.powi(3) - 0.5 * v.powi(4))
    };
    let total = 1.0 - RAMP;
    if u > 0.5 {
        1.0 - ramped(1.0 - u) / total
    } else {
        ramped(u) / total
    }
}

/// The right hand raised beside the head, waving three times.
pub(crate) fn wave(actor: &Actor, dice: &mut Dice) -> Action {
    let size = actor.performer.style.amplitude * dice.about_one(0.08);
    let raised = dice.between(-6.0, 8.0);
    let beat = 0.27;
    let up = 0.70;
    let mut keys = Keys::new(actor, dice).at(up, |pose| {
        let arm = pose.arm(Side::Right);
        arm.flex = 22.0;
        arm.spread = 82.0 + raised;
        arm.twist = -78.0;
        arm.elbow = 82.0;
        arm.fist = 0.05;
        arm.wrist = -8.0;
        pose.root.x += 0.012;
        pose.spine.side = 3.0;
        pose.head.twist = -6.0;
        pose.head.side = 3.0;
    });
    for k in 0..6 {
        let outward = if k % 2 == 0 { 1.0 } else { -1.0 };
        keys = keys.then(up + beat * (f64::from(k) + 1.0), |pose| {
            let arm = pose.arm(Side::Right);
            arm.elbow = 76.0 - outward * 27.0 * size;
            arm.spread = 82.0 + raised + outward * 5.0 * size;
            pose.spine.side = 3.0 - outward * 1.5;
        });
    }
    keys.stand(up + 6.0 * beat + 0.75).build(dice)
}
