//! Class templates of every kind.

use mtemplate::ndarray::{Array1, Array2};
use mtemplate::{ClassTemplate, Keyframe, MotionTemplate};
use proptest::prelude::*;

/// Values that quantise, values that do not, and any others.
fn value() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => prop_oneof![Just(0.0), Just(1.0), Just(0.5)],
        1 => prop_oneof![Just(-0.0), Just(f64::MIN_POSITIVE), Just(5e-324), Just(1.0 - f64::EPSILON)],
        1 => (1_u32..26).prop_map(|n| f64::from(n) / 26.0),
        1 => 0.0..=1.0_f64,
    ]
}

fn weight() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => Just(1.0),
        1 => 0.25..2.0_f64,
        1 => prop_oneof![Just(f64::MAX), Just(5e-324), Just(1e16), Just(123.0)],
    ]
}

/// Names as sets have them, and names that need quotes.
fn names(n_features: usize) -> impl Strategy<Value = Vec<String>> {
    let name = prop_oneof![4 => "[a-z_]{1,12}", 1 => any::<String>()];
    prop::collection::btree_set(name, n_features)
        .prop_map(|names| names.into_iter().collect::<Vec<String>>())
        .prop_shuffle()
}

fn keyframes(columns: usize, features: usize) -> impl Strategy<Value = Vec<Keyframe>> {
    let all = u64::MAX >> (64 - features);
    let bits = (any::<u64>(), any::<u64>(), 0..features);
    let stiffness = prop_oneof![Just(1.0), 1e-6..=1.0_f64];
    let one = (0..columns.max(1), bits, stiffness).prop_map(
        move |(column, (care, value, at_least), stiffness)| {
            let care = care & all | 1 << at_least;
            Keyframe {
                column,
                care,
                value: value & care,
                stiffness,
            }
        },
    );
    let at_most = if columns == 0 { 0 } else { 4 };
    prop::collection::vec(one, 0..=at_most).prop_map(|mut keyframes| {
        keyframes.sort_by_key(|keyframe| keyframe.column);
        keyframes
    })
}

pub(crate) fn template(columns: usize, features: usize) -> impl Strategy<Value = MotionTemplate> {
    // Runs and single values.
    let value = || (value(), 1_usize..4).prop_map(|(value, n)| vec![value; n]);
    let row = prop::collection::vec(value(), columns).prop_map(move |runs| {
        runs.concat()
            .into_iter()
            .take(columns)
            .collect::<Vec<f64>>()
    });
    let weights = prop_oneof![
        Just(vec![1.0; columns]),
        prop::collection::vec(weight(), columns)
    ];
    (prop::collection::vec(row, features), weights).prop_map(move |(rows, weights)| {
        let values = Array2::from_shape_fn((columns, features), |(k, i)| rows[i][k]);
        MotionTemplate::new(values, Array1::from(weights)).unwrap()
    })
}

pub(crate) fn class() -> impl Strategy<Value = ClassTemplate> {
    (0_usize..=7, prop_oneof![1_usize..=4, Just(64_usize)]).prop_flat_map(|(columns, features)| {
        (
            template(columns, features),
            names(features),
            keyframes(columns, features),
            (any::<String>(), any::<String>()),
            prop_oneof![Just(30.0), 1e-3..1e6_f64, Just(1e300)],
            prop::option::of(1_usize..=u32::MAX as usize),
            prop::option::of(prop_oneof![Just(0.06), 0.0..=1.0_f64, Just(f64::MAX)]),
        )
            .prop_map(
                |(template, features, keyframes, (name, feature_set), rate, n_motions, tau)| {
                    ClassTemplate {
                        name,
                        feature_set,
                        rate,
                        features,
                        template,
                        n_motions,
                        tau,
                        keyframes,
                    }
                },
            )
    })
}
