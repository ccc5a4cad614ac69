use mtemplate::ndarray::{Array1, Array2, array};
use mtemplate::{
    LearnConfig, MAX_ALIGNED_COLUMNS, MotionTemplate, TemplateError, Unwarp, align, learn,
};
use proptest::prelude::*;

use crate::naive_learn;

/// Sums of a few dozen terms, each rounded by 2⁻⁵³ of itself.
const ROUNDED: f64 = 1e-12;

fn boolean(n_features: usize) -> impl Strategy<Value = MotionTemplate> {
    let mask = u64::MAX >> (64 - n_features);
    // Few different words, so that ties are common.
    let word = prop_oneof![Just(0), Just(mask), Just(1), any::<u64>()];
    prop::collection::vec(word.prop_map(move |word| word & mask), 1..=8)
        .prop_map(move |words| MotionTemplate::from_words(&words, n_features).unwrap())
}

fn weighted(n_features: usize) -> impl Strategy<Value = MotionTemplate> {
    let value = prop_oneof![(0_u8..=4).prop_map(|v| f64::from(v) / 4.0), 0.0..=1.0_f64];
    let weight = prop_oneof![Just(1.0), Just(0.25), Just(0.75), Just(1.5), 0.2..3.0_f64];
    let columns = prop::collection::vec((prop::collection::vec(value, n_features), weight), 1..=8);
    columns.prop_map(move |columns| {
        let values = columns.iter().flat_map(|c| c.0.clone()).collect();
        let values = Array2::from_shape_vec((columns.len(), n_features), values).unwrap();
        MotionTemplate::new(values, columns.iter().map(|c| c.1).collect()).unwrap()
    })
}

/// One to five motions, all boolean, all weighted, or some of both.
fn motions() -> impl Strategy<Value = Vec<MotionTemplate>> {
    let n_features = prop_oneof![1_usize..=4, Just(39), Just(64)];
    n_features.prop_flat_map(|f| {
        prop_oneof![
            prop::collection::vec(boolean(f), 1..=5),
            prop::collection::vec(weighted(f), 1..=5),
            prop::collection::vec(prop_oneof![boolean(f), weighted(f)], 1..=5),
        ]
    })
}

fn config() -> impl Strategy<Value = LearnConfig> {
    let unwarp = prop_oneof![Just(Unwarp::Exact), Just(Unwarp::Balance)];
    let tolerance = prop_oneof![Just(0.0), Just(0.005)];
    (unwarp, tolerance, 1_usize..=3).prop_map(|(unwarp, tolerance, max_iterations)| LearnConfig {
        unwarp,
        tolerance,
        max_iterations,
    })
}

fn total(template: &MotionTemplate) -> f64 {
    template.weights().iter().sum()
}

