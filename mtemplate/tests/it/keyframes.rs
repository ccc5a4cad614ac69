//! Keyframes against their definitions, frame by frame and column by column.

use std::ops::Range;

use mtemplate::ndarray::{Array1, Array2};
use mtemplate::{
    AutomaticConfig, Cell, ExampleConfig, Examples, Keyframe, MotionTemplate, Preselection,
    choose_keyframes, learn_keyframes,
};
use proptest::collection::vec;
use proptest::prelude::*;

const FEATURES: usize = 4;
const WORDS: u64 = 1 << FEATURES;

/// Ascending columns of a template, and the number of its columns.
fn preselection() -> impl Strategy<Value = Preselection> {
    let keyframe = (0..WORDS, 0..WORDS, 0..5usize, 1..=20u32);
    (vec(keyframe, 1..4), 0..4usize).prop_map(|(drawn, rest)| {
        let mut column = 0;
        let mut keyframes = Vec::new();
        for (care, value, further, stiffness) in drawn {
            keyframes.push(Keyframe {
                column,
                care,
                value: value & care,
                stiffness: f64::from(stiffness) / 20.0,
            });
            column += further;
        }
        let last = keyframes[keyframes.len() - 1].column;
        Preselection::new(&keyframes, last + 1 + rest).unwrap()
    })
}

/// Words that stay for a while.
fn clip(at_most: usize) -> impl Strategy<Value = Vec<u64>> {
    vec((0..WORDS, 1..4usize), 0..at_most).prop_map(|runs| {
        let runs = runs.into_iter();
        runs.flat_map(|(word, n)| vec![word; n]).collect()
    })
}

/// Frames within twice the columns of a chain, one chain after the other. Gaps are compared in twentieths, exactly.
fn naive_stretches(p: &Preselection, words: &[u64]) -> Vec<bool> {
    let is_apart = |gap: usize, distance: usize, stiffness: f64| {
        let twentieths = (stiffness * 20.0).round() as usize;
        20 * gap >= twentieths * distance && gap * twentieths <= 20 * distance
    };
    let all = p.keyframes();
    let mut chains: Vec<Vec<usize>> = vec![Vec::new()];
    for (i, keyframe) in all.iter().enumerate() {
        let mut longer = Vec::new();
        for chain in chains {
            for (frame, word) in words.iter().enumerate() {
                let is_next = chain.last().is_none_or(|&before| {
                    let distance = keyframe.column - all[i - 1].column;
                    frame >= before && is_apart(frame - before, distance, keyframe.stiffness)
                });
                let is_same = (0..FEATURES).all(|bit| {
                    keyframe.care >> bit & 1 == 0 || keyframe.value >> bit & 1 == word >> bit & 1
                });
                if is_next && is_same {
                    longer.push([chain.clone(), vec![frame]].concat());
                }
            }
        }
        chains = longer;
    }
    let mut kept = vec![false; words.len()];
    // A template of 1 column more than a keyframe's has room for 2 frames behind it.
    let reach = p.stretch(0, 0, usize::MAX).end - 1;
    for chain in chains {
        let (first, last) = (chain[0], chain[chain.len() - 1]);
        for (frame, kept) in kept.iter_mut().enumerate() {
            *kept |= frame + 2 * all[0].column >= first && frame <= last + reach;
        }
    }
    kept
}

fn covered(stretches: &[Range<usize>], n: usize) -> Vec<bool> {
    (0..n)
        .map(|frame| stretches.iter().any(|s| s.contains(&frame)))
        .collect()
}

/// Columns of few different ones, so that neighbours are alike and there are keyframes to choose.
fn template() -> impl Strategy<Value = MotionTemplate> {
    let value = prop_oneof![3 => Just(1.0), 3 => Just(0.0), 1 => Just(0.5), 2 => (0..=40u8).prop_map(|v| f64::from(v) / 40.0)];
    vec((vec(value, FEATURES), 1..8usize), 1..5).prop_map(|runs| {
        let columns: Vec<f64> = runs
            .into_iter()
            .flat_map(|(column, n)| column.repeat(n))
            .collect();
        let n = columns.len() / FEATURES;
        let values = Array2::from_shape_vec((n, FEATURES), columns).unwrap();
        MotionTemplate::new(values, Array1::ones(n)).unwrap()
    })
}

