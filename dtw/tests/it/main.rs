//! The public interface, against a textbook twin and by its laws.

#![allow(clippy::unwrap_used)]

mod large;
mod laws;
mod matrix;
mod naive;
mod naive_search;
mod search;
mod search_stated;
mod stated;
