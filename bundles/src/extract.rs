//! Motion bundles: sets of similar substrings that partition the motion string (sections 3.3, 3.4).

use std::ops::Range;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::{Accessibility, MotionString};

mod bits;
mod closure;
mod extend;
mod free;
mod largest;
mod length;
mod rounds;
mod similar;
mod text;

pub(crate) use extend::check;
pub use extend::extend;
pub use length::max_letters;

/// Letters from `first` to `last`, both included, of one clip; at least two.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Substring {
    /// Index of the first letter.
    pub first: usize,
    /// Index of the last letter.
    pub last: usize,
}

impl Substring {
    /// The intervals between its letters; interval j joins letters j and j + 1.
    pub fn intervals(self) -> Range<usize> {
        self.first..self.last
    }

    /// Whether an interval belongs to both. Substrings that only share a letter share none.
    pub fn shares_interval(self, other: Self) -> bool {
        self.first < other.last && other.first < self.last
    }
}

/// Similar substrings, none of which share an interval.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StringBundle {
    /// The substrings by position, at least two; their number is the height B_h.
    pub members: Vec<Substring>,
    /// The width B_w, in frames: the mean of F̄(last) - F̄(first).
    pub mean_width: f64,
    /// The volume V = (B_h - 1)·B_w^ρ (equation 3).
    pub volume: f64,
}

impl StringBundle {
    /// The bundle of these members; `None` when there is none, or one is no substring of a clip.
    pub(crate) fn measured(
        members: Vec<Substring>,
        string: &MotionString,
        rho: f64,
    ) -> Option<Self> {
        // Widths are whole numbers of half frames, so that their sum is exact.
        let widths = members
            .iter()
            .map(|member| string.width(member.first, member.last));
        let sum: f64 = widths.sum::<Option<f64>>()?;
        let mean_width = sum / members.len() as f64;
        (!members.is_empty()).then(|| Self::new(members, mean_width, rho))
    }

    fn new(members: Vec<Substring>, mean_width: f64, rho: f64) -> Self {
        let others = members.len().saturating_sub(1);
        Self {
            volume: others as f64 * mean_width.powf(rho),
            mean_width,
            members,
        }
    }
}

/// Every interval of a motion string in one bundle.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Partition {
    /// The bundles in the order of their extraction.
    pub bundles: Vec<StringBundle>,
    /// What remains, by position: bundles of a single submotion. No two of a clip are adjacent.
    pub degenerate: Vec<Substring>,
}

/// How far the similarity of substrings is followed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Closure {
    /// To what is similar to a member, and so on (equation 5).
    Transitive,
    /// To what is similar to the seed itself.
    Direct,
}

/// Which occurrence of which letter a bundle grows from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum SeedInstance {
    /// The first unpartitioned one of the most frequent letter.
    First,
    /// Any unpartitioned one of that letter, by ChaCha with eight rounds under this seed: of n it takes number
    /// ⌊n·x / 2⁶⁴⌋ from the left, x the next 64 bits. One x is drawn for each bundle.
    Random(u64),
    /// Every unpartitioned letter, so that each bundle is the largest there is. The paper does not
    /// do this: it is slower, but nothing hangs on which letter comes first.
    Largest,
}

/// What makes a bundle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ExtractOptions {
    /// The largest number λ of letters in a submotion, at least 2; see [`max_letters`].
    pub max_letters: usize,
    /// The bias ρ towards long submotions, finite and at least 0.
    pub rho: f64,
    /// The least ratio γ of widths in a bundle, 0 to 1; at 0, widths do not matter.
    pub gamma: f64,
    /// How far similarity is followed.
    pub closure: Closure,
    /// Which occurrence of which letter a bundle grows from.
    pub seed: SeedInstance,
}

impl ExtractOptions {
    /// The paper's values for substrings of up to `max_letters` letters: ρ = 1, γ = 0.8, the
    /// transitive closure, and instances at random under seed 0.
    pub const fn new(max_letters: usize) -> Self {
        Self {
            max_letters,
            rho: 1.0,
            gamma: 0.8,
            closure: Closure::Transitive,
            seed: SeedInstance::Random(0),
        }
    }

