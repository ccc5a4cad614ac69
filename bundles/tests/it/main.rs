//! The public interface, against textbook twins and by its laws.

#![allow(clippy::unwrap_used)]
// A single clip is a slice of one range.
#![allow(clippy::single_range_in_vec_init)]

mod laws;
mod mixture;
mod naive;
mod naive_em;
mod pca;
mod stated;
