//! Places of boxes: the principal bundles on a circle, all others in rows below.

use std::f64::consts::{PI, TAU};

use super::BundleGraph;

/// Space between boxes, and around all of them.
pub(super) const GAP: f64 = 24.0;
/// Width of a box for each frame of the bundle's width.
const PER_FRAME: f64 = 2.0;
/// Height of a box for the square root of the bundle's height.
const PER_ROOT: f64 = 20.0;
/// Least width around a box, and height below it, for a label that does not fit into it.
pub(super) const LABEL: (f64, f64) = (58.0, 14.0);
/// Bundles on the circle: as many as can be told apart, where the paper shows from five to twenty.
const N_PRINCIPAL: usize = 24;
/// Least width of the picture: room for the legend, and for rows below a small circle.
pub(super) const MIN_WIDTH: f64 = 900.0;
/// Sweeps over all pairs that the order on the circle is improved in, at most.
const N_SWEEPS: usize = 20;

/// A box, in pixels.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Place {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) width: f64,
    pub(super) height: f64,
    /// Whether it is on the circle.
    pub(super) is_principal: bool,
}

impl Place {
    pub(super) fn middle(self) -> (f64, f64) {
        (self.x + self.width / 2.0, self.y + self.height / 2.0)
    }

    /// Width and height with the label.
    pub(super) fn cell(self) -> (f64, f64) {
        (self.width.max(LABEL.0), self.height + LABEL.1)
    }

    fn centre_cell_at(&mut self, x: f64, y: f64) {
        self.x = x - self.width / 2.0;
        self.y = y - self.cell().1 / 2.0;
    }
}

/// The box of each bundle: √height high and mean frames wide, each in its own unit. No two overlap.
///
/// The 24 bundles of the largest volumes, ties by id, are on a circle, those next to each other that
/// have many passages between them; all others follow in rows, by id.
pub(super) fn places(graph: &BundleGraph) -> Vec<Place> {
    let bundles = graph.bundles();
    let boxes = bundles.iter().map(|bundle| Place {
        width: bundle.mean_frames() * PER_FRAME,
        height: (bundle.height() as f64).sqrt() * PER_ROOT,
        ..Place::default()
    });
    let mut places: Vec<Place> = boxes.collect();
    let mut by_volume: Vec<usize> = (0..bundles.len()).collect();
    // Stable: ties stay in the order of ids.
    by_volume.sort_by(|&a, &b| bundles[b].volume.total_cmp(&bundles[a].volume));
    by_volume.truncate(N_PRINCIPAL);
    let ring = ring_order(graph, &by_volume);
    ring.iter().for_each(|&id| places[id].is_principal = true);
    let side = place_ring(&mut places, &ring);
    place_rows(&mut places, side);
    places
}

/// Puts the boxes of `ring` on a circle; gives the side of the square that holds them.
///
/// The circle around a box is seen from the middle of the big one under an angle that no other box
/// is in.
fn place_ring(places: &mut [Place], ring: &[usize]) -> f64 {
    let radius_of = |id: &usize| {
        let (width, height) = places[*id].cell();
        (width.hypot(height) + GAP) / 2.0
    };
    let radii: Vec<f64> = ring.iter().map(radius_of).collect();
    let largest = radii.iter().fold(0.0, |a: f64, &b| a.max(b));
    let angles = |radius: f64| radii.iter().map(move |r| 2.0 * (r / radius).asin());
    // The arc sine of x is at most x·π/2, so the boxes fit at the upper end.
    let (mut low, mut high) = (largest, largest.max(radii.iter().sum::<f64>() / 2.0));
    for _ in 0..30 {
        let middle = (low + high) / 2.0;
        if angles(middle).sum::<f64>() <= TAU {
            high = middle;
        } else {
            low = middle;
        }
    }
    let spread = TAU / angles(high).sum::<f64>();
    let centre = high + largest;
    // From the top on, clockwise.
    let mut at = -PI / 2.0;
    let angles: Vec<f64> = angles(high).collect();
    for (i, (&id, angle)) in ring.iter().zip(&angles).enumerate() {
        if i > 0 {
            at += spread * angle / 2.0;
        }
        places[id].centre_cell_at(centre + high * at.cos(), centre + high * at.sin());
        at += spread * angle / 2.0;
    }
    2.0 * centre
}

/// Puts all boxes that are not on the circle into rows below it.
fn place_rows(places: &mut [Place], side: f64) {
    let right = side.max(MIN_WIDTH);
    let (mut x, mut top, mut row): (f64, f64, Vec<usize>) = (GAP, side + GAP, Vec::new());
    // Boxes of a row stand on one line.
    let close = |places: &mut [Place], row: &mut Vec<usize>, top: f64| {
        let highest = row.iter().map(|&id| places[id].height).fold(0.0, f64::max);
        for id in row.drain(..) {
            places[id].y = top + highest - places[id].height;
        }
        top + highest + LABEL.1 + GAP
    };
    for id in 0..places.len() {
        if places[id].is_principal {
            continue;
        }
        let width = places[id].cell().0;
        if x + width > right && !row.is_empty() {
            top = close(places, &mut row, top);
            x = GAP;
        }
        places[id].x = x + (width - places[id].width) / 2.0;
        x += width + GAP / 2.0;
        row.push(id);
    }
    close(places, &mut row, top);
}

/// The bundles in an order in which passages lead to near ones: each put in where it lengthens the
/// passages least, then pairs exchanged as long as that shortens them. Ties: the first place.
fn ring_order(graph: &BundleGraph, ids: &[usize]) -> Vec<usize> {
    let n_passages = |a: usize, b: usize| {
        let one_way = |from, to| graph.edge(from, to).map_or(0, |edge| edge.passages.len());
        one_way(a, b) + one_way(b, a)
    };
    let n = ids.len();
    // By place in `ids`.
    let weights: Vec<Vec<usize>> = ids
        .iter()
        .map(|&a| ids.iter().map(|&b| n_passages(a, b)).collect())
        .collect();
    let length = |order: &[usize]| {
        let mut sum = 0;
        for (i, &a) in order.iter().enumerate() {
            for (j, &b) in order[..i].iter().enumerate() {
                sum += weights[a][b] * (i - j).min(order.len() - (i - j));
            }
        }
        sum
    };
    let mut order: Vec<usize> = Vec::with_capacity(n);
    for next in 0..n {
        let tried = (0..=order.len()).map(|at| {
            let mut tried = order.clone();
            tried.insert(at, next);
            tried
        });
        order = tried.min_by_key(|tried| length(tried)).unwrap_or_default();
    }
    let mut best = length(&order);
    for _ in 0..N_SWEEPS {
        let before = best;
        for i in 0..n {
            for j in i + 1..n {
                order.swap(i, j);
                let found = length(&order);
                if found < best {
                    best = found;
                } else {
                    order.swap(i, j);
                }
            }
        }
        if best == before {
            break;
        }
    }
    order.into_iter().map(|place| ids[place]).collect()
}
