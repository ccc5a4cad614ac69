//! Sets of feature words, written as masks.

use crate::segment;

/// The set of words that agree with `value` on the bits of `care`.
///
/// Bits outside `care` are free, so one mask stands for 2^(free bits) words. `care == 0` is the set of all words,
/// `care == u64::MAX` the set of one word.
///
/// Source: spec j.1, "store masks, not sets".
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Mask {
    care: u64,
    value: u64,
}

impl Mask {
    /// A mask; bits of `value` outside `care` are dropped, so equal sets compare equal.
    pub fn new(care: u64, value: u64) -> Mask {
        Mask {
            care,
            value: value & care,
        }
    }

    /// The set of exactly one word.
    pub fn word(word: u64) -> Mask {
        Mask::new(u64::MAX, word)
    }

    /// The bits a word must agree on.
    pub fn care(&self) -> u64 {
        self.care
    }

    /// The bits to agree with; zero outside [`care`](Self::care).
    pub fn value(&self) -> u64 {
        self.value
    }

    /// Whether `word` belongs to the set.
    #[inline]
    pub fn matches(&self, word: u64) -> bool {
        (word ^ self.value) & self.care == 0
    }

    /// Whether some word belongs to both sets: the values agree on every bit both care about.
    pub fn intersects(&self, other: &Mask) -> bool {
        (self.value ^ other.value) & self.care & other.care == 0
    }
}

/// A union of [`Mask`]s: the alternatives one query position accepts.
///
/// A set without masks is allowed and matches no word.
///
/// Source: 2005 paper, section 5.2, the V_ℓ of eq. 9.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct FuzzySet {
    // Sorted and without duplicates, so that the same masks in another order are the same set.
    masks: Vec<Mask>,
}

impl FuzzySet {
    /// The union of `masks`.
    pub fn new(masks: impl IntoIterator<Item = Mask>) -> FuzzySet {
        let mut masks: Vec<Mask> = masks.into_iter().collect();
        masks.sort_unstable();
        masks.dedup();
        FuzzySet { masks }
    }

    /// The set of exactly these words.
    pub fn from_words(words: impl IntoIterator<Item = u64>) -> FuzzySet {
        FuzzySet::new(words.into_iter().map(Mask::word))
    }

    /// The words that agree with one of the example `words` on the bits of `care`.
    pub fn of_example(words: &[u64], care: u64) -> FuzzySet {
        FuzzySet::new(segment(words).iter().map(|run| Mask::new(care, run.word)))
    }

    /// The masks, sorted by `(care, value)`, each once.
    pub fn masks(&self) -> &[Mask] {
        &self.masks
    }

    /// Whether `word` belongs to the set. Cost: O(masks).
    #[inline]
    pub fn matches(&self, word: u64) -> bool {
        self.masks.iter().any(|mask| mask.matches(word))
    }

    /// Whether some word belongs to both sets. Cost: O(masks of one × masks of the other).
    pub fn intersects(&self, other: &FuzzySet) -> bool {
        self.masks
            .iter()
            .any(|a| other.masks.iter().any(|b| a.intersects(b)))
    }

    /// The union of two sets. Cost: O(n log n) in the masks of both.
    pub fn union(&self, other: &FuzzySet) -> FuzzySet {
        FuzzySet::new(self.masks.iter().chain(&other.masks).copied())
    }
}

impl From<Mask> for FuzzySet {
    fn from(mask: Mask) -> FuzzySet {
        FuzzySet { masks: vec![mask] }
    }
}

#[cfg(test)]
mod tests;
