//! Distances from segments, heights and the smallest and largest of quantities against the twin.

use proptest::prelude::*;
use proptest::sample::select;
use relfeat::{FeatureSet, measure};

use crate::figure::{map, names};
use crate::naive::Clip;
use crate::naive::features2005::{Start, extreme};
use crate::twin::{manners, random_motion, with_gaps};

/// Relative to the largest coordinates, a hundred metres: the twin takes a cross product where the
/// library projects, and differences of squares cost half of the digits of an `f64`.
const NEAR: f64 = 1e-6;

#[derive(Clone, Debug)]
enum Asked {
    Segment {
        of: Vec<&'static str>,
        to: [&'static str; 2],
        radius: f64,
        start: Start,
    },
    Up {
        of: &'static str,
        from: &'static str,
    },
    Smallest(Vec<Asked>),
    Largest(Vec<Asked>),
}

impl Asked {
    fn toml(&self) -> String {
        let all = |parts: &[Asked]| parts.iter().map(Asked::toml).collect::<Vec<_>>().join(", ");
        match self {
            Asked::Segment {
                of,
                to,
                radius,
                start,
            } => {
                let flat = match start {
                    Start::Ball => "",
                    Start::Flat => ", flat_start = true",
                };
                format!(
                    "{{ kind = 'segment_distance', of = {of:?}, to = {to:?}, radius = {radius}{flat} }}"
                )
            }
            Asked::Up { of, from } => {
                format!("{{ kind = 'distance', of = '{of}', from = '{from}', along = 'up' }}")
            }
            Asked::Smallest(parts) => format!("{{ kind = 'smallest', of = [{}] }}", all(parts)),
            Asked::Largest(parts) => format!("{{ kind = 'largest', of = [{}] }}", all(parts)),
        }
    }

    /// `None` where rounding decides.
    fn value(&self, clip: &Clip, t: usize) -> Option<f64> {
        let all = |parts: &[Asked]| -> Option<Vec<f64>> {
            parts.iter().map(|part| part.value(clip, t)).collect()
        };
        match self {
            Asked::Segment {
                of,
                to,
                radius,
                start,
            } => {
                let [a, b] = to.map(|name| clip.at(name, 0));
                let length = (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt();
                let distances: Option<Vec<f64>> = of
                    .iter()
                    .map(|point| clip.segment_distance(t, point, *to, *start))
                    .collect();
                Some(extreme(&distances?, false) - radius * length)
            }
            Asked::Up { of, from } => {
                let (q, p) = (clip.at(of, t), clip.at(from, t));
                // A point is missing as a whole.
                Some(q[1] - p[1])
            }
            Asked::Smallest(parts) => Some(extreme(&all(parts)?, false)),
            Asked::Largest(parts) => Some(extreme(&all(parts)?, true)),
        }
    }
}

fn asked() -> impl Strategy<Value = Asked> {
    let name = || select(names());
    let start = select(vec![Start::Ball, Start::Flat]);
    let of = proptest::collection::vec(name(), 1..4);
    let radius = select(vec![0.0, 0.5, 3.0]);
    let segment =
        (of, [name(), name()], radius, start).prop_map(|(of, to, radius, start)| Asked::Segment {
            of,
            to,
            radius,
            start,
        });
    let up = (name(), name()).prop_map(|(of, from)| Asked::Up { of, from });
    prop_oneof![3 => segment, 1 => up].prop_recursive(2, 9, 3, |part| {
        let parts = proptest::collection::vec(part, 1..4);
        prop_oneof![
            parts.clone().prop_map(Asked::Smallest),
            parts.prop_map(Asked::Largest)
        ]
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, cases: 600, ..ProptestConfig::default() })]

    #[test]
    fn quantities_match_naive(
        asked in asked(),
        seed in any::<u64>(),
        manner in manners(),
        n_frames in 1usize..20,
        gaps in proptest::collection::vec((0usize..24, 0usize..20, 1usize..5), 0..4),
    ) {
        let positions = with_gaps(random_motion(seed, manner, n_frames, 30.0), &gaps);
        let set = FeatureSet::from_toml(&format!(
            "name = 't'\n[[feature]]\nname = 'x'\nset = 's'\nmirror = 'x'\nquantity = {}\nenter = '> 0 m'\nstay = '> 0 m'\n",
            asked.toml()
        )).unwrap();
        let found = measure(&set, 0, positions.view(), &map(), 30.0).unwrap().values;
        let clip = Clip::new(&positions, 30.0);
        prop_assert_eq!(found.len(), clip.n_frames());
        for (t, found) in found.into_iter().enumerate() {
            if let Some(expected) = asked.value(&clip, t) {
                let close = (found - expected).abs() <= NEAR * (1.0 + expected.abs());
                prop_assert!(close || found.is_nan() && expected.is_nan(), "frame {}: {} {}", t, found, expected);
            }
        }
    }
}
