use ndarray::{Array2, ArrayView2, s};
use proptest::prelude::*;

use super::Search;
use super::best::Best;
use super::bounds::{Cascade, Scratch};
use super::envelope::Envelope;
use super::margin::Norm;
use super::query::{Query, points_of};
use super::windows::Windows;
use crate::{BandRadius, Dtw, LocalCost, Sample};

const LOCALS: [LocalCost; 4] = [
    LocalCost::Euclidean,
    LocalCost::SquaredEuclidean,
    LocalCost::Manhattan,
    LocalCost::Cosine,
];

/// What margins may take from a bound of samples and deviations near one: far more than rounding, far less than
/// what a wrong bound would be off by.
const NEARLY: f64 = 1e-9;

fn sequence(
    dims: usize,
    frames: impl Into<prop::collection::SizeRange>,
) -> impl Strategy<Value = Array2<f64>> {
    let sample = prop_oneof![-1.0..1.0_f64, (-1_i8..=1).prop_map(f64::from)];
    prop::collection::vec(prop::collection::vec(sample, dims), frames).prop_map(move |frames| {
        let shape = (frames.len(), dims);
        Array2::from_shape_vec(shape, frames.concat()).unwrap()
    })
}

fn search() -> impl Strategy<Value = Search> {
    let local = prop::sample::select(&LOCALS[..]);
    (local, 0..6_usize, prop::bool::ANY).prop_map(|(local, radius, is_normalised)| {
        let search = Search::new(BandRadius::cells(radius)).with_local_cost(local);
        if is_normalised {
            search.z_normalised()
        } else {
            search
        }
    })
}

/// Such windows lose nothing to the margin that would hide a wrong bound.
fn has_no_small_deviation(frames: ArrayView2<'_, f64>) -> bool {
    frames.columns().into_iter().all(|samples| {
        let deviation = samples.std(0.0);
        deviation == 0.0 || deviation > 0.1
    })
}

fn distance<T: Sample>(search: &Search, a: ArrayView2<'_, T>, b: ArrayView2<'_, T>) -> Option<f64> {
    let dtw = Dtw::new(search.radius).with_local_cost(search.local);
    let (a, b) = (search.normalised(a), search.normalised(b));
    dtw.distance(a.view(), b.view()).unwrap()
}

/// Every bound of a pair, the strongest last; `None` without a path.
fn bounds<T: Sample>(
    search: &Search,
    a: ArrayView2<'_, T>,
    b: ArrayView2<'_, T>,
) -> Option<Vec<f64>> {
    let query = Query::new(search, a, b.nrows())?;
    let frames = search.normalised(b);
    let mut scratch = Scratch::default();
    let whole = query.bound_within(frames.view(), f64::INFINITY, &mut scratch)?;
    points_of(search.local, frames.view(), &mut scratch.points);
    let margin = query.margin(b.nrows());
    let mut cascade = Cascade {
        query: &query,
        m: b.nrows(),
        margin,
        limit: f64::INFINITY,
        scratch: &mut scratch,
    };
    let ends = cascade.ends();
    let by_query = ends + cascade.by_query();
    let by_candidate = ends + cascade.by_candidate();
    let mut sums = vec![ends, by_query, by_candidate];
    if margin.norm != Norm::Root || query.dims == 1 {
        cascade.by_query();
        sums.push(by_query + cascade.by_projection());
    }
    let mut bounds: Vec<f64> = sums.into_iter().map(|sum| cascade.bound(sum)).collect();
    assert_eq!(
        bounds.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        whole
    );
    let points = scratch.points;
    let warped = query.costs_but_for_rounding(b.nrows(), &[&points], f64::INFINITY);
    bounds.extend(warped[0]);
    Some(bounds)
}

