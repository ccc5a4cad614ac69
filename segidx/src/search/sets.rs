//! Which distinct words belong to which position of a query.

use crate::QueryPosition;
use crate::shard::Dictionary;

/// A bit per distinct word for each set of a query, so that asking about a segment is one look-up by the number of
/// its word.
pub(super) struct Sets {
    /// Per different set: bit i of the words is set if word i of the dictionary belongs to it.
    members: Vec<Vec<u64>>,
    /// Per position: its set among `members`. Queries by example come back to the same sets.
    of_position: Vec<usize>,
}

impl Sets {
    /// Cost: O(distinct words · masks).
    pub(super) fn new(dictionary: &Dictionary, positions: &[QueryPosition]) -> Sets {
        let mut different: Vec<&QueryPosition> = Vec::new();
        let mut of_position = Vec::with_capacity(positions.len());
        for position in positions {
            let known = different.iter().position(|d| d.set == position.set);
            of_position.push(known.unwrap_or(different.len()));
            if known.is_none() {
                different.push(position);
            }
        }
        let members = different.iter().map(|position| {
            let mut members = vec![0; dictionary.words.len().div_ceil(64)];
            for mask in position.set.masks() {
                for (bits, words) in members.iter_mut().zip(dictionary.words.chunks(64)) {
                    for (i, &word) in words.iter().enumerate() {
                        *bits |= u64::from(mask.matches(word)) << i;
                    }
                }
            }
            members
        });
        Sets {
            members: members.collect(),
            of_position,
        }
    }

    /// Whether word number `word` of the dictionary belongs to `position`.
    #[inline]
    pub(super) fn holds(&self, position: usize, word: usize) -> bool {
        self.members[self.of_position[position]][word / 64] >> (word % 64) & 1 == 1
    }

    /// The numbers of the words that belong to `position`, increasing.
    pub(super) fn numbers(&self, position: usize) -> impl Iterator<Item = usize> {
        let members = self.members[self.of_position[position]].iter().enumerate();
        members.flat_map(|(at, &bits)| {
            let mut left = bits;
            std::iter::from_fn(move || {
                let bit = left.trailing_zeros() as usize;
                // Clears the lowest bit; there is none left at zero.
                left &= left.checked_sub(1)?;
                Some(64 * at + bit)
            })
        })
    }

    /// Number of words that belong to `position`.
    pub(super) fn n_words(&self, position: usize) -> usize {
        let members = &self.members[self.of_position[position]];
        members.iter().map(|bits| bits.count_ones() as usize).sum()
    }
}
