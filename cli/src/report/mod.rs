//! Self-contained pages: what a [`document`] holds becomes one HTML file with the page of `cli/web`.

pub mod build;
pub mod clip;
pub mod document;
pub mod figure;
pub mod given;
pub mod graph;
pub mod html;
pub mod make;
pub mod pages;
pub mod pictures;
pub mod results;