fn check_pair<T: Sample>(
    search: &Search,
    a: &Array2<T>,
    b: &Array2<T>,
) -> Result<(), TestCaseError> {
    let cost = distance(search, a.view(), b.view());
    let Some(bounds) = bounds(search, a.view(), b.view()) else {
        prop_assert_eq!(cost, None);
        return Ok(());
    };
    let cost = cost.expect("what is bounded has a path");
    for bound in &bounds {
        prop_assert!(*bound <= cost, "{:?} of {}", bounds, cost);
    }
    if size_of::<T>() == size_of::<f64>() {
        let warped = bounds[bounds.len() - 1];
        prop_assert!(
            warped >= cost - NEARLY * (1.0 + cost),
            "{} of {}",
            warped,
            cost
        );
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    #[test]
    fn no_bound_is_above_the_distance(
        (a, b) in (0..4_usize).prop_flat_map(|dims| (sequence(dims, 0..14), sequence(dims, 0..14))),
        search in search(),
        scale in prop::sample::select(vec![1.0, 1e-25, 1e15]),
    ) {
        let (a, b) = (a * scale, b * scale);
        if scale == 1.0 {
            check_pair(&search, &a, &b)?;
        }
        check_pair(&search, &a.mapv(|x| x as f32), &b.mapv(|x| x as f32))?;
    }

    #[test]
    fn envelopes_are_extremes(
        points in prop::collection::vec(-9_i8..9, 1..40),
        len in 1..50_usize,
        radius in prop_oneof![0..8_usize, 0..60_usize, Just(usize::MAX)],
    ) {
        let points: Vec<f64> = points.into_iter().map(f64::from).collect();
        let mut envelope = Envelope::default();
        envelope.set(&points, points.len(), len, radius);
        for j in 0..len {
            let near = || (0..points.len()).filter(|i| i.abs_diff(j) <= radius).map(|i| points[i]);
            prop_assert_eq!(envelope.lower[j], near().fold(f64::INFINITY, f64::min));
            prop_assert_eq!(envelope.upper[j], near().fold(f64::NEG_INFINITY, f64::max));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// The bounds of windows side by side are those of each window, but for a larger margin.
    #[test]
    fn windows_side_by_side_are_windows(
        (query, series) in (1..4_usize)
            .prop_flat_map(|dims| (sequence(dims, 1..20), sequence(dims, 20..200))),
        search in search(),
        offset in prop::sample::select(vec![0.0, 1e3, 1e9]),
    ) {
        let (query, series) = (query + offset, series + offset);
        let n = query.nrows();
        let Some(ready) = Query::new(&search, query.view(), n) else {
            return Ok(());
        };
        let windows = Windows::new(&ready, series.view());
        let found = windows.by_envelope(&windows.by_ends(), f64::INFINITY);
        let starts: Vec<usize> = found.iter().map(|&(_, start)| start).collect();
        let window = |start| series.slice(s![start..start + n, ..]);
        let costs = (0..=series.nrows() - n).map(|start| distance(&search, query.view(), window(start)));
        let costs: Vec<Option<f64>> = costs.collect();
        let has_path = |start: &usize| costs[*start].is_some();
        if !(search.is_z_normalised() && search.local == LocalCost::Cosine) {
            let expected: Vec<usize> = (0..costs.len()).filter(has_path).collect();
            prop_assert_eq!(starts, expected);
        }
        for (bound, start) in found {
            let Some(cost) = costs[start] else { continue };
            prop_assert!(bound <= cost, "{} of {}", bound, cost);
            if offset == 0.0 && has_no_small_deviation(window(start)) && search.local != LocalCost::Cosine {
                let alone = bounds(&search, query.view(), window(start)).unwrap()[1];
                let error = (bound - alone).abs();
                prop_assert!(error <= NEARLY * (1.0 + alone), "{} for {}", bound, alone);
            }
        }
    }

    #[test]
    fn the_limit_is_never_below_the_last_choice(
        costs in prop::collection::vec(0_u8..20, 1..60),
        order in prop::collection::vec(0_usize..1_000, 60),
        (k, exclusion) in (1_usize..6, 0_usize..8),
    ) {
        let mut found: Vec<_> = costs.iter().map(|&cost| f64::from(cost)).zip(0..).collect();
        let mut all = Best::new(k, exclusion);
        all.extend(found.clone());
        let chosen = all.into_chosen();
        found.sort_by_key(|&(_, start)| order[start]);
        let mut best = Best::new(k, exclusion);
        for one in found {
            best.extend([one]);
            if let Some(last) = chosen.get(k - 1) {
                prop_assert!(best.limit() >= last.0);
            }
        }
        prop_assert_eq!(best.into_chosen(), chosen);
    }
}
