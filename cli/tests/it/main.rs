//! The pipeline and the command, on the built-in corpus and on real files.
#![allow(clippy::unwrap_used)]

mod align;
mod align_real;
mod annotate;
mod annotate_real;
mod command;
mod convert;
mod corpus;
mod damage;
mod doctor;
mod eval;
mod eval_real;
mod examples;
mod explain;
mod files;
mod keyframes_real;
mod learn;
mod library;
mod library_crash;
mod library_real;
mod library_stream;
mod mismatch;
mod plans;
mod rank;
mod rank_precision;
mod real;
mod real2005;
mod retrieval2005;
mod rigs;
mod scene;
mod template_align;
mod template_command;
mod template_files;
mod template_search;
mod templates;
mod templates_effects;