    pub(crate) fn check(&self) -> Result<(), ExtractError> {
        let (found, rho, gamma) = (self.max_letters, self.rho, self.gamma);
        if found < 2 {
            return Err(ExtractError::MaxLetters { found });
        }
        if !(rho.is_finite() && rho >= 0.0) {
            return Err(ExtractError::Rho { found: rho });
        }
        if !(0.0..=1.0).contains(&gamma) {
            return Err(ExtractError::Gamma { found: gamma });
        }
        Ok(())
    }
}

/// Why no bundles can be extracted.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ExtractError {
    /// Substrings would have no interval.
    #[error("expected substrings of at least 2 letters, found {found}")]
    MaxLetters {
        /// The largest number of letters.
        found: usize,
    },
    /// The bias is negative or not finite.
    #[error("expected a finite rho of at least 0, found {found}")]
    Rho {
        /// The bias.
        found: f64,
    },
    /// The ratio is no ratio of the smaller to the larger.
    #[error("expected gamma from 0 to 1, found {found}")]
    Gamma {
        /// The ratio.
        found: f64,
    },
    /// The string uses a letter that the accessibility matrix lacks.
    #[error("letter {position}: expected a label below {n_letters}, found {letter}")]
    UnknownLetter {
        /// Index in the string.
        position: usize,
        /// The label.
        letter: u32,
        /// Number of letters of the matrix.
        n_letters: usize,
    },
    /// A substring of a partition has no interval, leaves its clip, or shares an interval with
    /// another.
    #[error("expected disjoint substrings within clips, found letters {first}..={last}")]
    Overlap {
        /// Its first letter.
        first: usize,
        /// Its last letter.
        last: usize,
    },
    /// A partition covers a clip in part.
    #[error("clip {clip}: expected all or none of it partitioned, found {found} of {n_intervals}")]
    Partly {
        /// Index of the clip.
        clip: usize,
        /// Intervals covered.
        found: usize,
        /// Intervals of the clip.
        n_intervals: usize,
    },
}

/// Partitions `string` into bundles of similar substrings.
///
/// Round by round, the most frequent unpartitioned letter (ties: the smallest label) gives a seed
/// position c. Every free substring of up to λ letters that contains c is a seed. Its set begins
/// with the seed; each member in turn, in order of acceptance, brings the free substrings of up to
/// λ letters that a valid path of near letters links to it and whose widths are like the seed's
/// (γ times the wider is at most the narrower). They are accepted by mean distance along the best
/// path (the one of least sum, then of fewest cells), difference of widths, and position, except
/// those that share an interval with a member. Afterwards one pass removes members whose widths are
/// not like the mean; the seed stays. The set of largest volume becomes a bundle (ties: the larger
/// height, then the smaller seed). If every set is its seed alone, the narrower free interval next
/// to c is degenerate (ties: left). At the end, adjacent degenerate submotions merge.
///
/// Under [`SeedInstance::Largest`] there is no c: all free substrings of up to λ letters are seeds,
/// and when every set is its seed alone, all that is free is degenerate.
///
/// # Errors
///
/// When an option is out of its range, or a letter is not in `access`.
///
/// # Cost
///
/// Let f be the share of near letters among all pairs. Memory is O(m·(κ + λ)) bits. A round visits
/// up to λ first letters and f·m candidates for each, with O(λ) words of work where rows stay
/// alive, and as much for each member of each seed's closure. Each set of members is disjoint, so
/// seeds of n letters have at most m/n members. [`SeedInstance::Largest`] takes O(m²) bits more; its
/// first round visits m first letters, and each further one those that a bundle took something from.
pub fn extract(
    string: &MotionString,
    access: &Accessibility,
    options: &ExtractOptions,
) -> Result<Partition, ExtractError> {
    extend(&Partition::default(), string, access, options)
}
