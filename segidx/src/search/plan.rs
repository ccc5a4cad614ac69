//! Which engine runs, and which positions it starts from.

use super::pattern::Kind;
use super::sets::Sets;
use super::{Engine, EngineCosts, SearchPlan};
use crate::shard::View;
use crate::{FuzzySet, QueryPosition};

/// Segments, and distinct words, looked at to estimate how common each position is. A pure function of the index and
/// the query, so the plan, which changes no result anyway, is the same on every run.
const SAMPLE: usize = 512;

// Costs in units of one segment read in order, as the bench `search` found them.
/// Words that are compared with a mask in one unit.
const WORDS: usize = 4;
/// One word looked up among the distinct ones.
const LOOK_UP: usize = 40;
/// Opening one list.
const LIST: usize = 16;
/// One segment number of a list.
const POSTING: usize = 2;
/// A candidate somewhere in the shard.
const CANDIDATE: usize = 6;
/// A candidate met in order.
const NEXT_CANDIDATE: usize = 3;
/// A segment put in order, coalesced and joined.
const JOINED: usize = 4;

/// Positions to choose pivots from: every hit matches at least one of any `n` of them.
pub(super) struct Start {
    n: usize,
    among: Vec<usize>,
}

impl Start {
    pub(super) fn at(n: usize, among: Vec<usize>) -> Start {
        Start { n, among }
    }
}

pub(super) struct Plan {
    /// The engine, its pivots and the estimates; nothing has been read yet.
    pub(super) done: SearchPlan,
    /// Whether words are asked about more often than there are words.
    pub(super) tabulates: bool,
    /// About how many segments are read.
    pub(super) n_segments: usize,
}

impl Plan {
    /// Plans for at least one position and one segment.
    pub(super) fn new(
        view: &View<'_>,
        sets: &Sets<'_>,
        positions: &[QueryPosition],
        (engine, kind): (Engine, Kind<'_>),
    ) -> Plan {
        let sample = Sample::new(view, sets);
        let start = kind.start(positions.len());
        // Of positions equally rare in the sample the most specific one; of those the first.
        let rarity = |i: usize| (sample.n_segments(i), free_bits(&positions[i].set), i);
        let mut rarest: Vec<_> = start.among.into_iter().map(rarity).collect();
        rarest.sort_unstable();
        rarest.truncate(start.n);
        let n_candidates: usize = rarest.iter().map(|&(n_segments, ..)| n_segments).sum();
        let pivots: Vec<usize> = rarest.into_iter().map(|(.., position)| position).collect();

        let each = || sets.first_positions();
        let table: usize = each()
            .map(|i| sets.n_masks(i) * sets.n_words() / WORDS)
            .sum();
        let (n_words, n_segments) = (sets.n_words(), view.n_segments());
        let is_much = n_candidates > n_words;
        let in_lists = pivots.iter().map(|&i| sample.lists(i));
        let pivot =
            in_lists.sum::<usize>() + CANDIDATE * n_candidates + if is_much { table } else { 0 };
        let scan = n_segments * pivots.len() + NEXT_CANDIDATE * n_candidates + table;
        let joined = each().map(|i| sample.lists(i) + JOINED * sample.n_segments(i));
        let lists = joined.sum::<usize>();
        let engine = match engine {
            Engine::Auto if pivot <= scan.min(lists) => Engine::Pivot,
            Engine::Auto if scan <= lists => Engine::Scan,
            Engine::Auto => Engine::Lists,
            chosen => chosen,
        };
        Plan {
            tabulates: engine == Engine::Scan || engine == Engine::Pivot && is_much,
            n_segments: match engine {
                Engine::Scan => n_segments,
                _ => n_candidates,
            },
            done: SearchPlan {
                pivots: match engine {
                    Engine::Lists => Vec::new(),
                    _ => pivots,
                },
                engine,
                estimated: EngineCosts {
                    lists: lists as u64,
                    pivot: pivot as u64,
                    scan: scan as u64,
                },
                n_lists: 0,
                n_postings: 0,
                n_segments: 0,
                n_candidates: 0,
            },
        }
    }
}

/// Some segments and some distinct words, evenly chosen, to stand for all.
struct Sample<'p> {
    sets: &'p Sets<'p>,
    /// Numbers of words: of the sampled segments, and of the sampled words.
    of_segments: Vec<usize>,
    of_words: Vec<usize>,
    /// How many each stands for.
    segments_each: usize,
    words_each: usize,
}

impl<'p> Sample<'p> {
    fn new(view: &View<'_>, sets: &'p Sets<'p>) -> Sample<'p> {
        let stride = |n: usize| n.div_ceil(SAMPLE).max(1);
        let (segments_each, words_each) = (stride(view.n_segments()), stride(sets.n_words()));
        let segments = (0..view.n_segments()).step_by(segments_each);
        Sample {
            sets,
            of_segments: segments.map(|segment| view.entry(segment).word).collect(),
            of_words: (0..sets.n_words()).step_by(words_each).collect(),
            segments_each,
            words_each,
        }
    }

    fn count(&self, position: usize, words: &[usize]) -> usize {
        let words = words.iter();
        words
            .filter(|&&word| self.sets.holds(position, word))
            .count()
    }

    /// About how many segments belong to a position.
    fn n_segments(&self, position: usize) -> usize {
        self.segments_each * self.count(position, &self.of_segments)
    }

    /// About the cost of reading the lists of a position.
    fn lists(&self, position: usize) -> usize {
        let (n_masks, n_words) = (self.sets.n_masks(position), self.sets.n_words());
        let (find, n_lists) = if self.sets.are_words(position) {
            (n_masks * LOOK_UP, n_masks)
        } else {
            let n_lists = self.words_each * self.count(position, &self.of_words);
            (n_masks * n_words / WORDS, n_lists)
        };
        find + LIST * n_lists + POSTING * self.n_segments(position)
    }
}

/// Free bits of the least specific mask; a set without masks is the most specific of all.
fn free_bits(set: &FuzzySet) -> u32 {
    let free = set.masks().iter().map(|mask| mask.care().count_zeros());
    free.max().unwrap_or(0)
}
