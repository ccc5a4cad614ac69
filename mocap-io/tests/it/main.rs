//! The public API, on written and on real files.
#![allow(clippy::unwrap_used)]

mod laws;
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
mod strategies;
mod units;
mod writers;
