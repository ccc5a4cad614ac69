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
//! direction/|direction| · length, unit 1/`length` inch, 120 Hz. Written besides: GLB (glTF 2.0, ISO/IEC
//! 12113:2022), NPY 1.0 and NPZ (NumPy's NEP 1), CSV (RFC 4180).
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
mod glb;
mod kinematics;
mod layout;
mod local_rotation;
mod markers;
mod motion;
mod number;
mod ops;
mod position;
mod rotation;
mod skeleton;
mod table;
mod unit;
mod up;
mod warning;

pub use acclaim::{Amc, AngleUnit, Asf, parse_amc, parse_asf, write_amc, write_asf};
pub use bvh::{Bvh, parse_bvh, write_bvh};
pub use c3d::{
    Analog, ByteOrder, C3d, C3dErrorKind, C3dWarningKind, Event, EventSource, OtherPoints,
    Parameter, ParameterGroup, ParameterValue, Parameters, Storage, parse_c3d,
};
pub use error::{ParseError, ParseErrorKind, WriteError};
pub use explain::{Explanation, explain, explanations};
pub use gaps::{Filled, Gap};
pub use glb::{write_glb, write_glb_points};
pub use kinematics::forward_kinematics;
pub use local_rotation::local_rotations;
pub use markers::Markers;
pub use motion::{ChannelCountError, FrameRate, Motion};
pub use ndarray;
pub use ops::{
    BlendError, MirrorError, SeveralRoots, SkeletonMismatch, blend, blend_along, mirror_pairs,
    smoothstep_weights,
};
pub use position::Position;
pub use skeleton::{Axis, AxisFrame, Channel, Joint, OffsetFrame, Skeleton, SkeletonError};
pub use table::{write_csv, write_npy, write_npz, write_npz_points};
pub use unit::{LengthUnit, RateSource, UnitSource, guess_unit};
pub use up::{UpAxis, UpSource, guess_up};
pub use warning::{Warning, WarningKind};
