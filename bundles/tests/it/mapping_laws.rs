use bundles::ndarray::{Array1, Array2, Axis};
use bundles::{
    ExtractOptions, FrameMapping, MappingOptions, MotionString, Partition, extract, map_frames,
};
use proptest::prelude::*;

use crate::extract_laws::{Case, cases, options};

/// Sums and means of up to a few hundred numbers below 100 in another order.
const ROUNDING: f64 = 1e-9;

#[derive(Debug, Clone)]
pub(crate) struct Mapped {
    pub(crate) case: Case,
    pub(crate) partition: Partition,
    pub(crate) extraction: ExtractOptions,
    poses: Array2<f64>,
    options: MappingOptions,
}

pub(crate) fn mapped() -> impl Strategy<Value = Mapped> {
    let weight = prop_oneof![Just(0.0), Just(1.0), 0.0..20.0_f64];
    let mapping = (weight, any::<u64>(), 0_usize..4);
    (cases(0..4, 25), options(), mapping).prop_flat_map(|(case, options, mapping)| {
        let n_frames = n_frames(&case.string);
        let poses = prop_oneof![
            prop::collection::vec((-3_i8..4).prop_map(f64::from), n_frames * 4),
            prop::collection::vec(-9.0..9.0_f64, n_frames * 4),
        ];
        poses.prop_map(move |poses| Mapped {
            partition: extract(&case.string, &case.access(), &options).unwrap(),
            extraction: options,
            case: case.clone(),
            poses: Array2::from_shape_vec((n_frames, 4), poses)
                .unwrap()
                .slice_move(bundles::ndarray::s![.., ..mapping.2]),
            options: MappingOptions {
                duration_weight: mapping.0,
                seed: mapping.1,
                ..MappingOptions::default()
            },
        })
    })
}

fn n_frames(string: &MotionString) -> usize {
    string.runs().last().map_or(0, |run| run.frames.end)
}

/// Equation 6 by covariance matrices and two-pass variances.
fn objective(mapped: &Mapped, frame: &dyn Fn(usize) -> usize) -> f64 {
    let mut total = 0.0;
    for bundle in &mapped.partition.bundles {
        let of = |end: &dyn Fn(&bundles::Substring) -> usize| -> Vec<usize> {
            bundle
                .members
                .iter()
                .map(|member| frame(end(member)))
                .collect()
        };
        let (firsts, lasts) = (of(&|m| m.first), of(&|m| m.last));
        for frames in [&firsts, &lasts] {
            let poses = mapped.poses.select(Axis(0), frames);
            let mean = poses.mean_axis(Axis(0)).unwrap_or_else(|| Array1::zeros(0));
            let centred = &poses - &mean;
            let covariance = centred.t().dot(&centred) / frames.len() as f64;
            total += covariance.diag().sum();
        }
        let durations = firsts
            .iter()
            .zip(&lasts)
            .map(|(first, last)| (last - first) as f64);
        let durations: Array1<f64> = durations.collect();
        total += mapped.options.duration_weight * durations.var(0.0);
    }
    total
}

fn at(mapping: &FrameMapping) -> impl Fn(usize) -> usize {
    |position| mapping.frame(position).unwrap()
}

impl Mapped {
    pub(crate) fn run(&self, max_sweeps: usize) -> FrameMapping {
        let options = MappingOptions {
            max_sweeps,
            ..self.options.clone()
        };
        map_frames(
            &self.case.string,
            &self.partition,
            self.poses.view(),
            &options,
        )
        .unwrap()
    }
}

proptest! {
    #[test]
    fn no_sweep_makes_it_worse(mapped in mapped()) {
        let mut before = f64::INFINITY;
        for sweeps in 0..6 {
            let mapping = mapped.run(sweeps);
            let value = objective(&mapped, &at(&mapping));
            prop_assert!(value <= before + ROUNDING, "{value} after {before}");
            before = value;
        }
    }

    #[test]
    fn no_single_frame_can_be_better(mapped in mapped()) {
        let mapping = mapped.run(10_000);
        let value = objective(&mapped, &at(&mapping));
        for (position, run) in mapped.case.string.runs().iter().enumerate() {
            if mapping.frame(position).is_none() {
                continue;
            }
            for other in run.frames.clone() {
                let moved = |j: usize| if j == position { other } else { at(&mapping)(j) };
                let found = objective(&mapped, &moved);
                prop_assert!(found >= value - ROUNDING, "{found} at {position}, {value}");
            }
        }
    }

    #[test]
    fn frames_are_of_their_letters_and_increase(mapped in mapped(), sweeps in 0_usize..5) {
        let mapping = mapped.run(sweeps);
        let string = &mapped.case.string;
        let mut is_boundary = vec![false; string.len()];
        for substring in mapped.partition.substrings() {
            is_boundary[substring.first] = true;
            is_boundary[substring.last] = true;
        }
        let mut previous: Option<usize> = None;
        for (position, run) in string.runs().iter().enumerate() {
            prop_assert_eq!(mapping.frame(position).is_some(), is_boundary[position]);
            if let Some(frame) = mapping.frame(position) {
                prop_assert!(run.frames.contains(&frame));
                prop_assert!(previous.is_none_or(|previous| previous < frame));
                previous = Some(frame);
            }
        }
        prop_assert_eq!(mapping.frame(string.len()), None);
    }

    #[test]
    fn what_is_fixed_stays(mapped in mapped(), sweeps in 0_usize..3) {
        // Frames of no sweep at all are the means; fixed, they stay whatever the poses are.
        let fixed = mapped.run(sweeps);
        let options = MappingOptions { fixed: fixed.clone(), ..mapped.options.clone() };
        let poses = mapped.poses.mapv(|x| -x * x);
        let again = map_frames(&mapped.case.string, &mapped.partition, poses.view(), &options);
        prop_assert_eq!(again.unwrap(), fixed);
    }
}
