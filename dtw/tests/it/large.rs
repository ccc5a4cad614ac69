//! Many frames, close frames, and what other programs are known to get wrong.

use dtw::ndarray::Array2;
use dtw::{Band, BandRadius, Dtw, Ends, LocalCost};
use proptest::prelude::*;

/// Smooth, and different at every frame.
fn curve(frames: usize, pace: f64) -> Array2<f32> {
    Array2::from_shape_fn((frames, 2), |(i, d)| {
        let t = i as f64 * pace;
        ((t * 0.01).sin() * 3.0 + (t * 0.037 + d as f64).cos()) as f32
    })
}

#[test]
fn a_hundred_thousand_frames_in_a_band() {
    let frames = 100_000;
    let (a, b) = (curve(frames, 1.0), curve(frames, 0.999_9));
    let dtw = Dtw::new(BandRadius::cells(40));
    let path = dtw.align(a.view(), b.view()).unwrap().unwrap();
    assert_eq!(dtw.distance(a.view(), b.view()).unwrap(), Some(path.cost));
    // Steps in two parts in three thousand of the memory that all of them take.
    let frugal = dtw.with_path_memory(2_000);
    assert_eq!(frugal.align(a.view(), b.view()).unwrap().unwrap(), path);
}

/// One motion at two speeds: the path keeps to the line between the corners, within the frames by
/// which rounding may move a frame's best partner.
#[test]
fn a_slower_copy_is_followed() {
    let (a, b) = (curve(300, 1.0), curve(597, 0.5));
    for band in [Band::Full, Band::Slanted(BandRadius::cells(5))] {
        let path = Dtw::new(band).align(a.view(), b.view()).unwrap().unwrap();
        for (i, j) in path.steps {
            assert!((2 * i).abs_diff(j) <= 4, "{i} is aligned with {j}");
        }
    }
}

#[test]
fn a_piece_is_found_where_it_was_cut() {
    let series = curve(500, 1.0);
    let piece = series.slice(dtw::ndarray::s![120..180, ..]);
    let dtw = Dtw::default().with_ends(Ends::Open);
    let path = dtw.align(piece, series.view()).unwrap().unwrap();
    assert_eq!(
        (path.cost, path.steps[0], path.steps[59]),
        (0.0, (0, 120), (59, 179))
    );
    let curve = dtw.end_costs(piece, series.view()).unwrap();
    assert_eq!(curve.iter().position(|&cost| cost == Some(0.0)), Some(179));
    assert_eq!(curve.len(), 500);
}

/// A limit that is the cost of the diagonal, where the diagonal is best, is not exceeded.
#[test]
fn the_diagonal_is_within_its_own_cost() {
    for frames in [1, 20, 60, 1000] {
        let a = Array2::from_shape_fn((frames, 3), |(i, d)| (i * i + d) as f64 * 0.1);
        let b = a.mapv(|x| x + 0.1);
        let diagonal = (0..frames).fold(0.0, |sum: f64, i| {
            let squared = (0..3).fold(0.0, |sum: f64, d| sum + (a[[i, d]] - b[[i, d]]).powi(2));
            sum + squared.sqrt()
        });
        let within = Dtw::default().distance_within(a.view(), b.view(), diagonal);
        let cost = within
            .unwrap()
            .expect("the diagonal costs no more than itself");
        assert!(cost <= diagonal);
        let same = Dtw::default().distance_within(a.view(), a.view(), 0.0);
        assert_eq!(same.unwrap(), Some(0.0));
    }
}

/// Limits are in the units of the cost that is asked for.
#[test]
fn limits_are_not_squared() {
    let (a, b) = (Array2::<f64>::zeros((4, 1)), Array2::from_elem((4, 1), 3.0));
    for (local, cost) in [
        (LocalCost::Euclidean, 12.0),
        (LocalCost::SquaredEuclidean, 36.0),
        (LocalCost::Manhattan, 12.0),
    ] {
        let dtw = Dtw::default().with_local_cost(local);
        let within = |limit| dtw.distance_within(a.view(), b.view(), limit).unwrap();
        assert_eq!(within(cost), Some(cost));
        assert_eq!(within(cost - 0.5), None);
    }
}

/// (dims + 4) 2⁻²¹ of each local cost, as stated, for 64 dimensions; and as many more roundings as
/// there are frames.
const CLOSE_ERROR: f64 = 68.0 / 2_097_152.0 + 40.0 / 16_777_216.0;

proptest! {
    /// Frames far from zero and from each other, and partners that are close to them.
    #[test]
    fn close_frames_keep_their_digits(
        seed in any::<u64>(),
        dims in 1_usize..=64,
        offset in prop::sample::select(vec![0.0_f64, 1.0, 1e3]),
        nearness in prop::sample::select(vec![1.0_f64, 1e-1, 1e-2, 1e-3, 0.0]),
    ) {
        let mut state = seed | 1;
        let mut uniform = || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let a = Array2::from_shape_simple_fn((40, dims), || (offset + uniform()) as f32);
        let b = a.mapv(|x| x + (nearness * uniform()) as f32);
        let (exact_a, exact_b) = (a.mapv(f64::from), b.mapv(f64::from));
        for local in [LocalCost::Euclidean, LocalCost::SquaredEuclidean, LocalCost::Manhattan] {
            let dtw = Dtw::new(BandRadius::cells(0)).with_local_cost(local);
            let cost = dtw.distance(a.view(), b.view()).unwrap().unwrap();
            let exact = dtw.distance(exact_a.view(), exact_b.view()).unwrap().unwrap();
            prop_assert!((cost - exact).abs() <= CLOSE_ERROR * exact, "{} is not {}", cost, exact);
        }
    }
}
