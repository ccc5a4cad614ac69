//! Named cases whose answer is known without calculation.

use relfeat::ndarray::Array3;
use relfeat::{BodyMap, ExtractError, FeatureSet, Measured, Rig, extract, measure};

use crate::figure::{idx, map, motion, names, rig};

/// Positions are `f32`.
const ROUNDING: f64 = 1e-6;

/// One feature with a quantity as it stands in TOML.
fn set_of(quantity: &str, enter: &str, stay: &str) -> FeatureSet {
    FeatureSet::from_toml(&format!(
        "name = 't'\n[lengths]\nhl = [['rshoulder', 'relbow']]\n[[feature]]\nname = 'x'\nset = 's'\nmirror = 'x'\n\
         quantity = {quantity}\nenter = '{enter}'\nstay = '{stay}'\n"
    ))
    .unwrap_or_else(|e| panic!("{e}"))
}

fn values(quantity: &str, unit: &str, positions: &Array3<f32>, rate: f64) -> Vec<f64> {
    let test = format!(">= 0 {unit}");
    measure(
        &set_of(quantity, &test, &test),
        0,
        positions.view(),
        &map(),
        rate,
    )
    .unwrap()
    .values
}

/// The z of the normal, as the distance of a point one metre in front.
#[track_caller]
fn check_normal_z(points: [&str; 3], sign: f64) {
    let positions = motion(1, |_, name, at| match name {
        "headtop" => [0.0, 1.0, 1.0],
        // The thighs lean a little, so that no three points lie in a line.
        "lankle" | "rankle" => [2.0 * at[0], at[1], at[2]],
        "root" => [0.0, 1.0, 0.0],
        _ => [at[0], at[1], 0.0],
    });
    let quantity = format!(
        "{{ kind = 'distance', of = 'headtop', from = 'root', along = {{ normal = {points:?} }} }}"
    );
    let found = values(&quantity, "m", &positions, 30.0)[0];
    assert!((found - sign).abs() <= ROUNDING, "{points:?}: {found}");
}

#[test]
fn planes_point_where_the_spec_says() {
    // spec.md a.1: on a figure that faces +Z with its left at +X.
    check_normal_z(["root", "lhip", "lankle"], -1.0);
    check_normal_z(["root", "rankle", "rhip"], -1.0);
    check_normal_z(["neck", "rhip", "lhip"], 1.0);
    check_normal_z(["rhip", "lhip", "neck"], 1.0);
    check_normal_z(["root", "lshoulder", "rshoulder"], 1.0);
    // spec.md a.2, F31: backward.
    check_normal_z(["rankle", "neck", "lankle"], -1.0);
}

const FRONTAL: &str = "{ kind = 'distance', of = 'rwrist', from = 'root', along = { normal = ['root', 'lshoulder', 'rshoulder'] } }";

#[test]
fn a_degenerate_plane_keeps_the_normal_before_it() {
    // The wrist is 1 m in front; in some frames a shoulder falls onto the root.
    let flat = |frames: &'static [usize]| {
        motion(4, move |frame, name, at| match name {
            "rwrist" => [0.0, 1.0, 1.0],
            "lshoulder" if frames.contains(&frame) => [0.0, 1.0, 0.0],
            _ => at,
        })
    };
    let set = set_of(FRONTAL, ">= 0.5 m", ">= 0.5 m");
    let words = |positions: Array3<f32>| {
        extract(&set, positions.view(), &map(), 30.0, 30.0)
            .unwrap()
            .words
    };
    assert_eq!(words(flat(&[])), [1, 1, 1, 1]);
    assert_eq!(words(flat(&[1, 2])), [1, 1, 1, 1]);
    // In the first frames there is none to keep.
    assert_eq!(words(flat(&[0, 1])), [0, 0, 1, 1]);
    assert_eq!(words(flat(&[0, 1, 2, 3])), [0, 0, 0, 0]);
}

#[test]
fn points_in_a_line_span_no_plane_however_far_apart() {
    let positions = motion(1, |_, name, at| match name {
        "rshoulder" => [-1000.0, 1.0, 0.0],
        "lshoulder" => [1000.0, 1.0, 0.0],
        _ => at,
    });
    assert!(values(FRONTAL, "m", &positions, 30.0)[0].is_nan());
}

