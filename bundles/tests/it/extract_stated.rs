use bundles::ndarray::{Array2, array};
use bundles::{
    Accessibility, Closure, ExtractOptions, FrameMapping, MappingOptions, Partition, RandomWalk,
    SeedInstance, StringBundle, Substring, extend, extract, link, map_frames, max_letters, spell,
};
use bundles::{BundleGraph, DeadEnds};

/// Letters as far apart as their labels.
fn line(n_letters: usize, tau: f64) -> Accessibility {
    let distances = Array2::from_shape_fn((n_letters, n_letters), |(a, b)| a.abs_diff(b) as f64);
    Accessibility::new(distances.view(), tau).unwrap()
}

fn first(max_letters: usize) -> ExtractOptions {
    ExtractOptions {
        seed: SeedInstance::First,
        ..ExtractOptions::new(max_letters)
    }
}

const fn from_to(first: usize, last: usize) -> Substring {
    Substring { first, last }
}

#[test]
fn nothing_and_single_letters_have_no_bundle() {
    for (labels, clips) in [(vec![], vec![]), (vec![1, 1, 1], vec![0..2, 2..2, 2..3])] {
        let string = spell(&labels, &clips).unwrap();
        let partition = extract(&string, &line(2, 1.0), &first(5)).unwrap();
        assert_eq!(partition, Partition::default());
        let graph = link(&string, &partition, &FrameMapping::default()).unwrap();
        assert_eq!(
            (graph.bundles().len(), graph.clips().len()),
            (0, clips.len())
        );
    }
}

#[test]
fn what_occurs_once_is_one_degenerate_submotion_for_each_clip() {
    let string = spell(&[0, 2, 4, 6, 8, 10], &[0..4, 4..6]).unwrap();
    let partition = extract(&string, &line(11, 1.0), &first(9)).unwrap();
    assert_eq!(partition.bundles, []);
    assert_eq!(partition.degenerate, [from_to(0, 3), from_to(4, 5)]);
}

#[test]
fn bundles_meet_at_a_letter() {
    // 0 2 4 0 2 4 with 0 2 and 2 4 alike in both places: one bundle of the whole, or two that share the letter 2.
    let string = spell(&[0, 2, 4, 8, 0, 2, 4], &[0..7]).unwrap();
    let whole = extract(&string, &line(9, 0.0), &first(3)).unwrap();
    assert_eq!(whole.bundles[0].members, [from_to(0, 2), from_to(4, 6)]);
    assert_eq!(
        (whole.bundles[0].mean_width, whole.bundles[0].volume),
        (2.0, 2.0)
    );
    assert_eq!(whole.degenerate, [from_to(2, 4)]);
    let halves = extract(&string, &line(9, 0.0), &first(2)).unwrap();
    let members: Vec<_> = halves.bundles.iter().map(|b| b.members.clone()).collect();
    assert_eq!(
        members,
        [
            [from_to(0, 1), from_to(4, 5)],
            [from_to(1, 2), from_to(5, 6)]
        ]
    );
}

#[test]
fn the_closure_follows_what_the_seed_cannot_reach() {
    // 0 9, 1 9 and 2 9: each near the next, the first not near the last.
    let string = spell(&[0, 9, 1, 9, 2, 9], &[0..2, 2..4, 4..6]).unwrap();
    let height = |closure| {
        let options = ExtractOptions {
            closure,
            ..first(2)
        };
        let access = line(10, 1.0);
        extract(&string, &access, &options).unwrap().bundles[0]
            .members
            .len()
    };
    assert_eq!(
        (height(Closure::Transitive), height(Closure::Direct)),
        (3, 2)
    );
}

#[test]
fn gamma_tells_slow_from_fast() {
    // The same letters, once in 2 and 2, once in 9 and 9 frames: widths 2 and 9.
    let labels = [vec![0, 0, 1, 1], vec![0; 9], vec![1; 9]].concat();
    let string = spell(&labels, &[0..4, 4..22]).unwrap();
    let bundles = |gamma| {
        let options = ExtractOptions { gamma, ..first(2) };
        extract(&string, &line(2, 0.0), &options)
            .unwrap()
            .bundles
            .len()
    };
    assert_eq!((bundles(0.0), bundles(0.2), bundles(0.3)), (1, 1, 0));
}

