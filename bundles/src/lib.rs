//! Motion strings: clips spelt in letters, each letter a cluster of similar poses.
//!
//! [`spell`] turns a label for each frame into a [`MotionString`]; [`PoseClusters`] tells how far
//! apart two letters are, and [`adjacent_distance_median`] from which distance on they differ.
//!
//! # Units and shapes
//!
//! Frames count from 0 through all clips together, and a clip is a half-open range of them. Labels
//! are one `u32` for each frame; label a is row a of the cluster means, of shape
//! `(letters, dims)`, and element a of the standard deviations, both `f64` in the caller's unit. A
//! distance between letters has no unit: it counts standard deviations. Mean frames are `f64`
//! frame indices and may end in one half.
//!
//! # Source
//!
//! Beaudoin, van de Panne and Poulin, *Automatic construction of compact motion graphs* (technical
//! report 1296, 2007), sections 3.1 and 3.2. Where it is silent: σ in equation 1 is a standard
//! deviation; the threshold τ is the median distance of neighbouring letters, clip boundaries left
//! out; equal letters on both sides of a clip boundary stay two.
//!
//! # Example
//!
//! ```
//! use bundles::ndarray::array;
//! use bundles::{PoseClusters, adjacent_distance_median, spell};
//!
//! let string = spell(&[0, 0, 1, 2, 2, 2], &[0..3, 3..6])?;
//! let mean_frames: Vec<f64> = string.runs().iter().map(|run| run.mean_frame()).collect();
//! assert_eq!(mean_frames, [0.5, 2.0, 4.0]);
//!
//! let means = array![[0.0], [3.0], [9.0]];
//! let clusters = PoseClusters::new(means.view(), array![1.0, 2.0, 1.0].view())?;
//! assert_eq!(adjacent_distance_median(&string, &clusters)?, Some(3.0));
//! # Ok::<(), bundles::BundlesError>(())
//! ```
//!
//! # Cost
//!
//! Spelling takes O(frames) time and O(runs) memory; the median O(runs·dims) time and O(runs)
//! memory.
//!
//! # Features
//!
//! None.

#![cfg_attr(test, allow(clippy::unwrap_used))]

pub use ndarray;

/// Keeps the README's examples compiling.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

mod clusters;
mod draw;
mod error;
mod extract;
mod graph;
mod letters;
mod mapping;
mod model;
mod parallel;
mod spell;
mod threshold;
mod walk;

pub use clusters::PoseClusters;
pub use error::BundlesError;
pub use extract::{
    Closure, ExtractError, ExtractOptions, Partition, SeedInstance, StringBundle, Substring,
    extend, extract, max_letters,
};
pub use graph::{Bundle, BundleGraph, Edge, GraphFlaw, Passage, Submotion, link};
pub use letters::{Accessibility, AccessibilityError};
pub use mapping::{FrameMapping, MappingError, MappingOptions, map_frames};
pub use model::{BundleModel, EnvelopeError, ModelError, ModelErrorKind};
pub use spell::{Letter, MotionString, Run, spell};
pub use threshold::adjacent_distance_median;
pub use walk::{BlendFrame, DeadEnds, Piece, RandomWalk, Walk, WalkError};
