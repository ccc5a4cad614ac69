//! Columns that tell where in a library a template may match.

mod automatic;
mod chains;
mod examples;
mod preselection;
mod trace;

pub use automatic::{AutomaticConfig, choose_keyframes};
pub use examples::{ExampleConfig, Examples, LearnedKeyframes, learn_keyframes};
pub use preselection::{Preselection, PreselectionError};

/// A column of a template, cut down to some features.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Keyframe {
    /// Column of the template.
    pub column: usize,
    /// Features that are asked for.
    pub care: u64,
    /// What they have to be; bits outside `care` are 0.
    pub value: u64,
    /// Stiffness σ in (0, 1] of the distance d to the keyframe before: frames between the two number
    /// from ⌈σd⌉ to ⌊d/σ⌋ (spec.md e).
    pub stiffness: f64,
}

impl Keyframe {
    /// A stiffness that loses no match by its timing alone: a step of a match passes one column in two frames or two
    /// columns in one, so a match is between half and twice as fast as the template.
    pub const LOOSE: f64 = 0.5;

    /// Whether a word is as the keyframe asks.
    #[inline]
    pub fn accepts(&self, word: u64) -> bool {
        (word ^ self.value) & self.care == 0
    }
}
