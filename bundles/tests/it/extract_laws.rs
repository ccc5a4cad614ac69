use bundles::ndarray::Array2;
use bundles::{
    Accessibility, Closure, ExtractOptions, MotionString, Partition, SeedInstance, Substring,
    extend, extract, spell,
};
use proptest::prelude::*;

use crate::naive_extract::{Found, Naive};

/// Strings, clips and distances; few letters, so that much is similar.
#[derive(Debug, Clone)]
pub(crate) struct Case {
    pub(crate) string: MotionString,
    pub(crate) distances: Array2<f64>,
    pub(crate) tau: f64,
}

impl Case {
    pub(crate) fn access(&self) -> Accessibility {
        Accessibility::new(self.distances.view(), self.tau).unwrap()
    }
}

/// Frames of each run, by letter, clip by clip; whole distances, so that ties happen.
pub(crate) fn cases(
    n_clips: std::ops::Range<usize>,
    longest: usize,
) -> impl Strategy<Value = Case> {
    let n_letters = prop_oneof![Just(1_usize), 2_usize..6];
    n_letters.prop_flat_map(move |n_letters| {
        let run = (0..n_letters as u32, 1_usize..4);
        let clips = prop::collection::vec(prop::collection::vec(run, 0..longest), n_clips.clone());
        let distances = prop_oneof![
            prop::collection::vec((0_u8..6).prop_map(f64::from), n_letters * n_letters),
            prop::collection::vec(0.0..5.0, n_letters * n_letters),
        ];
        let tau = prop_oneof![Just(0.0), Just(2.0), Just(9.0), 0.5..4.0_f64];
        (clips, distances, tau).prop_map(move |(clips, raw, tau)| Case {
            string: string_of(&clips),
            distances: Array2::from_shape_fn((n_letters, n_letters), |(a, b)| {
                if a == b {
                    0.0
                } else {
                    raw[a.min(b) * n_letters + a.max(b)]
                }
            }),
            tau,
        })
    })
}

fn string_of(clips: &[Vec<(u32, usize)>]) -> MotionString {
    let (mut labels, mut spans) = (Vec::new(), Vec::new());
    for clip in clips {
        let start = labels.len();
        for &(label, length) in clip {
            labels.extend(std::iter::repeat_n(label, length));
        }
        spans.push(start..labels.len());
    }
    spell(&labels, &spans).unwrap()
}

pub(crate) fn options() -> impl Strategy<Value = ExtractOptions> {
    (
        2_usize..9,
        prop_oneof![Just(0.0), Just(1.0), Just(2.0), 0.0..3.0_f64],
        prop_oneof![Just(0.0), Just(0.5), Just(0.8), Just(1.0), 0.0..=1.0_f64],
        prop_oneof![Just(Closure::Transitive), Just(Closure::Direct)],
        prop_oneof![
            Just(SeedInstance::First),
            Just(SeedInstance::Largest),
            any::<u64>().prop_map(SeedInstance::Random)
        ],
    )
        .prop_map(|(max_letters, rho, gamma, closure, seed)| ExtractOptions {
            max_letters,
            rho,
            gamma,
            closure,
            seed,
        })
}

/// Every interval of every clip is in one substring; none is between clips.
#[track_caller]
fn assert_tiles(partition: &Partition, string: &MotionString) {
    let mut count = vec![0; string.len()];
    for substring in partition.substrings() {
        assert!(string.width(substring.first, substring.last).is_some());
        assert!(substring.first < substring.last);
        substring.intervals().for_each(|j| count[j] += 1);
    }
    let runs = string.runs();
    for (j, count) in count.into_iter().enumerate() {
        let is_within = runs
            .get(j + 1)
            .is_some_and(|next| next.clip == runs[j].clip);
        assert_eq!(count, usize::from(is_within));
    }
}

fn members(partition: &Partition) -> Vec<(usize, Substring)> {
    let bundles = partition.bundles.iter().enumerate();
    bundles
        .flat_map(|(id, b)| b.members.iter().map(move |&m| (id, m)))
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn partitions_equal_the_definition(case in cases(0..4, 9), options in options()) {
        let found = extract(&case.string, &case.access(), &options).unwrap();
        let expected = Naive::new(&case.string, &case.distances, case.tau, options).run();
        prop_assert_eq!(Found::from(&found), expected);
    }

    #[test]
    fn extensions_equal_the_definition(
        case in cases(0..5, 8),
        options in options(),
        n_old in 0_usize..4,
    ) {
        let n_old = n_old.min(case.string.n_clips());
        let old = first_clips(&case.string, n_old);
        let partition = extract(&old, &case.access(), &options).unwrap();
        let found = extend(&partition, &case.string, &case.access(), &options).unwrap();
        let mut naive = Naive::new(&case.string, &case.distances, case.tau, options);
        prop_assert_eq!(Found::from(&found), naive.extend(Found::from(&partition)));

        assert_tiles(&found, &case.string);
        for (id, member) in members(&partition) {
            prop_assert!(found.bundles[id].members.contains(&member));
        }
        for single in &partition.degenerate {
            prop_assert!(found.degenerate.contains(single));
        }
    }
}

/// The string of the first `n` clips alone.
fn first_clips(string: &MotionString, n: usize) -> MotionString {
    let clips: Vec<Vec<(u32, usize)>> = (0..n)
        .map(|clip| {
            let runs = &string.runs()[string.clip_span(clip).unwrap()];
            runs.iter()
                .map(|run| (run.letter.label(), run.frames.len()))
                .collect()
        })
        .collect();
    string_of(&clips)
}

proptest! {
    #[test]
    fn substrings_tile_each_clip(case in cases(0..6, 40), options in options()) {
        let partition = extract(&case.string, &case.access(), &options).unwrap();
        assert_tiles(&partition, &case.string);
        for bundle in &partition.bundles {
            prop_assert!(bundle.members.len() > 1);
            prop_assert!(bundle.members.is_sorted());
            for member in &bundle.members {
                prop_assert!(member.last - member.first < options.max_letters);
            }
        }
        for pair in partition.degenerate.windows(2) {
            prop_assert!(pair[0].last < pair[1].first);
        }
    }

    #[test]
    fn members_are_linked_by_near_paths(case in cases(0..4, 20), mut options in options()) {
        // Without the gamma test, which may remove the link between two others.
        options.gamma = 0.0;
        let partition = extract(&case.string, &case.access(), &options).unwrap();
        let mut naive = Naive::new(&case.string, &case.distances, case.tau, options);
        for bundle in &partition.bundles {
            let pairs: Vec<_> = bundle.members.iter().map(|m| (m.first, m.last)).collect();
            let (mut linked, mut rest) = (vec![pairs[0]], pairs[1..].to_vec());
            while let Some(member) = linked.pop() {
                let (near, far) = rest.into_iter().partition(|&o| naive.path(member, o).is_some());
                rest = far;
                linked.extend::<Vec<_>>(near);
            }
            prop_assert_eq!(rest, []);
        }
    }

    #[test]
    fn nothing_old_is_an_extraction(case in cases(0..4, 15), options in options()) {
        let access = case.access();
        let partition = extract(&case.string, &access, &options).unwrap();
        // Everything old stays as it is.
        prop_assert_eq!(
            extend(&partition, &case.string, &access, &options).unwrap(),
            partition
        );
    }
}
