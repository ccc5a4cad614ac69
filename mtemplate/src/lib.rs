//! Motion templates over feature words: learned from the motions of a class, quantised to 0, 1 and
//! wildcards, and matched against clips.
//!
//! [`MotionTemplate`] is the entry type. [`MotionTemplate::quantize`] gives a
//! [`QuantizedTemplate`], and its [`distance_curve`](QuantizedTemplate::distance_curve) tells for
//! every frame of a clip how well a stretch that ends there matches.
//! [`ClassTemplate`] adds what a template is called and for, and is what files hold: text that people
//! write and compare ([`ClassTemplate::to_text`] shows it), or bytes.
//!
//! # Units and shapes
//!
//! A clip is a slice with one `u64` word for each frame; bit i is feature i, and there are 1 to 64
//! features. What a bit means is the caller's. A template of K columns (the papers' word for its
//! frames) and f features is an array of shape `(columns, features)` with values in \[0, 1\] and a
//! weight for each column, a share of time in frames. Columns, features and frames are 0-based.
//! A cost is a mean over template columns; with weights of at most 1 it lies in \[0, 1\]. A frame
//! where no match can end has no cost: `None`.
//!
//! # Source
//!
//! Müller and Röder, *Motion templates for automatic classification and retrieval of motion
//! capture data* (2006), sections 4 and 5. Two details follow what the authors ran and not what
//! they printed: steps (template, data) of (1,1), (1,2), (2,1) weigh 1, 1, 2, so that the weights
//! of a path sum to K (equation 2 has none); and a column of weight α counts (α + 1)/2. Values
//! exactly at a threshold are quantised to 0 and 1.
//!
//! A clip that is too short for any match has no cost, as printed; [`ShortClips::Held`] is ours.
//!
//! Learning aligns with weights in the cost, as the authors did. A motion's weight is kept where
//! theirs lost some: a column shared by n columns of the reference gives α/n to each. Averages are
//! unwarped as printed, to weights of 1, unless [`Unwarp::Balance`] asks for what was run. A
//! threshold τ for each class ([`learn_tau`]) is ours.
//!
//! # Example
//!
//! ```
//! use mtemplate::{MatchConfig, MotionTemplate};
//!
//! let template = MotionTemplate::from_words(&[0b01, 0b11, 0b10], 2)?.quantize(0.1)?;
//! let matches = template.find_matches(&[0b00, 0b01, 0b11, 0b10, 0b10], &MatchConfig::up_to(0.1));
//! assert_eq!((matches[0].span.clone(), matches[0].cost), (1..4, 0.0));
//! # Ok::<(), mtemplate::TemplateError>(())
//! ```
//!
//! # Cost
//!
//! Reading and writing files takes time and memory in proportion to K·f. Learning from N motions takes
//! O(N²·K²·f) time for each of a few iterations: 26 motions of 45 columns and 39 features some 26
//! million differences. Quantising takes O(K·f) time. A curve over L frames takes O(K·L) time and O(K + L) memory; a
//! [`StreamMatcher`] takes O(K) time for each word and O(K) memory. Costs are whole numbers inside,
//! see [`COST_ERROR`]: they are the same bits for every processor, in a batch and in a stream.
//!
//! # Features
//!
//! `rayon` (default): learning uses all threads, with the same results.

#![cfg_attr(test, allow(clippy::unwrap_used))]

pub use ndarray;

/// Keeps the README's examples compiling.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

mod binary;
mod class;
mod curve;
mod edit;
mod error;
mod file_error;
mod fixed;
mod keyframes;
mod learn;
mod match_stream;
mod matches;
mod parallel;
mod quantize;
mod relax;
mod stream;
mod sweep;
mod template;
mod text;
mod threshold;

pub use class::{ANY, ClassError, ClassTemplate, KeyframeError, MAX_COLUMNS};
pub use curve::{DistanceCurve, Ending, ShortClips, Steps};
pub use edit::{EditError, combine};
pub use error::TemplateError;
pub use file_error::{FileError, FileErrorKind, Place};
pub use fixed::COST_ERROR;
pub use keyframes::{
    AutomaticConfig, ExampleConfig, Examples, Keyframe, LearnedKeyframes, Preselection,
    PreselectionError, choose_keyframes, learn_keyframes,
};
pub use learn::{Alignment, LearnConfig, Learned, MAX_ALIGNED_COLUMNS, Unwarp, align, learn};
pub use match_stream::MatchStream;
pub use matches::{Match, MatchConfig, select_matches};
pub use quantize::{Cell, QuantizedTemplate};
pub use stream::StreamMatcher;
pub use template::{MAX_FEATURES, MotionTemplate};
pub use threshold::{LearnedTau, TauConfig, learn_tau};
