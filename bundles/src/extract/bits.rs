//! Sets of positions as words of bits.

use std::ops::Range;

/// A set of positions; reads past its end find nothing.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Bits(Vec<u64>);

impl FromIterator<bool> for Bits {
    fn from_iter<I: IntoIterator<Item = bool>>(members: I) -> Self {
        let mut words = Vec::new();
        for (position, is_member) in members.into_iter().enumerate() {
            if position % 64 == 0 {
                words.push(0);
            }
            if is_member {
                words[position / 64] |= 1 << (position % 64);
            }
        }
        Self(words)
    }
}

impl Bits {
    /// No position of 0..`len`.
    pub(super) fn none(len: usize) -> Self {
        Self(vec![0; len.div_ceil(64)])
    }

    pub(super) fn clear(&mut self) {
        self.0.fill(0);
    }

    pub(super) fn words(&self) -> &[u64] {
        &self.0
    }

    /// The 64 positions from `at` on, the first in the lowest bit.
    pub(super) fn window(&self, at: usize) -> u64 {
        let (word, shift) = (at / 64, at % 64);
        let read = |word| self.0.get(word).copied().unwrap_or(0);
        if shift == 0 {
            return read(word);
        }
        read(word) >> shift | read(word + 1) << (64 - shift)
    }

    pub(super) fn contains(&self, position: usize) -> bool {
        self.window(position) & 1 == 1
    }

    pub(super) fn insert(&mut self, positions: Range<usize>) {
        self.each_word(positions, |word, mask| *word |= mask);
    }

    pub(super) fn remove(&mut self, positions: Range<usize>) {
        self.each_word(positions, |word, mask| *word &= !mask);
    }

    fn each_word(&mut self, positions: Range<usize>, mut change: impl FnMut(&mut u64, u64)) {
        let mut at = positions.start;
        while at < positions.end {
            let n = (64 - at % 64).min(positions.end - at);
            change(&mut self.0[at / 64], lowest(n) << (at % 64));
            at += n;
        }
    }

    /// Whether one of `positions` is in the set.
    pub(super) fn meets(&self, positions: Range<usize>) -> bool {
        let mut at = positions.start;
        while at < positions.end {
            let n = (positions.end - at).min(64);
            if self.window(at) & lowest(n) != 0 {
                return true;
            }
            at += n;
        }
        false
    }
}

/// The lowest `n` bits, at most 64.
pub(super) fn lowest(n: usize) -> u64 {
    match n {
        0 => 0,
        n => u64::MAX >> (64 - n.min(64)),
    }
}

/// Positions of the bits of `word`, in increasing order.
pub(super) fn ones(mut word: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let position = word.trailing_zeros();
        word &= word.checked_sub(1)?;
        Some(position as usize)
    })
}

#[cfg(test)]
mod tests;
