//! Which position to start from, and whether its lists or a scan give the candidates.

use super::Engine;
use crate::{FuzzySet, Index, QueryPosition};

/// Segments looked at to estimate how common each position is. A pure function of the index and the query, so the
/// plan, which changes no result anyway, is the same on every run.
const SAMPLE: usize = 512;

/// Cost of fetching one posting and its segment word, in units of reading one word in order.
const POSTING_COST: usize = 4;

pub(super) enum Source {
    /// The postings of these lists.
    Lists(Vec<usize>),
    /// Every segment.
    Scan,
}

pub(super) struct Plan {
    pub(super) pivot: usize,
    pub(super) source: Source,
}

impl Plan {
    /// Plans for at least one position and one segment.
    pub(super) fn new(index: &Index, positions: &[QueryPosition], engine: Engine) -> Plan {
        let n_segments = index.n_segments();
        let stride = n_segments.div_ceil(SAMPLE).max(1);
        let count = |position: &QueryPosition| {
            let sample = index.words.iter().step_by(stride);
            sample.filter(|&&word| position.set.matches(word)).count()
        };
        // Of positions equally rare in the sample the most specific one; of those the first.
        let rarity = |position: &QueryPosition| (count(position), free_bits(&position.set));
        let (pivot, (sampled, _)) = positions
            .iter()
            .map(rarity)
            .enumerate()
            .min_by_key(|&(_, rarity)| rarity)
            .unwrap_or((0, (0, 0)));
        let set = &positions[pivot].set;
        let scan = match engine {
            Engine::Auto => {
                let candidates = sampled * stride;
                let lists = if names_words(set) {
                    set.masks().len() * (index.n_lists().ilog2() as usize + 1)
                } else {
                    index.n_lists()
                };
                lists + POSTING_COST * candidates > n_segments
            }
            Engine::Lists => false,
            Engine::Scan => true,
        };
        let source = if scan {
            Source::Scan
        } else {
            Source::Lists(matching_lists(index, set))
        };
        Plan { pivot, source }
    }
}

/// Free bits of the least specific mask; a set without masks is the most specific of all.
fn free_bits(set: &FuzzySet) -> u32 {
    let free = set.masks().iter().map(|mask| mask.care().count_zeros());
    free.max().unwrap_or(0)
}

/// Whether every mask stands for one word, so the lists can be looked up instead of tried.
fn names_words(set: &FuzzySet) -> bool {
    set.masks().iter().all(|mask| mask.care() == u64::MAX)
}

/// The lists whose word belongs to `set`, each once: L(V) of eq. 11 before the union.
fn matching_lists(index: &Index, set: &FuzzySet) -> Vec<usize> {
    let words = &index.list_words;
    if names_words(set) {
        let masks = set.masks().iter();
        return masks
            .filter_map(|mask| words.binary_search(&mask.value()).ok())
            .collect();
    }
    let all = words.iter().enumerate();
    all.filter(|&(_, &word)| set.matches(word))
        .map(|(list, _)| list)
        .collect()
}
