//! Pictures: motions as strips of poses, feature matrices as heat-maps.

mod canvas;
mod font;
pub mod heatmap;
pub mod strip;

pub use canvas::Image;
