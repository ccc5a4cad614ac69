//! The public API, on written and on real files.
#![allow(clippy::unwrap_used)]

mod glb;
mod laws;
mod naive;
mod poses;
mod real;
mod roundtrip;
mod scene;
mod strategies;
mod table;
mod units;
mod writers;
