use dtw::ndarray::{Array2, array, s};
use dtw::{BandRadius, DtwError, LocalCost, Search};

/// A random walk with a copy of a part of itself, warped and scaled, from frame 700 on.
fn walk_with_a_copy() -> (Array2<f64>, Array2<f64>) {
    // Knuth's generator, of which the upper bits are taken.
    let mut state = 1_u64;
    let mut level = 0.0;
    let mut series = Array2::from_shape_simple_fn((2_000, 1), || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        level += (state >> 40) as f64 / 2.0_f64.powi(24) - 0.5;
        level
    });
    let query = series.slice(s![100..160, ..]).to_owned();
    for i in 0..60 {
        let warped = if (20..40).contains(&i) { i - 1 } else { i };
        series[[700 + i, 0]] = 3.0 * query[[warped, 0]] - 40.0;
    }
    (query, series)
}

#[test]
fn a_planted_copy_is_found() {
    let (query, series) = walk_with_a_copy();
    let search = Search::new(BandRadius::cells(3)).with_local_cost(LocalCost::SquaredEuclidean);
    let found = search
        .z_normalised()
        .best_windows(query.view(), series.view(), 2, 30)
        .unwrap();
    assert_eq!((found[0].start, found[0].cost), (100, 0.0));
    assert_eq!(found[1].start, 700);
    let as_given = search
        .best_windows(query.view(), series.view(), 2, 30)
        .unwrap();
    assert_eq!((as_given[0].start, as_given[0].cost), (100, 0.0));
    assert_ne!(
        as_given[1].start, 700,
        "the copy is elsewhere unless it is normalised"
    );
}

#[test]
fn equal_costs_are_in_order_of_starts() {
    let query = array![[0.0], [1.0]];
    let series = array![[0.0], [1.0], [0.0], [1.0], [0.0], [1.0], [0.0]];
    let search = Search::new(BandRadius::cells(0));
    let starts = |k, exclusion| -> Vec<usize> {
        let found = search
            .best_windows(query.view(), series.view(), k, exclusion)
            .unwrap();
        found.into_iter().map(|window| window.start).collect()
    };
    assert_eq!(starts(9, 0), [0, 2, 4, 1, 3, 5]);
    assert_eq!(starts(9, 1), [0, 2, 4, 1, 3, 5]);
    assert_eq!(starts(9, 2), [0, 2, 4]);
    assert_eq!(starts(9, 3), [0, 4]);
    assert_eq!(starts(1, 3), [0]);
    assert_eq!(starts(0, 3), []);
}

#[test]
fn costs_are_in_units_of_the_local_cost() {
    let (query, other) = (array![[0.0], [0.0]], array![[3.0], [3.0]]);
    let cost = |local| {
        let search = Search::new(BandRadius::cells(1)).with_local_cost(local);
        search.nearest(query.view(), &[other.view()], 1).unwrap()[0].cost
    };
    assert_eq!(cost(LocalCost::Euclidean), 6.0);
    assert_eq!(cost(LocalCost::SquaredEuclidean), 18.0);
    assert_eq!(cost(LocalCost::Manhattan), 6.0);
}

#[test]
fn a_constant_dimension_becomes_zeros() {
    // The mean of three times 0.1 is not 0.1.
    let (query, other) = (array![[0.1], [0.1], [0.1]], array![[7.7], [7.7], [7.7]]);
    let search = Search::new(BandRadius::cells(1)).z_normalised();
    let found = search.nearest(query.view(), &[other.view()], 1).unwrap();
    assert_eq!(found[0].cost, 0.0);
}

#[test]
fn nothing_is_found_where_there_is_nothing() {
    let search = Search::new(BandRadius::cells(1));
    let (none, some) = (Array2::<f64>::zeros((0, 2)), Array2::<f64>::zeros((3, 2)));
    assert_eq!(search.nearest(some.view(), &[], 1).unwrap(), []);
    assert_eq!(search.nearest(none.view(), &[some.view()], 1).unwrap(), []);
    assert_eq!(search.nearest(some.view(), &[none.view()], 1).unwrap(), []);
    assert_eq!(
        search.best_windows(none.view(), some.view(), 1, 0).unwrap(),
        []
    );
    assert_eq!(
        search.best_windows(some.view(), none.view(), 1, 0).unwrap(),
        []
    );
}

#[test]
fn dimensions_of_all_must_agree() {
    let search = Search::new(BandRadius::cells(1));
    let (two, three) = (Array2::<f64>::zeros((3, 2)), Array2::<f64>::zeros((3, 3)));
    let expected = DtwError::Dimensions { a: 2, b: 3 };
    let candidates = [two.view(), three.view()];
    assert_eq!(search.nearest(two.view(), &candidates, 0), Err(expected));
    let found = search.best_windows(two.view(), three.view(), 1, 0);
    assert_eq!(found, Err(expected));
}

#[cfg(feature = "rayon")]
#[test]
fn threads_do_not_change_what_is_found() {
    let (query, series) = walk_with_a_copy();
    let search = Search::new(BandRadius::cells(3)).z_normalised();
    let found = |n_threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads);
        let search = || search.best_windows(query.view(), series.view(), 40, 7);
        pool.build().unwrap().install(search).unwrap()
    };
    let alone = found(1);
    assert_eq!(alone.len(), 40);
    for n_threads in 2..5 {
        assert_eq!(found(n_threads), alone);
    }
}

/// Counted from their ends, frames of sequences of unequal lengths may be further apart than the
/// band's radius.
#[test]
fn the_last_frames_of_unequal_lengths_are_not_ruled_out() {
    let column = |samples: &[f64]| Array2::from_shape_fn((samples.len(), 1), |(i, _)| samples[i]);
    let query = column(&[0.0, 0.0, 0.0, 0.5, 0.0, 0.0, 0.4, 1.0, 0.0]);
    let longer = column(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0]);
    let search = Search::new(BandRadius::cells(1))
        .with_local_cost(LocalCost::Cosine)
        .z_normalised();
    // Above the mean or below it is all that a cosine sees in one dimension: all are the query.
    let mut candidates = vec![query.view(); 100];
    candidates[0] = longer.view();
    let nearest = search.nearest(query.view(), &candidates, 1).unwrap();
    assert_eq!((nearest[0].index, nearest[0].cost), (0, 0.0));
}
