use dtw::ndarray::{Array2, ArrayView2, s};
use dtw::{Band, BandRadius, Dtw, Ends, LocalCost, Missing, Sample, Search};
use proptest::prelude::*;

use crate::naive::{self, Rules};
use crate::naive_search::{choose, windows, z_normalised};

pub(crate) const LOCALS: [LocalCost; 4] = [
    LocalCost::Euclidean,
    LocalCost::SquaredEuclidean,
    LocalCost::Manhattan,
    LocalCost::Cosine,
];

/// What a series looks like.
#[derive(Debug, Clone, Copy)]
enum Kind {
    /// Whole numbers, so that many windows cost the same.
    Steps,
    Noise,
    Walk,
    /// Small deviations from a large number, of which single precision keeps little.
    Offset,
    Tiny,
    /// Squares are below and above what the samples' type holds.
    Extreme,
    Constant,
}

const KINDS: [Kind; 7] = [
    Kind::Steps,
    Kind::Noise,
    Kind::Walk,
    Kind::Offset,
    Kind::Tiny,
    Kind::Extreme,
    Kind::Constant,
];

/// Samples of one dimension from steps between -1 and 1.
fn samples(kind: Kind, steps: &[f64]) -> Vec<f64> {
    let mut sum = 0.0;
    let walk = |step: &f64| {
        sum += step;
        sum
    };
    match kind {
        Kind::Steps => steps.iter().map(|x| (x * 1.4).round()).collect(),
        Kind::Noise => steps.to_vec(),
        Kind::Walk => steps.iter().map(walk).collect(),
        Kind::Offset => steps.iter().map(walk).map(|x| 1e6 + 1e-3 * x).collect(),
        Kind::Tiny => steps.iter().map(|x| x * 1e-20).collect(),
        Kind::Extreme => steps
            .iter()
            .map(|x| x.signum() * (1e30 * x.abs()).powf(2.0 * x))
            .collect(),
        Kind::Constant => steps.iter().map(|_| 0.1).collect(),
    }
}

pub(crate) fn sequence(dims: usize, frames: usize) -> impl Strategy<Value = Array2<f64>> {
    let kinds = prop::collection::vec(prop::sample::select(&KINDS[..]), dims);
    let steps = prop::collection::vec(-1.0..1.0_f64, frames * dims);
    let gaps = prop::collection::vec((0..frames.max(1), 0..dims.max(1)), 0..3);
    (kinds, steps, prop::option::weighted(0.2, gaps)).prop_map(move |(kinds, steps, gaps)| {
        let mut sequence = Array2::zeros((frames, dims));
        for (d, kind) in kinds.into_iter().enumerate() {
            let samples = samples(kind, &steps[d * frames..(d + 1) * frames]);
            sequence.column_mut(d).assign(
                &ArrayView2::from_shape((1, frames), &samples)
                    .unwrap()
                    .row(0),
            );
        }
        for (frame, d) in gaps.into_iter().flatten() {
            if let Some(sample) = sequence.get_mut((frame, d)) {
                *sample = if frame % 4 == 0 {
                    f64::INFINITY
                } else {
                    f64::NAN
                };
            }
        }
        sequence
    })
}

#[derive(Debug, Clone)]
struct Case {
    query: Array2<f64>,
    series: Array2<f64>,
    search: Search,
    local: LocalCost,
    radius: BandRadius,
    is_normalised: bool,
    k: usize,
    exclusion: usize,
}

impl Case {
    fn prepared<T: Sample>(&self, frames: ArrayView2<'_, T>) -> Array2<T> {
        if self.is_normalised {
            z_normalised(frames)
        } else {
            frames.to_owned()
        }
    }

    /// The cost by [`Dtw`].
    fn distance<T: Sample>(&self, query: &Array2<T>, other: ArrayView2<'_, T>) -> Option<f64> {
        let dtw = Dtw::new(self.radius).with_local_cost(self.local);
        let (query, other) = (self.prepared(query.view()), self.prepared(other));
        dtw.distance(query.view(), other.view()).unwrap()
    }

    /// The cost by the textbook.
    fn naive(&self, other: ArrayView2<'_, f64>) -> Option<f64> {
        let rules = Rules {
            band: Band::SakoeChiba(self.radius),
            steps: dtw::StepPattern::classic().steps().to_vec(),
            ends: Ends::Closed,
        };
        let (query, other) = (self.prepared(self.query.view()), self.prepared(other));
        let costs = naive::costs(self.local, Missing::Closes, &query, &other);
        Some(naive::align(&costs, &rules)?.0)
    }

    fn found<T: Sample>(&self, query: &Array2<T>, series: &Array2<T>) -> Vec<(usize, f64)> {
        let found = self
            .search
            .best_windows(query.view(), series.view(), self.k, self.exclusion);
        let found = found.unwrap().into_iter();
        found.map(|window| (window.start, window.cost)).collect()
    }
}

