//! `motif search --features auto`: features are left out, one by one, until there are enough hits
//! (2005 paper, section 6.2, "hierarchical approach").
//!
//! The feature goes that has the briefest detail, that is the run of equal bits that is the shortest among
//! all runs of the compared features in the example: what lasts a tenth of a second in one performance is
//! seldom there in the next. Features that do not change in the example go last. Of features with equally
//! brief details that one goes without which the inverted lists promise the most hits: segment ℓ of the
//! query accepts a share p_ℓ of all segments of the library, and if segments were independent, there would
//! be about n · Π p_ℓ hits. Of equals the one of the highest number goes.
//!
//! Measured on 72 HDM05 clips of 11 classes against HDM05 and CMU, until there are 20 hits: of the ten best
//! hits in other clips 57 % are of the example's class; with the promise of the lists alone it is 46 %.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use segidx::segment;
use serde::Serialize;

use super::example::Example;
use crate::failure::Failure;
use crate::library::Library;
use crate::selection;

/// A step on the way to fewer features.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TrailStep {
    /// The feature left out in this step; none in the first one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dropped: Option<String>,
    /// Features still compared.
    pub n_features: usize,
    /// Segments of the query.
    pub n_segments: usize,
    /// Hits with these features.
    pub n_hits: usize,
}

/// How often each word occurs in a library.
pub(super) struct Lists {
    /// Words by increasing value, with numbers of segments.
    lengths: Vec<(u64, usize)>,
}

impl Lists {
    pub(super) fn of(library: &Library) -> Result<Lists, Failure> {
        let mut all: BTreeMap<u64, usize> = BTreeMap::new();
        for open in library.shards() {
            let lengths = open.shard.list_lengths();
            for (word, n) in lengths.map_err(|e| Failure::input(&open.path, e))? {
                *all.entry(word).or_default() += n;
            }
        }
        Ok(Lists {
            lengths: all.into_iter().collect(),
        })
    }

    /// The feature of `care` to leave out next. `None` if any would leave a query of a single segment,
    /// which is everywhere.
    ///
    /// Cost: O(words · segments of the query).
    fn next(&self, words: &[u64], care: u64) -> Option<u32> {
        let queried: Vec<u64> = words.iter().map(|word| word & care).collect();
        let positions: Vec<u64> = segment(&queried).iter().map(|s| s.word).collect();
        let accepted: Vec<[f64; 64]> = positions.iter().map(|&p| self.accepted(p, care)).collect();
        let compared = (0..u64::BITS).filter(|bit| care >> bit & 1 == 1);
        let candidates = compared.filter_map(|bit| {
            let mut n_left = 0;
            let mut promise = 0.0;
            let mut last = None;
            for (position, accepted) in positions.iter().zip(&accepted) {
                // Neighbours that differ in this feature alone become one position.
                let masked = position & !(1 << bit);
                if last.replace(masked) != Some(masked) {
                    n_left += 1;
                    promise += accepted[bit as usize].ln();
                }
            }
            (n_left > 1).then(|| (Reverse(briefest(&queried, bit)), promise, bit))
        });
        let last = |a: &(Reverse<usize>, f64, u32), b: &(Reverse<usize>, f64, u32)| {
            a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2))
        };
        candidates.max_by(last).map(|(.., bit)| bit)
    }

    /// Per feature the share of segments that agree with `position` on `care` without this feature.
    fn accepted(&self, position: u64, care: u64) -> [f64; 64] {
        let mut agreeing = 0;
        let mut differing = [0; 64];
        let mut n_segments = 0;
        for &(word, n) in &self.lengths {
            n_segments += n;
            let differs = (word ^ position) & care;
            match differs.count_ones() {
                0 => agreeing += n,
                1 => differing[differs.trailing_zeros() as usize] += n,
                _ => {}
            }
        }
        // An example that is not in the library has positions that no segment has: half a segment
        // keeps them comparable.
        let share = |n: usize| (n as f64).max(0.5) / n_segments.max(1) as f64;
        differing.map(|n| share(agreeing + n))
    }
}

