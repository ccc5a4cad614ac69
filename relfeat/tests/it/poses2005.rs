//! Poses whose answers a person can see, for the sets of 2005.

use relfeat::ndarray::Array3;
use relfeat::{BodyMap, FeatureSet, extract};

use crate::figure::{map, motion, names, rig};

const SETS: [&str; 2] = ["mueller2005", "mueller2005-text"];

/// What is on in the first frame of both sets.
#[track_caller]
fn check(positions: &Array3<f32>, expected: &[&str]) {
    for name in SETS {
        let set = FeatureSet::builtin(name).unwrap();
        let words = extract(&set, positions.view(), &map(), 120.0, 120.0)
            .unwrap()
            .words;
        let features = set.features().iter().enumerate();
        let on: Vec<&str> = features
            .filter(|(bit, _)| words[0] >> bit & 1 == 1)
            .map(|(_, f)| f.name.as_str())
            .collect();
        assert_eq!(on, expected, "{name}");
    }
}

/// A standing figure but for the named points.
fn pose(moved: &[(&str, [f32; 3])]) -> Array3<f32> {
    motion(1, |_, name, at| {
        moved
            .iter()
            .find(|(moved, _)| *moved == name)
            .map_or(at, |(_, to)| *to)
    })
}

#[test]
fn a_standing_figure_has_its_toes_in_front() {
    // The paper, section 3: F_r is 1 "for a pose corresponding to a person standing upright".
    check(&pose(&[]), &["rfoot_front", "lfoot_front"]);
}

#[test]
fn a_step_leaves_the_other_foot_behind() {
    // "It assumes the value 0 when the right foot moves to the back or the left foot to the front."
    let right_back = [
        ("rankle", [-0.1, 0.2, -0.28]),
        ("rtoes", [-0.1, 0.05, -0.15]),
    ];
    check(&pose(&right_back), &["lfoot_front"]);
    let left_ahead = [("lankle", [0.1, 0.2, 0.32]), ("ltoes", [0.1, 0.1, 0.5])];
    check(&pose(&left_ahead), &["lfoot_front"]);
}

#[test]
fn a_kick_raises_the_foot() {
    // The other foot is behind the kicking leg.
    let kick = [
        ("rknee", [-0.1, 0.95, 0.45]),
        ("rankle", [-0.1, 0.95, 0.87]),
        ("rtoes", [-0.1, 1.1, 0.95]),
    ];
    check(&pose(&kick), &["rfoot_front", "rfoot_raised"]);
}

#[test]
fn a_punch_stretches_the_arm_to_the_front() {
    // A little below the neck: at its height the paper's hand is raised, too.
    let punch = [
        ("lelbow", [0.2, 1.4, 0.3]),
        ("lwrist", [0.2, 1.39, 0.55]),
        ("lfingers", [0.2, 1.39, 0.7]),
    ];
    check(
        &pose(&punch),
        &["rfoot_front", "lfoot_front", "lhand_front"],
    );
}

#[test]
fn arms_and_legs_to_the_sides_are_sideways() {
    let arm = [
        ("relbow", [-0.5, 1.38, 0.0]),
        ("rwrist", [-0.75, 1.38, 0.0]),
        ("rfingers", [-0.9, 1.38, 0.0]),
    ];
    check(
        &pose(&arm),
        &["rfoot_front", "lfoot_front", "rarm_sideways"],
    );
    let leg = [("lankle", [0.38, 0.19, 0.0]), ("ltoes", [0.38, 0.1, 0.2])];
    check(
        &pose(&leg),
        &["rfoot_front", "lfoot_front", "lleg_sideways"],
    );
}

#[test]
fn crossed_limbs_have_changed_sides() {
    let legs = [
        ("rankle", [0.05, 0.11, 0.0]),
        ("rtoes", [0.05, 0.03, 0.2]),
        ("lankle", [-0.05, 0.11, 0.0]),
        ("ltoes", [-0.05, 0.03, 0.2]),
    ];
    check(
        &pose(&legs),
        &["rfoot_front", "lfoot_front", "legs_crossed"],
    );
    let arms = [
        ("relbow", [-0.2, 1.1, 0.2]),
        ("rwrist", [0.2, 1.1, 0.25]),
        ("rfingers", [0.35, 1.1, 0.25]),
        ("lelbow", [0.2, 1.1, 0.2]),
        ("lwrist", [-0.2, 1.1, 0.15]),
        ("lfingers", [-0.35, 1.1, 0.15]),
    ];
    let on = [
        "rfoot_front",
        "lfoot_front",
        "relbow_bent",
        "lelbow_bent",
        "arms_crossed",
    ];
    check(&pose(&arms), &on);
}

