//! Graphs as pictures, boxes as in the paper's figures.

use std::fmt::Write;

use super::escape::xml;
use super::layout::{GAP, Place, places};
use super::{BundleGraph, Edge};

impl BundleGraph {
    /// The graph as an SVG picture.
    ///
    /// A bundle is a box as wide as its mean frames and as high as the square root of its height,
    /// with its id, its height and its mean frames in it and its submotions as a title: `name@a-b`
    /// for frames a to b of a clip, counted from the clip's start. An edge is an arrow, dashed if
    /// it only leads through transitions. Clips without a name in `clip_names` are called by
    /// their index.
    pub fn to_svg(&self, clip_names: &[&str]) -> String {
        let places = places(self);
        let far = |end: &dyn Fn(&Place) -> f64| places.iter().map(end).fold(0.0, f64::max) + GAP;
        let (width, height) = (far(&|p| p.x + p.width), far(&|p| p.y + p.height));
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"11\">\n\
             <defs><marker id=\"arrow\" viewBox=\"0 0 8 8\" refX=\"8\" refY=\"4\" \
             markerWidth=\"8\" markerHeight=\"8\" orient=\"auto\">\
             <path d=\"M0 0L8 4L0 8z\"/></marker></defs>\n"
        );
        for edge in self.edges() {
            svg.push_str(&arrow(edge, &places));
        }
        for (id, (bundle, place)) in self.bundles().iter().zip(&places).enumerate() {
            let (x, y) = place.middle();
            let title = xml(&self.spans_text(&bundle.submotions, clip_names));
            // Writing to a string does not fail.
            let _ = writeln!(
                svg,
                "<g><title>{title}</title><rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" \
                 fill=\"#dce9f7\" stroke=\"#335\"/><text x=\"{x}\" y=\"{y}\" \
                 text-anchor=\"middle\">B{id} {} × {:.0}</text></g>",
                place.x,
                place.y,
                place.width,
                place.height,
                bundle.height(),
                bundle.mean_frames(),
            );
        }
        svg.push_str("</svg>\n");
        svg
    }
}

/// From the right side of a box to the left side of another; a loop goes around above its box.
fn arrow(edge: &Edge, places: &[Place]) -> String {
    let (from, to) = (places[edge.from], places[edge.to]);
    let (x1, y1) = (from.x + from.width, from.middle().1);
    let (x2, y2) = (to.x, to.middle().1);
    let is_direct = edge
        .passages
        .iter()
        .any(|passage| passage.transition.is_none());
    let dashes = if is_direct {
        ""
    } else {
        " stroke-dasharray=\"4 3\""
    };
    let (bend, lift) = if edge.from == edge.to {
        (GAP / 2.0, from.height / 2.0 + GAP)
    } else {
        (GAP, 0.0)
    };
    format!(
        "<path d=\"M{x1} {y1}C{} {} {} {} {x2} {y2}\" fill=\"none\" stroke=\"#555\"{dashes} \
         marker-end=\"url(#arrow)\"/>\n",
        x1 + bend,
        y1 - lift,
        x2 - bend,
        y2 - lift,
    )
}
