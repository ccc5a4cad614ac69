//! A template with everything that a reader has to know of it.

use crate::{Keyframe, MotionTemplate};

/// The template of a class of motions: what its features are and how it is to be used.
#[derive(Debug, Clone, PartialEq)]
pub struct ClassTemplate {
    /// Name of the class.
    pub name: String,
    /// Name of the feature set whose words it is for.
    pub feature_set: String,
    /// Words per second.
    pub rate: f64,
    /// Name of each feature, in the order of the bits.
    pub features: Vec<String>,
    /// Values and weights.
    pub template: MotionTemplate,
    /// Number of motions it was learned from; `None` for a template written by hand.
    pub n_motions: Option<usize>,
    /// Quality threshold τ learned for this class.
    pub tau: Option<f64>,
    /// Columns that preselect candidates, in ascending order.
    pub keyframes: Vec<Keyframe>,
}
