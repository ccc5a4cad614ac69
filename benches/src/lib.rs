//! Seeded data for the benches, from the built-in corpus.
//!
//! Nothing here is timed: benches make their data first.

#![cfg_attr(test, allow(clippy::unwrap_used))]

use cli::corpus::{Clip, Recording, plan};
use mocap_io::{AngleUnit, Asf, Motion, forward_kinematics};
use relfeat::{BodyMap, FeatureSet, extract};
use segidx::{Index, IndexBuilder};

pub mod scale;
pub mod stopwatch;
pub mod strings;

/// Words per second.
pub const RATE: f64 = 30.0;

/// The feature set of all benches.
///
/// # Panics
/// Never: the set is built in.
#[must_use]
pub fn features() -> FeatureSet {
    FeatureSet::builtin("mueller2006").expect("a built-in set")
}

/// The first long take of the corpus: about 30 s at 120 Hz, with an Acclaim skeleton.
///
/// # Panics
/// If the corpus has no takes.
#[must_use]
pub fn take() -> Clip {
    let recordings = plan();
    let take = recordings.iter().find(|r| r.class().is_none());
    clip(take.expect("the corpus has takes"), 1)
}

fn clip(recording: &Recording, seed: u64) -> Clip {
    recording.clip(seed).expect("the corpus is consistent")
}

/// A skeleton file's content for a motion.
#[must_use]
pub fn skeleton_of(motion: &Motion) -> Asf {
    Asf {
        name: "bench".to_owned(),
        skeleton: motion.skeleton.clone(),
        unit: motion.unit,
        angle_unit: AngleUnit::Degrees,
        warnings: Vec::new(),
    }
}

/// The words of a motion.
///
/// # Panics
/// If the corpus's skeleton is not recognised.
#[must_use]
pub fn words(motion: &Motion, set: &FeatureSet) -> Vec<u64> {
    let names: Vec<&str> = motion.skeleton.names().collect();
    let map = BodyMap::recognise(&names).expect("an Acclaim skeleton");
    let positions = forward_kinematics(motion);
    extract(set, positions.view(), &map, motion.rate.hz(), RATE)
        .expect("positions of the same skeleton")
        .words
}

/// The words of `n_clips` clips: the corpus again and again, with another seed each time.
///
/// # Panics
/// Never on the built-in corpus.
#[must_use]
pub fn documents(n_clips: usize) -> Vec<Vec<u64>> {
    let set = features();
    let recordings = plan();
    let all = (0..).flat_map(|seed| recordings.iter().map(move |r| (r, seed)));
    all.take(n_clips)
        .map(|(r, seed)| words(&clip(r, seed).motion, &set))
        .collect()
}

/// An index of these documents.
///
/// # Panics
/// If they are too many for one index.
#[must_use]
pub fn index(documents: &[Vec<u64>]) -> Index {
    let mut builder = IndexBuilder::new();
    for (i, words) in documents.iter().enumerate() {
        builder
            .push(i.to_string(), [], words)
            .expect("few documents");
    }
    builder.build()
}
