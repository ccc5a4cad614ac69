//! What must not change the words, and what must change them in a known way.

use proptest::prelude::*;
use relfeat::ndarray::Array3;
use relfeat::{BodyPoint, FeatureSet, FeatureWords, Quantity, extract, measure};

use crate::figure::{map, motion};
use crate::naive::kept_frames;

/// Positions are rounded to `f32`, at coordinates of up to ten times the figure's size; a value this
/// close to its threshold, relative to the size, the degree or the speed of a second, may change sides.
const NEAR: f64 = 2e-3;

/// The sets that the laws are tested on.
const SETS: [&str; 3] = ["mueller2006", "mueller2005", "mueller2005-text"];

/// The sets of 39 features.
const SETS_2006: [&str; 2] = ["mueller2006", "mueller2006-table6"];

fn set() -> FeatureSet {
    FeatureSet::builtin("mueller2006").unwrap()
}

fn words(set: &FeatureSet, positions: &Array3<f32>, rate: f64) -> FeatureWords {
    extract(set, positions.view(), &map(), rate, rate).unwrap()
}

/// A figure that waves, kicks and turns, in ways that `seed` decides.
fn lively(seed: u64, n_frames: usize) -> Array3<f32> {
    motion(n_frames, |frame, name, at| {
        let point = name.bytes().fold(seed | 1, |h, b| {
            h.wrapping_mul(31).wrapping_add(u64::from(b))
        });
        let wave = |i: u64| {
            let x = point
                .wrapping_mul(0x9e37_79b9_7f4a_7c15)
                .rotate_left(8 * i as u32)
                >> 40;
            let (size, phase) = ((x & 0xfff) as f32 / 4096.0, (x >> 12) as f32);
            0.4 * size * (phase + frame as f32 * 0.1 * (1.0 + size)).sin()
        };
        [at[0] + wave(0), at[1] + wave(1), at[2] + wave(2)]
    })
}

/// Whether the point of a segment with a flat start comes near the plane in which it starts.
fn is_near_flat_start(positions: &Array3<f32>, quantity: &Quantity) -> bool {
    let Quantity::SegmentDistance {
        of,
        to,
        flat_start: true,
        ..
    } = quantity
    else {
        return false;
    };
    positions.outer_iter().any(|pose| {
        let at = |p: BodyPoint| [0, 1, 2].map(|axis| f64::from(pose[[p.idx(), axis]]));
        let (start, end) = (at(to[0]), at(to[1]));
        of.iter().any(|&point| {
            let q = at(point);
            let along: f64 = (0..3)
                .map(|i| (q[i] - start[i]) * (end[i] - start[i]))
                .sum();
            let square: f64 = (0..3).map(|i| (end[i] - start[i]).powi(2)).sum();
            (along / square).abs() <= NEAR
        })
    })
}

/// Features of which some value comes near a threshold: hysteresis may carry the doubt on.
fn doubtful(set: &FeatureSet, positions: &Array3<f32>, rate: f64) -> u64 {
    let mut doubtful = 0;
    for (i, feature) in set.features().iter().enumerate() {
        let measured = measure(set, i, positions.view(), &map(), rate).unwrap();
        let largest = measured.values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        let thresholds: Vec<f64> = measured
            .enter
            .thresholds()
            .chain(measured.stay.thresholds())
            .collect();
        let is_near = |v: &f64| {
            thresholds
                .iter()
                .any(|x| (v - x).abs() <= NEAR * largest.max(1e-3))
        };
        if measured.values.iter().any(is_near) || is_near_flat_start(positions, &feature.quantity) {
            doubtful |= 1 << i;
        }
    }
    doubtful
}