#[test]
fn max_letters_is_the_paper_s() {
    // Runs of 4 frames: neighbours are 4 apart, so 200 frames are 50 letters.
    let labels: Vec<u32> = (0..1000).map(|frame| frame / 4).collect();
    let string = spell(&labels, &[0..500, 500..1000]).unwrap();
    assert_eq!(max_letters(&string, 200.0), 50);
    assert_eq!(max_letters(&string, 203.9), 50);
    // At least 2, and no more than there are.
    for none in [0.0, -5.0, f64::NAN] {
        assert_eq!(max_letters(&string, none), 2);
    }
    assert_eq!(max_letters(&string, f64::INFINITY), 250);
    assert_eq!(max_letters(&spell(&[3; 9], &[0..9]).unwrap(), 200.0), 2);
}

#[track_caller]
fn check<T: std::fmt::Debug, E: std::fmt::Display>(result: Result<T, E>, message: &str) {
    match result {
        Ok(found) => panic!("expected {message:?}, found {found:?}"),
        Err(error) => assert_eq!(error.to_string(), message),
    }
}

#[test]
fn distances_that_make_no_matrix_are_refused() {
    let new = |distances: Array2<f64>, tau| Accessibility::new(distances.view(), tau);
    check(
        new(Array2::zeros((2, 3)), 1.0),
        "expected as many columns as rows, found 2 rows and 3 columns",
    );
    for (a, b, found) in [(0, 1, f64::NAN), (0, 1, -1.0), (1, 1, 0.5)] {
        let mut distances = Array2::zeros((2, 2));
        distances[[a, b]] = found;
        let expected = "expected a finite distance, 0 if they are one";
        check(
            new(distances, 1.0),
            &format!("letters {a} and {b}: {expected}, found {found}"),
        );
    }
    check(
        new(array![[0.0, 1.0], [2.0, 0.0]], 1.0),
        "letters 1 and 0: expected the distance 1 both ways, found 2",
    );
    check(
        new(Array2::zeros((1, 1)), -1.0),
        "expected a finite threshold of at least 0, found -1",
    );
    let access = line(3, 1.0);
    let letter = bundles::Letter::from_label;
    assert_eq!(access.is_near(letter(0), letter(1)), Some(true));
    assert_eq!(access.is_near(letter(0), letter(2)), Some(false));
    assert_eq!(access.is_near(letter(0), letter(3)), None);
    assert_eq!(access.distance(letter(2), letter(0)), Some(2.0));
    assert_eq!(access.distance(letter(u32::MAX), letter(0)), None);
}

#[test]
fn options_out_of_range_are_refused() {
    let string = spell(&[0, 1, 5], &[0..3]).unwrap();
    let run = |n_letters, options| extract(&string, &line(n_letters, 0.0), &options);
    let good = first(3);
    check(
        run(6, first(1)),
        "expected substrings of at least 2 letters, found 1",
    );
    let rho = |rho| ExtractOptions { rho, ..good };
    check(
        run(6, rho(-0.5)),
        "expected a finite rho of at least 0, found -0.5",
    );
    let gamma = |gamma| ExtractOptions { gamma, ..good };
    check(run(6, gamma(1.5)), "expected gamma from 0 to 1, found 1.5");
    check(
        run(6, gamma(f64::NAN)),
        "expected gamma from 0 to 1, found NaN",
    );
    check(run(2, good), "letter 2: expected a label below 2, found 5");
}

#[test]
fn partitions_of_other_strings_are_refused() {
    let string = spell(&[0, 1, 0, 1, 0], &[0..3, 3..5]).unwrap();
    let run = |degenerate: &[Substring]| {
        let degenerate = degenerate.to_vec();
        let old = Partition {
            bundles: vec![],
            degenerate,
        };
        extend(&old, &string, &line(2, 0.0), &first(3))
    };
    let overlap = "expected disjoint substrings within clips, found letters";
    check(run(&[from_to(2, 3)]), &format!("{overlap} 2..=3"));
    check(run(&[from_to(1, 1)]), &format!("{overlap} 1..=1"));
    check(
        run(&[from_to(0, 2), from_to(1, 2)]),
        &format!("{overlap} 1..=2"),
    );
    check(run(&[from_to(4, 9)]), &format!("{overlap} 4..=9"));
    check(
        run(&[from_to(0, 1)]),
        "clip 0: expected all or none of it partitioned, found 1 of 2",
    );
}

