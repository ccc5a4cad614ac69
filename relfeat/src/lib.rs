//! Turns joint positions into relational features: one `u64` word per frame that says, bit by bit,
//! whether a hand is raised, a knee bent, the spine horizontal.
//!
//! [`BodyMap::recognise`] finds the body points, [`FeatureSet::builtin`] gives the features,
//! [`extract`] the words.
//!
//! # Units and shapes
//! Positions have shape `(frames, joints, 3)`, `f32`, metres, Y up; rates are in frames per second,
//! windows in milliseconds. Thresholds are relative to lengths of the body in the first frame, so
//! any length unit gives the same words. Frames and features count from 0; `F1` is feature 0, bit 0.
//!
//! # Source
//! Müller and Röder 2006, Table 6, as its authors ran it (spec.md a.1, a.2): set `mueller2006`;
//! as printed: `mueller2006-table6`. Müller, Röder and Clausen 2005, Table 1, likewise (spec.md b):
//! `mueller2005` and, by the paper's text, `mueller2005-text`. Schmitt hysteresis and smoothing happen at the motion's own
//! rate, before words are thinned out to the library rate. Deviation: a feature that lacks a body
//! point is 0 and listed in [`FeatureWords::unavailable`]. Marker mixes deviate from spec.md f where
//! the rig's file says so.
//!
//! # Example
//! ```
//! use ndarray::Array3;
//! use relfeat::{BodyMap, FeatureSet, Rig, extract};
//!
//! let set = FeatureSet::from_toml(r#"
//!     name = "arms"
//!     [[feature]]
//!     name = "rhand_up"
//!     set = "upper"
//!     mirror = "rhand_up"
//!     quantity = { kind = "angle", of = ["rshoulder", "rwrist"], to = "up" }
//!     enter = "0..45 deg"
//!     stay = "0..60 deg"
//! "#)?;
//! let rig = Rig::from_toml("name = 'two'\n[points]\nrshoulder = ['a']\nrwrist = ['b']")?;
//! let map = BodyMap::with_rig(&["a", "b"], &rig);
//! let mut positions = Array3::<f32>::zeros((2, 2, 3));
//! positions[[0, 1, 0]] = 0.6; // to the side
//! positions[[1, 1, 1]] = 0.6; // up
//! let words = extract(&set, positions.view(), &map, 30.0, 30.0)?.words;
//! assert_eq!(words, [0, 1]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Time is linear in frames times features, memory in frames.

#![cfg_attr(test, allow(clippy::unwrap_used))]

mod body_map;
mod body_point;
mod error;
mod extract;
mod feature_set;
mod hysteresis;
mod measure;
mod quantity;
mod stream;
mod threshold;
mod velocity;

pub use body_map::{BodyMap, PointRule, Rig};
pub use body_point::BodyPoint;
pub use error::{ConfigError, ExtractError, Unavailable};
pub use extract::{FeatureWords, Measured, extract, measure, source_frame};
pub use feature_set::{BUILTIN_SETS, Feature, FeatureSet, MAX_FEATURES};
pub use ndarray;
pub use quantity::{Dimension, Direction, Quantity, Segment, WorldAxis};
pub use stream::WordStream;
pub use threshold::{Bound, Test, Unit};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
