//! Graphs as pictures, boxes as in the paper's figures.

use std::fmt::Write;

use super::escape::xml;
use super::layout::{GAP, LABEL, MIN_WIDTH, Place, places};
use super::{BundleGraph, Edge};

/// Room above all boxes for what they mean.
const LEGEND: f64 = 40.0;

const STYLE: &str = "\
rect{fill:#dce9f7;stroke:#335}\
path{fill:none;stroke:#335}\
text{text-anchor:middle;paint-order:stroke;stroke:#fff;stroke-width:2.5px}\
.few{opacity:.15}\
.few:hover,g:hover>path{stroke:#c00;opacity:1}";

impl BundleGraph {
    /// The graph as an SVG picture.
    ///
    /// A bundle is a box as wide as its mean frames and as high as the square root of its height,
    /// with its id, its height and its mean frames in it or below it, and its submotions as a title:
    /// `name@a-b` for frames a to b of a clip, counted from the clip's start. The 24 bundles of the
    /// largest volume are on a circle, the others in rows below. An edge is an arrow, the wider the
    /// more passages it has, and dashed if it only leads through transitions; from and to the rows
    /// it is faint, and dark where the pointer is on its bundle. Clips without a name in
    /// `clip_names` are called by their index.
    pub fn to_svg(&self, clip_names: &[&str]) -> String {
        let mut places = places(self);
        places.iter_mut().for_each(|place| place.y += LEGEND);
        let far = |end: &dyn Fn(&Place) -> f64| places.iter().map(end).fold(0.0, f64::max) + GAP;
        let width = far(&|p| p.middle().0 + p.cell().0 / 2.0).max(MIN_WIDTH);
        let height = far(&|p| p.y + p.height + LABEL.1);
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"11\" \
             style=\"background:#fff\">\n\
             <style>{STYLE}</style>\n\
             <defs><marker id=\"arrow\" viewBox=\"0 0 8 8\" refX=\"8\" refY=\"4\" \
             markerWidth=\"8\" markerHeight=\"8\" markerUnits=\"userSpaceOnUse\" orient=\"auto\">\
             <path d=\"M0 0L8 4L0 8z\" style=\"fill:#335\"/></marker></defs>\n\
             <text x=\"{GAP}\" y=\"{GAP}\" style=\"text-anchor:start\">{} bundles, {} edges. \
             Bn h × f: bundle n has h submotions of f frames on average.</text>\n",
            self.bundles().len(),
            self.edges().len(),
        );
        // What is on the circle is drawn over the faint arrows.
        for is_principal in [false, true] {
            let drawn = (0..places.len()).filter(|&id| places[id].is_principal == is_principal);
            drawn.for_each(|id| self.draw(&mut svg, id, &places, clip_names));
        }
        svg.push_str("</svg>\n");
        svg
    }

    /// A box and the arrows out of it.
    fn draw(&self, svg: &mut String, id: usize, places: &[Place], clip_names: &[&str]) {
        let (bundle, place) = (&self.bundles()[id], places[id]);
        svg.push_str("<g>");
        for edge in self.edges_from(id) {
            svg.push_str(&arrow(edge, places));
        }
        let label = format!("B{id} {} × {:.0}", bundle.height(), bundle.mean_frames());
        let (x, middle) = place.middle();
        let y = if place.width < LABEL.0 {
            place.y + place.height + LABEL.1 - 3.0
        } else {
            middle + 4.0
        };
        let title = xml(&self.spans_text(&bundle.submotions, clip_names));
        // Writing to a string does not fail.
        let _ = writeln!(
            svg,
            "<title>{title}</title><rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>\
             <text x=\"{x:.1}\" y=\"{y:.1}\">{label}</text></g>",
            place.x, place.y, place.width, place.height,
        );
    }
}

/// From box to box, bent to its left, so that there and back are two lines; a loop stands on its box.
fn arrow(edge: &Edge, places: &[Place]) -> String {
    let (from, to) = (places[edge.from], places[edge.to]);
    let way = if edge.from == edge.to {
        let (x, reach) = (from.middle().0, (from.width / 4.0).min(GAP / 2.0));
        let lift = from.y - 1.5 * GAP;
        let (left, right) = (x - reach, x + reach);
        format!(
            "M{left:.1} {y:.1}C{:.1} {lift:.1} {:.1} {lift:.1} {right:.1} {y:.1}",
            left - GAP / 4.0,
            right + GAP / 4.0,
            y = from.y,
        )
    } else {
        let ((x1, y1), (x2, y2)) = (from.middle(), to.middle());
        let bend = 0.12;
        let control = (
            (x1 + x2) / 2.0 + bend * (y2 - y1),
            (y1 + y2) / 2.0 - bend * (x2 - x1),
        );
        let (start, end) = (border(from, control), border(to, control));
        format!(
            "M{:.1} {:.1}Q{:.1} {:.1} {:.1} {:.1}",
            start.0, start.1, control.0, control.1, end.0, end.1
        )
    };
    let is_direct = edge.passages.iter().any(|p| p.transition.is_none());
    let dashes = if is_direct {
        ""
    } else {
        " stroke-dasharray=\"4 3\""
    };
    let class = if from.is_principal && to.is_principal {
        ""
    } else {
        " class=\"few\""
    };
    let stroke = (0.6 * (edge.passages.len() as f64).sqrt()).min(4.0);
    format!(
        "<path d=\"{way}\" stroke-width=\"{stroke:.1}\"{dashes}{class} marker-end=\"url(#arrow)\"/>"
    )
}

/// Where the line from the middle of a box towards a point leaves it.
fn border(place: Place, (x, y): (f64, f64)) -> (f64, f64) {
    let (cx, cy) = place.middle();
    let (dx, dy) = (x - cx, y - cy);
    let share = (place.width / 2.0 / dx.abs()).min(place.height / 2.0 / dy.abs());
    // Inside the box, or at its middle: the point itself.
    let share = if share.is_finite() {
        share.min(1.0)
    } else {
        0.0
    };
    (cx + share * dx, cy + share * dy)
}
