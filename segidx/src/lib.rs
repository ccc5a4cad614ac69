//! Search in motion clips that are given as one feature word per frame: segment them, index the segments, and ask
//! where a sequence of words or of sets of words occurs, at any speed.
//!
//! [`IndexBuilder`] takes the words and gives an [`Index`], which is a [`Shard`] in memory; [`search_exact`] and
//! [`search_adaptive`] find a [`Query`] in a shard as ranked [`Hit`]s, [`search_mismatch`] one that may be wrong at a few
//! positions, [`search_scene`] a [`Scene`] of several; [`combine`] puts the hits of several feature sets together, and
//! [`search_keyframes`] finds poses at bounded distances.
//! [`Shard::as_bytes`] and [`Shard::open`] persist it, [`Manifest`] lists the shards of a library.
//! [`IndexBuilder::build_restricted`] indexes the same documents under some of the bits.
//!
//! # Units and shapes
//!
//! A word is a `u64`, one per frame; what a bit means is the caller's. Frames, segments, documents and query
//! positions are 0-based, ranges end-exclusive. Frames count from the start of their document; segments are numbered
//! through the whole index. Durations and costs are in frames; only [`Manifest::rate_hz`] knows a rate.
//!
//! # Source
//!
//! Müller, Röder, Clausen 2005, *Efficient content-based retrieval of motion capture data*, sections 4 and 5
//! (eq. 3–11) and 6.3, and spec j.1, which fixes the adaptive fuzzy hits; ranking and combination by spec j.3. Keyframes: spec e. Against
//! the paper: numbers start at 0, hits never cross documents, and sets are unions of masks.
//!
//! # Example
//!
//! ```
//! use segidx::{IndexBuilder, Query, search_adaptive, search_exact};
//!
//! let mut builder = IndexBuilder::new();
//! builder.push("slow", [], &[0b01, 0b01, 0b11, 0b10, 0b10, 0b00])?;
//! builder.push("fast", [], &[0b01, 0b10, 0b00])?;
//! let index = builder.build();
//!
//! // As an example of three frames, on both features: only the fast clip has these segments.
//! let example = [0b01, 0b10, 0b00];
//! let hits = search_exact(&index, &Query::exact(&example, u64::MAX))?;
//! assert_eq!(hits.len(), 1);
//! assert_eq!((hits[0].doc.index(), hits[0].span()), (1, 0..3));
//!
//! // On the higher feature alone: off, on, off. The slow clip follows, at the cost of its other durations.
//! let hits = search_adaptive(&index, &Query::fuzzy(&example, 0b10))?;
//! assert_eq!(hits.len(), 2);
//! assert_eq!((hits[1].doc.index(), hits[1].cost), (0, 3));
//! assert_eq!(hits[1].segments, [0..2, 2..5, 5..6]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Cost
//!
//! Building is O(frames + segments · log segments), a query O(distinct words + candidates · positions), opening a
//! shard O(pages of 64 KiB). A shard of 39 features at 120 frames per second takes about 8 bytes per segment; the
//! first search in it adds 12 bytes of memory per distinct word.
//!
//! # Features
//!
//! None.

#![cfg_attr(test, allow(clippy::unwrap_used))]

mod builder;
mod document;
mod envelope;
mod fuzzy_set;
mod hit;
mod keyframes;
mod manifest;
mod query;
mod scene;
mod search;
mod segment;
mod shard;

pub use builder::{BuildError, BuildErrorKind, IndexBuilder};
pub use document::{DocId, Document, InvertedList};
pub use envelope::{EnvelopeError, checksum};
pub use fuzzy_set::{FuzzySet, Mask};
pub use hit::Hit;
pub use keyframes::{KeyframeAnswer, KeyframeHit, KeyframeQuery, search_keyframes};
pub use manifest::{Manifest, ManifestError, ManifestErrorKind, Restriction, ShardEntry};
pub use query::{Query, QueryPosition};
pub use scene::{Progression, Relation, RunRef, Scene, SceneError, SceneHit, search_scene};
pub use search::{
    Answer, CombinedHit, Engine, EngineCosts, MismatchError, MismatchQuery, SearchPlan, combine,
    estimate_adaptive, search_adaptive, search_adaptive_around, search_adaptive_with, search_exact,
    search_exact_with, search_mismatch, search_mismatch_with,
};
pub use segment::{Segment, segment};
pub use shard::{Index, Part, RestrictionError, Shard, ShardError, ShardErrorKind};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
