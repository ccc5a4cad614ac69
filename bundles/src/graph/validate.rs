//! The invariants of a graph.

use thiserror::Error;

use super::{BundleGraph, Submotion};

/// An invariant of a [`BundleGraph`] that does not hold.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum GraphFlaw {
    /// A bundle has fewer than two submotions.
    #[error("bundle {bundle}: expected at least 2 submotions, found {found}")]
    Height {
        /// The bundle.
        bundle: usize,
        /// Its height.
        found: usize,
    },
    /// A submotion is empty, leaves its clip, or overlaps another.
    #[error("expected disjoint spans within clips, found {found:?}")]
    Span {
        /// The submotion.
        found: Submotion,
    },
    /// Edges are out of order, or one is without a passage.
    #[error("edge {edge}: expected edges by the ids they join, each with a passage")]
    Edge {
        /// Index of the edge.
        edge: usize,
    },
    /// A passage does not lead from frame to frame.
    #[error("edge {edge}, passage {passage}: expected submotions that share their frames")]
    Passage {
        /// Index of the edge.
        edge: usize,
        /// Index of the passage.
        passage: usize,
    },
}

impl BundleGraph {
    /// Checks what every graph of [`link`](crate::link) obeys: submotions are disjoint, within
    /// their clips, and meet where passages say so; edges are sorted, distinct and not empty.
    ///
    /// # Errors
    ///
    /// The first flaw found.
    pub fn debug_validate(&self) -> Result<(), GraphFlaw> {
        for (bundle, found) in self.bundles.iter().map(|b| b.submotions.len()).enumerate() {
            if found < 2 {
                return Err(GraphFlaw::Height { bundle, found });
            }
        }
        let nodes = self.bundles.iter().flat_map(|bundle| &bundle.submotions);
        let passages = self.edges.iter().flat_map(|edge| &edge.passages);
        let on_edges = passages.filter_map(|passage| passage.transition.as_ref());
        let mut all: Vec<&Submotion> = nodes.chain(on_edges).chain(&self.loose).collect();
        all.sort_unstable_by_key(|submotion| submotion.span.start);
        let mut end = 0;
        for submotion in all {
            let span = &submotion.span;
            let clip = self.clips.get(submotion.clip);
            let is_inside = clip.is_some_and(|c| c.start <= span.start && span.end < c.end);
            if span.is_empty() || !is_inside || span.start < end {
                let found = submotion.clone();
                return Err(GraphFlaw::Span { found });
            }
            end = span.end;
        }
        self.validate_edges()
    }

    fn validate_edges(&self) -> Result<(), GraphFlaw> {
        for (index, edge) in self.edges.iter().enumerate() {
            let before = index.checked_sub(1).map(|before| &self.edges[before]);
            let is_sorted = before.is_none_or(|b| (b.from, b.to) < (edge.from, edge.to));
            if !is_sorted || edge.passages.is_empty() {
                return Err(GraphFlaw::Edge { edge: index });
            }
            for (number, passage) in edge.passages.iter().enumerate() {
                let exit = self.submotion(edge.from, passage.exit);
                let entry = self.submotion(edge.to, passage.entry);
                let way = [exit, passage.transition.as_ref(), entry];
                let way: Vec<&Submotion> = way.into_iter().flatten().collect();
                let n = 2 + usize::from(passage.transition.is_some());
                let meet =
                    |w: &[&Submotion]| w[0].clip == w[1].clip && w[0].span.end == w[1].span.start;
                if way.len() != n || !way.windows(2).all(meet) {
                    return Err(GraphFlaw::Passage {
                        edge: index,
                        passage: number,
                    });
                }
            }
        }
        Ok(())
    }

    /// Submotion number `member` of a bundle.
    pub(crate) fn submotion(&self, bundle: usize, member: usize) -> Option<&Submotion> {
        self.bundles.get(bundle)?.submotions.get(member)
    }
}
