//! Which positions to start from, and whether their lists or a scan give the candidates.

use super::Engine;
use super::sets::Sets;
use crate::shard::View;
use crate::{FuzzySet, QueryPosition};

/// Segments looked at to estimate how common each position is. A pure function of the index and the query, so the
/// plan, which changes no result anyway, is the same on every run.
const SAMPLE: usize = 512;

/// Cost of fetching one list or one posting with its segment, in units of reading one segment in order.
const POSTING_COST: usize = 8;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Source {
    /// The inverted lists of the words of each pivot.
    Lists,
    /// Every segment.
    Scan,
}

/// Positions to choose pivots from: every hit matches at least one of any `n` of them.
pub(super) struct Start {
    n: usize,
    among: Vec<usize>,
}

impl Start {
    pub(super) fn at(n: usize, among: Vec<usize>) -> Start {
        Start { n, among }
    }

    /// For hits that match every position.
    pub(super) fn anywhere(positions: &[QueryPosition]) -> Start {
        Start::at(1, (0..positions.len()).collect())
    }
}

pub(super) struct Plan {
    /// The positions candidates belong to, the rarest first.
    pub(super) pivots: Vec<usize>,
    pub(super) source: Source,
    /// About how many segments the source gives.
    pub(super) n_candidates: usize,
}

impl Plan {
    /// Plans for at least one position and one segment.
    pub(super) fn new(
        view: &View<'_>,
        sets: &Sets<'_>,
        positions: &[QueryPosition],
        (engine, start): (Engine, Start),
    ) -> Plan {
        let n_segments = view.n_segments();
        let stride = n_segments.div_ceil(SAMPLE).max(1);
        let sample = (0..n_segments).step_by(stride);
        let sample: Vec<usize> = sample.map(|segment| view.entry(segment).word).collect();
        let count = |position| {
            let words = sample.iter();
            words.filter(|&&word| sets.holds(position, word)).count()
        };
        // Of positions equally rare in the sample the most specific one; of those the first.
        let rarity = |i: usize| (count(i), free_bits(&positions[i].set), i);
        let mut rarest: Vec<_> = start.among.into_iter().map(rarity).collect();
        rarest.sort_unstable();
        rarest.truncate(start.n);
        let n_candidates = stride * rarest.iter().map(|&(sampled, ..)| sampled).sum::<usize>();
        let pivots: Vec<usize> = rarest.into_iter().map(|(.., position)| position).collect();
        let source = match engine {
            Engine::Lists => Source::Lists,
            Engine::Scan => Source::Scan,
            // A scan is one pass per pivot.
            Engine::Auto if POSTING_COST * n_candidates > n_segments * pivots.len() => Source::Scan,
            Engine::Auto => Source::Lists,
        };
        Plan {
            pivots,
            source,
            n_candidates,
        }
    }
}

/// Free bits of the least specific mask; a set without masks is the most specific of all.
fn free_bits(set: &FuzzySet) -> u32 {
    let free = set.masks().iter().map(|mask| mask.care().count_zeros());
    free.max().unwrap_or(0)
}
