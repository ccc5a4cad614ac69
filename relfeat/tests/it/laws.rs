//! What must not change the words, and what must change them in a known way.

use proptest::prelude::*;
use relfeat::ndarray::Array3;
use relfeat::{BodyPoint, FeatureSet, FeatureWords, extract, measure};

use crate::figure::{map, motion};
use crate::naive::kept_frames;

/// Positions are rounded to `f32`, at coordinates of up to ten times the figure's size; a value this
/// close to its threshold, relative to the size, the degree or the speed of a second, may change sides.
const NEAR: f64 = 2e-3;

fn set() -> FeatureSet {
    FeatureSet::builtin("mueller2006").unwrap()
}

fn words(positions: &Array3<f32>, rate: f64) -> FeatureWords {
    extract(&set(), positions.view(), &map(), rate, rate).unwrap()
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

/// Features of which some value comes near a threshold: hysteresis may carry the doubt on.
fn doubtful(positions: &Array3<f32>, rate: f64) -> u64 {
    let mut doubtful = 0;
    for i in 0..39 {
        let measured = measure(&set(), i, positions.view(), &map(), rate).unwrap();
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
        if measured.values.iter().any(is_near) {
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
        let doubtful = doubtful(&before, 60.0);
        prop_assert!(doubtful.count_ones() < 39);
        for (frame, (a, b)) in words(&before, 60.0).words.iter().zip(&words(&after, 60.0).words).enumerate() {
            prop_assert_eq!(a & !doubtful, b & !doubtful, "frame {}", frame);
        }
    }

    #[test]
    fn a_mirrored_body_has_mirrored_words(seed in any::<u64>()) {
        // Unlike sides make unlike upper arms, which are the unit of the thresholds: make them alike.
        let mut before = lively(seed, 60);
        let point = |name: &str| BodyPoint::ALL.iter().position(|p| p.name() == name).unwrap();
        for axis in 0..3 {
            let sign = if axis == 0 { -1.0 } else { 1.0 };
            for side in ["shoulder", "elbow", "hip", "knee", "ankle"] {
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
        let doubtful = doubtful(&before, 60.0) | doubtful(&after, 60.0);
        let set = set();
        for (a, b) in words(&before, 60.0).words.iter().zip(&words(&after, 60.0).words) {
            for (i, feature) in set.features().iter().enumerate() {
                let j = feature.mirror;
                if (doubtful >> i | doubtful >> j) & 1 == 0 && !UNLIKE_MIRRORS.contains(&(i + 1)) {
                    prop_assert_eq!(a >> i & 1, b >> j & 1, "F{}", i + 1);
                }
            }
        }
    }
}

/// F1 and F2 measure velocities relative to the left hip in both versions (spec.md a.2).
const UNLIKE_MIRRORS: [usize; 2] = [1, 2];

#[test]
fn the_mirror_permutation_is_the_papers() {
    // spec.md a.1, counted from 1.
    let expected = [
        2, 1, 4, 3, 6, 5, 8, 7, 9, 10, 12, 11, 14, 13, 16, 15, 18, 17, 19, 21, 20, 22, 23, 24, 26,
        25, 28, 27, 30, 29, 31, 32, 34, 33, 36, 35, 37, 38, 39,
    ];
    for name in relfeat::BUILTIN_SETS {
        let set = FeatureSet::builtin(name).unwrap();
        let found: Vec<usize> = set.features().iter().map(|f| f.mirror + 1).collect();
        assert_eq!(found, expected);
    }
}

#[test]
fn the_rows_are_upper_lower_mix() {
    // spec.md a.1.
    for name in relfeat::BUILTIN_SETS {
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

#[test]
fn words_are_those_of_every_fourth_frame_from_120_to_30_hz() {
    for n_frames in 0..30 {
        let positions = lively(7, n_frames);
        let native = words(&positions, 120.0).words;
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
