//! The public API, on written and on real files.
#![allow(clippy::unwrap_used)]

mod acclaim_dialects;
mod bvh_dialects;
mod laws;
mod memory;
mod naive;
mod poses;
mod real;
mod strategies;
mod text_files;
mod units;
mod writers;
