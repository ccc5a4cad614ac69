//! Graphs for Graphviz.

use std::fmt::Write;

use super::escape::quoted;
use super::{BundleGraph, Submotion};

impl BundleGraph {
    /// The graph in the DOT language.
    ///
    /// Nodes are boxes with id, height and mean frames as label and the submotions as tooltip:
    /// `name@a-b` for frames a to b of a clip, counted from the clip's start. An edge is labelled
    /// with its number of passages, and dashed if all of them are transitions. Clips without a
    /// name in `clip_names` are called by their index.
    pub fn to_dot(&self, clip_names: &[&str]) -> String {
        let mut dot = String::from("digraph bundles {\n  rankdir=LR;\n  node [shape=box];\n");
        for (id, bundle) in self.bundles().iter().enumerate() {
            let spans = quoted(&self.spans_text(&bundle.submotions, clip_names));
            let (height, frames) = (bundle.height(), bundle.mean_frames());
            let root = (height as f64).sqrt() / 4.0;
            let inches = frames / 40.0;
            // Writing to a string does not fail.
            let _ = writeln!(
                dot,
                "  b{id} [label=\"B{id} {height} × {frames:.0}\", tooltip=\"{spans}\", \
                 height={root}, width={inches}];"
            );
        }
        for edge in self.edges() {
            let n = edge.passages.len();
            let is_direct = edge
                .passages
                .iter()
                .any(|passage| passage.transition.is_none());
            let style = if is_direct { "solid" } else { "dashed" };
            let (from, to) = (edge.from, edge.to);
            let _ = writeln!(dot, "  b{from} -> b{to} [label=\"{n}\", style={style}];");
        }
        dot.push_str("}\n");
        dot
    }

    /// `name@a-b`, separated by spaces.
    pub(super) fn spans_text(&self, submotions: &[Submotion], clip_names: &[&str]) -> String {
        let spans = submotions.iter().map(|submotion| {
            let span = self.in_clip(submotion);
            let name = clip_name(submotion.clip, clip_names);
            format!("{name}@{}-{}", span.start, span.end)
        });
        spans.collect::<Vec<_>>().join(" ")
    }

    /// Frames counted from the start of the clip.
    pub(super) fn in_clip(&self, submotion: &Submotion) -> std::ops::Range<usize> {
        let start = self.clips.get(submotion.clip).map_or(0, |clip| clip.start);
        let span = &submotion.span;
        span.start.saturating_sub(start)..span.end.saturating_sub(start)
    }
}

pub(super) fn clip_name(clip: usize, clip_names: &[&str]) -> String {
    let name = clip_names.get(clip).map(|&name| name.to_owned());
    name.unwrap_or_else(|| clip.to_string())
}
