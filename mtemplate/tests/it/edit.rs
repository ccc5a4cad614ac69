//! Edited templates.

use mtemplate::ndarray::{Array1, Array2, Axis, concatenate};
use mtemplate::{
    ANY, ClassError, ClassTemplate, EditError, LearnConfig, MotionTemplate, TemplateError, combine,
};
use proptest::prelude::*;

use crate::classes::class;

fn all(class: &ClassTemplate) -> u64 {
    u64::MAX >> (64 - class.features.len())
}

fn pairs(n_features: usize) -> Vec<usize> {
    // The last of an odd number is its own mirror.
    (0..n_features)
        .map(|i| if i ^ 1 < n_features { i ^ 1 } else { i })
        .collect()
}

/// A class whose values are copied without a rounding error, and far from any threshold.
fn plain(columns: usize) -> impl Strategy<Value = ClassTemplate> {
    let cells = prop_oneof![Just(0.0), Just(1.0), Just(ANY)];
    (prop::collection::vec(cells, 3 * columns), 1_usize..40).prop_map(move |(values, n)| {
        let values = Array2::from_shape_vec((columns, 3), values).unwrap();
        ClassTemplate {
            name: "plain".to_owned(),
            feature_set: "three".to_owned(),
            rate: 30.0,
            features: ["a", "b", "c"].map(str::to_owned).to_vec(),
            template: MotionTemplate::new(values, Array1::ones(columns)).unwrap(),
            n_motions: Some(n),
            tau: None,
            keyframes: Vec::new(),
        }
    })
}

proptest! {
    #[test]
    fn mirroring_twice_changes_nothing(class in class()) {
        let permutation = pairs(class.features.len());
        let mirrored = class.mirrored(&permutation).unwrap();
        prop_assert_eq!(mirrored.mirrored(&permutation), Ok(class));
    }

    #[test]
    fn keyframes_are_mirrored_with_their_columns(class in class()) {
        let permutation = pairs(class.features.len());
        let mirrored = class.mirrored(&permutation).unwrap();
        for (before, after) in class.keyframes.iter().zip(&mirrored.keyframes) {
            prop_assert_eq!((before.column, before.stiffness), (after.column, after.stiffness));
            for (to, &from) in permutation.iter().enumerate() {
                prop_assert_eq!(after.care >> to & 1, before.care >> from & 1);
                prop_assert_eq!(after.value >> to & 1, before.value >> from & 1);
            }
        }
    }

    #[test]
    fn a_restriction_to_all_changes_nothing(class in class()) {
        let n_columns = class.template.n_columns();
        prop_assume!(n_columns > 0);
        prop_assert_eq!(class.restricted(all(&class), 0..n_columns), Ok(class));
    }

    #[test]
    fn a_restriction_keeps_what_is_in_it_and_no_more(
        class in class(),
        features: u64,
        ends in any::<[prop::sample::Index; 2]>(),
    ) {
        let n_columns = class.template.n_columns();
        let features = features & all(&class);
        prop_assume!(n_columns > 0 && features != 0);
        let (a, b) = (ends[0].index(n_columns), ends[1].index(n_columns));
        let columns = a.min(b)..a.max(b) + 1;
        let part = class.restricted(features, columns.clone()).unwrap();
        prop_assert_eq!(part.check(), Ok(()));
        prop_assert_eq!(&part.features, &class.features);
        prop_assert_eq!(part.template.n_columns(), columns.len());
        for ((column, feature), &value) in part.template.values().indexed_iter() {
            let kept = class.template.values()[[columns.start + column, feature]];
            prop_assert_eq!(value, if features >> feature & 1 == 1 { kept } else { ANY });
        }
        let kept = class.keyframes.iter().filter(|one| {
            columns.contains(&one.column) && one.care & features != 0
        });
        let kept: Vec<(usize, u64, u64)> = kept
            .map(|one| (one.column - columns.start, one.care & features, one.value & features))
            .collect();
        let found: Vec<(usize, u64, u64)> =
            part.keyframes.iter().map(|one| (one.column, one.care, one.value)).collect();
        prop_assert_eq!(found, kept);
    }

    #[test]
    fn stretches_make_up_the_whole(class in class(), at in any::<prop::sample::Index>()) {
        let n_columns = class.template.n_columns();
        prop_assume!(n_columns > 1);
        let cut = 1 + at.index(n_columns - 1);
        let part = |columns| class.restricted(all(&class), columns).unwrap().template;
        let (head, tail) = (part(0..cut), part(cut..n_columns));
        let values = concatenate(Axis(0), &[head.values(), tail.values()]).unwrap();
        prop_assert_eq!(values, class.template.values());
    }

    #[test]
    fn paint_covers_its_cells_alone(
        class in class(),
        features: u64,
        value in 0.0..=1.0_f64,
        at in any::<prop::sample::Index>(),
    ) {
        let n_columns = class.template.n_columns();
        let features = features & all(&class);
        prop_assume!(n_columns > 0 && features != 0);
        let columns = at.index(n_columns)..n_columns;
        let painted = class.painted(value, features, columns.clone()).unwrap();
        for ((column, feature), &found) in painted.template.values().indexed_iter() {
            let is_painted = columns.contains(&column) && features >> feature & 1 == 1;
            let before = class.template.values()[[column, feature]];
            prop_assert_eq!(found, if is_painted { value } else { before });
        }
    }

    #[test]
    fn a_class_combined_with_itself_stays(class in (1_usize..8).prop_flat_map(plain), n in 1_usize..4) {
        let other = ClassTemplate { n_motions: Some(n), ..class.clone() };
        let both = combine("both", &[class.clone(), other], &LearnConfig::default()).unwrap();
        prop_assert_eq!(both.template.quantize(0.1), class.template.quantize(0.1));
        prop_assert_eq!(both.n_motions, class.n_motions.map(|known| known + n));
        prop_assert_eq!(both.name.as_str(), "both");
    }

    #[test]
    fn classes_count_by_their_motions(zeros in 1_usize..20, ones in 1_usize..20) {
        // One column each, so that there is nothing to align: the value is the share of motions.
        let of = |value, n| ClassTemplate {
            template: MotionTemplate::new(Array2::from_elem((1, 3), value), Array1::ones(1)).unwrap(),
            n_motions: n,
            ..blank(1)
        };
        let share = |a, b| {
            let both = combine("both", &[of(0.0, a), of(1.0, b)], &LearnConfig::default()).unwrap();
            both.template.values()[[0, 0]]
        };
        let expected = ones as f64 / (zeros + ones) as f64;
        prop_assert!((share(Some(zeros), Some(ones)) - expected).abs() <= SHARE_TOL);
        prop_assert_eq!(share(Some(zeros), None), 0.5);
    }
}

