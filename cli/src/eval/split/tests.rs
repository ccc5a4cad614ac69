use std::path::{Path, PathBuf};

use proptest::prelude::*;

use super::*;
use crate::eval::folders::LabelledFile;
use crate::source::ClipRef;

fn folders(names: &[(&str, &str)]) -> Folders {
    let mut folders = Folders::default();
    for (class, name) in names {
        if folders.classes.last().map(String::as_str) != Some(class) {
            folders.classes.push((*class).to_owned());
        }
        let path: PathBuf = Path::new("labelled").join(class).join(name);
        let class = folders.classes.len() - 1;
        let file = ClipRef { path, span: None };
        folders.files.push(LabelledFile { file, class });
    }
    folders
}

/// The sizes of the paper's 64 classes (spec.md g), and the clips that section 5.4 evaluates on.
const SIZES: [usize; 64] = [
    21, 17, 17, 32, 28, 29, 29, 27, 27, 16, 29, 29, 28, 13, 36, 41, 42, 17, 17, 14, 52, 29, 26, 30,
    30, 20, 30, 30, 30, 28, 16, 16, 16, 16, 16, 16, 13, 13, 20, 20, 17, 20, 30, 52, 28, 17, 20, 20,
    20, 20, 14, 14, 14, 14, 14, 14, 30, 30, 16, 15, 16, 18, 15, 13,
];
const N_CLIPS: usize = 1457;
const N_EVALUATED: usize = 718;

#[test]
fn the_papers_classes_leave_718_clips_to_evaluate() {
    assert_eq!(SIZES.iter().sum::<usize>(), N_CLIPS);
    let tests = |n: usize| paper(n).into_iter().filter(|r| *r == Role::Test).count();
    assert_eq!(SIZES.into_iter().map(tests).sum::<usize>(), N_EVALUATED);
}

#[test]
fn odd_classes_learn_from_one_more() {
    use Role::{Test, Train};
    assert_eq!(paper(5), [Train, Train, Test, Train, Test]);
    assert_eq!(paper(4), [Train, Test, Train, Test]);
    assert_eq!(paper(2), [Train, Train]);
    assert_eq!(paper(1), [Train]);
    assert_eq!(paper(0), []);
}

proptest! {
    #[test]
    fn every_kth_clip_is_a_test(n in 0_usize..40, every in 2_usize..6, seed in any::<Option<u64>>()) {
        let roles = |seed: Option<u64>| every_kth(n, every, seed.map(ChaCha8Rng::seed_from_u64).as_mut());
        let n_tests = roles(seed).iter().filter(|r| **r == Role::Test).count();
        prop_assert_eq!(n_tests, n / every);
        prop_assert_eq!(roles(seed), roles(seed));
        let in_order: Vec<bool> = roles(None).iter().map(|r| *r == Role::Test).collect();
        let expected: Vec<bool> = (1..=n).map(|k| k % every == 0).collect();
        prop_assert_eq!(in_order, expected);
    }
}

#[track_caller]
fn check_actors(names: &[(&str, &str)], part: Option<usize>, expected: Option<&[&str]>) {
    let found = find_actors(&folders(names), part)
        .ok()
        .map(|actors| actors.of_clips);
    let expected = expected.map(|names| names.iter().map(|n| (*n).to_owned()).collect::<Vec<_>>());
    assert_eq!(found, expected);
}

#[test]
fn actors_are_found_by_the_first_part_that_differs() {
    let hdm = [
        ("hop", "HDM_bd_hop_001_120.amc"),
        ("hop", "HDM_bk_hop_002_120.amc"),
        ("kick", "HDM_bd_kick_001_120.amc"),
        ("kick", "HDM_mm_kick_002_120.amc"),
    ];
    check_actors(&hdm, None, Some(&["bd", "bk", "bd", "mm"]));
    check_actors(&hdm, Some(4), Some(&["001", "002", "001", "002"]));
    check_actors(&hdm, Some(6), None);
    check_actors(&hdm, Some(0), None);
    let below = [
        ("hop", "anna/01.bvh"),
        ("hop", "anna/02.bvh"),
        ("hop", "ben/01.bvh"),
    ];
    check_actors(&below, None, Some(&["anna", "anna", "ben"]));
}

#[test]
fn actors_that_cannot_be_told_are_an_error() {
    // The first part that differs is a number of its own for every clip.
    check_actors(&[("hop", "take_1.bvh"), ("hop", "take_2.bvh")], None, None);
    check_actors(&[("hop", "same.bvh"), ("kick", "same.bvh")], None, None);
}

#[test]
fn some_actors_are_tested() {
    let folders = folders(&[("hop", "a_1.bvh"), ("hop", "b_1.bvh"), ("hop", "a_2.bvh")]);
    let roles = |test: &[&str]| {
        let test = test.iter().map(|name| (*name).to_owned()).collect();
        Split::Actor { test, part: None }.roles(&folders)
    };
    assert_eq!(
        roles(&["b"]).unwrap(),
        [Role::Train, Role::Test, Role::Train]
    );
    for refused in [&["c"][..], &[], &["a", "b"]] {
        let failure = roles(refused).unwrap_err().to_string();
        assert!(failure.contains("a, b"), "{failure}");
    }
}