/// The choice of 2006 on a matrix of cells.
fn naive_choice(
    t: &MotionTemplate,
    groups: &[u64],
    delta: f64,
    most: usize,
) -> Vec<(usize, u64, u64)> {
    let n = t.n_columns();
    let quantized = t.quantize(delta).unwrap();
    let cell = |column: Option<usize>, bit: usize| {
        column
            .and_then(|c| quantized.cell(c, bit))
            .unwrap_or(Cell::Wildcard)
    };
    let steady = |column: usize, bit: usize| {
        let this = cell(Some(column), bit);
        let same = this == cell(column.checked_sub(1), bit) && this == cell(Some(column + 1), bit);
        if same { this } else { Cell::Wildcard }
    };
    let members = |group: u64| (0..FEATURES).filter(move |bit| group >> bit & 1 == 1);
    let ramp = |column: usize| {
        let x = column.min(n - 1 - column) as f64 / (0.2 * n as f64);
        if x >= 1.0 {
            1.0
        } else {
            (1.0 - (std::f64::consts::PI * x).cos()) / 2.0
        }
    };
    let mut score = vec![vec![0.0; n]; groups.len()];
    for (g, &group) in groups.iter().enumerate() {
        for (column, score) in score[g].iter_mut().enumerate() {
            let sum: f64 = members(group)
                .map(|bit| match steady(column, bit) {
                    Cell::One => 2.0,
                    Cell::Zero => 1.2,
                    Cell::Wildcard => 0.0,
                })
                .sum();
            *score = sum / members(group).count() as f64 * ramp(column);
        }
    }
    let mut chosen = Vec::new();
    while chosen.len() < most {
        let mut best = (0.0, 0, 0);
        for column in 0..n {
            for (g, score) in score.iter().enumerate() {
                if score[column] > best.0 + ROUNDING {
                    best = (score[column], g, column);
                }
            }
        }
        if best.0 < 0.9 {
            break;
        }
        let (_, g, column) = best;
        let bits = |wanted: Cell| -> u64 {
            members(groups[g])
                .filter(|&bit| steady(column, bit) == wanted)
                .map(|bit| 1 << bit)
                .sum()
        };
        chosen.push((column, bits(Cell::One) | bits(Cell::Zero), bits(Cell::One)));
        let own = score[g].clone();
        let (mut left, mut right) = (column, column);
        while left > 0 && own[left - 1] <= own[left] {
            left -= 1;
        }
        while right + 1 < n && own[right + 1] <= own[right] {
            right += 1;
        }
        score[g][left..=right].fill(0.0);
        for score in &mut score {
            for (column_idx, score) in score.iter_mut().enumerate() {
                if column_idx.abs_diff(column) <= 5 {
                    *score = 0.0;
                }
            }
        }
    }
    chosen.sort_unstable();
    chosen
}

/// Scores are sums of 2 and 1.2 over at most four features in one of two orders: far less than a difference between two
/// scores of this test, and far more than their rounding.
const ROUNDING: f64 = 1e-9;

