use bundles::ndarray::{Array2, Axis, array};
use bundles::{PAPER_SHARE, Pca, PcaError};
use proptest::prelude::*;

/// Of numbers about 1: the eigenvalue iteration and sums of a few dozen products.
const TOL: f64 = 1e-9;

/// Of deviations: the root of 1e-12 of the variance of 5 dimensions and 30 frames, which may be
/// missing even where all is kept.
const WHOLE_TOL: f64 = 1.3e-5;

/// Frames whose dimensions are correlated, constant, or far from zero.
fn frames() -> impl Strategy<Value = Array2<f64>> {
    (1_usize..6, 2_usize..30).prop_flat_map(|(dims, n_frames)| {
        let numbers = prop::collection::vec(-3.0..3.0_f64, n_frames * dims);
        let kinds = prop::collection::vec(0_usize..4, dims);
        (numbers, kinds).prop_map(move |(numbers, kinds)| {
            let mut frames = Array2::from_shape_vec((n_frames, dims), numbers).unwrap();
            for (dim, kind) in kinds.into_iter().enumerate() {
                let first = frames.column(0).to_owned();
                let mut column = frames.column_mut(dim);
                match kind {
                    0 => column.fill(0.1),
                    1 => column.mapv_inplace(|x| 1e4 + 10.0 * x),
                    2 => column.zip_mut_with(&first, |x, first| *x = 0.1 * *x - 2.0 * first),
                    _ => {}
                }
            }
            frames
        })
    })
}

/// Frames with mean 0 and variance 1 in each dimension that varies.
fn standardised(frames: &Array2<f64>, varying: &[usize]) -> Array2<f64> {
    let mut standard = frames.select(Axis(1), varying);
    for mut column in standard.columns_mut() {
        let n = column.len() as f64;
        let mean = column.sum() / n;
        let deviation = (column.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n).sqrt();
        column.mapv_inplace(|x| (x - mean) / deviation);
    }
    standard
}

proptest! {
    #[test]
    fn components_are_the_eigenvectors_of_the_correlations(frames in frames()) {
        let pca = Pca::fit(frames.view(), 1.0).unwrap();
        let varies = |dim: &usize| frames.column(*dim).iter().any(|x| *x != frames[[0, *dim]]);
        let varying: Vec<usize> = (0..frames.ncols()).filter(varies).collect();
        prop_assert_eq!(pca.varying_dims(), &varying[..]);
        let standard = standardised(&frames, &varying);
        for (i, component) in pca.components().outer_iter().enumerate() {
            for a in 0..varying.len() {
                let correlation = |b: usize| {
                    let products = standard.rows().into_iter().map(|row| row[a] * row[b]);
                    products.sum::<f64>() / frames.nrows() as f64
                };
                let image: f64 = (0..varying.len()).map(|b| correlation(b) * component[b]).sum();
                prop_assert!((image - pca.variances()[i] * component[a]).abs() <= TOL);
            }
            for (j, other) in pca.components().outer_iter().enumerate() {
                let expected = f64::from(u8::from(i == j));
                prop_assert!((component.dot(&other) - expected).abs() <= TOL);
            }
        }
        prop_assert!(pca.variances().windows(2).into_iter().all(|pair| pair[0] >= pair[1]));
    }

    #[test]
    fn as_few_components_as_the_share_needs(frames in frames(), share in 0.01..=1.0_f64) {
        let pca = Pca::fit(frames.view(), share).unwrap();
        prop_assert!(pca.share() >= share - TOL);
        let n_kept = pca.n_components();
        if n_kept > 0 {
            let fewer: f64 = pca.variances().iter().take(n_kept - 1).sum();
            prop_assert!(fewer < share * pca.variances().sum());
        }
        let projected = pca.project(frames.view()).unwrap();
        for (i, column) in projected.columns().into_iter().enumerate() {
            let squares = column.iter().map(|x| x * x).sum::<f64>() / frames.nrows() as f64;
            prop_assert!((squares - pca.variances()[i]).abs() <= TOL);
            prop_assert!(column.sum().abs() <= TOL * frames.nrows() as f64);
        }
    }

    #[test]
    fn what_is_kept_whole_comes_back(frames in frames()) {
        let pca = Pca::fit(frames.view(), 1.0).unwrap();
        let back = pca.reconstruct(pca.project(frames.view()).unwrap().view()).unwrap();
        for ((i, j), expected) in frames.indexed_iter() {
            let tolerance = WHOLE_TOL * frames.column(j).std(0.0) + TOL * (1.0 + expected.abs());
            prop_assert!((back[[i, j]] - expected).abs() <= tolerance);
        }
    }
}

#[test]
fn two_dimensions_by_hand() {
    // On a line: the correlation is 1.
    let frames = array![[10.0, -1.0], [30.0, 7.0], [20.0, 3.0], [20.0, 3.0]];
    let pca = Pca::fit(frames.view(), PAPER_SHARE).unwrap();
    assert_eq!(pca.n_components(), 1);
    assert!((pca.variances()[0] - 2.0).abs() < TOL);

    // Sums of products: 4 + 4 + 1 + 1 = 10 each and 2 + 2 + 2 + 2 = 8 between: correlation 0.8.
    let scatter = array![[2.0, 1.0], [-2.0, -1.0], [1.0, 2.0], [-1.0, -2.0]];
    let pca = Pca::fit((&scatter * 3.0 + 50.0).view(), 1.0).unwrap();
    assert!((pca.variances()[0] - 1.8).abs() < TOL && (pca.variances()[1] - 0.2).abs() < TOL);
    let half = 0.5_f64.sqrt();
    let expected = array![[half, half], [half, -half]];
    assert!(
        (&pca.components() - &expected)
            .iter()
            .all(|x| x.abs() < TOL)
    );
    let n_kept = |share| Pca::fit(scatter.view(), share).unwrap().n_components();
    assert_eq!([n_kept(0.89), n_kept(0.9), n_kept(0.91)], [1, 1, 2]);
    assert!((Pca::fit(scatter.view(), 0.5).unwrap().share() - 0.9).abs() < TOL);
    // Another clip, by the same components: (2, 0) standardised is (2, 0)/√2.5.
    let pca = Pca::fit(scatter.view(), 0.5).unwrap();
    let projected = pca.project(array![[2.0, 0.0]].view()).unwrap();
    assert!((projected[[0, 0]] - 2.0 / 2.5_f64.sqrt() * half).abs() < TOL);
}

