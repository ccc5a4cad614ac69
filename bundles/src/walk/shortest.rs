//! The shortest walk from here to there (Dijkstra 1959).

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::{Walk, WalkError, shortest_transition};
use crate::BundleGraph;

/// Frames and bundles so far.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Length {
    frames: f64,
    n_bundles: usize,
}

impl Eq for Length {}

impl PartialOrd for Length {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Length {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        (self.frames.total_cmp(&other.frames)).then(self.n_bundles.cmp(&other.n_bundles))
    }
}

impl BundleGraph {
    /// The walk from one bundle to another that takes fewest frames.
    ///
    /// A bundle counts its mean frames, both ends included, and an edge those of its shortest
    /// transition. Ties go to the walk of fewer bundles; then, from the end back, to the smaller
    /// id. From a bundle to itself it is that bundle alone.
    ///
    /// # Errors
    ///
    /// When an id is unknown or no edges lead there.
    ///
    /// # Cost
    ///
    /// O((bundles + edges)·log edges + passages).
    pub fn shortest_walk(&self, from: usize, to: usize) -> Result<Walk, WalkError> {
        self.check_bundle(from)?;
        self.check_bundle(to)?;
        let mut best: Vec<Option<(Length, Option<usize>)>> = vec![None; self.bundles().len()];
        let mut is_done = vec![false; self.bundles().len()];
        let start = Length {
            frames: self.bundles()[from].mean_frames(),
            n_bundles: 1,
        };
        let mut ahead = BinaryHeap::from([Reverse((start, from))]);
        best[from] = Some((start, None));
        while let Some(Reverse((length, bundle))) = ahead.pop() {
            if std::mem::replace(&mut is_done[bundle], true) {
                continue;
            }
            for edge in self.edges_from(bundle) {
                let mean = self.bundles()[edge.to].mean_frames();
                let longer = Length {
                    frames: length.frames + (shortest_transition(edge) as f64 + mean),
                    n_bundles: length.n_bundles + 1,
                };
                let found = (longer, Some(bundle));
                if !is_done[edge.to] && best[edge.to].is_none_or(|known| found < known) {
                    best[edge.to] = Some(found);
                    ahead.push(Reverse((longer, edge.to)));
                }
            }
        }
        if best[to].is_none() {
            return Err(WalkError::Unreachable { from, to });
        }
        let before = |&bundle: &usize| best[bundle].and_then(|(_, before)| before);
        let mut bundles: Vec<usize> = std::iter::successors(Some(to), before).collect();
        bundles.reverse();
        self.walk_along(&bundles)
    }
}