/// A mean of up to 40 zeros and ones, averaged again in up to ten iterations, each sum and quotient
/// rounded once.
const SHARE_TOL: f64 = 10.0 * 41.0 * f64::EPSILON;

fn blank(columns: usize) -> ClassTemplate {
    ClassTemplate {
        name: "blank".to_owned(),
        feature_set: "three".to_owned(),
        rate: 30.0,
        features: ["a", "b", "c"].map(str::to_owned).to_vec(),
        template: MotionTemplate::blank(columns, 3).unwrap(),
        n_motions: None,
        tau: Some(0.06),
        keyframes: Vec::new(),
    }
}

#[test]
fn a_threshold_goes_with_the_costs_it_was_learned_for() {
    let whole = blank(4);
    assert_eq!(whole.restricted(0b111, 0..4).unwrap().tau, Some(0.06));
    assert_eq!(whole.restricted(0b011, 0..4).unwrap().tau, None);
    assert_eq!(whole.restricted(0b111, 0..3).unwrap().tau, None);
    assert_eq!(whole.painted(1.0, 0b001, 0..4).unwrap().tau, None);
    assert_eq!(whole.mirrored(&[1, 0, 2]).unwrap().tau, Some(0.06));
}

#[test]
fn what_is_not_there_cannot_be_edited() {
    let class = blank(4);
    let columns = |found| {
        Err(EditError::Columns {
            n_columns: 4,
            found,
        })
    };
    assert_eq!(class.restricted(1, 2..2), columns(2..2));
    assert_eq!(class.restricted(1, 2..5), columns(2..5));
    let features = |found| {
        let n_features = 3;
        Err(EditError::Features { n_features, found })
    };
    assert_eq!(class.restricted(0, 0..4), features(0));
    assert_eq!(class.painted(1.0, 0b1000, 0..4), features(0b1000));
    let value = class.painted(1.5, 1, 0..4).unwrap_err();
    assert_eq!(
        value.to_string(),
        "column 0, feature 0: expected a value in [0, 1], found 1.5"
    );
    let mirrored = class.mirrored(&[0, 0, 1]);
    assert_eq!(
        mirrored,
        Err(TemplateError::Permutation { n_features: 3 }.into())
    );

    let config = LearnConfig::default();
    assert_eq!(
        combine("none", &[], &config),
        Err(TemplateError::NoMotions.into())
    );
    let slow = ClassTemplate {
        rate: 10.0,
        ..blank(4)
    };
    let error = combine("both", &[class.clone(), slow], &config).unwrap_err();
    assert_eq!(
        error.to_string(),
        "expected templates for words of one feature set and rate, found 30 Hz of three and 10 Hz \
         of three"
    );
    let odd = ClassTemplate {
        rate: f64::NAN,
        ..class
    };
    let rate = |result| matches!(result, Err(EditError::Class(ClassError::Rate { .. })));
    assert!(rate(odd.restricted(1, 0..4)) && rate(odd.painted(1.0, 1, 0..4)));
    assert!(rate(odd.mirrored(&[0, 1, 2])) && rate(combine("one", &[odd], &config)));
}

#[test]
fn the_papers_mirror_image_comes_from_the_permutation() {
    // spec.md a.1, 1-based.
    let listed = [
        2, 1, 4, 3, 6, 5, 8, 7, 9, 10, 12, 11, 14, 13, 16, 15, 18, 17, 19, 21, 20, 22, 23, 24, 26,
        25, 28, 27, 30, 29, 31, 32, 34, 33, 36, 35, 37, 38, 39,
    ];
    let permutation = listed.map(|number| number - 1);
    // F13, F32 and F33 of the paper's sweeping right hand become F14, F32 and F34.
    let sweep = ClassTemplate {
        features: (1..=39).map(|number| format!("F{number}")).collect(),
        template: MotionTemplate::blank(50, 39).unwrap(),
        ..blank(0)
    };
    let bits = |numbers: [u32; 3]| numbers.map(|number| 1 << (number - 1)).iter().sum::<u64>();
    let right = sweep.painted(1.0, bits([13, 32, 33]), 0..50).unwrap();
    let left = sweep.painted(1.0, bits([14, 32, 34]), 0..50).unwrap();
    assert_eq!(right.mirrored(&permutation), Ok(left));
}