#[test]
fn poses_and_frames_that_do_not_fit_are_refused() {
    let string = spell(&[0, 1, 0], &[0..3]).unwrap();
    let partition = extract(&string, &line(2, 0.0), &first(3)).unwrap();
    let poses = Array2::zeros((3, 1));
    let run = |poses: &Array2<f64>, options: &MappingOptions| {
        map_frames(&string, &partition, poses.view(), options)
    };
    let good = MappingOptions::default();
    let mapping = run(&poses, &good).unwrap();
    check(
        run(&Array2::zeros((2, 1)), &good),
        "expected a pose for each of 3 frames, found 2",
    );
    let nan = array![[0.0], [f64::NAN], [0.0]];
    check(
        run(&nan, &good),
        "frame 1, dimension 0: expected a finite number, found NaN",
    );
    let duration_weight = -1.0;
    let negative = MappingOptions {
        duration_weight,
        ..good.clone()
    };
    check(
        run(&poses, &negative),
        "expected a finite duration weight of at least 0, found -1",
    );
    let other = spell(&[0, 0, 0, 1, 0], &[0..5]).unwrap();
    let other = extract(&other, &line(2, 0.0), &first(3)).unwrap();
    assert_eq!(other, partition);
    let shifted = MappingOptions {
        fixed: mapping,
        ..good
    };
    let string = spell(&[0, 0, 0, 1, 0], &[2..5]).unwrap();
    let found = map_frames(&string, &partition, Array2::zeros((5, 1)).view(), &shifted);
    check(
        found,
        "letter 0: expected a fixed frame of the letter, found Some(0)",
    );
}

#[test]
fn walks_that_do_not_exist_are_refused() {
    let string = spell(&[0, 1, 2, 0, 1, 2], &[0..3, 3..6]).unwrap();
    let partition = Partition {
        bundles: vec![bundle(&[(0, 1), (3, 4)]), bundle(&[(1, 2), (4, 5)])],
        degenerate: vec![],
    };
    let poses = Array2::zeros((6, 1));
    let mapping = map_frames(
        &string,
        &partition,
        poses.view(),
        &MappingOptions::default(),
    );
    let graph = link(&string, &partition, &mapping.unwrap()).unwrap();
    assert_eq!(graph.walk_along(&[0, 1]).unwrap().bundles, [0, 1]);
    check(
        graph.walk_along(&[]),
        "expected at least one bundle, found none",
    );
    check(
        graph.walk_along(&[0, 2]),
        "expected a bundle below 2, found 2",
    );
    check(
        graph.walk_along(&[0, 1, 0]),
        "step 1: expected an edge from bundle 1, found none to bundle 0",
    );
    check(
        graph.shortest_walk(1, 0),
        "expected a way from bundle 1 to bundle 0, found none",
    );
    let random = RandomWalk {
        n_bundles: 0,
        start: None,
        dead_ends: DeadEnds::Avoid,
        seed: 0,
    };
    check(
        graph.random_walk(&random),
        "expected at least one bundle, found none",
    );
    let walk = graph.random_walk(&RandomWalk {
        n_bundles: 9,
        start: Some(0),
        ..random
    });
    // Nothing lasts here: it goes to the end.
    assert_eq!(walk.unwrap().bundles, [0, 1]);
    assert_eq!(BundleGraph::default().debug_validate(), Ok(()));
}

fn bundle(members: &[(usize, usize)]) -> StringBundle {
    StringBundle {
        members: members
            .iter()
            .map(|&(first, last)| from_to(first, last))
            .collect(),
        mean_width: 1.0,
        volume: 1.0,
    }
}

#[cfg(feature = "rayon")]
#[test]
fn any_number_of_threads_finds_the_same() {
    let labels: Vec<u32> = (0..3000_u64)
        .map(|i| ((i * i * 2_654_435_761) >> 9) as u32 % 12)
        .collect();
    let string = spell(&labels, &[0..1100, 1100..3000]).unwrap();
    let run = |n_threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(n_threads)
            .build()
            .unwrap();
        let options = ExtractOptions::new(12);
        pool.install(|| extract(&string, &line(12, 1.0), &options))
            .unwrap()
    };
    let one = run(1);
    assert!(one.bundles.len() > 1);
    assert_eq!(run(2), one);
    assert_eq!(run(5), one);
}
