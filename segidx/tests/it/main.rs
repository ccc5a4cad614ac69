//! Tests of the public API.

#![allow(clippy::unwrap_used)]

mod damage;
mod golden;
mod naive;
mod persistence;
mod properties;
mod scene;
mod seal;
mod walking;
