//! Bundle graphs: bundles as nodes, shared frames as edges (section 4).

use std::ops::Range;

use crate::{FrameMapping, MotionString, Partition, Substring};

mod components;
mod dot;
mod escape;
mod graphml;
mod json;
mod layout;
mod svg;
mod validate;

pub use validate::GraphFlaw;

/// Frames of one clip, from the pose at `span.start` to the pose at `span.end`.
///
/// The pose at the end belongs to the submotion, too: it is the first pose of what follows. So the
/// spans of successive submotions tile their clip, and `span.end` is a frame of the clip.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Submotion {
    /// Index of the clip.
    pub clip: usize,
    /// Its frames, through all clips; never empty.
    pub span: Range<usize>,
}

/// A node: submotions that are alike.
#[derive(Debug, Clone, PartialEq)]
pub struct Bundle {
    /// Its submotions by frame, at least two; their number is the height.
    pub submotions: Vec<Submotion>,
    /// The volume V of its substrings (equation 3).
    pub volume: f64,
}

impl Bundle {
    /// The height B_h: its number of submotions.
    pub fn height(&self) -> usize {
        self.submotions.len()
    }

    /// The width in frames, from first to last pose, on average.
    pub fn mean_frames(&self) -> f64 {
        let lengths = self.submotions.iter().map(|submotion| submotion.span.len());
        lengths.sum::<usize>() as f64 / self.submotions.len() as f64
    }
}

/// One way along an edge: out of one submotion and into another of the same clip.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Passage {
    /// Index of the submotion that is left, in its bundle.
    pub exit: usize,
    /// Index of the submotion that is entered, in its bundle.
    pub entry: usize,
    /// A degenerate bundle on the way; `None` where the two share a frame.
    pub transition: Option<Submotion>,
}

/// All ways from one bundle to another.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Edge {
    /// Index of the bundle that is left.
    pub from: usize,
    /// Index of the bundle that is entered.
    pub to: usize,
    /// The ways by frame; at least one.
    pub passages: Vec<Passage>,
}

/// A motion-bundle graph.
///
/// Bundles have the ids of their [`Partition`]. Every submotion is in a bundle, on an edge, or
/// loose.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct BundleGraph {
    pub(crate) clips: Vec<Range<usize>>,
    pub(crate) bundles: Vec<Bundle>,
    pub(crate) edges: Vec<Edge>,
    pub(crate) loose: Vec<Submotion>,
}

impl BundleGraph {
    /// The frames of each clip.
    pub fn clips(&self) -> &[Range<usize>] {
        &self.clips
    }

    /// The nodes; the index of a bundle is its id.
    pub fn bundles(&self) -> &[Bundle] {
        &self.bundles
    }

    /// The edges by the ids they join; one for each pair, loops included.
    pub fn edges(&self) -> &[Edge] {
        &self.edges
    }

    /// Degenerate submotions that a clip begins or ends with: no walk leads through them.
    pub fn loose(&self) -> &[Submotion] {
        &self.loose
    }

    /// The edge between two bundles. Cost: O(log edges).
    pub fn edge(&self, from: usize, to: usize) -> Option<&Edge> {
        let found = self
            .edges
            .binary_search_by_key(&(from, to), |edge| (edge.from, edge.to));
        found.ok().and_then(|index| self.edges.get(index))
    }

    /// The edges out of a bundle, by the bundle they enter. Cost: O(log edges).
    pub fn edges_from(&self, bundle: usize) -> &[Edge] {
        let start = self.edges.partition_point(|edge| edge.from < bundle);
        let end = self.edges.partition_point(|edge| edge.from <= bundle);
        &self.edges[start..end]
    }
}

/// A submotion on its way into a graph, and its place in a bundle if it is in one.
struct Placed {
    submotion: Submotion,
    place: Option<(usize, usize)>,
}

