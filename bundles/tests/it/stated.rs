use std::ops::Range;

use bundles::ndarray::{Array1, Array2, array};
use bundles::{BundlesError, Letter, PoseClusters, adjacent_distance_median, spell};

#[test]
fn equal_letters_meet_at_a_boundary_and_stay_two() {
    let string = spell(&[7, 7, 7, 7], &[0..2, 2..4]).unwrap();
    let frames: Vec<Range<usize>> = string.runs().iter().map(|run| run.frames.clone()).collect();
    assert_eq!(frames, [0..2, 2..4]);
    assert_eq!(string.width(0, 1), None);
}

#[test]
fn nothing_spells_nothing() {
    let string = spell(&[], &[]).unwrap();
    assert!(string.is_empty());
    assert_eq!(string.clip_span(0), None);
    let string = spell(&[1, 2], &[0..0, 1..1]).unwrap();
    assert!(string.is_empty());
    assert_eq!((string.n_clips(), string.clip_span(1)), (2, Some(0..0)));
    let clusters = PoseClusters::new(array![[0.0]].view(), array![1.0].view()).unwrap();
    assert_eq!(adjacent_distance_median(&string, &clusters), Ok(None));
}

#[test]
fn a_boundary_is_no_neighbourhood() {
    let clusters = PoseClusters::new(
        array![[0.0], [1.0], [50.0]].view(),
        array![1.0, 1.0, 1.0].view(),
    );
    let clusters = clusters.unwrap();
    let median = |clips: &[Range<usize>]| {
        adjacent_distance_median(&spell(&[0, 1, 2], clips).unwrap(), &clusters).unwrap()
    };
    assert_eq!(median(&[0..3]), Some(25.0));
    assert_eq!(median(&[0..2, 2..3]), Some(1.0));
    assert_eq!(median(&[0..1, 1..2, 2..3]), None);
}

#[test]
fn the_tighter_letter_sets_the_distance() {
    let means = array![[0.0, 0.0], [3.0, 4.0]];
    let clusters = PoseClusters::new(means.view(), array![2.0, 0.5].view()).unwrap();
    let distance = |a, b| clusters.distance(Letter::from_label(a), Letter::from_label(b));
    assert_eq!(distance(0, 1), Some(10.0));
    assert_eq!(distance(1, 1), Some(0.0));
    assert_eq!(distance(0, 2), None);
    assert_eq!(distance(u32::MAX, 0), None);
}

#[track_caller]
fn check<T: std::fmt::Debug>(result: Result<T, BundlesError>, message: &str) {
    assert_eq!(result.unwrap_err().to_string(), message);
}

#[test]
fn each_error_says_what_was_expected_and_found() {
    let labels = [0; 5];
    check(
        spell(&labels, &[0..6]),
        "clip 0: expected a range within 0..5, found 0..6",
    );
    check(
        spell(&labels, &[0..3, 2..5]),
        "clip 1: expected a range within 3..5, found 2..5",
    );
    let backwards = Range { start: 3, end: 2 };
    check(
        spell(&labels, &[backwards]),
        "clip 0: expected a range within 0..5, found 3..2",
    );

    let means = Array2::zeros((2, 1));
    check(
        PoseClusters::new(means.view(), Array1::ones(3).view()),
        "expected a standard deviation for each of 2 letters, found 3",
    );
    check(
        PoseClusters::new(means.view(), array![1.0, 0.0].view()),
        "letter 1: expected a positive finite standard deviation, found 0",
    );
    check(
        PoseClusters::new(array![[f64::NAN]].view(), array![1.0].view()),
        "letter 0: expected a finite mean, found NaN",
    );
    let clusters = PoseClusters::new(means.view(), array![1.0, 1.0].view()).unwrap();
    let string = spell(&[0, 2], &[0..2]).unwrap();
    check(
        adjacent_distance_median(&string, &clusters),
        "expected letters below 2, found 2",
    );
}
