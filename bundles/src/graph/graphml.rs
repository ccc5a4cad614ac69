//! Graphs for graph tools.

use std::fmt::Write;

use super::BundleGraph;
use super::escape::xml;

const KEYS: [(&str, &str, &str); 6] = [
    ("node", "height", "int"),
    ("node", "mean_frames", "double"),
    ("node", "volume", "double"),
    ("node", "spans", "string"),
    ("edge", "passages", "int"),
    ("edge", "transitions", "string"),
];

impl BundleGraph {
    /// The graph in GraphML.
    ///
    /// Nodes carry height, mean frames, volume and their submotions, edges their number of passages
    /// and their transitions; submotions are `name@a-b` for frames a to b of a clip, counted from
    /// the clip's start. Clips without a name in `clip_names` are called by their index.
    pub fn to_graphml(&self, clip_names: &[&str]) -> String {
        let mut text = String::from(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
             <graphml xmlns=\"http://graphml.graphdrawing.org/xmlns\">\n",
        );
        // Writing to a string does not fail.
        for (of, name, kind) in KEYS {
            let _ = writeln!(
                text,
                "  <key id=\"{name}\" for=\"{of}\" attr.name=\"{name}\" attr.type=\"{kind}\"/>"
            );
        }
        text.push_str("  <graph id=\"bundles\" edgedefault=\"directed\">\n");
        for (id, bundle) in self.bundles().iter().enumerate() {
            let _ = writeln!(
                text,
                "    <node id=\"b{id}\"><data key=\"height\">{}</data>\
                 <data key=\"mean_frames\">{}</data><data key=\"volume\">{}</data>\
                 <data key=\"spans\">{}</data></node>",
                bundle.height(),
                bundle.mean_frames(),
                bundle.volume,
                xml(&self.spans_text(&bundle.submotions, clip_names)),
            );
        }
        for edge in self.edges() {
            let ways = edge.passages.iter();
            let transitions: Vec<_> = ways.filter_map(|way| way.transition.clone()).collect();
            let _ = writeln!(
                text,
                "    <edge source=\"b{}\" target=\"b{}\"><data key=\"passages\">{}</data>\
                 <data key=\"transitions\">{}</data></edge>",
                edge.from,
                edge.to,
                edge.passages.len(),
                xml(&self.spans_text(&transitions, clip_names)),
            );
        }
        text.push_str("  </graph>\n</graphml>\n");
        text
    }
}
