//! The public interface, against a textbook twin and by its laws.

#![allow(clippy::unwrap_used)]

mod large;
mod laws;
mod naive;
mod stated;
