//! Dynamic time warping of multi-dimensional sequences.
//!
//! [`Dtw`] is the entry type: a [`Band`], a [`LocalCost`], a [`StepPattern`] and [`Ends`]. It
//! compares two sequences ([`Dtw::distance`], [`Dtw::align`]), anything with a cost per pair of
//! frames ([`Dtw::distance_with`], [`Dtw::align_with`]) or a matrix of them ([`Dtw::distance_of`],
//! [`Dtw::align_of`]).
//!
//! # Units and shapes
//!
//! A sequence is a view of shape `(frames, dims)` of `f32` or `f64`; frames are 0-based, i counts
//! the first sequence's and j the second's. A cost has the unit of the dimensions (their square for
//! [`LocalCost::SquaredEuclidean`]) and is never a root of a sum along the path. A [`BandRadius`]
//! counts cells; 0 is the diagonal.
//!
//! *No path* is `None`, never a number: when either sequence is empty, when the band cuts off every
//! path, when the steps cannot reach the end, and when every path crosses a pair whose local cost
//! is not finite. What a NaN means is [`Missing`].
//!
//! `f64` gives the textbook's sums, in order, on every machine. `f32` expands squared distances to
//! |a|² + |b|² - 2 ab about the mean of both sequences and sums the differences again wherever that
//! cancels, so that a local cost is wrong by (dims + 4) 2⁻²¹ of itself at most; results may differ
//! in that order between machines with and without fused operations, and never between runs.
//!
//! # Source
//!
//! D(i,j) = min over steps (di, dj, w) of D(i-di,j-dj) + w C(i,j): Sakoe and Chiba, *Dynamic
//! programming algorithm optimization for spoken word recognition* (1978); Itakura (1975) for his
//! band; Müller, *Information Retrieval for Music and Motion* (2007), chapter 4, for slope limits
//! and subsequences. A path's first cell costs C once, whatever the pattern. Paths too large for
//! memory follow Hirschberg (1975).
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
//! Time is one local cost for each cell of the band, and a little more at its rims. Beside a copy of
//! the second sequence, a distance takes memory for one row of the band; a path two bits a cell
//! (four for patterns of one's own) up to [`Dtw::with_path_memory`], and beyond that as much as
//! allowed and a few rows, in about twice the time.
//!
//! # Features
//!
//! `rayon` (default): distance matrices and searches use all threads, with the same results.

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
