use dtw::ndarray::Array2;
use dtw::{Band, BandRadius, Dtw, DtwError, Ends, Step, StepPattern};
use proptest::prelude::*;

use crate::search::{LOCALS, sequence};

fn dtw() -> impl Strategy<Value = Dtw> {
    let band = prop_oneof![
        Just(Band::Full),
        (0..4_usize).prop_map(|radius| Band::SakoeChiba(BandRadius::cells(radius))),
        (0..4_usize).prop_map(|radius| Band::Slanted(BandRadius::cells(radius))),
    ];
    let steps = prop_oneof![
        Just(StepPattern::classic()),
        Just(StepPattern::symmetric2()),
        Just(StepPattern::asymmetric()),
        Just(StepPattern::new([Step::new(1, 2, 1.0), Step::new(1, 1, 1.0)]).unwrap()),
        Just(StepPattern::new([Step::new(1, 0, 1.0), Step::new(0, 1, 2.0)]).unwrap()),
    ];
    let ends = prop::sample::select(vec![Ends::Closed, Ends::OpenBegin, Ends::Open]);
    let local = prop::sample::select(&LOCALS[..]);
    (band, steps, ends, local).prop_map(|(band, steps, ends, local)| {
        Dtw::new(band)
            .with_steps(steps)
            .with_ends(ends)
            .with_local_cost(local)
    })
}

proptest! {
    #[test]
    fn a_matrix_holds_every_distance(
        dtw in dtw(),
        series in (0..3_usize, prop::collection::vec(0..7_usize, 0..7)).prop_flat_map(|(dims, lens)| {
            lens.into_iter().map(|len| sequence(dims, len)).collect::<Vec<_>>()
        }),
    ) {
        let views: Vec<_> = series.iter().map(|frames| frames.view()).collect();
        let matrix = dtw.distance_matrix(&views).unwrap();
        prop_assert_eq!(matrix.dim(), (series.len(), series.len()));
        for ((i, j), cost) in matrix.indexed_iter() {
            prop_assert_eq!(*cost, dtw.distance(views[i], views[j]).unwrap());
        }
    }
}

#[test]
fn dimensions_of_all_must_agree() {
    let (two, three) = (Array2::<f64>::zeros((3, 2)), Array2::<f64>::zeros((3, 3)));
    let matrix = Dtw::default().distance_matrix(&[two.view(), three.view()]);
    assert_eq!(matrix, Err(DtwError::Dimensions { a: 2, b: 3 }));
}