#[test]
fn hands_touch_each_other() {
    let hands = [
        ("rwrist", [-0.1, 1.2, 0.2]),
        ("rfingers", [-0.02, 1.2, 0.32]),
        ("lwrist", [0.1, 1.2, 0.2]),
        ("lfingers", [0.02, 1.2, 0.32]),
    ];
    let on = [
        "rfoot_front",
        "lfoot_front",
        "relbow_bent",
        "lelbow_bent",
        "hands_touching",
    ];
    check(&pose(&hands), &on);
}

#[test]
fn a_hand_on_the_chest_does_not_touch_the_head() {
    // 0.1 m below the neck and 0.1 m before it: the head's segment is 0.3 m long.
    let chest = [("rwrist", [-0.15, 1.3, 0.1]), ("rfingers", [0.0, 1.3, 0.1])];
    let on = ["rfoot_front", "lfoot_front", "relbow_bent"];
    check(&pose(&chest), &on);
    let chin = [
        ("rwrist", [-0.12, 1.36, 0.1]),
        ("rfingers", [0.0, 1.45, 0.1]),
    ];
    let on = [on.as_slice(), &["rhand_touching_head"]].concat();
    check(&pose(&chin), &on);
    let above = [
        ("lelbow", [0.2, 1.65, 0.0]),
        ("lwrist", [0.1, 1.79, 0.1]),
        ("lfingers", [0.0, 1.9, 0.1]),
    ];
    let on = [
        "rfoot_front",
        "lfoot_front",
        "lhand_raised",
        "lhand_touching_head",
    ];
    check(&pose(&above), &on);
}

#[test]
fn hands_reach_hips_shanks_and_feet_but_no_thigh() {
    let feet = ["rfoot_front", "lfoot_front"];
    let with = |more: &[&'static str]| [feet.as_slice(), more].concat();
    let hip = [
        ("rwrist", [-0.2, 1.05, 0.21]),
        ("rfingers", [-0.2, 0.95, 0.1]),
    ];
    check(&pose(&hip), &with(&["relbow_bent", "rhand_touching_hip"]));
    let thigh = [
        ("rwrist", [-0.17, 0.86, 0.02]),
        ("rfingers", [-0.1, 0.73, 0.02]),
    ];
    check(&pose(&thigh), &feet);
    let other_shank = [("rwrist", [0.0, 0.5, 0.15]), ("rfingers", [0.1, 0.4, 0.1])];
    check(&pose(&other_shank), &with(&["rhand_touching_leg"]));
    // The foot is 0.215 m long: a hand touches it at 0.30 m behind the ankle, and not at 0.33 m.
    let behind = |z| pose(&[("lwrist", [0.1, 0.2, z]), ("lfingers", [0.1, 0.05, z])]);
    check(&behind(-0.3), &with(&["lhand_touching_leg"]));
    check(&behind(-0.33), &feet);
}

#[test]
fn the_torso_is_bent_only_over_both_thighs() {
    let one = [
        ("rknee", [-0.1, 0.95, 0.45]),
        ("rankle", [-0.1, 0.53, 0.45]),
        ("rtoes", [-0.1, 0.5, 0.65]),
    ];
    check(&pose(&one), &["rfoot_front", "rfoot_raised", "rknee_bent"]);
    let other = [
        ("lknee", [0.1, 0.95, 0.45]),
        ("lankle", [0.1, 0.53, 0.45]),
        ("ltoes", [0.1, 0.5, 0.65]),
    ];
    let on = [
        "rfoot_front",
        "lfoot_front",
        "rfoot_raised",
        "lfoot_raised",
        "rknee_bent",
        "lknee_bent",
        "torso_bent",
    ];
    check(&pose(&[one, other].concat()), &on);
}

/// The word of the last frame, a feature alone.
fn last(set: &str, feature: &str, positions: &Array3<f32>) -> bool {
    let set = FeatureSet::builtin(set).unwrap();
    let found = extract(&set, positions.view(), &map(), 120.0, 120.0).unwrap();
    found.words.last().unwrap() & set.select(feature).unwrap() != 0
}

#[test]
fn levels_are_those_of_the_spec() {
    // In the first frame the value is far beyond the strict level, in the second between the levels.
    // hl = 0.3, fl = 0.45, chest = 0.15.
    let two = |point: &'static str, first: [f32; 3], second: [f32; 3]| {
        motion(2, move |frame, name, at| match (name == point, frame) {
            (true, 0) => first,
            (true, _) => second,
            _ => at,
        })
    };
    let cases = [
        // Between 0 and 0.25 fl behind the plane.
        ("rfoot_front", "rtoes", [-0.1, 0.0, 0.2], [-0.1, 0.0, -0.05]),
        // Between the neck and the chest.
        ("rhand_raised", "rwrist", [-0.2, 1.6, 0.0], [-0.2, 1.3, 0.0]),
    ];
    for (feature, point, first, second) in cases {
        let sinking = two(point, first, second);
        assert!(last("mueller2005", feature, &sinking), "{feature}");
        assert!(!last("mueller2005-text", feature, &sinking), "{feature}");
        let settled = two(point, second, second);
        assert!(!last("mueller2005", feature, &settled), "{feature}");
    }
    // Between 1 and 1.15 hl before the body: the text has the loose level.
    let reaching = two("rwrist", [-0.2, 1.2, 0.32], [-0.2, 1.2, 0.32]);
    assert!(!last("mueller2005", "rhand_front", &reaching));
    assert!(last("mueller2005-text", "rhand_front", &reaching));
}

