//! The public interface, against a textbook twin and by its laws.

#![allow(clippy::unwrap_used)]

mod laws;
mod naive;
mod naive_search;
mod search;
mod stated;
