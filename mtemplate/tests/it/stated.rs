use mtemplate::ndarray::{Array1, Array2, array};
use mtemplate::{Cell, MatchConfig, MotionTemplate, QuantizedTemplate, TemplateError};

/// Costs of the best matches that end at each frame, and their starts.
fn curve(template: &QuantizedTemplate, words: &[u64]) -> (Vec<Option<f64>>, Vec<Option<usize>>) {
    let starts = (0..words.len()).map(|last| template.start_of(words, last));
    (
        template.distance_curve(words).costs().collect(),
        starts.collect(),
    )
}

#[test]
fn a_value_at_the_threshold_is_quantised() {
    let values = array![[0.1, 0.11, 0.9, 0.89, 0.0, 1.0]];
    let template = MotionTemplate::new(values, array![1.0])
        .unwrap()
        .quantize(0.1)
        .unwrap();
    let cells: Vec<Cell> = (0..6)
        .filter_map(|feature| template.cell(0, feature))
        .collect();
    use Cell::{One, Wildcard, Zero};
    assert_eq!(cells, [Zero, Wildcard, One, Wildcard, Zero, One]);
    assert_eq!(template.words(0), Some((0b110101, 0b100100)));
}

#[test]
fn nothing_stands_outside_the_template() {
    let template = MotionTemplate::from_words(&[1, 0], 2)
        .unwrap()
        .quantize(0.1)
        .unwrap();
    assert_eq!((template.n_columns(), template.n_features()), (2, 2));
    assert_eq!(template.cell(2, 0), None);
    assert_eq!(template.cell(0, 2), None);
    assert_eq!(template.words(2), None);
    assert_eq!(template.local_cost(2, 0), None);
}

#[test]
fn a_heavier_column_costs_more() {
    let values = array![[1.0, 0.0, 0.5], [0.5, 0.5, 0.5]];
    let template = MotionTemplate::new(values, array![1.5, 9.0])
        .unwrap()
        .quantize(0.1)
        .unwrap();
    // One of two cells disagrees: 1/2 · (1.5 + 1)/2 / 2 columns.
    assert_eq!(template.local_cost(0, 0b011), Some(0.3125));
    assert_eq!(template.local_cost(1, 0b011), Some(0.0));
}

#[test]
fn skipping_a_column_weighs_twice() {
    // Three columns on two frames: 0 -> 2 by (2,1). The last column disagrees.
    let template = MotionTemplate::from_words(&[1, 1, 1], 1)
        .unwrap()
        .quantize(0.1)
        .unwrap();
    let (costs, starts) = curve(&template, &[1, 0]);
    assert_eq!(costs, [None, Some(2.0 / 3.0)]);
    assert_eq!(starts, [None, Some(0)]);
}

#[test]
fn ties_take_the_shorter_data_step() {
    let template = MotionTemplate::from_words(&[1, 1], 1)
        .unwrap()
        .quantize(0.1)
        .unwrap();
    let (_, starts) = curve(&template, &[1, 1, 1]);
    assert_eq!(starts, [None, Some(0), Some(1)]);
    let best = &template.find_matches(&[1, 1, 1], &MatchConfig::up_to(0.0))[0];
    assert_eq!((best.span.clone(), best.cost), (0..2, 0.0));
}

#[test]
fn too_little_has_no_match() {
    let words = [1, 0, 1];
    for columns in 0..2 {
        let template = MotionTemplate::from_words(&words[..columns], 1).unwrap();
        let template = template.quantize(0.1).unwrap();
        assert_eq!(curve(&template, &words), (vec![None; 3], vec![None; 3]));
        assert_eq!(template.find_matches(&words, &MatchConfig::up_to(1.0)), []);
    }
    let template = MotionTemplate::from_words(&[1; 7], 1)
        .unwrap()
        .quantize(0.1)
        .unwrap();
    assert_eq!(template.find_matches(&words, &MatchConfig::up_to(1.0)), []);
    assert!(template.distance_curve(&[]).is_empty());
}

#[track_caller]
fn check(result: Result<MotionTemplate, TemplateError>, message: &str) {
    assert_eq!(result.unwrap_err().to_string(), message);
}

#[test]
fn each_error_says_what_was_expected_and_found() {
    check(
        MotionTemplate::from_words(&[], 0),
        "expected 1 to 64 features, found 0",
    );
    check(
        MotionTemplate::from_words(&[], 65),
        "expected 1 to 64 features, found 65",
    );
    check(
        MotionTemplate::from_words(&[1, 6], 2),
        "frame 1: expected bits below 2, found 0x6",
    );
    check(
        MotionTemplate::new(array![[0.0], [f64::NAN]], array![1.0, 1.0]),
        "column 1, feature 0: expected a value in [0, 1], found NaN",
    );
    check(
        MotionTemplate::new(array![[0.0]], array![0.0]),
        "column 0: expected a positive finite weight, found 0",
    );
    check(
        MotionTemplate::new(array![[0.0]], Array1::ones(2)),
        "expected a weight for each of 1 columns, found 2",
    );
    let template = MotionTemplate::new(Array2::zeros((1, 3)), Array1::ones(1)).unwrap();
    for permutation in [&[0, 1][..], &[0, 1, 1], &[0, 1, 3], &[0, 1, 2, 2]] {
        check(
            template.mirrored(permutation),
            "expected each of 3 features once, found no permutation of them",
        );
    }
    for threshold in [-0.1, 0.5, f64::NAN] {
        let error = template.quantize(threshold).unwrap_err();
        assert_eq!(
            error.to_string(),
            format!("expected a threshold in [0, 0.5), found {threshold}")
        );
    }
}

#[test]
fn all_64_bits_are_features() {
    let template = MotionTemplate::from_words(&[u64::MAX, 1 << 63], 64).unwrap();
    let template = template.quantize(0.1).unwrap();
    assert_eq!(template.words(1), Some((u64::MAX, 1 << 63)));
    assert_eq!(template.local_cost(0, 0), Some(0.5));
}
