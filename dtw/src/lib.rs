//! Dynamic time warping of multi-dimensional sequences.
//!
//! [`Dtw`] is the entry type: it holds a band and a local cost, and compares two sequences
//! ([`Dtw::distance`], [`Dtw::align`]) or anything with a cost per pair of frames
//! ([`Dtw::distance_with`], [`Dtw::align_with`]).
//!
//! # Units and shapes
//!
//! A sequence is a view of shape `(frames, dims)`; frames are 0-based. Elements are anything that
//! converts into `f64` without loss, such as `f32` or `f64`; all sums are made in `f64`, in order
//! of frames and dimensions, so a result is the same on every run. A cost has the unit of the
//! dimensions (their square for [`LocalCost::SquaredEuclidean`]). A [`BandRadius`] counts cells to
//! either side of `i = j`; 0 is the diagonal.
//!
//! *No path* is `None`, never a number: when either sequence is empty, when the band does not
//! reach the last pair of frames, and when every path crosses a pair whose local cost is not
//! finite. So a frame with a NaN aligns with nothing.
//!
//! # Source
//!
//! Sakoe and Chiba, *Dynamic programming algorithm optimization for spoken word recognition*
//! (1978), with steps (1,1), (0,1), (1,0) of weight 1 in place of their symmetric weights. For
//! unequal lengths the band stays around `i = j` and is not slanted.
//!
//! # Example
//!
//! ```
//! use dtw::ndarray::array;
//! use dtw::{BandRadius, Dtw};
//!
//! let a = array![[0.0], [1.0], [2.0], [2.0]];
//! let b = array![[0.0], [0.0], [1.0], [3.0]];
//! let path = Dtw::new(BandRadius::cells(1)).align(a.view(), b.view())?.expect("a path exists");
//! assert_eq!(path.cost, 2.0);
//! assert_eq!(path.steps, [(0, 0), (0, 1), (1, 2), (2, 2), (3, 3)]);
//! # Ok::<(), dtw::DtwError>(())
//! ```
//!
//! # Cost
//!
//! With sequences of n and m frames and a band of radius r, time is O(n·min(m, 2r+1)) local costs.
//! A distance takes O(m) memory, a path one byte for each cell of the band.
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

mod aligned;
mod band;
mod costs;
mod dtw;
mod engine;
mod error;
mod lanes;
mod local;
mod matrix;
mod parallel;
mod path;
mod sample;
mod search;
mod step;
mod strip;

pub use band::{Band, BandRadius, Slope};
pub use dtw::Dtw;
pub use error::DtwError;
pub use local::{LocalCost, Missing};
pub use path::WarpingPath;
pub use sample::Sample;
pub use search::{Neighbour, Search, Window};
pub use step::{Ends, Step, StepPattern};
