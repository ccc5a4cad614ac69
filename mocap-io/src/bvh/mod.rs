//! Biovision hierarchy files.

mod explain;
mod hierarchy;
mod parse;
mod rate;
mod repair;
mod rows;
mod write;

pub(crate) use explain::EXPLANATIONS;
pub use parse::{Bvh, parse_bvh};
pub use write::write_bvh;
