//! Graphs of motion bundles as SVG.

use std::collections::BTreeMap;
use std::fmt::Write;

use bundles::BundleGraph;
use rust_sugiyama::configure::Config;
use rust_sugiyama::from_vertices_and_edges;

/// Bundles drawn at most, those of the greatest volume: layers of many more take minutes to put in order.
const MOST_NODES: usize = 150;

/// Pixels between nodes.
const APART: f64 = 24.0;
/// Pixels around everything, and between parts that no edge joins.
const MARGIN: f64 = 16.0;
/// Pixels per frame of a node's width, and per square root of its submotions of its height.
const PER_FRAME: f64 = 1.2;
const PER_ROOT: f64 = 14.0;
/// Nodes are at least this wide and high, so that their names can be read, in pixels.
const LEAST: [f64; 2] = [38.0, 20.0];
/// Parts of the graph stand side by side up to this width, in pixels.
const WIDTH: f64 = 1600.0;

/// Where a node is.
#[derive(Clone, Copy, Debug)]
struct Node {
    /// Of its middle.
    at: [f64; 2],
    size: [f64; 2],
}

/// The graph in layers, from top to bottom: a bundle is as wide as its submotions are long on average, and as high
/// as the square root of their number (Beaudoin et al. 2007, figure 1), and has the class `node` and its id in
/// `data-bundle`. Of more than 150 bundles those of the greatest volume are drawn, see [`drawn`].
#[must_use]
pub fn svg(graph: &BundleGraph) -> String {
    let drawn = largest(graph);
    let edges = graph.edges().iter().map(|edge| (edge.from, edge.to));
    let edges: Vec<(usize, usize)> = edges
        .filter(|(from, to)| drawn.contains_key(from) && drawn.contains_key(to))
        .collect();
    let (nodes, [width, height]) = place(&drawn, &edges);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" width=\"{width:.0}\" \
        height=\"{height:.0}\" font-family=\"sans-serif\" font-size=\"12\"><defs><marker id=\"arrow\" \
        viewBox=\"0 0 8 8\" refX=\"7\" refY=\"4\" markerWidth=\"7\" markerHeight=\"7\" orient=\"auto\">\
        <path d=\"M0 0 8 4 0 8z\" fill=\"#6f7987\"/></marker></defs>"
    );
    for (from, to) in edges {
        let path = match (nodes.get(&from), nodes.get(&to)) {
            (Some(node), Some(_)) if from == to => loop_path(node),
            (Some(from), Some(to)) => edge_path(from, to),
            _ => continue,
        };
        // Writing to a string does not fail.
        let _ = write!(
            out,
            "<path class=\"edge\" data-from=\"B{from}\" data-to=\"B{to}\" d=\"{path}\" fill=\"none\" \
            stroke=\"#6f7987\" stroke-opacity=\"0.6\" marker-end=\"url(#arrow)\"/>"
        );
    }
    for (&id, node) in &nodes {
        let [x, y] = [0, 1].map(|axis| node.at[axis] - node.size[axis] / 2.0);
        let bundle = &graph.bundles()[id];
        let _ = write!(
            out,
            "<g class=\"node\" data-bundle=\"B{id}\"><title>B{id}: {} submotions of {:.0} frames</title>\
            <rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{:.1}\" height=\"{:.1}\" rx=\"3\" fill=\"#cfdfee\" \
            stroke=\"#144580\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\" fill=\"#262d38\">B{id}</text></g>",
            bundle.height(),
            bundle.mean_frames(),
            node.size[0],
            node.size[1],
            node.at[0],
            node.at[1] + 4.0,
        );
    }
    out.push_str("</svg>");
    out
}

/// What is said of a drawing that lacks some of `n_bundles`, as name and value.
#[must_use]
pub fn drawn(n_bundles: usize) -> Option<(&'static str, String)> {
    let said = || ("drawn", format!("the {MOST_NODES} largest bundles"));
    (n_bundles > MOST_NODES).then(said)
}

