//! Biovision hierarchy files.

mod explain;
mod parse;
mod write;

pub(crate) use explain::EXPLANATIONS;
pub use parse::{Bvh, parse_bvh};
pub use write::write_bvh;
