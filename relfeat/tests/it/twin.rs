//! `extract` against the textbook twin, bit by bit.

use proptest::prelude::*;
use proptest::sample::select;
use relfeat::ndarray::Array3;
use relfeat::{FeatureSet, extract};

use crate::figure::{STANDING, map, motion};
use crate::naive::{Clip, kept_frames};

/// States of a feature by its bit.
type Twin = fn(&Clip, usize) -> Vec<Option<bool>>;

/// Built-in sets with their number of features and twin.
const TWINS: [(&str, usize, Twin); 3] = [
    ("mueller2006", 39, |clip, bit| clip.states(bit + 1)),
    ("mueller2005", 31, Clip::states2005),
    ("mueller2005-text", 31, Clip::states2005_text),
];

/// A point that is missing from a frame on, for some frames.
pub(crate) type Gap = (usize, usize, usize);

pub(crate) fn with_gaps(mut positions: Array3<f32>, gaps: &[Gap]) -> Array3<f32> {
    let n_frames = positions.dim().0;
    for &(point, first, length) in gaps {
        for frame in first..(first + length).min(n_frames) {
            for axis in 0..3 {
                positions[[frame, point, axis]] = f32::NAN;
            }
        }
    }
    positions
}

pub(crate) fn manners() -> impl Strategy<Value = Manner> {
    use Manner as M;
    select(vec![
        M::Smooth,
        M::Smooth,
        M::Rough,
        M::Frozen,
        M::Sinking,
        M::Collapsing,
    ])
}

/// How a random motion goes.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Manner {
    Smooth,
    Rough,
    Frozen,
    /// Slowly down to the floor and up again.
    Sinking,
    /// In every other frame some points coincide, so that directions vanish.
    Collapsing,
}

/// A small generator (Knuth's MMIX constants): the motions need many numbers and no shrinking.
struct Dice(u64);

impl Dice {
    fn next(&mut self) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        self.0 >> 33
    }

    /// From -1 to 1.
    fn signed(&mut self) -> f32 {
        self.next() as f32 / (1u64 << 30) as f32 - 1.0
    }
}

pub(crate) fn random_motion(seed: u64, manner: Manner, n_frames: usize, rate: f64) -> Array3<f32> {
    let mut dice = Dice(seed.wrapping_mul(2).wrapping_add(1));
    for _ in 0..8 {
        dice.next();
    }
    // A figure somewhere near the standing one, each point on a wave of its own.
    let scale = 10f32.powi((dice.next() % 4) as i32 - 1);
    let reach = [0.05, 0.3, 1.0][(dice.next() % 3) as usize];
    let mut waves = Vec::new();
    for at in STANDING {
        let start = at.map(|v| v + reach * dice.signed());
        let swing = at.map(|_| reach * dice.signed());
        let (hz, phase) = (3.0 * dice.signed(), 3.0 * dice.signed());
        waves.push((start, swing, hz, phase));
    }
    let mut point = 0;
    motion(n_frames, |frame, _, _| {
        let (start, swing, hz, phase) = waves[point % 24];
        point += 1;
        let seconds = frame as f32 / rate as f32;
        let at = match manner {
            Manner::Smooth => [0, 1, 2].map(|i| {
                start[i]
                    + swing[i] * (phase + hz * std::f32::consts::TAU * seconds + i as f32).sin()
            }),
            Manner::Rough => start.map(|v| v + reach * dice.signed()),
            Manner::Frozen => start,
            Manner::Sinking => [
                start[0],
                start[1] * (0.7 + 0.5 * (scale + 3.0 * seconds).sin()),
                start[2],
            ],
            Manner::Collapsing if dice.next().is_multiple_of(4) => start.map(|v| v.trunc()),
            Manner::Collapsing => start,
        };
        at.map(|v| scale * v)
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn words_match_naive(
        seed in any::<u64>(),
        manner in manners(),
        n_frames in prop_oneof![0usize..5, 5usize..40, 100usize..150],
        rate in select(vec![24.0, 30.0, 60.0, 100.0, 119.88, 120.0, 240.0]),
        library_rate in select(vec![10.0, 24.0, 30.0, 120.0]),
    ) {
        let positions = random_motion(seed, manner, n_frames, rate);
        for twin in TWINS {
            check_words(&positions, rate, library_rate, twin)?;
        }
    }

    #[test]
    fn words_with_missing_points_match_naive(
        seed in any::<u64>(),
        manner in manners(),
        n_frames in prop_oneof![1usize..3, 20usize..60],
        rate in select(vec![30.0, 100.0, 120.0]),
        gaps in proptest::collection::vec((0usize..24, 0usize..60, 1usize..8), 1..5),
    ) {
        let positions = with_gaps(random_motion(seed, manner, n_frames, rate), &gaps);
        for twin in &TWINS[1..] {
            check_words(&positions, rate, rate, *twin)?;
        }
    }
}

fn check_words(
    positions: &Array3<f32>,
    rate: f64,
    library_rate: f64,
    (name, n_features, twin): (&str, usize, Twin),
) -> Result<(), TestCaseError> {
    let set = FeatureSet::builtin(name).unwrap();
    let found = extract(&set, positions.view(), &map(), rate, library_rate).unwrap();
    prop_assert_eq!(&found.unavailable, &vec![]);
    prop_assert_eq!(set.features().len(), n_features);
    let clip = Clip::new(positions, rate);
    let kept = kept_frames(positions.dim().0, rate, library_rate);
    prop_assert_eq!(found.words.len(), kept.len());
    for bit in 0..n_features {
        let states = twin(&clip, bit);
        for (word, &frame) in found.words.iter().zip(&kept) {
            if let Some(on) = states[frame] {
                prop_assert_eq!(
                    word >> bit & 1 == 1,
                    on,
                    "{}: {} in frame {}",
                    name,
                    set.features()[bit].name,
                    frame
                );
            }
        }
    }
    Ok(())
}

/// The comparison above means little if rounding decides too often, or no feature is ever on.
#[test]
fn random_motions_turn_every_feature_on_and_off() {
    for (name, n_features, twin) in TWINS {
        let mut seen = vec![[0usize; 3]; n_features];
        for seed in 0..60 {
            let manner = if seed % 2 == 0 {
                Manner::Smooth
            } else {
                Manner::Rough
            };
            let clip = Clip::new(&random_motion(seed, manner, 100, 60.0), 60.0);
            for (bit, seen) in seen.iter_mut().enumerate() {
                for state in twin(&clip, bit) {
                    seen[state.map_or(2, usize::from)] += 1;
                }
            }
        }
        for (bit, [off, on, unknown]) in seen.into_iter().enumerate() {
            assert!(off > 0 && on > 0, "{name}, bit {bit}: {off} off, {on} on");
            assert!(
                unknown * 100 < off + on,
                "{name}, bit {bit}: {unknown} unknown"
            );
        }
    }
}
