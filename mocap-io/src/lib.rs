//! Reads and writes motion-capture files and turns them into joint positions.
//!
//! Start with [`parse_bvh`], or [`parse_asf`] and [`parse_amc`]; [`forward_kinematics`] gives positions.
//!
//! # Units and shapes
//! A [`Motion`] keeps what its file says: channels of shape `(frames, channels)` in degrees and file
//! units, and the [`LengthUnit`]. Positions have shape `(frames, joints, 3)`, `f32`, metres, Y up,
//! right-handed. Frames count from 0, spans are half open; lines and columns in errors count from 1.
//!
//! # Source
//! BVH as Biovision wrote it and as exporters bend it; ASF/AMC as in spec.md f: root rotation
//! Rz·Ry·Rx, bone rotation C·(Rz·Ry·Rx)·C⁻¹ with C from `axis`, bone vector
//! direction/|direction| · length, unit 1/`length` inch, 120 Hz.
//!
//! # Example
//! ```
//! let text = "HIERARCHY\nROOT Hips\n{\n OFFSET 0 0 0\n CHANNELS 6 Xposition Yposition Zposition \
//!     Zrotation Xrotation Yrotation\n End Site\n {\n  OFFSET 0 170 0\n }\n}\n\
//!     MOTION\nFrames: 1\nFrame Time: 0.0083333\n0 90 0 90 0 0\n";
//! let bvh = mocap_io::parse_bvh(text.as_bytes())?;
//! assert_eq!(bvh.motion.rate.hz(), 120.0);
//! assert_eq!(bvh.motion.unit, mocap_io::LengthUnit::CENTIMETRE); // 170 high: a person in centimetres
//! let positions = mocap_io::forward_kinematics(&bvh.motion);
//! assert_eq!(positions.dim(), (1, 2, 3));
//! assert_eq!(positions[[0, 1, 0]], -1.7); // turned by 90° about Z, the tip points to -X
//! # Ok::<(), mocap_io::ParseError>(())
//! ```
//!
//! Reading is linear in the bytes, kinematics in frames times joints; nothing is kept but the result.

#![cfg_attr(test, allow(clippy::unwrap_used))]

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

mod acclaim;
mod bvh;
mod c3d;
mod cursor;
mod error;
mod explain;
mod gaps;
mod kinematics;
mod layout;
mod markers;
mod motion;
mod position;
mod skeleton;
mod unit;
mod up;

pub use acclaim::{Amc, AngleUnit, Asf, parse_amc, parse_asf, write_amc, write_asf};
pub use bvh::{Bvh, parse_bvh, write_bvh};
pub use c3d::{
    Analog, ByteOrder, C3d, C3dErrorKind, C3dWarningKind, Event, EventSource, OtherPoints,
    Parameter, ParameterGroup, ParameterValue, Parameters, Storage, parse_c3d,
};
pub use error::{ParseError, ParseErrorKind, Warning, WarningKind, WriteError};
pub use explain::{Explanation, explain, explanations};
pub use gaps::{Filled, Gap};
pub use kinematics::forward_kinematics;
pub use markers::Markers;
pub use motion::{ChannelCountError, FrameRate, Motion};
pub use ndarray;
pub use position::Position;
pub use skeleton::{Axis, AxisFrame, Channel, Joint, OffsetFrame, Skeleton, SkeletonError};
pub use unit::{LengthUnit, RateSource, UnitSource, guess_unit};
pub use up::{UpAxis, UpSource, guess_up};
