//! The built-in corpus: a procedural human that performs labelled motions.
//!
//! [`plan`] lists what there is, [`Recording::clip`] makes one clip, [`corpus`] makes all of them.
//!
//! # Units and shapes
//! Motions have an Acclaim skeleton with the bone names, axes and length unit of the CMU and HDM05
//! files: degrees and 1/0.45 inch, +Y up; a figure at zero yaw faces +Z, its left is +X. Spans of
//! labels are in frames of the clip, 0-based, end exclusive.
//!
//! # Source
//! Nothing is recorded. Motions are key poses and footstep plans with constants set by hand; inverse
//! kinematics turns them into joint angles. Segment lengths follow Winter, *Biomechanics and Motor
//! Control of Human Movement*, fig. 4.1.

mod action;
mod arms;
mod body;
mod class;
mod curve;
mod dice;
mod gait;
mod jump;
mod performer;
mod pose;
mod record;
mod settle;
mod solve;
mod strike;
mod take;
#[cfg(test)]
mod tests;

use std::ops::Range;

use mocap_io::Motion;

pub use class::Class;
pub use performer::Performer;
pub use record::{CorpusError, Recording, plan};

/// A labelled span of a clip.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Label {
    /// What is done.
    pub class: Class,
    /// In frames of the clip, end exclusive.
    pub span: Range<usize>,
}

/// A motion with its ground truth.
#[derive(Clone, Debug, PartialEq)]
pub struct Clip {
    /// Performer and what is shown, such as `anna/kick_left_02` or `anna/take_01`.
    pub name: String,
    /// Who moves.
    pub performer: Performer,
    /// What is shown; `None` for a take of several classes.
    pub class: Option<Class>,
    /// In order of time, without overlap. What is between them is standing, getting up, or walking
    /// along a curve.
    pub labels: Vec<Label>,
    /// Degrees and units of 1/0.45 inch.
    pub motion: Motion,
}

/// All clips, in the order of [`plan`]. The same seed gives the same numbers.
///
/// # Errors
/// See [`Recording::clip`].
pub fn corpus(seed: u64) -> Result<Vec<Clip>, CorpusError> {
    plan()
        .iter()
        .map(|recording| recording.clip(seed))
        .collect()
}
