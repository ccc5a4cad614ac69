use dtw::ndarray::{Array2, array};
use dtw::{Band, BandRadius, Dtw, DtwError};

#[track_caller]
fn check(band: impl Into<Band>, a: &[f64], b: &[f64], expected: Option<f64>) {
    let column = |samples: &[f64]| Array2::from_shape_vec((samples.len(), 1), samples.to_vec());
    let (a, b) = (column(a).unwrap(), column(b).unwrap());
    let dtw = Dtw::new(band);
    assert_eq!(dtw.distance(a.view(), b.view()).unwrap(), expected);
    assert_eq!(
        dtw.align(a.view(), b.view()).unwrap().map(|path| path.cost),
        expected
    );
}

#[test]
fn nothing_aligns_with_nothing() {
    check(Band::Full, &[], &[], None);
    check(Band::Full, &[1.0], &[], None);
    check(BandRadius::cells(0), &[], &[1.0], None);
}

#[test]
fn one_frame_aligns_with_all() {
    check(Band::Full, &[1.0], &[3.0], Some(2.0));
    check(Band::Full, &[1.0], &[3.0, 1.0, 0.0], Some(3.0));
}

#[test]
fn a_band_that_misses_the_end_has_no_path() {
    check(BandRadius::cells(1), &[0.0], &[0.0, 0.0], Some(0.0));
    check(BandRadius::cells(1), &[0.0], &[0.0, 0.0, 0.0], None);
    check(BandRadius::cells(0), &[0.0, 1.0], &[1.0, 1.0], Some(1.0));
    check(BandRadius::cells(0), &[0.0, 1.0], &[1.0], None);
}

#[test]
fn a_frame_that_is_no_number_aligns_with_nothing() {
    check(Band::Full, &[0.0, f64::NAN, 0.0], &[0.0, 0.0, 0.0], None);
    check(Band::Full, &[0.0, f64::INFINITY], &[0.0], None);
}

#[test]
fn a_closed_cell_is_walked_around() {
    let cost = |i, j| if (i, j) == (1, 1) { f64::NAN } else { 1.0 };
    let path = Dtw::default().align_with(3, 3, cost).unwrap().unwrap();
    assert_eq!(path.steps, [(0, 0), (1, 0), (2, 1), (2, 2)]);
    assert_eq!(path.cost, 4.0);
    let path = Dtw::new(BandRadius::cells(0))
        .align_with(3, 3, cost)
        .unwrap();
    assert_eq!(path, None);
}

#[test]
fn ties_go_diagonally_then_along_the_second() {
    let path = Dtw::default()
        .align_with(2, 2, |_, _| 0.0)
        .unwrap()
        .unwrap();
    assert_eq!(path.steps, [(0, 0), (1, 1)]);
    // Around the dear middle, (0,1) and (1,0) into the last cell are both free.
    let around = |i, j| if (i, j) == (1, 1) { 5.0 } else { 0.0 };
    let path = Dtw::default().align_with(3, 3, around).unwrap().unwrap();
    assert_eq!(path.steps, [(0, 0), (1, 0), (2, 1), (2, 2)]);
}

#[test]
fn costs_may_be_negative() {
    assert_eq!(
        Dtw::default().distance_with(2, 2, |_, _| -1.0).unwrap(),
        Some(-3.0)
    );
}

#[test]
fn single_precision_is_read_exactly() {
    let (a, b) = (array![[0.1_f32, 2.0]], array![[0.1_f32, 5.0]]);
    assert_eq!(
        Dtw::default().distance(a.view(), b.view()).unwrap(),
        Some(3.0)
    );
}

#[test]
fn dimensions_must_agree() {
    let (a, b) = (Array2::<f64>::zeros((2, 3)), Array2::zeros((2, 4)));
    let error = Dtw::default().distance(a.view(), b.view()).unwrap_err();
    assert_eq!(error, DtwError::Dimensions { a: 3, b: 4 });
    assert_eq!(
        error.to_string(),
        "expected sequences of equal dimension, found 3 and 4"
    );
    assert_eq!(Dtw::default().align(a.view(), b.view()).unwrap_err(), error);
}

#[test]
fn more_cells_than_memory_is_an_error() {
    let huge = usize::MAX / 2;
    let error = Dtw::default()
        .align_with(huge, huge, |_, _| 0.0)
        .unwrap_err();
    assert_eq!(
        error,
        DtwError::TooLarge {
            rows: huge,
            columns: huge
        }
    );
    let error = Dtw::default()
        .distance_with(1, huge, |_, _| 0.0)
        .unwrap_err();
    assert_eq!(
        error,
        DtwError::TooLarge {
            rows: 1,
            columns: huge
        }
    );
}
