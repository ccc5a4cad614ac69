//! The string as the search reads it: letters as rows of bits over positions, middles as integers.

use crate::extract::Substring;
use crate::extract::bits::Bits;
use crate::{Accessibility, ExtractError, MotionString};

/// What does not change while bundles are extracted.
pub(super) struct Text<'a> {
    pub(super) access: &'a Accessibility,
    pub(super) letters: Vec<usize>,
    /// Twice the mean frame of each run, so that all widths are integers, in half frames.
    middles: Vec<usize>,
    /// Of each letter: the positions whose letter is near it. Empty for letters not in the string.
    near: Vec<Bits>,
    pub(super) max_letters: usize,
}

impl<'a> Text<'a> {
    pub(super) fn new(
        string: &MotionString,
        access: &'a Accessibility,
        max_letters: usize,
    ) -> Result<Self, ExtractError> {
        let n_letters = access.n_letters();
        let mut letters = Vec::with_capacity(string.len());
        let mut is_used = vec![false; n_letters];
        for (position, run) in string.runs().iter().enumerate() {
            let label = run.letter.label();
            let letter = usize::try_from(label).ok().filter(|&row| row < n_letters);
            let letter = letter.ok_or(ExtractError::UnknownLetter {
                position,
                letter: label,
                n_letters,
            })?;
            is_used[letter] = true;
            letters.push(letter);
        }
        let near = (0..n_letters).map(|letter| {
            if !is_used[letter] {
                return Bits::default();
            }
            let row = access.near_row(letter);
            let is_near = |other: &usize| row[other / 64] >> (other % 64) & 1 == 1;
            letters.iter().map(is_near).collect()
        });
        let near = near.collect();
        let frames = string.runs().iter().map(|run| &run.frames);
        Ok(Self {
            access,
            middles: frames.map(|f| f.start + f.end.saturating_sub(1)).collect(),
            letters,
            near,
            max_letters,
        })
    }

    pub(super) fn len(&self) -> usize {
        self.letters.len()
    }

    /// Positions whose letter is near the one at `position`.
    pub(super) fn near(&self, position: usize) -> &Bits {
        &self.near[self.letters[position]]
    }

    /// Width in half frames.
    pub(super) fn width(&self, substring: Substring) -> usize {
        self.middles[substring.last] - self.middles[substring.first]
    }

    /// How many letters from `first` on, up to `last`, are at most `width` half frames away from it.
    pub(super) fn letters_within(&self, first: usize, last: usize, width: usize) -> usize {
        let middles = &self.middles[first..=last];
        middles.partition_point(|middle| middle - middles[0] <= width)
    }
}

/// Widths, in half frames, that are like a reference: the smaller of the two is at least γ times
/// the larger.
#[derive(Debug, Clone, Copy)]
pub(super) struct Band {
    pub(super) least: usize,
    pub(super) most: usize,
}

impl Band {
    pub(super) fn around(reference: f64, gamma: f64) -> Self {
        if gamma == 0.0 {
            return Self {
                least: 0,
                most: usize::MAX,
            };
        }
        /// Beyond any width, and far below where `f64` skips integers.
        const WIDEST: f64 = 1e15;
        if reference / gamma > WIDEST {
            let least = (gamma * reference).ceil() as usize;
            let most = usize::MAX;
            return Self { least, most };
        }
        // Quotients are rounded: the products decide, as they do for a single width.
        let mut least = (gamma * reference).floor() as usize;
        while (least as f64) < gamma * reference {
            least += 1;
        }
        let mut most = (reference / gamma).ceil() as usize;
        while gamma * most as f64 > reference {
            most -= 1;
        }
        while gamma * (most + 1) as f64 <= reference {
            most += 1;
        }
        Self { least, most }
    }

    pub(super) fn contains(self, width: usize) -> bool {
        (self.least..=self.most).contains(&width)
    }
}
