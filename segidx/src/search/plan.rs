//! Which position to start from, and whether its lists or a scan give the candidates.

use super::Engine;
use super::sets::Sets;
use crate::shard::View;
use crate::{FuzzySet, QueryPosition};

/// Segments looked at to estimate how common each position is. A pure function of the index and the query, so the
/// plan, which changes no result anyway, is the same on every run.
const SAMPLE: usize = 512;

/// Cost of fetching one list or one posting with its segment, in units of reading one segment in order.
const POSTING_COST: usize = 8;

pub(super) enum Source {
    /// The postings of these lists.
    Lists(Vec<usize>),
    /// Every segment.
    Scan,
}

pub(super) struct Plan {
    pub(super) pivot: usize,
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
        engine: Engine,
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
        let rarity = |(i, position): (usize, &QueryPosition)| (count(i), free_bits(&position.set));
        let (pivot, (sampled, _)) = positions
            .iter()
            .enumerate()
            .map(rarity)
            .enumerate()
            .min_by_key(|&(_, rarity)| rarity)
            .unwrap_or((0, (0, 0)));
        let n_candidates = sampled * stride;
        let source = match engine {
            Engine::Lists => Source::Lists(sets.numbers(pivot)),
            Engine::Scan => Source::Scan,
            Engine::Auto if POSTING_COST * n_candidates > n_segments => Source::Scan,
            Engine::Auto => Source::Lists(sets.numbers(pivot)),
        };
        Plan {
            pivot,
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
