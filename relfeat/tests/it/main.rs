//! The public API.
#![allow(clippy::unwrap_used)]

mod figure;
mod laws;
mod naive;
mod poses;
mod rigs;
mod twin;