fn without(mut positions: Array3<f32>, name: &str, frame: usize) -> Array3<f32> {
    for axis in 0..3 {
        positions[[frame, idx(name), axis]] = f32::NAN;
    }
    positions
}

#[track_caller]
fn check_missing(quantity: &str, unit: &str, name: &str, expected: &[usize]) {
    let positions = motion(20, |_, name, at| match name {
        "rwrist" => [0.0, 1.0, 1.0],
        _ => at,
    });
    let found = values(quantity, unit, &without(positions, name, 10), 30.0);
    let missing: Vec<usize> = (0..20).filter(|&t| found[t].is_nan()).collect();
    assert_eq!(missing, expected, "{quantity}, {name}");
}

#[test]
fn a_missing_point_turns_features_off_in_its_own_frame_only() {
    for name in ["rwrist", "root", "lshoulder", "rshoulder"] {
        check_missing(FRONTAL, "m", name, &[10]);
    }
    let axis =
        "{ kind = 'distance', of = 'rwrist', from = 'root', along = { axis = ['chest', 'neck'] } }";
    for name in ["chest", "neck", "rwrist"] {
        check_missing(axis, "m", name, &[10]);
    }
    let angle = "{ kind = 'angle', of = ['rknee', 'rhip'], to = ['rknee', 'rankle'] }";
    for name in ["rhip", "rankle", "rknee"] {
        check_missing(angle, "deg", name, &[10]);
    }
    check_missing(
        "{ kind = 'angle', of = ['root', 'neck'], to = 'up' }",
        "deg",
        "neck",
        &[10],
    );
    check_missing(
        "{ kind = 'height', of = 'rtoes', above_lowest_except = [] }",
        "m",
        "headtop",
        &[10],
    );
    check_missing(
        "{ kind = 'height', of = 'rtoes', above_lowest_except = ['headtop'] }",
        "m",
        "headtop",
        &[],
    );
    check_missing("{ kind = 'vertical_extent' }", "m", "belly", &[10]);
    for name in ["root", "rwrist", "lankle"] {
        check_missing(
            "{ kind = 'horizontal_diameter', of = ['root', 'rwrist', 'lankle'] }",
            "m",
            name,
            &[10],
        );
    }
}

#[test]
fn a_missing_point_turns_velocities_off_where_a_window_begins_or_ends_on_it() {
    // Without smoothing the velocity at t is x(t+1) − x(t).
    check_missing(
        "{ kind = 'speed', of = ['root'], window_ms = 0 }",
        "m/s",
        "root",
        &[9, 10],
    );
    // 100 ms at 30 Hz are three samples, t−1 … t+1: from x(t−1) to x(t+2).
    check_missing(
        "{ kind = 'speed', of = ['neck', 'root'], window_ms = 100 }",
        "m/s",
        "root",
        &[8, 11],
    );
    let velocity = "{ kind = 'velocity', of = 'rwrist', relative_to = 'root', along = { axis = ['chest', 'neck'] }, \
                    window_ms = 100 }";
    check_missing(velocity, "m/s", "rwrist", &[8, 11]);
    check_missing(velocity, "m/s", "root", &[8, 11]);
    // The direction is that of the frame itself.
    check_missing(velocity, "m/s", "neck", &[10]);
}

#[test]
fn a_feature_that_was_on_goes_off_where_its_point_is_missing() {
    let set = set_of(FRONTAL, ">= 0.5 m", ">= 0.5 m");
    let positions = motion(5, |_, name, at| {
        if name == "rwrist" {
            [0.0, 1.0, 1.0]
        } else {
            at
        }
    });
    let found = extract(
        &set,
        without(positions, "rwrist", 2).view(),
        &map(),
        30.0,
        30.0,
    )
    .unwrap();
    assert_eq!(found.words, [1, 1, 0, 1, 1]);
}

