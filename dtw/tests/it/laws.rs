use dtw::ndarray::Array2;
use dtw::{BandRadius, Dtw, LocalCost};
use proptest::prelude::*;

use crate::naive;

const LOCALS: [LocalCost; 3] = [
    LocalCost::Euclidean,
    LocalCost::SquaredEuclidean,
    LocalCost::Manhattan,
];

/// Small whole numbers make ties common; a NaN closes cells.
fn sample() -> impl Strategy<Value = f64> {
    prop_oneof![
        8 => (-2_i8..=2).prop_map(f64::from),
        3 => -1.0..1.0_f64,
        1 => Just(f64::NAN),
    ]
}

/// Up to six frames: the twin's recursion is exponential in them.
fn sequence(dims: usize) -> impl Strategy<Value = Array2<f64>> {
    (0_usize..=6).prop_flat_map(move |frames| {
        prop::collection::vec(sample(), frames * dims)
            .prop_map(move |samples| Array2::from_shape_vec((frames, dims), samples).unwrap())
    })
}

fn pair() -> impl Strategy<Value = (Array2<f64>, Array2<f64>)> {
    (0_usize..=3).prop_flat_map(|dims| (sequence(dims), sequence(dims)))
}

fn band() -> impl Strategy<Value = BandRadius> {
    prop_oneof![
        Just(BandRadius::full()),
        (0_usize..8).prop_map(BandRadius::cells)
    ]
}

proptest! {
    #[test]
    fn equals_the_textbook((a, b) in pair(), band in band(), local in prop::sample::select(&LOCALS)) {
        let dtw = Dtw::new(band).with_local_cost(local);
        let path = dtw.align(a.view(), b.view()).unwrap();
        let distance = dtw.distance(a.view(), b.view()).unwrap();
        prop_assert_eq!(distance, path.as_ref().map(|path| path.cost));
        let path = path.map(|path| (path.cost, path.steps));
        prop_assert_eq!(path, naive::align(&a, &b, local, band.radius()));
    }

    #[test]
    fn a_wider_band_never_costs_more((a, b) in pair(), radius in 0_usize..6) {
        let distance = |band| Dtw::new(band).distance(a.view(), b.view()).unwrap();
        let narrow = distance(BandRadius::cells(radius));
        let wide = distance(BandRadius::cells(radius + 1));
        if let Some(narrow) = narrow {
            prop_assert!(wide.unwrap() <= narrow);
        }
    }

    #[test]
    fn a_path_starts_and_ends_at_the_corners_and_moves_by_its_steps((a, b) in pair()) {
        let Some(path) = Dtw::default().align(a.view(), b.view()).unwrap() else { return Ok(()) };
        prop_assert_eq!(path.steps[0], (0, 0));
        prop_assert_eq!(path.steps[path.steps.len() - 1], (a.nrows() - 1, b.nrows() - 1));
        for pair in path.steps.windows(2) {
            let step = (pair[1].0 - pair[0].0, pair[1].1 - pair[0].1);
            prop_assert!([(1, 1), (0, 1), (1, 0)].contains(&step));
        }
    }

    #[test]
    fn order_of_the_two_does_not_change_the_cost((a, b) in pair(), band in band()) {
        let dtw = Dtw::new(band).with_local_cost(LocalCost::Manhattan);
        let there = dtw.distance(a.view(), b.view()).unwrap();
        prop_assert_eq!(there, dtw.distance(b.view(), a.view()).unwrap());
    }
}