/// Length of the shortest run of equal bits; without a change in the bit longer than any.
fn briefest(words: &[u64], bit: u32) -> usize {
    let runs = words.chunk_by(|a, b| (a ^ b) >> bit & 1 == 0);
    let lengths: Vec<usize> = runs.map(<[u64]>::len).collect();
    match lengths[..] {
        [] | [_] => usize::MAX,
        _ => lengths.into_iter().min().unwrap_or(usize::MAX),
    }
}

/// Leaves features of the example out until there are `enough` hits, or none can go.
///
/// # Errors
/// Those of `n_hits`, which counts the hits of an example.
pub(super) fn relax(
    mut example: Example,
    library: &Library,
    enough: usize,
    n_hits: impl Fn(&Example) -> Result<usize, Failure>,
) -> Result<(Example, Vec<TrailStep>), Failure> {
    let lists = Lists::of(library)?;
    let mut trail: Vec<TrailStep> = Vec::new();
    let mut dropped = None;
    loop {
        let words = &example.clip.words;
        let queried: Vec<u64> = words.iter().map(|word| word & example.care).collect();
        let step = TrailStep {
            dropped,
            n_features: example.care.count_ones() as usize,
            n_segments: segment(&queried).len(),
            n_hits: n_hits(&example)?,
        };
        let is_enough = step.n_hits >= enough;
        trail.push(step);
        let next = if is_enough {
            None
        } else {
            lists.next(&example.clip.words, example.care)
        };
        let Some(bit) = next else {
            return Ok((example, trail));
        };
        dropped = selection::names(&library.features.set, 1 << bit).pop();
        example.care &= !(1 << bit);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lists(lengths: &[(u64, usize)]) -> Lists {
        Lists {
            lengths: lengths.to_vec(),
        }
    }

    #[test]
    fn the_feature_with_the_briefest_detail_goes_first() {
        let lists = lists(&[(0b00, 1), (0b01, 1), (0b10, 1), (0b11, 1), (0b111, 1)]);
        // Bit 1 is on for one word, bit 0 never for less than two, bit 2 always.
        let words = [0b100, 0b100, 0b101, 0b101, 0b111, 0b101];
        assert_eq!(lists.next(&words, 0b111), Some(1));
        assert_eq!(lists.next(&words, 0b101), Some(2));
    }

    #[test]
    fn of_equally_brief_features_that_goes_which_is_rarest_in_the_lists() {
        // Both bits change at the same time and are mostly on.
        let words = [0b11, 0b11, 0b00, 0b00, 0b11, 0b11];
        let few_of_1 = lists(&[(0b00, 40), (0b01, 40), (0b10, 10), (0b11, 10)]);
        assert_eq!(few_of_1.next(&words, 0b11), Some(1));
        let few_of_0 = lists(&[(0b00, 40), (0b01, 10), (0b10, 40), (0b11, 10)]);
        assert_eq!(few_of_0.next(&words, 0b11), Some(0));
    }

    #[test]
    fn what_would_leave_a_single_segment_stays() {
        let lists = lists(&[(0b00, 1), (0b01, 1)]);
        assert_eq!(lists.next(&[0b00, 0b01], 0b01), None);
        assert_eq!(lists.next(&[0b00, 0b01], 0b11), Some(1));
        assert_eq!(lists.next(&[], 0b11), None);
    }

    #[test]
    fn shares_are_those_of_the_lists_counted_one_by_one() {
        let lists = lists(&[(0, 3), (1, 5), (2, 7), (3, 11), (6, 13)]);
        for care in 0..8 {
            for position in 0..8u64 {
                let accepted = lists.accepted(position & care, care);
                for bit in (0..3usize).filter(|bit| care >> bit & 1 == 1) {
                    let rest = care & !(1 << bit);
                    let agree = lists.lengths.iter();
                    let n: usize = agree
                        .filter(|(word, _)| (word ^ position) & rest == 0)
                        .map(|(_, n)| n)
                        .sum();
                    let share = (n as f64).max(0.5) / 39.0;
                    assert_eq!(accepted[bit], share, "{care} {position} {bit}");
                }
            }
        }
    }
}
