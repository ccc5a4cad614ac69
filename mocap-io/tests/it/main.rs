//! The public API, on written and on real files.
#![allow(clippy::unwrap_used)]

mod real;