#[test]
fn lengths_are_those_of_the_first_frame() {
    let set = set_of(FRONTAL, ">= 3 hl", ">= 3 hl");
    // The wrist is 1 m in front; the upper arm has 0.3 m, and later 0.4 m.
    let positions = motion(2, |frame, name, at| match name {
        "rwrist" => [0.0, 1.0, 1.0],
        "relbow" if frame == 1 => [at[0], at[1] - 0.1, at[2]],
        _ => at,
    });
    assert_eq!(
        extract(&set, positions.view(), &map(), 30.0, 30.0)
            .unwrap()
            .words,
        [1, 1]
    );
    let missing = without(positions, "relbow", 0);
    assert_eq!(
        extract(&set, missing.view(), &map(), 30.0, 30.0)
            .unwrap()
            .words,
        [0, 0]
    );
}

#[test]
fn hysteresis_has_two_thresholds() {
    let set = set_of(FRONTAL, ">= 1 m", ">= 0.5 m");
    let heights = [0.7, 1.25, 0.7, 0.25, 0.7, 1.0, 0.5, 0.4];
    let positions = motion(8, |frame, name, at| {
        if name == "rwrist" {
            [0.0, 1.0, heights[frame]]
        } else {
            at
        }
    });
    let found = extract(&set, positions.view(), &map(), 30.0, 30.0).unwrap();
    assert_eq!(found.words, [0, 1, 1, 0, 0, 1, 1, 0]);
}

#[test]
fn a_standing_figure_answers_as_expected() {
    let set = FeatureSet::builtin("mueller2006").unwrap();
    let on = |positions: &Array3<f32>| -> Vec<String> {
        let word = extract(&set, positions.view(), &map(), 120.0, 30.0)
            .unwrap()
            .words[0];
        let features = set.features().iter().enumerate();
        features
            .filter(|(i, _)| word >> i & 1 == 1)
            .map(|(_, f)| f.name.clone())
            .collect()
    };
    assert_eq!(on(&motion(1, |_, _, at| at)), [] as [&str; 0]);
    let raised = motion(1, |_, name, at| match name {
        "relbow" => [-0.2, 1.7, 0.0],
        "rwrist" => [-0.2, 1.9, 0.0],
        "rfingers" => [-0.2, 2.0, 0.0],
        _ => at,
    });
    assert_eq!(on(&raised), ["rhand_above_neck", "rhumerus_abducted"]);
    let step = motion(1, |_, name, at| match name {
        "rankle" | "rtoes" => [at[0], at[1], at[2] - 0.3],
        _ => at,
    });
    assert_eq!(on(&step), ["rfoot_behind_lleg"]);
    let lying = motion(1, |_, _, [x, y, z]| [x, z, y]);
    let lying = on(&lying);
    for name in [
        "spine_horizontal",
        "vertical_extent_small",
        "rhand_lowered",
        "lhand_lowered",
        "horizontal_extent_large",
    ] {
        assert!(lying.iter().any(|n| n == name), "{name}: {lying:?}");
    }
}

#[test]
fn a_rig_without_toes_lacks_the_features_that_need_them() {
    let mut rig = rig();
    rig.points
        .retain(|point, _| !matches!(point.name(), "ltoes" | "rtoes"));
    let map = BodyMap::with_rig(&names(), &rig);
    let set = FeatureSet::builtin("mueller2006").unwrap();
    let positions = motion(3, |_, _, at| at);
    let found = extract(&set, positions.view(), &map, 30.0, 30.0).unwrap();
    let numbers: Vec<usize> = found
        .unavailable
        .iter()
        .map(|u| u.feature_idx + 1)
        .collect();
    // F17, F18, F33, F34, F37 look for the lowest point, F25 and F26 for the speed of toes.
    assert_eq!(numbers, [17, 18, 25, 26, 33, 34, 37]);
    assert_eq!(found.unavailable, set.unavailable(&map));
    let missing: Vec<&str> = found.unavailable[2]
        .missing
        .iter()
        .map(|p| p.name())
        .collect();
    assert_eq!(missing, ["rtoes"]);
    assert_eq!(measure(&set, 16, positions.view(), &map, 30.0), None);
    let lacking: u64 = numbers.iter().map(|n| 1 << (n - 1)).sum();
    assert!(found.words.iter().all(|word| word & lacking == 0));
}