fn case(
    query: std::ops::Range<usize>,
    series: std::ops::Range<usize>,
) -> impl Strategy<Value = Case> {
    (0..4_usize, query, series)
        .prop_flat_map(|(dims, n, len)| {
            let radius = prop_oneof![0..4_usize, 0..2 * n + 2, Just(usize::MAX)];
            (
                sequence(dims, n),
                sequence(dims, len),
                (0..len.max(1), prop::bool::ANY),
                prop::sample::select(&LOCALS[..]),
                radius,
                prop::bool::ANY,
                prop_oneof![4 => 0..4_usize, 1 => 0..2 * len + 2],
                prop_oneof![2 => 0..3_usize, 1 => 0..2 * n + 2],
            )
        })
        .prop_map(
            |(query, series, cut, local, radius, is_normalised, k, exclusion)| {
                let (start, is_part) = cut;
                let end = (start + query.nrows()).min(series.nrows());
                let query = if is_part && start <= end {
                    series.slice(s![start..end, ..]).to_owned()
                } else {
                    query
                };
                let radius = BandRadius::cells(radius);
                let search = Search::new(radius).with_local_cost(local);
                let search = if is_normalised {
                    search.z_normalised()
                } else {
                    search
                };
                Case {
                    query,
                    series,
                    search,
                    local,
                    radius,
                    is_normalised,
                    k,
                    exclusion,
                }
            },
        )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1_000))]

    #[test]
    fn windows_are_those_of_the_textbook(case in case(0..9, 0..50)) {
        prop_assume!(case.local != LocalCost::Cosine);
        let costs = windows(case.query.nrows(), &case.series, |window| case.naive(window));
        let expected = choose(costs, case.k, case.exclusion);
        prop_assert_eq!(case.found(&case.query, &case.series), expected);
    }

    #[test]
    fn windows_are_those_of_every_distance(case in case(0..9, 0..50)) {
        let costs = windows(case.query.nrows(), &case.series, |window| case.distance(&case.query, window));
        let expected = choose(costs, case.k, case.exclusion);
        prop_assert_eq!(case.found(&case.query, &case.series), expected);
    }

    #[test]
    fn windows_of_single_precision_are_exact_too(case in case(0..9, 0..50)) {
        let (query, series) = (case.query.mapv(|x| x as f32), case.series.mapv(|x| x as f32));
        let costs = windows(query.nrows(), &series, |window| case.distance(&query, window));
        let expected = choose(costs, case.k, case.exclusion);
        prop_assert_eq!(case.found(&query, &series), expected);
    }
}

/// Sequences of different lengths, some of them twice.
fn candidates() -> impl Strategy<Value = (Case, Vec<Array2<f64>>)> {
    let lens = prop::collection::vec(0..9_usize, 0..30);
    (case(0..9, 0..1), lens).prop_flat_map(|(case, lens)| {
        let dims = case.query.ncols();
        let candidates: Vec<_> = lens.into_iter().map(|len| sequence(dims, len)).collect();
        (Just(case), candidates).prop_map(|(case, mut candidates)| {
            let again = candidates.iter().take(3).cloned().collect::<Vec<_>>();
            candidates.extend(again);
            candidates.push(case.query.clone());
            (case, candidates)
        })
    })
}

fn nearest<T: Sample>(
    case: &Case,
    query: &Array2<T>,
    candidates: &[Array2<T>],
) -> Vec<(usize, f64)> {
    let views: Vec<_> = candidates.iter().map(|frames| frames.view()).collect();
    let found = case.search.nearest(query.view(), &views, case.k).unwrap();
    found
        .into_iter()
        .map(|found| (found.index, found.cost))
        .collect()
}

fn chosen<T: Sample>(
    case: &Case,
    candidates: &[Array2<T>],
    cost: impl Fn(ArrayView2<'_, T>) -> Option<f64>,
) -> Vec<(usize, f64)> {
    let costs = candidates.iter().enumerate();
    let costs = costs.filter_map(|(index, frames)| Some((cost(frames.view())?, index)));
    choose(costs.collect(), case.k, 0)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1_000))]

    #[test]
    fn neighbours_are_those_of_the_textbook((case, candidates) in candidates()) {
        prop_assume!(case.local != LocalCost::Cosine);
        let expected = chosen(&case, &candidates, |frames| case.naive(frames));
        prop_assert_eq!(nearest(&case, &case.query, &candidates), expected);
    }

    #[test]
    fn neighbours_are_those_of_every_distance((case, candidates) in candidates()) {
        let expected = chosen(&case, &candidates, |frames| case.distance(&case.query, frames));
        prop_assert_eq!(nearest(&case, &case.query, &candidates), expected);
    }

    #[test]
    fn neighbours_of_single_precision_are_exact_too((case, candidates) in candidates()) {
        let query = case.query.mapv(|x| x as f32);
        let candidates: Vec<_> = candidates.iter().map(|frames| frames.mapv(|x| x as f32)).collect();
        let expected = chosen(&case, &candidates, |frames| case.distance(&query, frames));
        prop_assert_eq!(nearest(&case, &query, &candidates), expected);
    }
}

proptest! {
    // Each is a search over more than one block of windows.
    #![proptest_config(ProptestConfig::with_cases(150))]

    #[test]
    fn long_series_are_searched_exactly(case in case(1..40, 300..1_400)) {
        let costs = windows(case.query.nrows(), &case.series, |window| case.distance(&case.query, window));
        let expected = choose(costs, case.k, case.exclusion);
        prop_assert_eq!(case.found(&case.query, &case.series), expected);
    }

    #[test]
    fn long_series_of_single_precision_are_searched_exactly(case in case(1..40, 300..1_400)) {
        let (query, series) = (case.query.mapv(|x| x as f32), case.series.mapv(|x| x as f32));
        let costs = windows(query.nrows(), &series, |window| case.distance(&query, window));
        let expected = choose(costs, case.k, case.exclusion);
        prop_assert_eq!(case.found(&query, &series), expected);
    }
}
