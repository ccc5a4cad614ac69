use mtemplate::ndarray::{Array1, Array2};
use mtemplate::{COST_ERROR, Cell, MotionTemplate};
use proptest::prelude::*;

use crate::naive;

fn words(n_features: usize, at_most: usize) -> impl Strategy<Value = Vec<u64>> {
    let mask = u64::MAX >> (64 - n_features);
    prop::collection::vec(any::<u64>().prop_map(move |word| word & mask), 0..=at_most)
}

fn clip() -> impl Strategy<Value = (Vec<u64>, usize)> {
    (1_usize..=64).prop_flat_map(|n_features| (words(n_features, 12), Just(n_features)))
}

/// Multiples of 1/20 fall on thresholds often.
fn value() -> impl Strategy<Value = f64> {
    prop_oneof![
        (0_u8..=20).prop_map(|share| f64::from(share) / 20.0),
        0.0..=1.0_f64
    ]
}

fn template() -> impl Strategy<Value = MotionTemplate> {
    (0_usize..=7, prop_oneof![1_usize..=4, Just(64_usize)]).prop_flat_map(|(columns, features)| {
        let values = prop::collection::vec(value(), columns * features);
        let weights = prop::collection::vec(prop_oneof![Just(1.0), 0.25..2.0_f64], columns);
        (values, weights).prop_map(move |(values, weights)| {
            let values = Array2::from_shape_vec((columns, features), values).unwrap();
            MotionTemplate::new(values, Array1::from(weights)).unwrap()
        })
    })
}

fn threshold() -> impl Strategy<Value = f64> {
    prop_oneof![Just(0.0), Just(0.05), Just(0.1), Just(0.4), 0.0..0.5_f64]
}

proptest! {
    #[test]
    fn template_of_one_motion_is_its_feature_matrix(
        (words, n_features) in clip(),
        threshold in threshold(),
    ) {
        let template = MotionTemplate::from_words(&words, n_features).unwrap();
        prop_assert_eq!(template.n_columns(), words.len());
        prop_assert!(template.weights().iter().all(|&weight| weight == 1.0));
        for ((frame, feature), &value) in template.values().indexed_iter() {
            prop_assert_eq!(value, if words[frame] >> feature & 1 == 1 { 1.0 } else { 0.0 });
        }
        let quantized = template.quantize(threshold).unwrap();
        for (frame, &word) in words.iter().enumerate() {
            let all = u64::MAX >> (64 - n_features);
            prop_assert_eq!(quantized.words(frame), Some((all, word)));
        }
    }

    #[test]
    fn quantised_cells_equal_the_definition(template in template(), threshold in threshold()) {
        let quantized = template.quantize(threshold).unwrap();
        for ((column, feature), &value) in template.values().indexed_iter() {
            let expected = naive::quantize(value, threshold);
            prop_assert_eq!(quantized.cell(column, feature), Some(expected));
            let (care, value) = quantized.words(column).unwrap();
            prop_assert_eq!(care >> feature & 1 == 1, expected != Cell::Wildcard);
            prop_assert_eq!(value >> feature & 1 == 1, expected == Cell::One);
        }
    }

    #[test]
    fn local_costs_equal_the_definition(
        template in template(),
        threshold in threshold(),
        word in any::<u64>(),
    ) {
        let quantized = template.quantize(threshold).unwrap();
        for k in 0..template.n_columns() {
            let expected =
                naive::local_cost(template.values(), template.weights(), threshold, k, word);
            prop_assert_eq!(quantized.local_cost(k, word), Some(expected));
        }
    }

    #[test]
    fn curves_equal_the_textbook(
        template in template(),
        words in prop_oneof![words(2, 10), words(64, 10)],
        threshold in threshold(),
    ) {
        let quantized = template.quantize(threshold).unwrap();
        let curve = quantized.distance_curve(&words);
        prop_assert_eq!(curve.len(), words.len());
        let n_columns = template.n_columns();
        let largest = template.weights().iter().fold(1.0, |a: f64, b| a.max(*b));
        let error = COST_ERROR * n_columns as f64 * (largest + 1.0) / 2.0;
        let c = |k, l: usize| quantized.local_cost(k, words[l]).unwrap();
        for end in 0..words.len() {
            let expected =
                if n_columns < 2 { None } else { naive::reach(&c, n_columns - 1, end) };
            let found = curve.cost(end);
            prop_assert_eq!(found.is_some(), expected.is_some());
            let costs = found.zip(expected);
            prop_assert!(costs.is_none_or(|(found, (cost, _))| (found - cost).abs() <= error));
        }
    }

    #[test]
    fn a_motion_costs_nothing_where_it_stands(
        (motion, n_features) in clip(),
        before in words(64, 5),
    ) {
        prop_assume!(motion.len() >= 2);
        let template = MotionTemplate::from_words(&motion, n_features).unwrap();
        let words = [&before[..], &motion].concat();
        let curve = template.quantize(0.0).unwrap().distance_curve(&words);
        prop_assert_eq!(curve.cost(words.len() - 1), Some(0.0));
    }

    #[test]
    fn wildcards_do_not_affect_cost(template in template(), threshold in threshold(), noise: u64) {
        let quantized = template.quantize(threshold).unwrap();
        for k in 0..template.n_columns() {
            let (care, value) = quantized.words(k).unwrap();
            prop_assert_eq!(quantized.local_cost(k, value | (noise & !care)), Some(0.0));
        }
    }

    #[test]
    fn mirroring_and_its_inverse_cancel(
        template in template(),
        shuffle in Just((0..64).collect::<Vec<usize>>()).prop_shuffle(),
    ) {
        let there: Vec<usize> =
            shuffle.into_iter().filter(|&feature| feature < template.n_features()).collect();
        let mut back = vec![0; there.len()];
        for (to, &from) in there.iter().enumerate() {
            back[from] = to;
        }
        let mirrored = template.mirrored(&there).unwrap();
        for ((column, feature), value) in mirrored.values().indexed_iter() {
            prop_assert_eq!(*value, template.values()[[column, there[feature]]]);
        }
        prop_assert_eq!(mirrored.mirrored(&back).unwrap(), template);
    }
}
