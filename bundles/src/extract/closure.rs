//! The set M of a seed: transitive closure (equation 5) without overlaps, γ and volume (equation 3).

use std::cmp::Ordering;

use crate::extract::bits::Bits;
use crate::extract::free::Free;
use crate::extract::similar::{Candidate, End, Search};
use crate::extract::text::{Band, Text};
use crate::extract::{Closure, ExtractOptions, StringBundle, Substring};

/// What one thread needs to evaluate seeds.
pub(super) struct Scratch {
    search: Search,
    /// Intervals of the members accepted so far.
    taken: Bits,
    candidates: Vec<Candidate>,
    members: Vec<Substring>,
    /// Intervals of the seeds and of whatever was accepted, where anybody asks.
    seen: Option<Bits>,
}

/// A potential bundle of a seed.
pub(super) struct Potential {
    seed: Substring,
    pub(super) bundle: StringBundle,
}

impl Potential {
    /// Which one is kept: the larger volume, then the larger height, then the smaller seed.
    pub(super) fn order(&self, other: &Self) -> Ordering {
        let height = |potential: &Self| potential.bundle.members.len();
        (self.bundle.volume.total_cmp(&other.bundle.volume))
            .then(height(self).cmp(&height(other)))
            .then(other.seed.cmp(&self.seed))
    }
}

/// What the seeds from one first letter come to.
pub(super) struct Outcome {
    pub(super) best: Option<Potential>,
    /// Last letters of the seeds that nothing is similar to.
    pub(super) lone: Vec<usize>,
    /// The intervals that all this depends on, if they are noted: marking others changes nothing.
    pub(super) seen: Option<Bits>,
}

impl Scratch {
    pub(super) fn new(text: &Text<'_>) -> Self {
        Self {
            search: Search::default(),
            taken: Bits::none(text.len()),
            candidates: Vec::new(),
            members: Vec::new(),
            seen: None,
        }
    }

    /// Notes from now on what outcomes depend on.
    pub(super) fn noting(text: &Text<'_>) -> Self {
        Self {
            seen: Some(Bits::none(text.len())),
            ..Self::new(text)
        }
    }

    /// The best bundle of the seeds from letter `first` to each of `lasts`, in increasing order.
    pub(super) fn best_from(
        &mut self,
        (text, free): (&Text<'_>, &Free),
        options: &ExtractOptions,
        first: usize,
        lasts: &[usize],
    ) -> Outcome {
        let seed = |last| Substring { first, last };
        let end = |&last: &usize| End {
            last,
            band: Band::around(text.width(seed(last)) as f64, options.gamma),
        };
        let ends: Vec<End> = lasts.iter().map(end).collect();
        if let (Some(seen), Some(&last)) = (&mut self.seen, lasts.last()) {
            seen.clear();
            seen.insert(seed(last).intervals());
        }
        let mut candidates = vec![Vec::new(); ends.len()];
        let emit = |end: usize, candidate: Candidate| {
            if !candidate.substring.shares_interval(seed(lasts[end])) {
                candidates[end].push(candidate);
            }
        };
        let context = (text, free.allowed());
        self.search.similar(context, first, &ends, emit);

        let mut outcome = Outcome {
            best: None,
            lone: Vec::new(),
            seen: None,
        };
        for (end, candidates) in ends.iter().zip(candidates) {
            if candidates.is_empty() {
                outcome.lone.push(end.last);
                continue;
            }
            let seed = seed(end.last);
            self.begin(&[seed]);
            self.candidates = candidates;
            self.accept();
            if options.closure == Closure::Transitive {
                self.close((text, free), end.band, 1);
            }
            self.release();
            self.drop_unlike(text, options.gamma, 1);
            let Some(bundle) = self.bundle(text, options.rho) else {
                continue;
            };
            let potential = Potential { seed, bundle };
            let is_better = |best: &Potential| potential.order(best) == Ordering::Greater;
            if outcome.best.as_ref().is_none_or(is_better) {
                outcome.best = Some(potential);
            }
        }
        outcome.seen.clone_from(&self.seen);
        outcome
    }

    /// Starts from these members, which count as accepted.
    pub(super) fn begin(&mut self, members: &[Substring]) {
        self.members.clear();
        self.members.extend(members);
        for member in members {
            self.taken.insert(member.intervals());
        }
    }

    /// Accepts what is similar to members from index `next` on and has a width in `band`, members
    /// accepted on the way included.
    pub(super) fn close(&mut self, context: (&Text<'_>, &Free), band: Band, mut next: usize) {
        while let Some(&member) = self.members.get(next) {
            self.accept_like(context, band, member);
            next += 1;
        }
    }

    /// Accepts what is similar to `member` and has a width in `band`.
    pub(super) fn accept_like(
        &mut self,
        (text, free): (&Text<'_>, &Free),
        band: Band,
        member: Substring,
    ) {
        let end = End {
            last: member.last,
            band,
        };
        self.candidates.clear();
        let Self {
            search,
            taken,
            candidates,
            ..
        } = self;
        let context = (text, free.without(taken));
        let emit = |_, candidate| candidates.push(candidate);
        search.similar(context, member.first, &[end], emit);
        self.accept();
    }

    /// Accepts the candidates in order, but none that shares an interval with a member.
    ///
    /// Of these the accepted ones alone are noted: without one that was not accepted, as it shares an
    /// interval with another, all is as before.
    fn accept(&mut self) {
        self.candidates.sort_unstable_by(Candidate::before);
        for candidate in &self.candidates {
            let intervals = candidate.substring.intervals();
            if !self.taken.meets(intervals.clone()) {
                if let Some(seen) = &mut self.seen {
                    seen.insert(intervals.clone());
                }
                self.taken.insert(intervals);
                self.members.push(candidate.substring);
            }
        }
    }

    /// Ends what [`begin`](Self::begin) began.
    pub(super) fn release(&mut self) {
        for member in &self.members {
            self.taken.remove(member.intervals());
        }
    }

    /// One pass of the γ test over the members after the first `kept`.
    pub(super) fn drop_unlike(&mut self, text: &Text<'_>, gamma: f64, kept: usize) {
        if gamma == 0.0 {
            return;
        }
        let band = Band::around(mean_half_frames(text, &self.members), gamma);
        let mut index = 0;
        self.members.retain(|&member| {
            index += 1;
            index <= kept || band.contains(text.width(member))
        });
    }

    /// The members as a bundle; `None` if there is only one.
    pub(super) fn bundle(&self, text: &Text<'_>, rho: f64) -> Option<StringBundle> {
        let mut members = self.members.clone();
        members.sort_unstable();
        (members.len() > 1).then(|| {
            let mean_width = mean_half_frames(text, &members) / 2.0;
            StringBundle::new(members, mean_width, rho)
        })
    }
}

/// The mean width of `members`, which are some, in half frames.
pub(super) fn mean_half_frames(text: &Text<'_>, members: &[Substring]) -> f64 {
    let widths = members.iter().map(|&member| text.width(member));
    widths.sum::<usize>() as f64 / members.len() as f64
}
