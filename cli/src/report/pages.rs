//! One module per kind of page.

pub mod alignment;
pub mod annotation;
pub mod bundles;
pub mod library;
pub mod search;