/// Sizes of the bundles of the greatest volume, of equals the first ones.
fn largest(graph: &BundleGraph) -> BTreeMap<usize, [f64; 2]> {
    let mut ids: Vec<usize> = (0..graph.bundles().len()).collect();
    ids.sort_by(|&a, &b| {
        let volume = |id: usize| graph.bundles()[id].volume;
        volume(b).total_cmp(&volume(a)).then(a.cmp(&b))
    });
    let sizes = ids.into_iter().take(MOST_NODES).map(|id| {
        let bundle = &graph.bundles()[id];
        let width = (bundle.mean_frames() * PER_FRAME).max(LEAST[0]);
        let height = ((bundle.height() as f64).sqrt() * PER_ROOT).max(LEAST[1]);
        (id, [width, height])
    });
    sizes.collect()
}

/// Places all nodes, and gives the size of everything. Parts that no edge joins stand side by side, in rows.
fn place(
    sizes: &BTreeMap<usize, [f64; 2]>,
    edges: &[(usize, usize)],
) -> (BTreeMap<usize, Node>, [f64; 2]) {
    let number = |id: usize| u32::try_from(id).unwrap_or(u32::MAX);
    let vertices: Vec<(u32, (f64, f64))> = sizes
        .iter()
        .map(|(&id, &[width, height])| (number(id), (width, height)))
        .collect();
    let between = edges.iter().filter(|(from, to)| from != to);
    let between: Vec<(u32, u32)> = between.map(|&(a, b)| (number(a), number(b))).collect();
    let config = Config {
        vertex_spacing: APART,
        ..Config::default()
    };
    let mut nodes = BTreeMap::new();
    let (mut corner, mut row_height, mut right) = ([MARGIN; 2], 0.0f64, 0.0f64);
    for (mut part, ..) in from_vertices_and_edges(&vertices, &between, &config) {
        part.sort_by_key(|(id, _)| *id);
        let placed = part.iter().filter_map(|&(id, (x, y))| {
            let size = *sizes.get(&id)?;
            Some((id, Node { at: [x, y], size }))
        });
        let placed: Vec<(usize, Node)> = placed.collect();
        let bound = |axis: usize, sign: f64| {
            let ends = placed
                .iter()
                .map(|(_, n)| sign * n.at[axis] + n.size[axis] / 2.0);
            sign * ends.fold(f64::MIN, f64::max)
        };
        if placed.is_empty() {
            continue;
        }
        let low = [bound(0, -1.0), bound(1, -1.0)];
        let extent = [bound(0, 1.0) - low[0], bound(1, 1.0) - low[1]];
        if corner[0] > MARGIN && corner[0] + extent[0] > WIDTH {
            corner = [MARGIN, corner[1] + row_height + APART];
            row_height = 0.0;
        }
        for (id, node) in placed {
            let at = [0, 1].map(|axis| node.at[axis] - low[axis] + corner[axis]);
            nodes.insert(id, Node { at, ..node });
        }
        corner[0] += extent[0] + APART;
        row_height = row_height.max(extent[1]);
        right = right.max(corner[0]);
    }
    (nodes, [right + MARGIN, corner[1] + row_height + MARGIN])
}

/// From the lower edge of one node to the upper one of another below it, and the other way round for one above it.
fn edge_path(from: &Node, to: &Node) -> String {
    let down = if to.at[1] >= from.at[1] { 1.0 } else { -1.0 };
    let (x1, y1) = (from.at[0], from.at[1] + down * from.size[1] / 2.0);
    let (x2, y2) = (to.at[0], to.at[1] - down * to.size[1] / 2.0);
    let bend = ((y2 - y1).abs() / 2.0).max(APART) * down;
    format!(
        "M{x1:.1} {y1:.1}C{x1:.1} {:.1} {x2:.1} {:.1} {x2:.1} {y2:.1}",
        y1 + bend,
        y2 - bend
    )
}

/// From a node's right edge back to it.
fn loop_path(node: &Node) -> String {
    let (x, y) = (node.at[0] + node.size[0] / 2.0, node.at[1]);
    format!(
        "M{x:.1} {:.1}C{:.1} {:.1} {:.1} {:.1} {x:.1} {:.1}",
        y - 5.0,
        x + APART,
        y - 14.0,
        x + APART,
        y + 14.0,
        y + 5.0
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_said_that_bundles_are_not_drawn() {
        assert_eq!(drawn(MOST_NODES), None);
        let (name, value) = drawn(MOST_NODES + 1).unwrap();
        assert_eq!((name, value.as_str()), ("drawn", "the 150 largest bundles"));
    }
}
