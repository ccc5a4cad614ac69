//! `motif search --features auto`: features are left out, one by one, until there are enough hits
//! (2005 paper, section 6.2, "hierarchical approach").
//!
//! Which feature goes is decided by the lengths of the inverted lists. With features `S`, segment ℓ of
//! the query accepts a share p_ℓ of all segments of the library; if segments were independent, there would
//! be about n · Π p_ℓ hits. That feature goes without which this is largest, so few have to go. Of equals
//! the one of the highest number goes.

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
        let mut best: Option<(f64, u32)> = None;
        for bit in (0..u64::BITS).filter(|bit| care >> bit & 1 == 1) {
            // Neighbours that differ in this feature alone become one position.
            let mut n_left = 0;
            let mut score = 0.0;
            let mut last = None;
            for (position, accepted) in positions.iter().zip(&accepted) {
                let masked = position & !(1 << bit);
                if last.replace(masked) != Some(masked) {
                    n_left += 1;
                    score += accepted[bit as usize].ln();
                }
            }
            if n_left > 1 && best.is_none_or(|(most, _)| score >= most) {
                best = Some((score, bit));
            }
        }
        best.map(|(_, bit)| bit)
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
    fn the_feature_goes_that_keeps_most_hits_away() {
        // Bit 0 changes in the query and everywhere; bit 1 is on in the query and hardly elsewhere.
        let lists = lists(&[(0b00, 40), (0b01, 40), (0b10, 10), (0b11, 10)]);
        assert_eq!(lists.next(&[0b10, 0b11, 0b10], 0b11), Some(1));
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
                for bit in 0..3 {
                    if care >> bit & 1 == 0 {
                        continue;
                    }
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
