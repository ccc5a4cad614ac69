//! The public interface, against textbook twins and by its laws.

#![allow(clippy::unwrap_used)]

mod laws;
mod matching;
mod naive;
mod stated;
