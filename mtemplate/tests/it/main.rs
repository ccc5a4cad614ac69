//! The public interface, against textbook twins and by its laws.

#![allow(clippy::unwrap_used)]

mod laws;
mod learn;
mod naive;
mod naive_learn;
mod stated;