#[test]
fn speeds_are_in_lengths_of_the_body() {
    // Metres per second: fl = 0.45, hl = 0.3.
    let moving = |points: &'static [&'static str], speed: f32| {
        motion(40, move |frame, name, at| {
            let way = speed * frame as f32 / 120.0;
            let moves = points.contains(&name) || points.is_empty();
            if moves {
                [at[0] + way, at[1], at[2]]
            } else {
                at
            }
        })
    };
    for set in SETS {
        let on = |feature, points, speed| last(set, feature, &moving(points, speed));
        assert!(on("rfoot_fast", &["rtoes", "rankle"], 0.5));
        assert!(!on("rfoot_fast", &["rtoes", "rankle"], 0.4));
        // Turning on the heel.
        assert!(!on("rfoot_fast", &["rtoes"], 5.0));
        assert!(on("lhand_fast", &["lfingers"], 0.4));
        assert!(!on("lhand_fast", &["lfingers"], 0.25));
        assert!(on("root_fast", &[], 0.65));
        assert!(!on("root_fast", &[], 0.55));
    }
    // Between the levels of 1.25 and 1 hl/s.
    let slowly = moving(&["lfingers"], 0.35);
    assert!(!last("mueller2005", "lhand_fast", &slowly));
    assert!(last("mueller2005-text", "lhand_fast", &slowly));
}

#[test]
fn a_rig_without_fingers_lacks_the_features_that_need_them() {
    let mut rig = rig();
    rig.points
        .retain(|point, _| !matches!(point.name(), "lfingers" | "rfingers"));
    let map = BodyMap::with_rig(&names(), &rig);
    for name in SETS {
        let set = FeatureSet::builtin(name).unwrap();
        assert_eq!(set.unavailable(&crate::figure::map()), []);
        let lacking: Vec<&str> = set
            .unavailable(&map)
            .iter()
            .map(|u| set.features()[u.feature_idx].name.as_str())
            .collect();
        let expected = [
            "rhand_fast",
            "lhand_fast",
            "hands_touching",
            "rhand_touching_leg",
            "lhand_touching_leg",
            "rhand_touching_head",
            "lhand_touching_head",
            "rhand_touching_hip",
            "lhand_touching_hip",
        ];
        assert_eq!(lacking, expected);
    }
}
