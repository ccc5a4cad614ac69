//! The public API, on written and on real files.
#![allow(clippy::unwrap_used)]

mod acclaim_dialects;
mod bvh_dialects;
mod c3d;
mod c3d_gaps;
mod c3d_real;
mod c3d_writer;
mod glb;
mod golden;
mod laws;
mod memory;
mod naive;
mod ops;
mod ops_blend;
mod ops_floor;
mod ops_layout;
mod ops_mirror;
mod ops_real;
mod ops_resample;
mod poses;
mod real;
mod roundtrip;
mod scene;
mod strategies;
mod table;
mod text_files;
mod units;
mod up;
mod writers;
