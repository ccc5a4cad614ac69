//! p(j): which intervals are free, and how often each letter is unpartitioned.

use crate::MotionString;
use crate::extract::Substring;
use crate::extract::bits::Bits;
use crate::extract::similar::Allowed;
use crate::extract::text::Text;

/// The intervals that belong to no bundle yet.
pub(super) struct Free {
    /// Interval j joins letters j and j + 1; those between clips are never free.
    pub(super) intervals: Bits,
    none: Bits,
    /// Occurrences of each letter, in order.
    occurrences: Vec<Vec<usize>>,
    /// Of each letter: how many occurrences are unpartitioned.
    counts: Vec<usize>,
}

impl Free {
    /// All intervals within the clips of `string`.
    pub(super) fn all(string: &MotionString, text: &Text<'_>) -> Self {
        let runs = string.runs();
        let is_within = |j: usize| {
            runs.get(j + 1)
                .is_some_and(|next| next.clip == runs[j].clip)
        };
        let mut free = Self {
            intervals: (0..runs.len()).map(is_within).collect(),
            none: Bits::none(runs.len()),
            occurrences: vec![Vec::new(); text.access.n_letters()],
            counts: vec![0; text.access.n_letters()],
        };
        for (position, &letter) in text.letters.iter().enumerate() {
            free.occurrences[letter].push(position);
            free.counts[letter] += usize::from(free.is_unpartitioned(position));
        }
        free
    }

    pub(super) fn allowed(&self) -> Allowed<'_> {
        Allowed {
            free: &self.intervals,
            taken: &self.none,
        }
    }

    /// All free intervals but those `taken`.
    pub(super) fn without<'a>(&'a self, taken: &'a Bits) -> Allowed<'a> {
        Allowed {
            free: &self.intervals,
            taken,
        }
    }

    /// Whether interval `j - 1` or interval `j` is free.
    fn is_unpartitioned(&self, position: usize) -> bool {
        let is_free_before = position > 0 && self.intervals.contains(position - 1);
        is_free_before || self.intervals.contains(position)
    }

    /// Partitions the intervals of `substring`.
    pub(super) fn mark(&mut self, text: &Text<'_>, substring: Substring) {
        let positions = substring.first..=substring.last;
        let count = |free: &Self, position| usize::from(free.is_unpartitioned(position));
        for position in positions.clone() {
            self.counts[text.letters[position]] -= count(self, position);
        }
        self.intervals.remove(substring.intervals());
        for position in positions {
            self.counts[text.letters[position]] += count(self, position);
        }
    }

    /// The unpartitioned occurrences of the letter that has most of them, the smallest such letter;
    /// empty when no interval is free.
    pub(super) fn most_frequent(&self) -> Vec<usize> {
        let most = self.counts.iter().copied().max().unwrap_or(0);
        let letter = self.counts.iter().position(|&count| count == most);
        let Some(letter) = letter.filter(|_| most > 0) else {
            return Vec::new();
        };
        let occurrences = self.occurrences[letter].iter().copied();
        let is_unpartitioned = |&position: &usize| self.is_unpartitioned(position);
        occurrences.filter(is_unpartitioned).collect()
    }
}
