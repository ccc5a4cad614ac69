//! GLB, the binary form of glTF 2.0 (Khronos, ISO/IEC 12113:2022).

mod document;
mod json;
mod mesh;
mod points;
mod skeleton;

pub use points::write_glb_points;
pub use skeleton::write_glb;
