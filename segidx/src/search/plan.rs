//! Which engine runs, and which positions it starts from.

use std::cell::OnceCell;

use super::pattern::Kind;
use super::sets::Sets;
use super::{Engine, EngineCosts, SearchPlan};
use crate::shard::{Dictionary, View};
use crate::{FuzzySet, QueryPosition};

/// Segments, and distinct words, looked at to estimate how common a position is. A pure function of the index and the
/// query, so the plan, which changes no result anyway, is the same on every run.
const SAMPLE: usize = 512;

/// A dictionary of so few words is counted as a whole: sampled segments are on as many pages of the shard, which are to
/// be read and checked.
const SMALL: usize = 4 * SAMPLE;

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
    /// The rarest position that candidates do not come from.
    pub(super) probe: Option<usize>,
    /// Whether words are asked about more often than there are words.
    pub(super) tabulates: bool,
    /// About how many segments are read.
    pub(super) n_segments: usize,
}

impl Plan {
    /// Plans for at least one position and one segment.
    pub(super) fn new(
        (view, dictionary): (&View<'_>, &Dictionary),
        sets: &Sets<'_>,
        positions: &[QueryPosition],
        (engine, kind): (Engine, Kind<'_>),
    ) -> Plan {
        let sample = Sample::new(view, sets, dictionary);
        let start = kind.start(positions.len());
        // Of positions equally rare in the sample the most specific one; of those the first.
        let rarity = |i: usize| (sample.n_segments(i), free_bits(&positions[i].set), i);
        let mut rarest: Vec<_> = start.among.into_iter().map(rarity).collect();
        rarest.sort_unstable();
        let probe = rarest.get(start.n).map(|&(.., position)| position);
        rarest.truncate(start.n);
        let n_candidates: usize = rarest.iter().map(|&(n_segments, ..)| n_segments).sum();
        let pivots: Vec<usize> = rarest.into_iter().map(|(.., position)| position).collect();

        let each = || sets.first_positions();
        let masks = sets.different().iter().map(|set| set.masks().len());
        let table = masks.sum::<usize>() * sets.n_words() / WORDS;
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
            probe,
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

/// About how common the sets are.
struct Sample<'p> {
    sets: &'p Sets<'p>,
    /// Per different set about how many segments and how many distinct words belong to it.
    n_segments: Vec<usize>,
    n_lists: Vec<usize>,
}

impl<'p> Sample<'p> {
    /// Counts the lists of a few words, or in a small dictionary; else looks at some segments and some distinct words,
    /// evenly chosen.
    fn new(view: &View<'_>, sets: &'p Sets<'p>, dictionary: &Dictionary) -> Sample<'p> {
        let stride = |n: usize| n.div_ceil(SAMPLE).max(1);
        let (segments_each, words_each) = (stride(view.n_segments()), stride(sets.n_words()));
        let segments = OnceCell::new();
        let words = OnceCell::new();
        let sampled = |set: &FuzzySet| {
            let segments: &Vec<u64> = segments.get_or_init(|| {
                let segments = (0..view.n_segments()).step_by(segments_each);
                let words = segments.map(|segment| sets.word(view.entry(segment).word));
                words.collect()
            });
            let n_lists = match sets.are_words(set) {
                true => set.masks().len(),
                false => {
                    let words: &Vec<u64> = words.get_or_init(|| {
                        let words = (0..sets.n_words()).step_by(words_each);
                        words.map(|word| sets.word(word)).collect()
                    });
                    words_each * count(set, words)
                }
            };
            (segments_each * count(set, segments), n_lists)
        };
        let counted = |set: &FuzzySet| {
            let mut counts = (0, 0);
            for word in 0..sets.n_words() {
                if set.matches(sets.word(word)) {
                    counts.0 += dictionary.list_len(word);
                    counts.1 += 1;
                }
            }
            counts
        };
        let is_small = sets.n_words() <= SMALL;
        let counts = sets.different().iter().enumerate();
        let counts = counts.map(|(i, set)| match sets.exact_counts(i) {
            Some(counts) => counts,
            None if is_small => counted(set),
            None => sampled(set),
        });
        let (n_segments, n_lists) = counts.unzip();
        Sample {
            sets,
            n_segments,
            n_lists,
        }
    }

    /// About how many segments belong to a position.
    fn n_segments(&self, position: usize) -> usize {
        self.n_segments[self.sets.of_position(position)]
    }

    /// About the cost of reading the lists of a position.
    fn lists(&self, position: usize) -> usize {
        let set = self.sets.of_position(position);
        let different = self.sets.different()[set];
        let find = match self.sets.are_words(different) {
            true => different.masks().len() * LOOK_UP,
            false => different.masks().len() * self.sets.n_words() / WORDS,
        };
        find + LIST * self.n_lists[set] + POSTING * self.n_segments[set]
    }
}

/// How many of some words belong to a set.
fn count(set: &FuzzySet, words: &[u64]) -> usize {
    match set.masks() {
        // Without a loop over masks the words are compared several at a time.
        [mask] => words.iter().filter(|&&word| mask.matches(word)).count(),
        _ => words.iter().filter(|&&word| set.matches(word)).count(),
    }
}

/// Free bits of the least specific mask; a set without masks is the most specific of all.
fn free_bits(set: &FuzzySet) -> u32 {
    let free = set.masks().iter().map(|mask| mask.care().count_zeros());
    free.max().unwrap_or(0)
}
