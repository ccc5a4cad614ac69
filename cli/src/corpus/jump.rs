use super::action::{Action, Keys};
use super::class::Side;
use super::curve::{Spline, track};
use super::dice::Dice;
use super::pose::{Actor, Place, Pose};

/// Two jumps into a straddle with the hands overhead, and back.
pub(crate) fn jumping_jack(actor: &Actor, dice: &mut Dice) -> Action {
    let actor = actor.clone();
    let style = actor.performer.style;
    let leg = actor.body.leg();
    let period = 1.08 * dice.about_one(0.06) / style.tempo;
    let wide = 0.36 * leg * style.amplitude * dice.about_one(0.06);
    let reach = 160.0 * (0.5 + 0.5 * style.amplitude) * dice.about_one(0.02);
    let duration = 2.0 * period;
    let curves = JackCurves::new();
    Action::new(duration, Place::default(), move |t| {
        // Both ends of a repetition are neutral standing.
        let u = (t / period).fract();
        let at = |curve: &Spline<1>| curve.at(u)[0];
        let (open, arms) = (at(&curves.feet), at(&curves.arms));
        let mut pose = actor.stand();
        for side in Side::BOTH {
            let mut footing = actor.footing(side);
            footing.x += side.sign() * open * (wide - actor.half_stance());
            footing.yaw += side.sign() * 8.0 * open;
            footing.pitch = at(&curves.heels);
            footing.lift = leg * at(&curves.lift);
            *pose.leg(side) = footing.leg(&actor.body);
        }
        // In the straddle the legs reach less far down.
        let closed = (leg * leg - actor.half_stance().powi(2)).sqrt();
        let spread =
            (leg * leg - (actor.half_stance() * (1.0 - open) + wide * open).powi(2)).sqrt();
        pose.root.y += leg * at(&curves.rise) - (closed - spread);
        pose.spine.flex += 4.0 * at(&curves.dip);
        pose.lean += 5.0 * at(&curves.dip);
        pose.both_arms(|arm| {
            arm.spread += arms * (reach - arm.spread);
            arm.flex += 8.0 * arms;
            arm.twist -= 30.0 * arms;
            arm.elbow += arms * (18.0 - arm.elbow);
        });
        pose
    })
}

/// One repetition of a jumping jack over `[0, 1]`, in legs where it is a length.
struct JackCurves {
    /// 0 closed, 1 straddled.
    feet: Spline<1>,
    /// 0 hanging, 1 overhead.
    arms: Spline<1>,
    lift: Spline<1>,
    /// Degrees the heels are rolled up.
    heels: Spline<1>,
    /// Height of the pelvis relative to standing.
    rise: Spline<1>,
    dip: Spline<1>,
}

impl JackCurves {
    fn new() -> JackCurves {
        JackCurves {
            feet: track(&[
                (0.0, 0.0),
                (0.17, 0.0),
                (0.38, 1.0),
                (0.60, 1.0),
                (0.82, 0.0),
                (1.0, 0.0),
            ]),
            arms: track(&[
                (0.0, 0.0),
                (0.08, 0.0),
                (0.47, 1.0),
                (0.53, 1.0),
                (0.92, 0.0),
                (1.0, 0.0),
            ]),
            lift: track(&[
                (0.0, 0.0),
                (0.15, 0.0),
                (0.28, 0.075),
                (0.40, 0.0),
                (0.58, 0.0),
                (0.71, 0.065),
                (0.84, 0.0),
                (1.0, 0.0),
            ]),
            heels: track(&[
                (0.0, 0.0),
                (0.06, 0.0),
                (0.17, 32.0),
                (0.28, 40.0),
                (0.39, 18.0),
                (0.46, 0.0),
                (0.51, 0.0),
                (0.60, 32.0),
                (0.71, 40.0),
                (0.83, 18.0),
                (0.92, 0.0),
                (1.0, 0.0),
            ]),
            rise: track(&[
                (0.0, 0.0),
                (0.08, -0.07),
                (0.17, 0.03),
                (0.28, 0.115),
                (0.39, 0.01),
                (0.48, -0.06),
                (0.60, 0.03),
                (0.71, 0.11),
                (0.83, 0.01),
                (0.92, -0.05),
                (1.0, 0.0),
            ]),
            dip: track(&[
                (0.0, 0.0),
                (0.08, 1.0),
                (0.26, 0.0),
                (0.46, 1.0),
                (0.70, 0.0),
                (0.92, 1.0),
                (1.0, 0.0),
            ]),
        }
    }
}

/// A jump forward off both feet.
pub(crate) fn hop(actor: &Actor, dice: &mut Dice) -> Action {
    let body = &actor.body;
    let leg = body.leg();
    let size = actor.performer.style.amplitude * dice.about_one(0.08);
    let far = 0.42 * leg * size;
    let high = 0.13 * leg * size;
    let feet = |pose: &mut Pose, z: f64, lift: f64, pitch: f64| {
        for side in Side::BOTH {
            let mut footing = actor.footing(side);
            footing.z = z;
            footing.lift = lift;
            footing.pitch = pitch;
            *pose.leg(side) = footing.leg(body);
        }
    };
    let arms = |pose: &mut Pose, flex: f64, elbow: f64| {
        pose.both_arms(|arm| {
            arm.flex = flex;
            arm.elbow = elbow;
        });
    };
    let end = Place {
        z: far,
        ..Place::default()
    };
    let mut action = Keys::new(actor, dice)
        .at(0.46, |pose| {
            pose.root.y -= 0.20 * leg;
            pose.root.z -= 0.02 * leg;
            pose.lean = 24.0;
            pose.spine.flex += 16.0;
            arms(pose, -34.0, 22.0);
        })
        .at(0.76, |pose| {
            pose.root.y += 0.055 * leg;
            pose.root.z += 0.17 * leg;
            pose.lean = 8.0;
            feet(pose, 0.0, 0.0, 42.0);
            arms(pose, 48.0, 32.0);
        })
        .at(0.92, |pose| {
            pose.root.y += 0.05 * leg + high;
            pose.root.z += 0.15 * leg + 0.42 * far;
            pose.lean = 6.0;
            pose.spine.flex += 4.0;
            feet(pose, 0.50 * far, 1.05 * high, 30.0);
            arms(pose, 76.0, 40.0);
        })
        .at(1.08, |pose| {
            pose.root.y -= 0.015 * leg;
            pose.root.z += far - 0.06 * leg;
            pose.lean = 12.0;
            pose.spine.flex += 10.0;
            feet(pose, far, 0.0, 10.0);
            arms(pose, 58.0, 32.0);
        })
        .at(1.29, |pose| {
            pose.root.y -= 0.17 * leg;
            pose.root.z += far - 0.02 * leg;
            pose.lean = 22.0;
            pose.spine.flex += 14.0;
            feet(pose, far, 0.0, 0.0);
            arms(pose, 24.0, 30.0);
        })
        .at(1.85, |pose| {
            pose.root.z += far;
            feet(pose, far, 0.0, 0.0);
        })
        .build(dice);
    action.end = end;
    action
}
