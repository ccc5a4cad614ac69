use dtw::ndarray::Array2;
use dtw::{Band, BandRadius, Dtw, Ends, LocalCost, Missing, Slope, Step, StepPattern};
use proptest::prelude::*;

use crate::naive::{self, Rules};

const LOCALS: [LocalCost; 4] = [
    LocalCost::Euclidean,
    LocalCost::SquaredEuclidean,
    LocalCost::Manhattan,
    LocalCost::Cosine,
];

/// Dimensions of [`pair`] at most.
const MAX_DIMS: usize = 5;

/// A cosine is subtracted from one, so its error is that of numbers near one, whatever is left.
const COSINE_ERROR: f64 = 1e-14;

/// Small whole numbers make ties common; a NaN closes cells.
fn sample() -> impl Strategy<Value = f64> {
    prop_oneof![
        20 => (-2_i8..=2).prop_map(f64::from),
        8 => -1.0..1.0_f64,
        1 => Just(f64::NAN),
    ]
}

/// Mostly few frames; sometimes more than a strip's rows and a block's columns.
fn sequence(dims: usize) -> impl Strategy<Value = Array2<f64>> {
    prop_oneof![4 => 0_usize..=6, 1 => 7_usize..=150].prop_flat_map(move |frames| {
        prop::collection::vec(sample(), frames * dims)
            .prop_map(move |samples| Array2::from_shape_vec((frames, dims), samples).unwrap())
    })
}

fn pair() -> impl Strategy<Value = (Array2<f64>, Array2<f64>)> {
    (0..=MAX_DIMS).prop_flat_map(|dims| (sequence(dims), sequence(dims)))
}

fn band(n: usize, m: usize) -> impl Strategy<Value = Band> {
    let radius = || prop_oneof![0_usize..8, 0_usize..150].prop_map(BandRadius::cells);
    let slope = prop::sample::select(vec![1.0, 1.5, 2.0, 3.0, 10.0]);
    let row = (0..m + 2, 0..m + 2).prop_map(|(a, b)| a.min(b)..a.max(b) + 1);
    prop_oneof![
        Just(Band::Full),
        radius().prop_map(Band::SakoeChiba),
        radius().prop_map(Band::Slanted),
        slope.prop_map(|slope| Band::Itakura(Slope::at_most(slope).unwrap())),
        prop::collection::vec(row, n).prop_map(Band::Rows),
    ]
}

fn steps() -> impl Strategy<Value = StepPattern> {
    let step = (
        0_usize..4,
        0_usize..4,
        prop::sample::select(vec![0.0, 0.5, 1.0, 2.0]),
    )
        .prop_filter("advances", |(rows, columns, _)| rows + columns > 0)
        .prop_map(|(rows, columns, weight)| Step::new(rows, columns, weight));
    let unit = |weights: [f64; 3]| {
        let [a, b, c] = weights;
        let steps = [Step::new(1, 1, a), Step::new(0, 1, b), Step::new(1, 0, c)];
        StepPattern::new(steps).unwrap()
    };
    let weight = || prop::sample::select(vec![0.0, 0.5, 1.0, 3.0]);
    prop_oneof![
        2 => Just(StepPattern::classic()),
        1 => Just(StepPattern::symmetric2()),
        1 => Just(StepPattern::asymmetric()),
        1 => Just(StepPattern::slope_limited([1.0, 1.0, 2.0]).unwrap()),
        1 => Just(StepPattern::slope_limited([1.0, 1.0, 1.0]).unwrap()),
        1 => [weight(), weight(), weight()].prop_map(unit),
        1 => prop::collection::vec(step, 1..6).prop_map(|steps| StepPattern::new(steps).unwrap()),
    ]
}

fn ends() -> impl Strategy<Value = Ends> {
    prop::sample::select(vec![
        Ends::Closed,
        Ends::OpenBegin,
        Ends::OpenEnd,
        Ends::Open,
    ])
}

/// Two sequences and everything that can be said about their warping.
#[derive(Debug, Clone)]
struct Case {
    a: Array2<f64>,
    b: Array2<f64>,
    local: LocalCost,
    missing: Missing,
    band: Band,
    steps: StepPattern,
    ends: Ends,
}