proptest! {
    #[test]
    fn stretches_reach_around_every_chain(p in preselection(), words in clip(10)) {
        let stretches = p.stretches(&words);
        prop_assert_eq!(covered(&stretches, words.len()), naive_stretches(&p, &words));
        prop_assert!(stretches.windows(2).all(|pair| pair[0].end < pair[1].start));
    }

    #[test]
    fn the_automatic_choice_is_that_of_2006(
        template in template(),
        groups in prop_oneof![Just(vec![0b1111]), Just(vec![0b0011, 0b1100]), Just(vec![0b0001, 0b0110, 0b1000])],
        most in 0..9usize,
    ) {
        let config = AutomaticConfig { max_keyframes: most, ..AutomaticConfig::interactive() };
        let chosen = choose_keyframes(&template, &groups, &config).unwrap();
        let raw: Vec<_> = chosen.iter().map(|k| (k.column, k.care, k.value)).collect();
        prop_assert_eq!(raw, naive_choice(&template, &groups, 0.1, most));
    }

    #[test]
    fn the_threshold_is_raised_until_there_is_a_keyframe(template in template()) {
        let groups = [0b0011, 0b1100];
        let chosen = choose_keyframes(&template, &groups, &AutomaticConfig::batch()).unwrap();
        let raw: Vec<_> = chosen.iter().map(|k| (k.column, k.care, k.value)).collect();
        let first = (10..=20u32)
            .map(|percent| naive_choice(&template, &groups, 0.1 + f64::from(percent - 10) * 0.01, 8))
            .find(|choice| !choice.is_empty());
        prop_assert_eq!(raw, first.unwrap_or_default());
    }

    #[test]
    fn no_training_clip_is_lost(
        motion in clip(6).prop_filter("a template needs two columns", |words| words.len() > 1),
        positives in vec((clip(3), vec(0..3usize, 20), clip(3)), 1..4),
        negatives in vec(clip(8), 0..4),
        config in (1..4usize, 1..9usize, 0..3usize, 1..=4u8).prop_map(|(max_keyframes, max_columns, margin, slack)| ExampleConfig {
            max_keyframes, max_columns, margin, slack: f64::from(slack) / 4.0, min_gain: 0.0, features: WORDS - 1,
        }),
    ) {
        // The motion at other speeds, some frames twice and some left out, with something before and after.
        let perform = |(before, speed, after): &(Vec<u64>, Vec<usize>, Vec<u64>)| {
            let frames = motion.iter().zip(speed.iter().cycle());
            let motion = frames.flat_map(|(&word, &n)| vec![word; if n == 0 { 1 } else { n }]);
            before.iter().copied().chain(motion).chain(after.iter().copied()).collect::<Vec<u64>>()
        };
        let positives: Vec<Vec<u64>> = positives.iter().map(perform).collect();
        let template = MotionTemplate::from_words(&motion, FEATURES).unwrap().quantize(0.1).unwrap();
        let [p, n] = [&positives, &negatives].map(|clips| clips.iter().map(Vec::as_slice).collect::<Vec<_>>());
        let learned = learn_keyframes(&template, &Examples { positives: &p, negatives: &n }, &config);
        let mut kept: usize = negatives.iter().map(Vec::len).sum();
        if let Ok(preselection) = Preselection::new(&learned.keyframes, template.n_columns()) {
            kept = n.iter().flat_map(|words| preselection.stretches(words)).map(|s| s.len()).sum();
            for (i, words) in positives.iter().enumerate() {
                let best = template.find_matches(words, &mtemplate::MatchConfig { tau: f64::INFINITY, max_matches: 1 });
                prop_assert_eq!(best.is_empty(), learned.unmatched.contains(&i));
                let Some(best) = best.first() else { continue };
                let stretches = preselection.stretches(words);
                let kept = stretches.iter().find(|s| s.start <= best.span.start && best.span.end <= s.end);
                let Some(kept) = kept else {
                    return Err(TestCaseError::fail(format!("{best:?} is not in {stretches:?}")));
                };
                // The same match is found there.
                let again = template.find_matches(&words[kept.clone()], &mtemplate::MatchConfig { tau: f64::INFINITY, max_matches: 1 });
                prop_assert_eq!(again[0].cost, best.cost);
            }
        }
        let n_frames: usize = negatives.iter().map(Vec::len).sum();
        prop_assert_eq!(learned.kept, kept as f64 / n_frames.max(1) as f64);
    }
}

#[test]
fn gaps_are_whole_frames_between_the_stiff_bounds() {
    let at = |column, stiffness| Keyframe {
        column,
        care: 0,
        value: 0,
        stiffness,
    };
    let p = Preselection::new(&[at(0, 1.0), at(10, 0.8), at(17, 1.0), at(20, 0.1)], 21).unwrap();
    assert_eq!(p.gaps(), [8..=12, 7..=7, 1..=30]);
    // 0.7 * 10 and 7 / 0.7 are not whole in binary.
    let p = Preselection::new(&[at(0, 1.0), at(10, 0.7), at(17, 0.7)], 18).unwrap();
    assert_eq!(p.gaps(), [7..=14, 5..=10]);
    assert_eq!(p.greedy_frames(), 36);
}

#[test]
fn keyframes_that_do_not_fit_are_refused() {
    let at = |column, stiffness| Keyframe {
        column,
        care: 0,
        value: 0,
        stiffness,
    };
    let refused = |keyframes: &[Keyframe]| Preselection::new(keyframes, 5).unwrap_err().to_string();
    assert_eq!(refused(&[]), "expected one keyframe or more, found none");
    assert_eq!(
        refused(&[at(2, 1.0), at(1, 1.0)]),
        "keyframe 1: expected column 2 or a later one, found 1"
    );
    assert_eq!(
        refused(&[at(5, 1.0)]),
        "keyframe 0: expected a column below 5, found 5"
    );
    for (found, text) in [(0.0, "0"), (-1.0, "-1"), (1.5, "1.5"), (f64::NAN, "NaN")] {
        assert_eq!(
            refused(&[at(0, found)]),
            format!("keyframe 0: expected a stiffness above 0 and up to 1, found {text}")
        );
    }
}
