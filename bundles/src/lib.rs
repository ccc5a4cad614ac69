//! Motion strings: clips spelt in letters, each letter a cluster of similar poses.
//!
//! [`Pca`] reduces pose vectors to a few components, [`fit_mixture`] or [`exemplars`] clusters those
//! as [`PoseClusters`], which [label](PoseClusters::label) frames, [`spell`] makes a
//! [`MotionString`] of the labels, and [`adjacent_distance_median`] tells from which distance on
//! letters differ.
//!
//! # Units and shapes
//!
//! Pose vectors are `f64` of shape `(frames, dims)`, in any unit: [`Pca`] standardises them.
//! Frames count from 0 through all clips together, and a clip is a half-open range of them. Labels
//! are one `u32` for each frame; label a is row a of the cluster means, of shape
//! `(letters, dims)`, and element a of standard deviations and weights, all `f64`. A distance
//! between letters has no unit: it counts standard deviations. Mean frames are `f64` frame indices
//! and may end in one half.
//!
//! A [`Substring`] has a first and a last letter, both included; the half-open range from one to
//! the other counts the intervals between them, which bundles share out. Poses are
//! `(frames, dims)`, `f64`. A [`Submotion`] is a half-open range of frames; the pose at its end is
//! the first of what follows it. What precedes the first frame chosen in a clip, and what follows
//! the last, is in no submotion: part of one letter each. A clip of one letter has none.
//!
//! # Source
//!
//! Beaudoin, van de Panne and Poulin, *Automatic construction of compact motion graphs* (technical
//! report 1296, 2007), sections 3.1 to 4. Where it is silent: dimensions are standardised before
//! PCA, those that do not vary left out; EM starts from k-means++ and ends after 100 iterations or
//! a change below 1e-4 of the log-likelihood; no variance is below 1e-6 of the mean variance;
//! responsibilities below e^-80 of a frame's largest are nothing; a cluster with less than 1e-6
//! frames is put at the frame of least density; labels are by likelihood without weight; σ in
//! equation 1 is a standard deviation; the threshold τ is the median distance of neighbouring
//! letters, clip boundaries left out; equal letters on both sides of a clip boundary stay two.
//!
//! Sections 3.3 to 4 are [`extract`] to [`BundleGraph::walk_along`]; each says how it fills the
//! paper's gaps. Deviations: [`exemplars`] and [`SeedInstance::Largest`], which the paper does not
//! have; members of a bundle share no interval, and have at most λ letters as seeds have; the
//! closure stays among widths like the seed's; the objective of [`map_frames`] has traces where the
//! paper prints determinants.
//!
//! # Example
//!
//! ```
//! use std::num::NonZeroUsize;
//!
//! use bundles::ndarray::array;
//! use bundles::{EmOptions, Kappa, LabelRule, Pca, adjacent_distance_median, fit_mixture, spell};
//!
//! let poses = array![[0.0, 5.0], [0.1, 5.0], [9.0, 5.0], [9.1, 5.0], [0.1, 5.0]];
//! let pca = Pca::fit(poses.view(), bundles::PAPER_SHARE)?;
//! let reduced = pca.project(poses.view())?;
//! assert_eq!(reduced.dim(), (5, 1));
//!
//! let kappa = NonZeroUsize::new(2).map_or(Kappa::Auto, Kappa::Letters);
//! let clusters = fit_mixture(reduced.view(), &EmOptions::new(kappa))?.clusters;
//! let labels = clusters.label(reduced.view(), LabelRule::Likelihood)?;
//! let string = spell(&labels, &[0..5])?;
//! let mean_frames: Vec<f64> = string.runs().iter().map(|run| run.mean_frame()).collect();
//! assert_eq!(mean_frames, [0.5, 2.5, 4.0]);
//! assert!(adjacent_distance_median(&string, &clusters)?.is_some_and(|tau| tau > 100.0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! What occurs twice becomes a bundle:
//!
//! ```
//! use bundles::ndarray::Array2;
//! use bundles::{Accessibility, ExtractOptions, extract, spell};
//!
//! let string = spell(&[0, 0, 1, 2, 3, 0, 1, 1, 2], &[0..9])?;
//! let apart = Array2::from_shape_fn((4, 4), |(a, b)| if a == b { 0.0 } else { 9.0 });
//! let access = Accessibility::new(apart.view(), 1.0)?;
//! let partition = extract(&string, &access, &ExtractOptions::new(3))?;
//! assert_eq!(partition.bundles[0].members.len(), 2);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Cost
//!
//! PCA takes O(frames·dims² + dims³) time; an iteration of EM, the seeding and labels
//! O(frames·letters·dims), in vectors of the processor's width, and O((frames + letters)·dims)
//! memory, with up to 64 copies of the letters' part in EM. Spelling takes O(frames) time and O(runs) memory; the
//! median O(runs·dims) time and O(runs) memory. [`extract`], [`map_frames`] and [`link`] state theirs.
//!
//! # Features
//!
//! `rayon` (default): PCA, mixtures, labels and the seeds of a round use all threads, with the same
//! results.

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
mod mixture;
mod model;
mod parallel;
mod pca;
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
pub use mixture::{
    EmOptions, Kappa, KappaCandidate, LabelRule, MixtureError, MixtureFit, exemplars, fit_mixture,
    fit_mixture_from,
};
pub use model::{BundleModel, EnvelopeError, ModelError, ModelErrorKind};
pub use pca::{PAPER_SHARE, Pca, PcaError};
pub use spell::{Letter, MotionString, Run, spell};
pub use threshold::adjacent_distance_median;
pub use walk::{BlendFrame, DeadEnds, Piece, RandomWalk, Walk, WalkError};
