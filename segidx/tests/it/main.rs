//! Tests of the public API.

#![allow(clippy::unwrap_used)]

mod damage;
mod golden;
mod mismatch;
mod naive;
mod persistence;
mod properties;
mod restriction;
mod scene;
mod seal;
mod walking;
