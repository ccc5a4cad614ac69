use ndarray::Array2;
use proptest::prelude::*;

use super::*;
use crate::BandRadius;

/// Every kind of kernel that this processor can run, the one without vectors first.
fn kinds() -> Vec<Arch> {
    let mut kinds = vec![Arch::Scalar];
    #[cfg(target_arch = "x86_64")]
    {
        kinds.extend(pulp::x86::V3::try_new().map(Arch::V3));
        kinds.extend(pulp::x86::V4::try_new().map(Arch::V4));
    }
    kinds
}

fn sequence(dims: usize) -> impl Strategy<Value = Array2<f64>> {
    let sample = prop_oneof![
        20 => -2.0..2.0_f64,
        5 => (-1_i8..=1).prop_map(f64::from),
        1 => Just(f64::NAN),
    ];
    prop::collection::vec(sample, dims * 200).prop_flat_map(move |samples| {
        (0_usize..=200).prop_map(move |frames| {
            let samples = samples[..frames * dims].to_vec();
            Array2::from_shape_vec((frames, dims), samples).unwrap()
        })
    })
}

fn dtw() -> impl Strategy<Value = Dtw> {
    let locals = vec![
        LocalCost::Euclidean,
        LocalCost::SquaredEuclidean,
        LocalCost::Manhattan,
        LocalCost::Cosine,
    ];
    let steps = vec![
        StepPattern::classic(),
        StepPattern::symmetric2(),
        StepPattern::asymmetric(),
    ];
    let bands = prop_oneof![
        Just(Band::Full),
        (0_usize..200).prop_map(|radius| Band::Slanted(BandRadius::cells(radius))),
    ];
    let ends = vec![Ends::Closed, Ends::OpenBegin, Ends::OpenEnd, Ends::Open];
    (
        prop::sample::select(locals),
        prop::sample::select(steps),
        bands,
        prop::sample::select(ends),
    )
        .prop_map(|(local, steps, band, ends)| {
            Dtw::new(band)
                .with_local_cost(local)
                .with_steps(steps)
                .with_ends(ends)
        })
}

fn align_on<T: Sample>(
    arch: Arch,
    dtw: &Dtw,
    a: &Array2<T>,
    b: &Array2<T>,
) -> (Option<WarpingPath>, Option<f64>) {
    let shape = (a.nrows(), b.nrows());
    let pair = |height| Pair::new(dtw.local, (a.view(), b.view()), height);
    (
        dtw.run_on(arch, shape, pair, Path).unwrap(),
        dtw.run_on(arch, shape, pair, Distance { limit: None })
            .unwrap(),
    )
}

/// Of costs that are each summed in another order of roundings: (dims + 4) 2⁻²⁴ / (1/16) for five
/// dimensions, and one rounding more for each of some 400 sums.
const SINGLE_ERROR: f64 = 1e-4;

proptest! {
    #[test]
    fn kernels_agree(dtw in dtw(), (a, b) in (0_usize..=5).prop_flat_map(|d| (sequence(d), sequence(d)))) {
        let expected = align_on(Arch::Scalar, &dtw, &a, &b);
        prop_assert_eq!(expected.0.as_ref().map(|path| path.cost), expected.1);
        for arch in kinds() {
            prop_assert_eq!(&expected, &align_on(arch, &dtw, &a, &b), "{:?}", arch);
        }
        let (a, b) = (a.mapv(|x| x as f32), b.mapv(|x| x as f32));
        let expected = align_on(Arch::Scalar, &dtw, &a, &b).1;
        for arch in kinds() {
            let (path, cost) = align_on(arch, &dtw, &a, &b);
            prop_assert_eq!(path.map(|path| path.cost), cost);
            prop_assert_eq!(cost.is_some(), expected.is_some());
            if let (Some(cost), Some(expected)) = (cost, expected) {
                let error = SINGLE_ERROR * (1.0 + expected);
                prop_assert!((cost - expected).abs() <= error, "{} {} {:?}", cost, expected, arch);
            }
        }
    }
}

proptest! {
    #[test]
    fn end_costs_of_a_function_are_those_of_sequences(
        a in sequence(2), b in sequence(2), dtw in dtw(),
    ) {
        let local = |i, j| dtw.local.between(dtw.missing, a.row(i), b.row(j));
        let found = dtw.end_costs_with(a.nrows(), b.nrows(), local);
        prop_assert_eq!(found, dtw.end_costs(a.view(), b.view()));
    }
}
