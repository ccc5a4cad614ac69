//! Tests of the public API.

#![allow(clippy::unwrap_used)]

mod golden;
mod naive;
mod persistence;
mod properties;
mod scene;
mod walking;