/// The graph of `partition`, a frame of `mapping` for each end of its substrings.
///
/// A bundle is a node. Two bundles are joined where a submotion of the one ends at the frame where
/// a submotion of the other begins, or where a degenerate submotion leads from frame to frame.
/// Parallel edges are one edge with all passages. `None` when the mapping lacks a frame, or has
/// them out of order: when it is not of this string and partition.
///
/// Cost: O(n·log n) for n substrings.
pub fn link(
    string: &MotionString,
    partition: &Partition,
    mapping: &FrameMapping,
) -> Option<BundleGraph> {
    let submotion = |substring: &Substring| {
        let run = string.runs().get(substring.first)?;
        let span = mapping.frame(substring.first)?..mapping.frame(substring.last)?;
        let clip = run.clip;
        (!span.is_empty()).then_some(Submotion { clip, span })
    };
    let mut placed = Vec::new();
    let mut bundles = Vec::with_capacity(partition.bundles.len());
    for (id, bundle) in partition.bundles.iter().enumerate() {
        let submotions: Vec<_> = bundle
            .members
            .iter()
            .map(submotion)
            .collect::<Option<_>>()?;
        for (member, submotion) in submotions.iter().enumerate() {
            let (submotion, place) = (submotion.clone(), Some((id, member)));
            placed.push(Placed { submotion, place });
        }
        let volume = bundle.volume;
        bundles.push(Bundle { submotions, volume });
    }
    for single in &partition.degenerate {
        let (submotion, place) = (submotion(single)?, None);
        placed.push(Placed { submotion, place });
    }
    placed.sort_unstable_by_key(|placed| placed.submotion.span.start);

    let (mut ways, mut loose) = (Vec::new(), Vec::new());
    for (index, Placed { submotion, place }) in placed.iter().enumerate() {
        let follows = |before: &&Placed| {
            before.submotion.clip == submotion.clip
                && before.submotion.span.end == submotion.span.start
        };
        let before = index
            .checked_sub(1)
            .map(|before| &placed[before])
            .filter(follows);
        let Some((to, entry)) = *place else {
            // An edge if bundles are on both sides, which the next submotion sees.
            let after = placed.get(index + 1).filter(|after| {
                after.submotion.clip == submotion.clip
                    && after.submotion.span.start == submotion.span.end
            });
            let is_way = [before, after]
                .iter()
                .all(|side| side.is_some_and(|s| s.place.is_some()));
            if !is_way {
                loose.push(submotion.clone());
            }
            continue;
        };
        let Some(before) = before else { continue };
        let (origin, transition) = match before.place {
            Some(origin) => (Some(origin), None),
            None => {
                let origin = index.checked_sub(2).map(|earlier| &placed[earlier]);
                let origin = origin.filter(|earlier| {
                    earlier.submotion.clip == submotion.clip
                        && earlier.submotion.span.end == before.submotion.span.start
                });
                (origin.and_then(|o| o.place), Some(before.submotion.clone()))
            }
        };
        if let Some((from, exit)) = origin {
            let passage = Passage {
                exit,
                entry,
                transition,
            };
            ways.push((from, to, passage));
        }
    }
    let clips = (0..string.n_clips()).scan(0, |end, clip| {
        let runs = string
            .clip_span(clip)
            .and_then(|span| string.runs().get(span));
        let (first, last) = (runs.and_then(<[_]>::first), runs.and_then(<[_]>::last));
        let start = first.map_or(*end, |run| run.frames.start);
        *end = last.map_or(*end, |run| run.frames.end);
        Some(start..*end)
    });
    Some(BundleGraph {
        clips: clips.collect(),
        bundles,
        edges: merge(ways),
        loose,
    })
}

/// Ways in order of frames, as edges.
fn merge(mut ways: Vec<(usize, usize, Passage)>) -> Vec<Edge> {
    ways.sort_by_key(|&(from, to, _)| (from, to));
    let mut edges: Vec<Edge> = Vec::new();
    for (from, to, passage) in ways {
        match edges.last_mut() {
            Some(edge) if (edge.from, edge.to) == (from, to) => edge.passages.push(passage),
            _ => edges.push(Edge {
                from,
                to,
                passages: vec![passage],
            }),
        }
    }
    edges
}
