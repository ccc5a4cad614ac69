//! Round by round: a seed letter, the best set of all seeds through it, marking (section 3.3).

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

use crate::draw::below;
use crate::extract::closure::{Outcome, Potential, Scratch};
use crate::extract::free::Free;
use crate::extract::text::Text;
use crate::extract::{ExtractOptions, Partition, SeedInstance, Substring};
use crate::parallel;

/// Seeds: their first letter and their last ones, in increasing order.
pub(super) type Seeds = (usize, Vec<usize>);

/// The state of an extraction.
pub(super) struct Extraction<'a> {
    pub(super) text: Text<'a>,
    pub(super) free: Free,
    pub(super) options: &'a ExtractOptions,
    /// Seeds that nothing is similar to, by first letter, as bits by length. Marking takes
    /// candidates away and never adds one, so they stay what they are.
    lone: Vec<Vec<u64>>,
    pub(super) scratch: Vec<Scratch>,
}

impl<'a> Extraction<'a> {
    pub(super) fn new(text: Text<'a>, free: Free, options: &'a ExtractOptions) -> Self {
        Self {
            lone: vec![Vec::new(); text.len()],
            text,
            free,
            options,
            scratch: Vec::new(),
        }
    }

    /// Partitions all free intervals.
    pub(super) fn run(&mut self, partition: &mut Partition) {
        let single = match self.options.seed {
            SeedInstance::Largest => self.run_largest(partition),
            SeedInstance::First => self.run_letters(partition, None),
            SeedInstance::Random(seed) => {
                self.run_letters(partition, Some(ChaCha8Rng::seed_from_u64(seed)))
            }
        };
        partition.degenerate.extend(merge(single));
        partition.degenerate.sort_unstable();
    }

    /// Bundles that grow from instances of the most frequent letters, at random where there are dice.
    /// Returns the intervals that are in none.
    fn run_letters(
        &mut self,
        partition: &mut Partition,
        mut dice: Option<ChaCha8Rng>,
    ) -> Vec<Substring> {
        let mut single = Vec::new();
        loop {
            let instances = self.free.most_frequent();
            let chosen = match &mut dice {
                None => 0,
                Some(dice) => below(dice, instances.len()),
            };
            // Termination: a round marks an interval, and without a free one there is no instance.
            let Some(&seed) = instances.get(chosen) else {
                break;
            };
            if let Some(best) = self.best_through(seed) {
                for &member in &best.bundle.members {
                    self.free.mark(&self.text, member);
                }
                partition.bundles.push(best.bundle);
            } else {
                let interval = self.narrower_interval(seed);
                self.free.mark(&self.text, interval);
                single.push(interval);
            }
        }
        single
    }

    /// The set of largest volume among those of all seeds through letter `c`.
    fn best_through(&mut self, c: usize) -> Option<Potential> {
        let reach = self.text.max_letters - 1;
        let intervals = &self.free.intervals;
        let firsts = (c.saturating_sub(reach)..c).rev();
        let firsts = firsts.take_while(|&first| intervals.contains(first));
        let after = self.free.allowed().run(c, reach);
        let mut seeds: Vec<Seeds> = Vec::new();
        for first in std::iter::once(c).chain(firsts) {
            let last = (c + after).min(first + reach);
            let lasts = (first + 1).max(c)..=last;
            let lasts: Vec<usize> = lasts.filter(|&last| !self.is_lone(first, last)).collect();
            if !lasts.is_empty() {
                seeds.push((first, lasts));
            }
        }
        let (text, free, options) = (&self.text, &self.free, self.options);
        let evaluate = |scratch: &mut Scratch, (first, lasts): &Seeds| {
            scratch.best_from((text, free), options, *first, lasts)
        };
        let outcomes: Vec<Outcome> =
            parallel::map_with(&seeds, &mut self.scratch, || Scratch::new(text), evaluate);
        let mut best: Option<Potential> = None;
        for ((first, _), outcome) in seeds.iter().zip(outcomes) {
            for last in outcome.lone {
                self.set_lone(*first, last);
            }
            let found = outcome.best.into_iter();
            best = best.into_iter().chain(found).max_by(Potential::order);
        }
        best
    }

    pub(super) fn is_lone(&self, first: usize, last: usize) -> bool {
        let length = last - first;
        let word = self.lone[first].get(length / 64).copied().unwrap_or(0);
        word >> (length % 64) & 1 == 1
    }

    pub(super) fn set_lone(&mut self, first: usize, last: usize) {
        let (length, words) = (last - first, &mut self.lone[first]);
        if words.len() <= length / 64 {
            words.resize(length / 64 + 1, 0);
        }
        words[length / 64] |= 1 << (length % 64);
    }

    /// The narrower of the free intervals next to `c`, of which there is one; the left one if both
    /// are as wide.
    fn narrower_interval(&self, c: usize) -> Substring {
        let interval = |first| Substring {
            first,
            last: first + 1,
        };
        let before = c
            .checked_sub(1)
            .filter(|&j| self.free.intervals.contains(j));
        let after = Some(c).filter(|&j| self.free.intervals.contains(j));
        let sides = [before, after].into_iter().flatten().map(interval);
        let narrowest = sides.min_by_key(|&side| self.text.width(side));
        narrowest.unwrap_or(interval(c))
    }
}

/// Adjacent submotions as one. Intervals of different clips are never adjacent.
fn merge(mut single: Vec<Substring>) -> Vec<Substring> {
    single.sort_unstable();
    let mut merged: Vec<Substring> = Vec::new();
    for submotion in single {
        match merged.last_mut() {
            Some(before) if before.last == submotion.first => before.last = submotion.last,
            _ => merged.push(submotion),
        }
    }
    merged
}
