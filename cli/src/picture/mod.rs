//! Pictures: motions as strips of poses, feature matrices and agreements as heat-maps.

pub mod agreement;
mod canvas;
pub mod curve;
mod font;
pub mod heatmap;
pub mod strip;
pub mod template;

pub use canvas::{Charted, Image};
