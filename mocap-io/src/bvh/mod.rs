//! Biovision hierarchy files.

mod parse;
mod write;

pub use parse::{Bvh, parse_bvh};
pub use write::write_bvh;
