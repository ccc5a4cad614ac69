//! Motions made from motions.

mod axes;
mod blend;
mod concatenate;
mod floor;
mod interpolate;
mod markers;
mod mirror;
mod mismatch;
mod own_offsets;
mod root;
mod sides;

pub use blend::{BlendError, blend, blend_along, smoothstep_weights};
pub use mirror::MirrorError;
pub use mismatch::SkeletonMismatch;
pub use own_offsets::SeveralRoots;
pub use sides::mirror_pairs;
