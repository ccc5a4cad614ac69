//! What has been found so far, and how dear a window may be to matter still.

use std::collections::BTreeSet;

/// A cost and the start or index that it belongs to.
pub(super) type Found = (f64, usize);

/// Cheapest first, and of equals the first.
pub(super) fn by_cost(a: &Found, b: &Found) -> std::cmp::Ordering {
    a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))
}

/// The greedy choice by (cost, start) of starts that are at least `exclusion` apart.
#[derive(Debug)]
pub(super) struct Best {
    k: usize,
    exclusion: usize,
    /// Everything found that is not above the limit, cheapest first.
    found: Vec<Found>,
    limit: f64,
}

impl Best {
    pub(super) fn new(k: usize, exclusion: usize) -> Self {
        Self {
            k,
            exclusion,
            found: Vec::new(),
            limit: f64::INFINITY,
        }
    }

    /// What costs more than this is not among the best, whatever else is found.
    pub(super) fn limit(&self) -> f64 {
        self.limit
    }

    /// Chosen starts of which the dearest bounds the k-th of the final choice.
    ///
    /// With an exclusion, something cheaper that is found later may displace two chosen ones, one
    /// on either side (three starts within its reach would be closer to one another than the
    /// exclusion). Let 2k - 1 be chosen at costs up to c: each of them is in the end chosen or
    /// within reach of a chosen one that costs no more, so fewer than k final ones up to c could
    /// account for 2k - 2 of them at most.
    pub(super) fn wanted(&self) -> usize {
        if self.exclusion <= 1 {
            self.k
        } else {
            self.k.saturating_mul(2).saturating_sub(1)
        }
    }

    pub(super) fn extend(&mut self, more: impl IntoIterator<Item = Found>) {
        let before = self.found.len();
        self.found.extend(more);
        if self.found.len() == before {
            return;
        }
        self.found.sort_unstable_by(by_cost);
        let chosen = self.choose(self.wanted());
        if chosen.len() == self.wanted()
            && let Some(&(limit, _)) = chosen.last()
        {
            self.limit = limit;
            self.found.retain(|&(cost, _)| cost <= limit);
        }
    }

    pub(super) fn into_chosen(self) -> Vec<Found> {
        self.choose(self.k)
    }

    fn choose(&self, n: usize) -> Vec<Found> {
        let reach = self.exclusion.saturating_sub(1);
        let mut starts = BTreeSet::new();
        let mut chosen = Vec::new();
        for &(cost, start) in &self.found {
            if chosen.len() == n {
                break;
            }
            let near = start.saturating_sub(reach)..=start.saturating_add(reach);
            if starts.range(near).next().is_none() {
                starts.insert(start);
                chosen.push((cost, start));
            }
        }
        chosen
    }
}