fn moved(positions: &Array3<f32>, by: impl Fn([f64; 3]) -> [f64; 3]) -> Array3<f32> {
    let mut moved = positions.clone();
    for mut pose in moved.outer_iter_mut() {
        for mut point in pose.outer_iter_mut() {
            let to = by([0, 1, 2].map(|i| f64::from(point[i])));
            for i in 0..3 {
                point[i] = to[i] as f32;
            }
        }
    }
    moved
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, cases: 60, ..ProptestConfig::default() })]

    #[test]
    fn place_heading_and_size_do_not_matter(
        seed in any::<u64>(),
        heading in 0.0..6.3f64,
        to in [-5.0..5.0, -5.0..5.0, -5.0..5.0],
        size in prop_oneof![Just(1.0), 0.3..3.0, Just(100.0)],
    ) {
        let (sin, cos) = heading.sin_cos();
        let before = lively(seed, 60);
        let after = moved(&before, |[x, y, z]| {
            [cos * x + sin * z + to[0], y + to[1], cos * z - sin * x + to[2]].map(|v| size * v)
        });
        for name in SETS {
            let set = FeatureSet::builtin(name).unwrap();
            let doubtful = doubtful(&set, &before, 60.0);
            prop_assert!(doubtful != set.all());
            let (before, after) = (words(&set, &before, 60.0).words, words(&set, &after, 60.0).words);
            for (frame, (a, b)) in before.iter().zip(&after).enumerate() {
                prop_assert_eq!(a & !doubtful, b & !doubtful, "{}, frame {}", name, frame);
            }
        }
    }

    #[test]
    fn a_mirrored_body_has_mirrored_words(seed in any::<u64>()) {
        // Unlike sides make unlike upper arms, which are the unit of the thresholds: make them alike.
        let mut before = lively(seed, 60);
        let point = |name: &str| BodyPoint::ALL.iter().position(|p| p.name() == name).unwrap();
        for axis in 0..3 {
            let sign = if axis == 0 { -1.0 } else { 1.0 };
            for side in ["shoulder", "elbow", "wrist", "fingers", "hip", "knee", "ankle", "toes"] {
                let (l, r) = (point(&format!("l{side}")), point(&format!("r{side}")));
                before[[0, l, axis]] = sign * before[[0, r, axis]];
            }
            if axis == 0 {
                before[[0, point("root"), 0]] = 0.0;
            }
        }
        let mut after = moved(&before, |[x, y, z]| [-x, y, z]);
        for (i, name) in BodyPoint::ALL.iter().map(|p| p.name()).enumerate() {
            if let Some(other) = name.strip_prefix('l') {
                let j = point(&format!("r{other}"));
                for frame in 0..60 {
                    for axis in 0..3 {
                        after.swap([frame, i, axis], [frame, j, axis]);
                    }
                }
            }
        }
        for name in SETS {
            let set = FeatureSet::builtin(name).unwrap();
            let doubtful = doubtful(&set, &before, 60.0) | doubtful(&set, &after, 60.0);
            let (before, after) = (words(&set, &before, 60.0).words, words(&set, &after, 60.0).words);
            for (a, b) in before.iter().zip(&after) {
                for (i, feature) in set.features().iter().enumerate() {
                    let j = feature.mirror;
                    if (doubtful >> i | doubtful >> j) & 1 == 0 && !UNLIKE_MIRRORS.contains(&feature.name.as_str()) {
                        prop_assert_eq!(a >> i & 1, b >> j & 1, "{}: {}", name, feature.name);
                    }
                }
            }
        }
    }
}

/// F1 and F2 of 2006 measure velocities relative to the left hip in both versions (spec.md a.2).
const UNLIKE_MIRRORS: [&str; 2] = ["rhand_moving_forwards", "lhand_moving_forwards"];

#[test]
fn the_mirror_permutation_is_the_papers() {
    // spec.md a.1, counted from 1.
    let expected = [
        2, 1, 4, 3, 6, 5, 8, 7, 9, 10, 12, 11, 14, 13, 16, 15, 18, 17, 19, 21, 20, 22, 23, 24, 26,
        25, 28, 27, 30, 29, 31, 32, 34, 33, 36, 35, 37, 38, 39,
    ];
    for name in SETS_2006 {
        let set = FeatureSet::builtin(name).unwrap();
        let found: Vec<usize> = set.features().iter().map(|f| f.mirror + 1).collect();
        assert_eq!(found, expected);
    }
}

#[test]
fn the_rows_are_upper_lower_mix() {
    // spec.md a.1.
    for name in SETS_2006 {
        let set = FeatureSet::builtin(name).unwrap();
        for (i, feature) in set.features().iter().enumerate() {
            let part = match i + 1 {
                1..=14 => "upper",
                15..=26 => "lower",
                _ => "mix",
            };
            assert_eq!(feature.set, part, "F{}", i + 1);
        }
    }
}

