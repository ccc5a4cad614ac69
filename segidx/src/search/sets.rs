//! Which distinct words belong to which position of a query.

use crate::shard::Dictionary;
use crate::{FuzzySet, QueryPosition};

/// The sets of a query over the distinct words of a shard.
pub(super) struct Sets<'a> {
    words: &'a [u64],
    /// The different sets. Queries by example come back to the same ones.
    different: Vec<&'a FuzzySet>,
    /// Per position: its set among `different`.
    of_position: Vec<usize>,
    /// Per different set a bit per word, if they were asked for; else empty.
    members: Vec<Vec<u64>>,
}

impl<'a> Sets<'a> {
    pub(super) fn new(dictionary: &'a Dictionary, positions: &'a [QueryPosition]) -> Sets<'a> {
        let mut different: Vec<&FuzzySet> = Vec::new();
        let mut of_position = Vec::with_capacity(positions.len());
        for position in positions {
            let known = different.iter().position(|&set| *set == position.set);
            of_position.push(known.unwrap_or(different.len()));
            if known.is_none() {
                different.push(&position.set);
            }
        }
        Sets {
            words: &dictionary.words,
            different,
            of_position,
            members: Vec::new(),
        }
    }

    /// Makes asking about a segment one look-up by the number of its word, whatever the sets, which pays where it is
    /// asked more often than there are words. Cost: O(distinct words · masks).
    pub(super) fn tabulate(&mut self) {
        let sets = self.different.iter();
        self.members = sets.map(|set| self.members_of(set)).collect();
    }

    fn members_of(&self, set: &FuzzySet) -> Vec<u64> {
        let mut members = vec![0; self.words.len().div_ceil(64)];
        for mask in set.masks() {
            for (bits, words) in members.iter_mut().zip(self.words.chunks(64)) {
                for (i, &word) in words.iter().enumerate() {
                    *bits |= u64::from(mask.matches(word)) << i;
                }
            }
        }
        members
    }

    /// Whether word number `word` of the dictionary belongs to `position`.
    #[inline]
    pub(super) fn holds(&self, position: usize, word: usize) -> bool {
        let set = self.of_position[position];
        match self.members.get(set) {
            Some(members) => members[word / 64] >> (word % 64) & 1 == 1,
            None => self.different[set].matches(self.words[word]),
        }
    }

    /// The numbers of the words that belong to `position`, increasing: L(V) of eq. 11 before the union.
    ///
    /// Cost: O(distinct words · masks), less if every mask stands for one word.
    pub(super) fn numbers(&self, position: usize) -> Vec<usize> {
        let set = self.different[self.of_position[position]];
        if set.masks().iter().all(|mask| mask.care() == u64::MAX) {
            // Masks of full care come in the order of their words.
            let words = set.masks().iter().map(|mask| mask.value());
            return words
                .filter_map(|word| self.words.binary_search(&word).ok())
                .collect();
        }
        let mut numbers = Vec::new();
        for (at, &bits) in self.members_of(set).iter().enumerate() {
            let mut left = bits;
            while left != 0 {
                numbers.push(64 * at + left.trailing_zeros() as usize);
                left &= left - 1;
            }
        }
        numbers
    }
}
