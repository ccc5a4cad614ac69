//! The public API.
#![allow(clippy::unwrap_used)]

mod figure;
mod laws;
mod naive;
mod poses;
mod poses2005;
mod quantities;
mod rigs;
mod stream;
mod twin;