#[test]
fn the_printed_table_differs_where_the_spec_says() {
    // spec.md a.2, last column, and a.3; F29 and F30 because the paper prints closed intervals.
    let expected = [
        3, 4, 5, 6, 9, 13, 14, 15, 16, 17, 18, 19, 25, 26, 27, 28, 29, 30, 33, 34, 38,
    ];
    let (ran, printed) = (set(), FeatureSet::builtin("mueller2006-table6").unwrap());
    let mut found = Vec::new();
    for (i, (a, b)) in ran.features().iter().zip(printed.features()).enumerate() {
        assert_eq!((&a.name, &a.set, a.mirror), (&b.name, &b.set, b.mirror));
        if a != b {
            found.push(i + 1);
        }
    }
    assert_eq!(found, expected);
    for length in ["hl", "sw", "hw", "chest", "body"] {
        assert_eq!(ran.length(length), printed.length(length));
    }
}

/// Paper 2005, Table 1, in its order; what has a right and a left form stands for both.
const TABLE_1: [(&str, &[&str]); 3] = [
    (
        "lower",
        &[
            "?foot_front",
            "?foot_raised",
            "?foot_fast",
            "?knee_bent",
            "?leg_sideways",
            "legs_crossed",
        ],
    ),
    (
        "upper",
        &[
            "?hand_front",
            "?hand_raised",
            "?arm_sideways",
            "?elbow_bent",
            "?hand_fast",
            "arms_crossed",
            "hands_touching",
        ],
    ),
    (
        "mix",
        &[
            "?hand_touching_leg",
            "?hand_touching_head",
            "?hand_touching_hip",
            "torso_bent",
            "root_fast",
        ],
    ),
];

#[test]
fn the_features_of_2005_stand_in_the_papers_order() {
    let mut expected: Vec<(&str, String, String)> = Vec::new();
    for (part, names) in TABLE_1 {
        for name in names {
            match name.strip_prefix('?') {
                Some(name) => {
                    let (right, left) = (format!("r{name}"), format!("l{name}"));
                    expected.push((part, right.clone(), left.clone()));
                    expected.push((part, left, right));
                }
                None => expected.push((part, (*name).to_owned(), (*name).to_owned())),
            }
        }
    }
    for name in ["mueller2005", "mueller2005-text"] {
        let set = FeatureSet::builtin(name).unwrap();
        let features = set.features();
        let found: Vec<(&str, String, String)> = features
            .iter()
            .map(|f| {
                (
                    f.set.as_str(),
                    f.name.clone(),
                    features[f.mirror].name.clone(),
                )
            })
            .collect();
        assert_eq!(found, expected);
        let sizes = ["lower", "upper", "mix"].map(|part| set.select(part).unwrap().count_ones());
        assert_eq!(sizes, [11, 12, 8]);
    }
}

#[test]
fn the_text_of_2005_has_the_loose_level_alone_where_it_prints_none() {
    // Paper 2005, section 3: foot in front and raised hand 0, bent 120 degrees.
    let printed = [
        "foot_front",
        "hand_raised",
        "knee_bent",
        "elbow_bent",
        "torso_bent",
    ];
    let ran = FeatureSet::builtin("mueller2005").unwrap();
    let text = FeatureSet::builtin("mueller2005-text").unwrap();
    for (ran, text) in ran.features().iter().zip(text.features()) {
        assert_eq!(ran.quantity, text.quantity, "{}", ran.name);
        assert_eq!(text.enter, text.stay, "{}", ran.name);
        let is_printed = printed.iter().any(|name| ran.name.ends_with(name));
        assert_eq!(ran.stay != text.stay, is_printed, "{}", ran.name);
    }
}

#[test]
fn words_are_those_of_every_fourth_frame_from_120_to_30_hz() {
    for n_frames in 0..30 {
        let positions = lively(7, n_frames);
        let native = words(&set(), &positions, 120.0).words;
        let found = extract(&set(), positions.view(), &map(), 120.0, 30.0).unwrap();
        assert_eq!(found.words.len(), n_frames.div_ceil(4));
        assert_eq!(found.rate, 30.0);
        let fourth: Vec<u64> = native.iter().step_by(4).copied().collect();
        assert_eq!(found.words, fourth);
    }
}

#[test]
fn ties_between_frames_go_to_the_later_one() {
    // 100 Hz to 24 Hz: tick 3 is at 12.5 frames, tick 9 at 37.5, and so on.
    for (rate, library_rate) in [
        (100.0, 24.0),
        (120.0, 80.0),
        (24.0, 48.0),
        (30.0, 120.0),
        (119.88, 30.0),
    ] {
        let expected = kept_frames(400, rate, library_rate);
        let found: Vec<usize> = (0..expected.len())
            .map(|k| relfeat::source_frame(k, rate, library_rate))
            .collect();
        assert_eq!(found, expected, "{rate} to {library_rate}");
    }
}
