//! Which distinct words belong to which position of a query.

use crate::shard::Dictionary;
use crate::{FuzzySet, QueryPosition};

/// The sets of a query over the distinct words of a shard, of which the bits of `care` are looked at.
pub(super) struct Sets<'a> {
    words: &'a [u64],
    care: u64,
    /// The different sets. Queries by example come back to the same ones.
    different: Vec<&'a FuzzySet>,
    /// Per position: its set among `different`.
    of_position: Vec<usize>,
    /// Per different set the numbers of its words, increasing, with how many segments have them, if it is given as a few
    /// words.
    few: Vec<Option<Few>>,
    /// Per different set a bit per word, if they were asked for; else empty.
    members: Vec<Vec<u64>>,
}

/// A set of a few words. In place, for a query of words has no other work that would take as long as an allocation.
struct Few {
    numbers: [usize; FEW],
    len: usize,
    n_segments: usize,
}

/// Sets of up to as many words are looked up before the search.
const FEW: usize = 8;

impl Few {
    fn numbers(&self) -> &[usize] {
        &self.numbers[..self.len]
    }
}

impl<'a> Sets<'a> {
    pub(super) fn new(
        dictionary: &'a Dictionary,
        positions: &'a [QueryPosition],
        care: u64,
    ) -> Sets<'a> {
        let mut different: Vec<&FuzzySet> = Vec::new();
        let mut of_position = Vec::with_capacity(positions.len());
        for position in positions {
            let known = different.iter().position(|&set| *set == position.set);
            of_position.push(known.unwrap_or(different.len()));
            if known.is_none() {
                different.push(&position.set);
            }
        }
        let mut sets = Sets {
            words: &dictionary.words,
            care,
            different,
            of_position,
            few: Vec::new(),
            members: Vec::new(),
        };
        let few = sets.different.iter().map(|set| {
            if set.masks().len() > FEW || !sets.are_words(set) {
                return None;
            }
            let mut few = Few {
                numbers: [0; FEW],
                len: 0,
                n_segments: 0,
            };
            for number in sets.look_up(set) {
                few.numbers[few.len] = number;
                few.len += 1;
                few.n_segments += dictionary.list_len(number);
            }
            Some(few)
        });
        sets.few = few.collect();
        sets
    }

    /// The number of segments of the different set `set` and of its words, if it is given as a few words.
    pub(super) fn exact_counts(&self, set: usize) -> Option<(usize, usize)> {
        let few = self.few[set].as_ref()?;
        Some((few.n_segments, few.len))
    }

    /// The different sets.
    pub(super) fn different(&self) -> &[&'a FuzzySet] {
        &self.different
    }

    /// The number of the set of `position` among the different ones.
    pub(super) fn of_position(&self, position: usize) -> usize {
        self.of_position[position]
    }

    /// A position of each different set, the first one.
    pub(super) fn first_positions(&self) -> impl Iterator<Item = usize> {
        let first = |set| self.of_position.iter().position(|&other| other == set);
        (0..self.different.len()).filter_map(first)
    }

    pub(super) fn n_words(&self) -> usize {
        self.words.len()
    }

    /// Word number `word`, as far as it is looked at.
    pub(super) fn word(&self, word: usize) -> u64 {
        self.words[word] & self.care
    }

    /// Makes asking about a segment one look-up by the number of its word, whatever the sets, which pays where it is
    /// asked more often than there are words. Cost: O(distinct words · masks).
    pub(super) fn tabulate(&mut self) {
        let sets = self.different.iter().zip(&self.few);
        self.members = sets
            .map(|(set, few)| match few {
                Some(_) => Vec::new(),
                None => self.members_of(set),
            })
            .collect();
    }

    fn members_of(&self, set: &FuzzySet) -> Vec<u64> {
        let mut members = vec![0; self.words.len().div_ceil(64)];
        for mask in set.masks() {
            for (bits, words) in members.iter_mut().zip(self.words.chunks(64)) {
                for (i, &word) in words.iter().enumerate() {
                    *bits |= u64::from(mask.matches(word & self.care)) << i;
                }
            }
        }
        members
    }

    /// Whether word number `word` of the dictionary belongs to `position`.
    #[inline]
    pub(super) fn holds(&self, position: usize, word: usize) -> bool {
        let set = self.of_position[position];
        if let Some(few) = &self.few[set] {
            return few.numbers().contains(&word);
        }
        match self.members.get(set) {
            Some(members) => members[word / 64] >> (word % 64) & 1 == 1,
            None => self.different[set].matches(self.words[word] & self.care),
        }
    }

    /// Whether not all bits of a word are looked at, so that neighbouring segments may have the same word.
    #[inline]
    pub(super) fn is_restricted(&self) -> bool {
        self.care != u64::MAX
    }

    /// Whether two words, by their numbers, differ in no bit that is looked at.
    #[inline]
    pub(super) fn agree(&self, a: usize, b: usize) -> bool {
        (self.words[a] ^ self.words[b]) & self.care == 0
    }

    /// Whether [`numbers`](Self::numbers) looks the masks of a set up one by one.
    pub(super) fn are_words(&self, set: &FuzzySet) -> bool {
        let mut masks = set.masks().iter();
        !self.is_restricted() && masks.all(|mask| mask.care() == u64::MAX)
    }

    /// The numbers of the words of a set that is given as words.
    fn look_up(&self, set: &FuzzySet) -> impl Iterator<Item = usize> {
        // Masks of full care come in the order of their words.
        let words = set.masks().iter().map(|mask| mask.value());
        words.filter_map(|word| self.words.binary_search(&word).ok())
    }

    /// The numbers of the words that belong to `position`, increasing: L(V) of eq. 11 before the union.
    ///
    /// Cost: O(distinct words · masks), less if every mask stands for one word.
    pub(super) fn numbers(&self, position: usize) -> Vec<usize> {
        let set = self.of_position[position];
        if let Some(few) = &self.few[set] {
            return few.numbers().to_vec();
        }
        if self.are_words(self.different[set]) {
            return self.look_up(self.different[set]).collect();
        }
        let tabulated = self.members.get(set);
        let fresh = match tabulated {
            Some(_) => Vec::new(),
            None => self.members_of(self.different[set]),
        };
        let mut numbers = Vec::new();
        for (at, &bits) in tabulated.unwrap_or(&fresh).iter().enumerate() {
            let mut left = bits;
            while left != 0 {
                numbers.push(64 * at + left.trailing_zeros() as usize);
                left &= left - 1;
            }
        }
        numbers
    }
}
