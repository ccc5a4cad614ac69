//! The public interface, against textbook twins and by its laws.

#![allow(clippy::unwrap_used)]

mod binary;
mod classes;
mod keyframes;
mod laws;
mod naive;
mod stated;
mod text;