proptest! {
    #[test]
    fn learning_equals_the_textbook(motions in motions(), config in config()) {
        let learned = learn(&motions, &config).unwrap();
        let (columns, iterations, distance) = naive_learn::learn(&motions, &config);
        prop_assert_eq!(naive_learn::columns(&learned.template), columns);
        prop_assert_eq!(learned.iterations, iterations);
        prop_assert_eq!(learned.distance, distance);
    }

    #[test]
    fn alignments_equal_the_textbook(motions in motions()) {
        for reference in &motions {
            for other in &motions {
                let found = align(reference, other).unwrap();
                let expected =
                    naive_learn::align(&naive_learn::columns(reference), &naive_learn::columns(other));
                prop_assert_eq!((found.path, found.cost), expected);
            }
        }
    }

    #[test]
    fn the_cost_is_the_same_both_ways(motions in motions()) {
        let (a, b) = (&motions[0], &motions[motions.len() - 1]);
        prop_assert_eq!(align(a, b).unwrap().cost, align(b, a).unwrap().cost);
    }

    #[test]
    fn weight_is_kept(motions in motions(), config in config()) {
        let learned = learn(&motions, &config).unwrap();
        let mean = motions.iter().map(total).sum::<f64>() / motions.len() as f64;
        prop_assert!((total(&learned.template) - mean).abs() <= ROUNDED * mean);
    }

    #[test]
    fn exact_weights_are_1_but_the_last(motions in motions(), config in config()) {
        let config = LearnConfig { unwarp: Unwarp::Exact, ..config };
        let template = learn(&motions, &config).unwrap().template;
        let mean = motions.iter().map(total).sum::<f64>() / motions.len() as f64;
        // A mean that rounding has carried past a whole number is that number.
        prop_assert_eq!(template.n_columns(), ((mean - 1e-9).ceil() as usize).max(1));
        let weights = template.weights().to_vec();
        let (last, others) = weights.split_last().unwrap();
        prop_assert!(others.iter().all(|&weight| weight == 1.0));
        prop_assert!(*last > 0.0 && *last <= 1.0 + 1e-9);
    }

    #[test]
    fn balanced_weights_are_near_1(motions in motions(), config in config()) {
        let config = LearnConfig { unwarp: Unwarp::Balance, ..config };
        let template = learn(&motions, &config).unwrap().template;
        let weights = template.weights();
        // A column that joined a remainder and was repeated weighs less than 1.5; one that is all
        // there is weighs what there is.
        prop_assert!(weights.iter().all(|&weight| weight < 1.5 + 1e-9));
        prop_assert!(weights.len() == 1 || weights.iter().all(|&weight| weight >= 0.75 - 1e-9));
    }

    #[test]
    fn values_stay_between_the_least_and_the_largest(motions in motions(), config in config()) {
        let template = learn(&motions, &config).unwrap().template;
        for feature in 0..template.n_features() {
            let of_feature = |t: &MotionTemplate| t.values().column(feature).to_vec();
            let before: Vec<f64> = motions.iter().flat_map(of_feature).collect();
            let least = before.iter().copied().fold(1.0, f64::min);
            let largest = before.iter().copied().fold(0.0, f64::max);
            for value in of_feature(&template) {
                prop_assert!((least - ROUNDED..=largest + ROUNDED).contains(&value));
                prop_assert!((0.0..=1.0).contains(&value));
            }
        }
    }

    #[test]
    fn one_motion_is_its_own_template(motion in boolean(5), config in config()) {
        let learned = learn(std::slice::from_ref(&motion), &config).unwrap();
        prop_assert_eq!(learned.template, motion);
        prop_assert_eq!((learned.iterations, learned.distance), (1, 0.0));
    }

    #[test]
    fn equal_motions_are_their_template(motion in boolean(5), n in 1_usize..=8, config in config()) {
        // A repeated frame may be aligned with its neighbours' copies alike, but ties go diagonally.
        let learned = learn(&vec![motion.clone(); n], &config).unwrap();
        let difference = &learned.template.values() - &motion.values();
        prop_assert!(difference.iter().all(|d| d.abs() <= ROUNDED));
        prop_assert_eq!((learned.iterations, learned.distance), (1, 0.0));
    }

    #[test]
    fn the_order_of_the_others_changes_an_iteration_by_rounding_alone(
        (motions, shuffled) in motions().prop_flat_map(|motions| {
            let others = motions[1..].to_vec();
            (Just(motions), Just(others).prop_shuffle())
        }),
    ) {
        let config = LearnConfig { max_iterations: 1, ..LearnConfig::default() };
        let expected = learn(&motions, &config).unwrap();
        let reordered = [&motions[..1], &shuffled].concat();
        let found = learn(&reordered, &config).unwrap();
        prop_assert_eq!(found.template.n_columns(), expected.template.n_columns());
        let differences = &found.template.values() - &expected.template.values();
        // A last column that weighs next to nothing is a mean of next to nothing.
        let full = expected.template.weights().iter().take_while(|&&w| w >= 1e-3).count();
        prop_assert!(differences.rows().into_iter().take(full).flatten().all(|d| d.abs() <= 1e-9));
        prop_assert!((found.distance - expected.distance).abs() <= ROUNDED);
    }

    #[test]
    fn memory_order_does_not_matter(motions in motions(), config in config()) {
        let transposed = motions.iter().map(|motion| {
            let by_feature = motion.values().t().as_standard_layout().into_owned();
            MotionTemplate::new(by_feature.reversed_axes(), motion.weights().to_owned()).unwrap()
        });
        let transposed: Vec<MotionTemplate> = transposed.collect();
        prop_assert_eq!(learn(&transposed, &config), learn(&motions, &config));
    }
}

/// Words of motions that begin alike and differ in pace.
fn class(n_motions: usize, seed: u64) -> Vec<MotionTemplate> {
    let mut state = seed;
    let mut dice = move |sides: u64| {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (state >> 33) % sides
    };
    let mut motion = || {
        let pose = |k: u64| (0x0f0f_3355_aa00_u64.rotate_left(k as u32 * 3)) & ((1 << 39) - 1);
        let frames = (0..12).flat_map(|k| vec![pose(k); 1 + dice(4) as usize]);
        let words: Vec<u64> = frames
            .collect::<Vec<_>>()
            .into_iter()
            .map(|w| w ^ (1 << dice(39)))
            .collect();
        MotionTemplate::from_words(&words, 39).unwrap()
    };
    (0..n_motions).map(|_| motion()).collect()
}

