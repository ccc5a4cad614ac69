//! Places of boxes: layers from left to right along the edges.

use super::BundleGraph;

/// Space between boxes, and around all of them.
pub(super) const GAP: f64 = 40.0;
/// Width of a box for each frame of the bundle's width.
const PER_FRAME: f64 = 2.0;
/// Height of a box for the square root of the bundle's height.
const PER_ROOT: f64 = 20.0;

/// A box, in pixels.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Place {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) width: f64,
    pub(super) height: f64,
}

impl Place {
    pub(super) fn middle(self) -> (f64, f64) {
        (self.x + self.width / 2.0, self.y + self.height / 2.0)
    }
}

/// The box of each bundle: √height high and mean frames wide, each in its own unit.
///
/// Edges that close a cycle in a depth-first search by id are left out; a bundle's layer is then
/// the length of the longest way to it, and its place in the layer the mean place of the bundles
/// that lead to it.
pub(super) fn places(graph: &BundleGraph) -> Vec<Place> {
    let bundles = graph.bundles();
    let mut places: Vec<Place> = bundles
        .iter()
        .map(|bundle| Place {
            width: bundle.mean_frames() * PER_FRAME,
            height: (bundle.height() as f64).sqrt() * PER_ROOT,
            ..Place::default()
        })
        .collect();
    let mut x = GAP;
    for layer in layers(graph) {
        let mut y = GAP;
        for &id in &layer {
            (places[id].x, places[id].y) = (x, y);
            y += places[id].height + GAP;
        }
        let widths = layer.iter().map(|&id| places[id].width);
        x += widths.fold(0.0, f64::max) + GAP;
    }
    places
}

fn layers(graph: &BundleGraph) -> Vec<Vec<usize>> {
    let (order, is_back) = search(graph);
    let n = graph.bundles().len();
    let (mut rank, mut before) = (vec![0; n], vec![Vec::new(); n]);
    for &id in order.iter().rev() {
        for (index, edge) in edges_of(graph, id) {
            if !is_back[index] {
                rank[edge] = rank[edge].max(rank[id] + 1);
                before[edge].push(id);
            }
        }
    }
    let n_layers = rank.iter().max().map_or(0, |most| most + 1);
    let mut layers = vec![Vec::new(); n_layers];
    (0..n).for_each(|id| layers[rank[id]].push(id));
    let mut place = vec![0.0; n];
    for layer in &mut layers {
        let mean = |id: &usize| {
            let sum: f64 = before[*id].iter().map(|&other| place[other]).sum();
            sum / before[*id].len().max(1) as f64
        };
        // Stable: ties stay in the order of ids.
        layer.sort_by(|a, b| mean(a).total_cmp(&mean(b)));
        let n_in_layer = layer.len() as f64;
        for (index, &id) in layer.iter().enumerate() {
            place[id] = index as f64 / n_in_layer;
        }
    }
    layers
}

/// Bundles in the order a depth-first search leaves them, and which edges close a cycle.
fn search(graph: &BundleGraph) -> (Vec<usize>, Vec<bool>) {
    #[derive(Clone, Copy, PartialEq)]
    enum State {
        New,
        Open,
        Done,
    }
    let n = graph.bundles().len();
    let (mut state, mut order) = (vec![State::New; n], Vec::with_capacity(n));
    let mut is_back = vec![false; graph.edges().len()];
    for root in 0..n {
        if state[root] != State::New {
            continue;
        }
        state[root] = State::Open;
        let mut way = vec![(root, edges_of(graph, root))];
        while let Some((id, edges)) = way.last_mut() {
            match edges.next() {
                Some((index, to)) if state[to] == State::Open => is_back[index] = true,
                Some((_, to)) if state[to] == State::New => {
                    state[to] = State::Open;
                    way.push((to, edges_of(graph, to)));
                }
                Some(_) => {}
                None => {
                    state[*id] = State::Done;
                    order.push(*id);
                    way.pop();
                }
            }
        }
    }
    (order, is_back)
}

/// Index and target of each edge out of a bundle.
fn edges_of(graph: &BundleGraph, bundle: usize) -> impl Iterator<Item = (usize, usize)> {
    let first = graph.edges().partition_point(|edge| edge.from < bundle);
    let targets = graph.edges_from(bundle).iter().map(|edge| edge.to);
    targets
        .enumerate()
        .map(move |(offset, to)| (first + offset, to))
}