#[test]
fn a_rig_without_an_elbow_lacks_the_unit_of_most_thresholds() {
    let mut rig = rig();
    rig.points.retain(|point, _| point.name() != "relbow");
    let set = FeatureSet::builtin("mueller2006").unwrap();
    let unavailable = set.unavailable(&BodyMap::with_rig(&names(), &rig));
    // F39 is the root's speed, in humerus lengths.
    assert!(unavailable.iter().any(|u| u.feature_idx == 38));
    // F32 is an angle without it.
    assert!(unavailable.iter().all(|u| u.feature_idx != 31));
}

#[test]
fn arguments_that_do_not_fit_are_errors() {
    let set = FeatureSet::builtin("mueller2006").unwrap();
    let positions = motion(2, |_, _, at| at);
    let error = |positions: &Array3<f32>, rate, library_rate| {
        extract(&set, positions.view(), &map(), rate, library_rate).unwrap_err()
    };
    assert_eq!(
        error(&Array3::zeros((2, 24, 2)), 30.0, 30.0),
        ExtractError::Shape(2, 24, 2)
    );
    let few = error(&Array3::zeros((2, 23, 3)), 30.0, 30.0);
    assert_eq!(
        few.to_string(),
        "the body map names joint 23, the positions have 23 joints"
    );
    for rate in [0.0, -30.0, f64::INFINITY] {
        let found = error(&positions, rate, 30.0);
        assert_eq!(
            found,
            ExtractError::Rate {
                what: "the rate",
                found: rate
            }
        );
        let found = error(&positions, 30.0, rate);
        assert_eq!(
            found.to_string(),
            format!("the library rate must be positive and finite, found {rate}")
        );
        assert_eq!(measure(&set, 0, positions.view(), &map(), rate), None);
    }
    assert!(matches!(
        error(&positions, f64::NAN, 30.0),
        ExtractError::Rate { .. }
    ));
    let many = error(&positions, 1.0, 1e9);
    assert_eq!(
        many.to_string(),
        "2 frames at 1 Hz give too many at 1000000000 Hz"
    );
    assert_eq!(measure(&set, 39, positions.view(), &map(), 30.0), None);
    assert_eq!(
        measure(&set, 0, Array3::zeros((0, 24, 3)).view(), &map(), 30.0),
        None
    );
}

#[test]
fn measured_numbers_come_with_their_thresholds() {
    let positions = motion(3, |frame, name, at| match name {
        "root" => [0.0, 1.0, 0.1 * frame as f32],
        _ => at,
    });
    let set = FeatureSet::builtin("mueller2006").unwrap();
    let Measured {
        values,
        enter,
        stay,
    } = measure(&set, 38, positions.view(), &map(), 30.0).unwrap();
    // 0.1 m per frame are 3 m/s; the upper arm has 0.3 m.
    assert!(
        values.iter().all(|v| (v - 3.0).abs() <= 10.0 * ROUNDING),
        "{values:?}"
    );
    let close = |found: f64, expected: f64| (found - expected).abs() <= ROUNDING;
    assert!(
        close(enter.thresholds().next().unwrap(), 0.69)
            && close(stay.thresholds().next().unwrap(), 0.6)
    );
}

#[test]
fn extreme_rates_take_no_time() {
    let set = FeatureSet::builtin("mueller2006").unwrap();
    let positions = motion(50, |_, _, at| at);
    assert_eq!(
        extract(&set, positions.view(), &map(), 1e15, 30.0)
            .unwrap()
            .words
            .len(),
        1
    );
    assert_eq!(
        extract(&set, positions.view(), &map(), 1e-300, 1e-300)
            .unwrap()
            .words
            .len(),
        50
    );
}

#[test]
fn weighted_points_lie_on_or_beyond_the_bone() {
    let rig =
        Rig::from_toml("name = 'w'\n[points]\nroot = ['a']\nneck = { a = -0.5, b = 1.5 }").unwrap();
    let map = BodyMap::with_rig(&["a", "b"], &rig);
    let mut positions = Array3::zeros((1, 2, 3));
    positions[[0, 1, 1]] = 2.0;
    let quantity =
        "{ kind = 'distance', of = 'neck', from = 'root', along = { axis = ['root', 'neck'] } }";
    let found = measure(
        &set_of(quantity, ">= 0 m", ">= 0 m"),
        0,
        positions.view(),
        &map,
        30.0,
    )
    .unwrap();
    assert_eq!(found.values, [3.0]);
}