impl Case {
    fn dtw(&self) -> Dtw {
        Dtw::new(self.band.clone())
            .with_local_cost(self.local)
            .with_missing(self.missing)
            .with_steps(self.steps.clone())
            .with_ends(self.ends)
    }

    fn rules(&self) -> Rules {
        Rules {
            band: self.band.clone(),
            steps: self.steps.steps().to_vec(),
            ends: self.ends,
        }
    }

    fn costs(&self) -> Array2<f64> {
        naive::costs(self.local, self.missing, &self.a, &self.b)
    }
}

fn case() -> impl Strategy<Value = Case> {
    pair().prop_flat_map(|(a, b)| {
        let band = band(a.nrows(), b.nrows());
        let local = prop::sample::select(&LOCALS[..]);
        let missing = prop::sample::select(vec![Missing::Closes, Missing::LeftOut]);
        (local, missing, band, steps(), ends()).prop_map(
            move |(local, missing, band, steps, ends)| Case {
                a: a.clone(),
                b: b.clone(),
                local,
                missing,
                band,
                steps,
                ends,
            },
        )
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    #[test]
    fn double_precision_is_the_textbook_to_the_last_bit(case in case()) {
        prop_assume!(case.local != LocalCost::Cosine);
        let (a, b) = (case.a.view(), case.b.view());
        let path = case.dtw().align(a, b).unwrap();
        let distance = case.dtw().distance(a, b).unwrap();
        prop_assert_eq!(distance, path.as_ref().map(|path| path.cost));
        let path = path.map(|path| (path.cost, path.steps));
        prop_assert_eq!(path, naive::align(&case.costs(), &case.rules()));
    }

    #[test]
    fn a_cosine_is_one_within_rounding(case in case()) {
        let case = Case { local: LocalCost::Cosine, ..case };
        let path = case.dtw().align(case.a.view(), case.b.view()).unwrap();
        let best = naive::align(&case.costs(), &case.rules());
        prop_assert_eq!(path.is_some(), best.is_some());
        if let (Some(path), Some((cost, _))) = (path, best) {
            let error = COSINE_ERROR * 8.0 * path.steps.len() as f64;
            prop_assert!((path.cost - cost).abs() <= error, "{} is not {}", path.cost, cost);
            let along = naive::cost_of(&case.costs(), &case.rules(), &path.steps).unwrap();
            prop_assert!((path.cost - along).abs() <= error, "{} is not {}", path.cost, along);
        }
    }

    #[test]
    fn a_matrix_and_a_function_are_the_same_as_sequences(case in case()) {
        let costs = case.costs();
        let (n, m) = costs.dim();
        let path = case.dtw().align_of(costs.view()).unwrap();
        prop_assert_eq!(&path, &case.dtw().align_with(n, m, |i, j| costs[[i, j]]).unwrap());
        let cost = path.as_ref().map(|path| path.cost);
        prop_assert_eq!(cost, case.dtw().distance_of(costs.view()).unwrap());
        prop_assert_eq!(cost, case.dtw().distance_with(n, m, |i, j| costs[[i, j]]).unwrap());
        let best = naive::align(&costs, &case.rules());
        prop_assert_eq!(path.map(|path| (path.cost, path.steps)), best);
    }

    #[test]
    fn single_precision_is_near(case in case()) {
        let single = |frames: &Array2<f64>| frames.mapv(|x| x as f32);
        let (a, b) = (single(&case.a), single(&case.b));
        let double = |frames: &Array2<f32>| frames.mapv(f64::from);
        let case = Case { a: double(&a), b: double(&b), ..case };
        let path = case.dtw().align(a.view(), b.view()).unwrap();
        let distance = case.dtw().distance(a.view(), b.view()).unwrap();
        prop_assert_eq!(distance, path.as_ref().map(|path| path.cost));
        let best = naive::align(&case.costs(), &case.rules());
        prop_assert_eq!(path.is_some(), best.is_some());
        if let (Some(path), Some((cost, _))) = (path, best) {
            let error = single_error(path.steps.len(), cost);
            prop_assert!((path.cost - cost).abs() <= error, "{} is not {}", path.cost, cost);
            let along = naive::cost_of(&case.costs(), &case.rules(), &path.steps).unwrap();
            prop_assert!((path.cost - along).abs() <= error, "{} is not {}", path.cost, along);
        }
    }

    #[test]
    fn a_limit_changes_nothing_below_it(case in case(), share in 0.0..2.0_f64) {
        let (a, b) = (case.a.view(), case.b.view());
        let distance = case.dtw().distance(a, b).unwrap();
        let within = |limit| case.dtw().distance_within(a, b, limit).unwrap();
        prop_assert_eq!(within(f64::INFINITY), distance);
        if let Some(cost) = distance {
            prop_assert_eq!(within(cost), distance, "a limit is allowed to be reached");
            let limit = cost * share;
            prop_assert_eq!(within(limit), distance.filter(|&cost| cost <= limit));
            prop_assert_eq!(within(cost.next_down()), None);
        }
    }

    #[test]
    fn memory_does_not_change_the_path(case in case(), bytes in 0_u64..4_000) {
        let (a, b) = (case.a.view(), case.b.view());
        let path = case.dtw().align(a, b).unwrap();
        prop_assert_eq!(path, case.dtw().with_path_memory(bytes).align(a, b).unwrap());
    }

    #[test]
    fn a_wider_band_never_costs_more(case in case(), radius in 0_usize..80) {
        let (a, b) = (case.a.view(), case.b.view());
        let shapes: [fn(BandRadius) -> Band; 2] = [Band::SakoeChiba, Band::Slanted];
        for shape in shapes {
            let distance = |radius| {
                let case = Case { band: shape(BandRadius::cells(radius)), ..case.clone() };
                case.dtw().distance(a, b).unwrap()
            };
            if let Some(narrow) = distance(radius) {
                prop_assert!(distance(radius + 1).unwrap() <= narrow);
            }
        }
    }

    #[test]
    fn order_of_the_two_does_not_change_the_cost(case in case()) {
        let band = match case.band {
            Band::Slanted(radius) => Band::SakoeChiba(radius),
            Band::Rows(_) => Band::Full,
            other => other,
        };
        let case = Case { band, ends: Ends::Closed, ..case };
        for steps in [StepPattern::classic(), StepPattern::symmetric2()] {
            let dtw = case.dtw().with_steps(steps);
            let there = dtw.distance(case.a.view(), case.b.view()).unwrap();
            prop_assert_eq!(there, dtw.distance(case.b.view(), case.a.view()).unwrap());
        }
    }

    #[test]
    fn bands_are_what_they_say(
        (n, m, band) in (0_usize..40, 0_usize..40)
            .prop_flat_map(|(n, m)| (Just(n), Just(m), band(n, m)))
    ) {
        let mut cells = 0;
        for i in 0..n {
            let columns = band.columns(i, (n, m));
            cells += columns.len() as u64;
            for j in 0..m {
                prop_assert_eq!(columns.contains(&j), naive::is_inside(&band, (i, j), (n, m)));
            }
        }
        prop_assert_eq!(band.cells(n, m), cells);
    }

    #[test]
    fn a_slanted_band_always_has_a_path((n, m) in (1_usize..60, 1_usize..60), radius in 0_usize..3) {
        let dtw = Dtw::new(Band::Slanted(BandRadius::cells(radius)));
        prop_assert!(dtw.distance_with(n, m, |_, _| 0.0).unwrap().is_some());
    }
}

/// Of a sum of so many costs with a relative error of (dims + 4) 2⁻²⁴ / (1/16) each, cosines near
/// one another being uncertain by as much of one, times at most three for weights.
fn single_error(n_pairs: usize, cost: f64) -> f64 {
    let each = (MAX_DIMS + 4) as f64 * f64::from(f32::EPSILON) / 2.0 * 16.0;
    let sums = n_pairs as f64 * f64::from(f32::EPSILON);
    (each + sums) * cost + 3.0 * n_pairs as f64 * f64::from(f32::EPSILON)
}
