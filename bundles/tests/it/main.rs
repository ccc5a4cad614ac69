//! The public interface, against textbook twins and by its laws.

#![allow(clippy::unwrap_used)]
// A single clip is a slice of one range.
#![allow(clippy::single_range_in_vec_init)]

mod exemplars;
mod exports;
mod extract_laws;
mod extract_stated;
mod graph_laws;
mod laws;
mod mapping_laws;
mod mixture;
mod model_laws;
mod naive;
mod naive_em;
mod naive_extract;
mod pca;
mod seal;
mod stated;
mod toy;
mod walk_laws;