#[test]
fn threads_change_nothing() {
    for unwarp in [Unwarp::Exact, Unwarp::Balance] {
        let config = LearnConfig {
            unwarp,
            tolerance: 0.0,
            max_iterations: 4,
        };
        let motions = class(9, 7);
        let mut results = Vec::new();
        for n_threads in [1, 2, 4] {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(n_threads)
                .build()
                .unwrap();
            results.push(pool.install(|| learn(&motions, &config)).unwrap());
        }
        assert_eq!(results[0], results[1]);
        assert_eq!(results[0], results[2]);
        assert!(results[0].template.n_columns() > 12);
    }
}

#[test]
fn a_slower_motion_costs_nothing_and_shares_its_weight() {
    let quick = MotionTemplate::from_words(&[0b00, 0b01, 0b11], 2).unwrap();
    let slow = MotionTemplate::from_words(&[0b00, 0b00, 0b01, 0b01, 0b11], 2).unwrap();
    let found = align(&quick, &slow).unwrap();
    assert_eq!(found.path, [(0, 0), (0, 1), (1, 2), (1, 3), (2, 4)]);
    assert_eq!(found.cost, 0.0);
    // Weights 3/2, 3/2 and 1 in real time: half of the second cell is each pose's.
    let learned = learn(&[quick, slow], &LearnConfig::default()).unwrap();
    assert_eq!(learned.template.weights(), array![1.0, 1.0, 1.0, 1.0]);
    let expected = array![[0.0, 0.0], [0.5, 0.0], [1.0, 0.0], [1.0, 1.0]];
    assert_eq!(learned.template.values(), expected);
    assert_eq!(learned.distance, 0.0);
}

#[test]
fn balance_repeats_and_merges() {
    // Weights 2, 0.5, 0.5 and 0.25: two columns, one of two halves, and the rest of a quarter in it.
    let values = array![[1.0], [0.0], [1.0], [0.0]];
    let motion = MotionTemplate::new(values, array![2.0, 0.5, 0.5, 0.25]).unwrap();
    let config = LearnConfig {
        unwarp: Unwarp::Balance,
        ..LearnConfig::default()
    };
    let learned = learn(&[motion], &config).unwrap().template;
    assert_eq!(learned.weights(), array![1.0, 1.0, 1.25]);
    assert_eq!(learned.values(), array![[1.0], [1.0], [0.4]]);
}

#[test]
fn each_motion_that_cannot_be_learned_from_is_named() {
    let motion = |n_columns: usize, n_features: usize| {
        MotionTemplate::new(
            Array2::zeros((n_columns, n_features)),
            Array1::ones(n_columns),
        )
        .unwrap()
    };
    let heavy = MotionTemplate::new(array![[0.0]], array![1e300]).unwrap();
    let cases = [
        (vec![], "expected one motion or more, found none"),
        (
            vec![motion(1, 1), motion(0, 1)],
            "motion 1: expected one frame or more, found none",
        ),
        (
            vec![motion(1, 1), motion(1, 2)],
            "motion 1: expected 1 features, found 2",
        ),
        (
            vec![motion(1, 1), motion(MAX_ALIGNED_COLUMNS + 1, 1)],
            "motion 1: expected at most 8192 columns and as much total weight, found 8193",
        ),
    ];
    for (motions, message) in cases {
        let error = learn(&motions, &LearnConfig::default()).unwrap_err();
        assert_eq!(error.to_string(), message);
    }
    let error = learn(std::slice::from_ref(&heavy), &LearnConfig::default()).unwrap_err();
    assert_eq!(
        error,
        TemplateError::TooLong {
            motion: 0,
            found: 1e300
        }
    );
    assert_eq!(
        align(&motion(1, 1), &heavy).unwrap_err(),
        TemplateError::TooLong {
            motion: 1,
            found: 1e300
        }
    );
    // Weights too small to divide by are an error and no panic.
    let tiny = MotionTemplate::new(array![[1.0], [0.0]], array![5e-324, 5e-324]).unwrap();
    let both = [motion(1, 1), tiny];
    for unwarp in [Unwarp::Exact, Unwarp::Balance] {
        let config = LearnConfig {
            unwarp,
            ..LearnConfig::default()
        };
        let _ = learn(&both, &config);
        let _ = learn(&both[1..], &config);
    }
}
