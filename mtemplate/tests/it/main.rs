//! The public interface, against textbook twins and by its laws.

#![allow(clippy::unwrap_used)]

mod binary;
mod classes;
mod edit;
mod keyframes;
mod laws;
mod learn;
mod matching;
mod naive;
mod naive_learn;
mod stated;
mod text;
