//! Words as another performer's would be.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use segidx::{Segment, segment};

/// Share of copies that are cut somewhere and go on like another clip.
const SPLICED: f64 = 0.1;
/// Share of segments that are left out.
const DROPPED: f64 = 0.03;
/// Share of segments after which the last two come again. Half of [`DROPPED`], so that copies are about as
/// long as their originals.
const REPEATED: f64 = DROPPED / 2.0;
/// Share of frames at which a feature flips for a while.
const FLIPPED: f64 = 0.01;
/// Most frames a feature stays flipped.
const FLIP_FRAMES: usize = 6;
/// Bounds of the logarithm of how much slower a segment is performed.
const TEMPO: f64 = 0.3;

/// A copy of `words` that another performer might have made: segments last longer or shorter, some are left
/// out, some pairs come twice, features flip for a moment, and now and then the end is that of `other`.
///
/// Words have `n_features` bits. The same arguments give the same copy. Copies are as long as their originals
/// on average, to a few per cent.
#[must_use]
pub fn perform(words: &[u64], other: &[u64], n_features: usize, seed: u64) -> Vec<u64> {
    let mut dice = Dice::new(seed);
    let segments = spliced(&mut dice, segment(words), segment(other));
    let mut copy = Vec::with_capacity(words.len() + words.len() / 4);
    for (i, segment) in segments.iter().enumerate() {
        if !dice.happens(DROPPED) {
            hold(&mut dice, segment, &mut copy);
        }
        if dice.happens(REPEATED) {
            for segment in &segments[i.saturating_sub(1)..=i] {
                hold(&mut dice, segment, &mut copy);
            }
        }
    }
    flip(&mut dice, &mut copy, n_features);
    copy
}

/// The segments, now and then with the end of others from the same share of their length on.
fn spliced(dice: &mut Dice, mut segments: Vec<Segment>, others: Vec<Segment>) -> Vec<Segment> {
    if dice.happens(SPLICED) {
        let share = dice.unit();
        let at = |n: usize| (share * n as f64) as usize;
        segments.truncate(at(segments.len()));
        segments.extend(&others[at(others.len())..]);
    }
    segments
}

/// Appends the frames of a segment, more or fewer of them. Rounded by chance, lengths keep their mean, and
/// short segments sometimes vanish.
fn hold(dice: &mut Dice, segment: &Segment, copy: &mut Vec<u64>) {
    let factor = (TEMPO * (2.0 * dice.unit() - 1.0)).exp();
    let n_frames = (factor * segment.len as f64 + dice.unit()) as usize;
    copy.extend(std::iter::repeat_n(segment.word, n_frames));
}

fn flip(dice: &mut Dice, copy: &mut [u64], n_features: usize) {
    for frame in 0..copy.len() {
        if n_features > 0 && dice.happens(FLIPPED) {
            let bit = 1 << dice.below(n_features);
            let end = copy.len().min(frame + 1 + dice.below(FLIP_FRAMES));
            for word in &mut copy[frame..end] {
                *word ^= bit;
            }
        }
    }
}

/// A seeded stream of random numbers.
pub(super) struct Dice(ChaCha8Rng);

impl Dice {
    pub(super) fn new(seed: u64) -> Dice {
        Dice(ChaCha8Rng::seed_from_u64(seed))
    }

    /// Uniform in `[0, 1)`.
    fn unit(&mut self) -> f64 {
        // 32 bits are finer than any share here.
        f64::from(self.0.next_u32()) * (0.5_f64).powi(32)
    }

    fn happens(&mut self, share: f64) -> bool {
        self.unit() < share
    }

    /// Uniform below `n`, which is not 0.
    pub(super) fn below(&mut self, n: usize) -> usize {
        (self.unit() * n as f64) as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FEATURES: usize = 5;

    /// Clips of segments of 1 to 9 frames.
    fn clip(seed: u64, n_segments: usize) -> Vec<u64> {
        let mut dice = Dice::new(seed);
        let segments = (0..n_segments).flat_map(|i| {
            let word = (2 * dice.below(1 << (FEATURES - 1)) + i % 2) as u64;
            std::iter::repeat_n(word, 1 + dice.below(9))
        });
        segments.collect()
    }

    #[test]
    fn a_seed_is_a_performer() {
        let (words, other) = (clip(1, 40), clip(2, 40));
        let copy = |seed| perform(&words, &other, FEATURES, seed);
        assert_eq!(copy(7), copy(7));
        let copies: std::collections::BTreeSet<Vec<u64>> = (0..100).map(copy).collect();
        assert_eq!(copies.len(), 100);
        assert!(!copies.contains(&words));
    }

    #[test]
    fn copies_have_the_features_and_on_average_the_length_of_their_originals() {
        const COPIES: usize = 2_000;
        // The standard error of the mean length is below half a per cent; the mean tempo is 1.015.
        const TOLERANCE: f64 = 0.04;
        let (words, other) = (clip(1, 40), clip(2, 40));
        let mut n_frames = 0;
        for seed in 0..COPIES as u64 {
            let copy = perform(&words, &other, FEATURES, seed);
            assert!(copy.iter().all(|word| word >> FEATURES == 0));
            n_frames += copy.len();
        }
        let spliced = SPLICED * (other.len() as f64 - words.len() as f64) / 2.0;
        let expected = COPIES as f64 * (words.len() as f64 + spliced);
        let share = n_frames as f64 / expected;
        assert!((share - 1.0).abs() < TOLERANCE, "{share}");
    }

    #[test]
    fn segments_survive_and_do_not() {
        // Of a copy most but not all segments are those of the original, in number.
        let words = clip(1, 400);
        let n_segments = |words: &[u64]| segment(words).len() as f64;
        let share = n_segments(&perform(&words, &words, FEATURES, 3)) / n_segments(&words);
        assert!((0.5..2.0).contains(&share), "{share}");
        assert!(perform(&[], &[], FEATURES, 1).is_empty());
        assert!(perform(&[0; 50], &[], 0, 1).iter().all(|&word| word == 0));
    }
}
