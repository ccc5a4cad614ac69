//! Pictures: motions as strips of poses, feature matrices, agreements and scenes as heat-maps.

pub mod agreement;
mod canvas;
pub mod curve;
mod font;
pub mod heatmap;
pub mod scene;
pub mod strip;
pub mod template;

pub use canvas::{Charted, Image};
