//! Columns that tell where in a library a template may match.

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