#[test]
fn what_does_not_vary_is_left_out() {
    // A mean of 0.1s is not exactly 0.1, and a unit in the last place is no movement.
    let noisy = 7.3_f64.next_up();
    let frames = array![[0.1, 1.0, 7.3], [0.1, 2.0, noisy], [0.1, 4.0, 7.3]];
    let pca = Pca::fit(frames.view(), 0.7).unwrap();
    assert_eq!(pca.varying_dims(), [1]);
    assert_eq!((pca.dims(), pca.n_components()), (3, 1));
    assert!(pca.components() == array![[1.0]]);
    let pca = Pca::fit(frames.select(Axis(0), &[0, 0]).view(), 0.7).unwrap();
    assert_eq!((pca.n_components(), pca.share()), (0, 1.0));
    assert_eq!(pca.project(frames.view()).unwrap().dim(), (3, 0));
}

/// A joint that is fixed, as programs that solve for angles write it.
#[test]
fn rounding_around_zero_is_no_movement() {
    let noise = [-2.04e-14, 1.339e-14, -4.008e-14, 1.016e-14];
    let swing = [-31.0, 12.0, 40.0, -5.0];
    let frames = Array2::from_shape_fn((4, 2), |(i, j)| [noise, swing][j][i]);
    let pca = Pca::fit(frames.view(), PAPER_SHARE).unwrap();
    assert_eq!(pca.varying_dims(), [1]);
    // Alone, it is all there is.
    let pca = Pca::fit(frames.select(Axis(1), &[0]).view(), PAPER_SHARE).unwrap();
    assert_eq!(pca.varying_dims(), [0]);
}

#[test]
fn threads_change_nothing() {
    let shape = (20_000, 7);
    let frames = Array2::from_shape_fn(shape, |(i, j)| ((i * (j + 3)) as f64).sin() + i as f64);
    let on = |n_threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(n_threads)
            .build()
            .unwrap();
        pool.install(|| {
            let pca = Pca::fit(frames.view(), 0.9).unwrap();
            let projected = pca.project(frames.view()).unwrap();
            (pca, projected)
        })
    };
    assert_eq!(on(1), on(4));
}

#[test]
fn components_survive_storage_and_no_others_do() {
    let frames = array![[0.0, 1.0, 5.0], [2.0, 1.0, 4.0], [1.0, 1.0, 9.0]];
    let pca = Pca::fit(frames.view(), 0.9).unwrap();
    let bytes = postcard::to_stdvec(&pca).unwrap();
    assert_eq!(postcard::from_bytes::<Pca>(&bytes).unwrap(), pca);
    let stored = |varying: Vec<usize>, sigma: f64, components: Array2<f64>| {
        let parts = (varying, array![0.0], array![sigma], array![1.0], components);
        postcard::from_bytes::<Pca>(&postcard::to_stdvec(&parts).unwrap())
    };
    assert!(stored(vec![0], 1.0, array![[1.0]]).is_ok());
    assert!(stored(vec![1], 1.0, array![[1.0]]).is_err());
    assert!(stored(vec![0], 0.0, array![[1.0]]).is_err());
    assert!(stored(vec![0], 1.0, array![[1.0, 0.0]]).is_err());
    assert!(stored(vec![0], 1.0, array![[f64::NAN]]).is_err());
}

#[track_caller]
fn check<T: std::fmt::Debug>(result: Result<T, PcaError>, message: &str) {
    assert_eq!(result.unwrap_err().to_string(), message);
}

#[test]
fn each_error_says_what_was_expected_and_found() {
    let fit = |frames: Array2<f64>| Pca::fit(frames.view(), 0.7);
    check(
        fit(Array2::zeros((0, 2))),
        "expected at least one frame, found none",
    );
    check(
        fit(array![[0.0, 0.0], [f64::INFINITY, 0.0]]),
        "frame 1, dimension 0: expected a finite number, found inf",
    );
    check(
        fit(array![[0.0, 1e200], [1.0, 2e200]]),
        "dimension 1: expected a finite variance, found inf",
    );
    for share in [0.0, 1.1, f64::NAN] {
        let message =
            format!("expected a share of the variance above 0 and up to 1, found {share}");
        check(Pca::fit(array![[0.0]].view(), share), &message);
    }
    let pca = fit(array![[0.0, 1.0], [1.0, 0.5]]).unwrap();
    check(
        pca.project(array![[0.0]].view()),
        "expected frames of 2 dimensions, found 1",
    );
    check(
        pca.project(array![[0.0, f64::NAN]].view()),
        "frame 0, dimension 1: expected a finite number, found NaN",
    );
    check(
        pca.reconstruct(array![[0.0, 0.0]].view()),
        "expected frames of 1 dimensions, found 2",
    );
}
