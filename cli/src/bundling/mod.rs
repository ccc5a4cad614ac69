//! Motion bundles of clips: their pose vectors, and the `.mbg` files that models are kept in.

mod build;
mod file;
pub mod purity;
mod smooth;
mod vectors;

pub use build::{LetterRule, Poses, What, bundle, extended};
pub use file::{BundleClip, Bundled, Settings, load, save};
pub use smooth::{smoothed, smoothed_clips};
pub use vectors::{VectorError, layout, pose_vectors};
