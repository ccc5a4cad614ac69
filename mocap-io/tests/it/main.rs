//! The public API, on written and on real files.
#![allow(clippy::unwrap_used)]

mod c3d;
mod c3d_gaps;
mod c3d_real;
mod c3d_writer;
mod laws;
mod naive;
mod poses;
mod real;
mod strategies;
mod units;
mod up;
mod writers;
