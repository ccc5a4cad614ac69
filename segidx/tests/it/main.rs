//! Tests of the public API.

#![allow(clippy::unwrap_used)]

mod combine;
mod damage;
mod golden;
mod keyframes;
mod mismatch;
mod naive;
mod persistence;
mod plans;
mod positions;
mod properties;
mod restricted;
mod restriction;
mod scene;
mod seal;
mod walking;
