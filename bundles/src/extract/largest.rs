//! The largest bundle of all seeds, round by round.
//!
//! Only what a bundle has taken from the sets of a first letter changes them: the other ones
//! are known from the rounds before.

use crate::extract::bits::Bits;
use crate::extract::closure::{Outcome, Potential, Scratch};
use crate::extract::rounds::{Extraction, Seeds};
use crate::extract::{Partition, Substring};
use crate::parallel;

/// The best set of the seeds from a first letter.
#[derive(Default)]
struct Known {
    best: Option<Potential>,
    /// The intervals it depends on.
    seen: Bits,
}

impl Extraction<'_> {
    /// Partitions all free intervals: bundles by descending volume, and what is left when there are
    /// none.
    pub(super) fn run_largest(&mut self, partition: &mut Partition) -> Vec<Substring> {
        let n = self.text.len();
        let mut known: Vec<Known> = (0..n).map(|_| Known::default()).collect();
        let mut stale: Vec<usize> = (0..n).collect();
        loop {
            let seeds: Vec<Seeds> = stale.iter().map(|&first| self.seeds_from(first)).collect();
            let outcomes = self.evaluate(&seeds);
            for ((first, _), outcome) in seeds.into_iter().zip(outcomes) {
                known[first] = self.noted(first, outcome);
            }
            let sets = known.iter().enumerate();
            let sets = sets.filter_map(|(first, known)| Some((first, known.best.as_ref()?)));
            let Some((first, _)) = sets.max_by(|a, b| a.1.order(b.1)) else {
                break;
            };
            let Some(best) = known[first].best.take() else {
                break;
            };
            let members = &best.bundle.members;
            for &member in members {
                self.free.mark(&self.text, member);
            }
            let is_stale = |known: &Known| {
                let mut taken = members.iter().map(|member| member.intervals());
                taken.any(|intervals| known.seen.meets(intervals))
            };
            stale = (0..n).filter(|&first| is_stale(&known[first])).collect();
            partition.bundles.push(best.bundle);
        }
        let left = (0..n).filter(|&first| self.free.intervals.contains(first));
        let interval = |first| Substring {
            first,
            last: first + 1,
        };
        left.map(interval).collect()
    }

    fn evaluate(&mut self, seeds: &[Seeds]) -> Vec<Outcome> {
        let (text, free, options) = (&self.text, &self.free, self.options);
        let evaluate = |scratch: &mut Scratch, (first, lasts): &Seeds| {
            scratch.best_from((text, free), options, *first, lasts)
        };
        let new = || Scratch::noting(text);
        parallel::map_with(seeds, &mut self.scratch, new, evaluate)
    }

    fn noted(&mut self, first: usize, outcome: Outcome) -> Known {
        for last in outcome.lone {
            self.set_lone(first, last);
        }
        Known {
            best: outcome.best,
            seen: outcome.seen.unwrap_or_default(),
        }
    }

    /// All free seeds from letter `first` that something may be similar to.
    fn seeds_from(&self, first: usize) -> Seeds {
        let run = self.free.allowed().run(first, self.text.max_letters - 1);
        let lasts = first + 1..=first + run;
        (
            first,
            lasts.filter(|&last| !self.is_lone(first, last)).collect(),
        )
    }
}
