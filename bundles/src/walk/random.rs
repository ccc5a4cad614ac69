//! Random walks that last.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

use super::{Walk, WalkError};
use crate::draw::below;
use crate::{BundleGraph, Edge};

/// Whether a random walk may come to where it cannot go on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum DeadEnds {
    /// It stays where it can go on for ever, as long as it starts there.
    Avoid,
    /// It takes any edge.
    Allow,
}

/// How a random walk goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RandomWalk {
    /// The largest number of bundles on the way, at least 1.
    pub n_bundles: usize,
    /// Where it starts; `None` for any bundle of the largest strongly connected component that has
    /// an edge (ties: the one of the smallest id), or any at all where none has.
    pub start: Option<usize>,
    /// Whether it may end early.
    pub dead_ends: DeadEnds,
    /// Seed of ChaCha with eight rounds.
    pub seed: u64,
}

/// What a random walk looks ahead to.
struct Prospects {
    /// Of each bundle: its component's index.
    component: Vec<usize>,
    /// Of each component: whether an edge stays in it.
    is_cyclic: Vec<bool>,
    /// Of each bundle: whether edges lead from it to a cyclic component.
    is_live: Vec<bool>,
}

impl BundleGraph {
    /// A random walk: every edge it may take is as likely as the others, and so is every passage.
    ///
    /// Under [`DeadEnds::Avoid`] it stays in its strongly connected component where that has an
    /// edge inside; from elsewhere it only goes where a component with such an edge is in reach; if
    /// none is, it goes anywhere. So it ends before `n_bundles` only if no edge leads from where it
    /// is, which happens only when it starts where no walk lasts.
    ///
    /// # Errors
    ///
    /// When the graph is empty, the start unknown, or the number of bundles 0.
    ///
    /// # Cost
    ///
    /// O(bundles + edges·log edges) before the first step.
    pub fn random_walk(&self, options: &RandomWalk) -> Result<Walk, WalkError> {
        if self.bundles().is_empty() || options.n_bundles == 0 {
            return Err(WalkError::Empty);
        }
        let components = self.components();
        let prospects = self.prospects(&components);
        let mut dice = ChaCha8Rng::seed_from_u64(options.seed);
        let start = match options.start {
            Some(start) => start,
            None => {
                let lasting = components.iter().zip(&prospects.is_cyclic);
                let lasting = lasting
                    .filter(|(_, is_cyclic)| **is_cyclic)
                    .map(|(ids, _)| ids);
                // Of equally large ones, the first.
                match lasting.rev().max_by_key(|ids| ids.len()) {
                    Some(ids) => ids[below(&mut dice, ids.len())],
                    None => below(&mut dice, self.bundles().len()),
                }
            }
        };
        self.check_bundle(start)?;
        let (mut bundles, mut passages) = (vec![start], Vec::new());
        let mut bundle = start;
        while bundles.len() < options.n_bundles {
            let edges = self.choices(bundle, options.dead_ends, &prospects);
            if edges.is_empty() {
                break;
            }
            let edge = edges[below(&mut dice, edges.len())];
            passages.push(&edge.passages[below(&mut dice, edge.passages.len())]);
            bundle = edge.to;
            bundles.push(bundle);
        }
        self.through(&bundles, &passages)
    }

    fn choices(&self, bundle: usize, dead_ends: DeadEnds, prospects: &Prospects) -> Vec<&Edge> {
        let edges = self.edges_from(bundle);
        let is_wise = |edge: &&Edge| {
            let component = prospects.component[bundle];
            match dead_ends {
                DeadEnds::Allow => true,
                DeadEnds::Avoid if prospects.is_cyclic[component] => {
                    prospects.component[edge.to] == component
                }
                DeadEnds::Avoid => prospects.is_live[edge.to] || !prospects.is_live[bundle],
            }
        };
        edges.iter().filter(is_wise).collect()
    }

    fn prospects(&self, components: &[Vec<usize>]) -> Prospects {
        let n = self.bundles().len();
        let mut component = vec![0; n];
        for (index, ids) in components.iter().enumerate() {
            ids.iter().for_each(|&id| component[id] = index);
        }
        let mut is_cyclic = vec![false; components.len()];
        let mut entries = vec![Vec::new(); n];
        for edge in self.edges() {
            if component[edge.from] == component[edge.to] {
                is_cyclic[component[edge.from]] = true;
            }
            entries[edge.to].push(edge.from);
        }
        let mut is_live: Vec<bool> = component.iter().map(|&index| is_cyclic[index]).collect();
        let mut ahead: Vec<usize> = (0..n).filter(|&id| is_live[id]).collect();
        while let Some(id) = ahead.pop() {
            for &before in &entries[id] {
                if !std::mem::replace(&mut is_live[before], true) {
                    ahead.push(before);
                }
            }
        }
        Prospects {
            component,
            is_cyclic,
            is_live,
        }
    }
}
