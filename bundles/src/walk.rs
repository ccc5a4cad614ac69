//! Walks: from bundle to bundle, blending inside each (section 4).

use std::ops::Range;

use thiserror::Error;

use crate::{BundleGraph, Edge, Passage, Submotion};

mod random;
mod shortest;

pub use random::{DeadEnds, RandomWalk};

/// A way through a graph, ready to be played.
#[derive(Debug, Clone, PartialEq)]
pub struct Walk {
    /// The bundles on the way.
    pub bundles: Vec<usize>,
    /// What is played, one after the other; each begins with the pose the one before ends with.
    pub pieces: Vec<Piece>,
}

/// A part of a [`Walk`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Piece {
    /// Frames of one clip as they are.
    Plain(Submotion),
    /// From one submotion of a bundle into another.
    Blend {
        /// The bundle.
        bundle: usize,
        /// What is played at the start.
        entry: Submotion,
        /// What is played at the end.
        exit: Submotion,
    },
}

/// The pose to play at one frame: a mixture of poses at two places, between frames as a rule.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BlendFrame {
    /// Place in the entry submotion, in frames.
    pub entry: f64,
    /// Place in the exit submotion, in frames.
    pub exit: f64,
    /// Weight of the exit, 0 to 1.
    pub weight: f64,
}

impl Piece {
    /// Number of frames to play: those of the span, or the mean of entry and exit, rounded up.
    pub fn n_frames(&self) -> usize {
        match self {
            Self::Plain(submotion) => submotion.span.len(),
            Self::Blend { entry, exit, .. } => (entry.span.len() + exit.span.len()).div_ceil(2),
        }
    }

    /// Frame `k` of the piece; 0 is the first pose of the entry, [`n_frames`](Self::n_frames) the
    /// last pose of the exit, which the next piece begins with. `None` after that.
    ///
    /// Time runs through both submotions at even speeds, u = k / n, and the weight is the
    /// smoothstep 3u² - 2u³.
    pub fn frame(&self, k: usize) -> Option<BlendFrame> {
        let n = self.n_frames();
        if k > n {
            return None;
        }
        let u = if n == 0 { 0.0 } else { k as f64 / n as f64 };
        let place = |span: &Range<usize>| span.start as f64 + u * span.len() as f64;
        Some(match self {
            Self::Plain(Submotion { span, .. }) => {
                let frame = (span.start + k) as f64;
                BlendFrame {
                    entry: frame,
                    exit: frame,
                    weight: 0.0,
                }
            }
            Self::Blend { entry, exit, .. } => BlendFrame {
                entry: place(&entry.span),
                exit: place(&exit.span),
                weight: u * u * (3.0 - 2.0 * u),
            },
        })
    }
}

/// Why there is no such walk.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum WalkError {
    /// There is no bundle of that id.
    #[error("expected a bundle below {n_bundles}, found {bundle}")]
    Bundle {
        /// The id.
        bundle: usize,
        /// Number of bundles.
        n_bundles: usize,
    },
    /// No edge joins two bundles.
    #[error("step {step}: expected an edge from bundle {from}, found none to bundle {to}")]
    Edge {
        /// Number of edges before it.
        step: usize,
        /// The bundle to leave.
        from: usize,
        /// The bundle to enter.
        to: usize,
    },
    /// No edges lead from one bundle to the other.
    #[error("expected a way from bundle {from} to bundle {to}, found none")]
    Unreachable {
        /// Where the walk starts.
        from: usize,
        /// Where it is to end.
        to: usize,
    },
    /// A walk goes somewhere.
    #[error("expected at least one bundle, found none")]
    Empty,
}

impl BundleGraph {
    /// The walk along these bundles.
    ///
    /// Of each edge it takes the passage with the shortest transition (none is shortest); among
    /// these one that leaves the submotion just entered, which needs no blend; among these the
    /// first. The first bundle is entered where it is left, and the last one left where it is
    /// entered; a bundle alone plays its first submotion.
    ///
    /// # Errors
    ///
    /// When there is no bundle, an id is unknown, or an edge is missing.
    pub fn walk_along(&self, bundles: &[usize]) -> Result<Walk, WalkError> {
        for &bundle in bundles {
            self.check_bundle(bundle)?;
        }
        let mut entry = None;
        let mut passages: Vec<&Passage> = Vec::new();
        for (step, pair) in bundles.windows(2).enumerate() {
            let (from, to) = (pair[0], pair[1]);
            let missing = WalkError::Edge { step, from, to };
            let edge = self.edge(from, to).ok_or(missing)?;
            let key = |passage: &&Passage| {
                (
                    transition_frames(passage),
                    entry.is_some_and(|entry| entry != passage.exit),
                )
            };
            // The first of the least.
            let passage = edge.passages.iter().min_by_key(key);
            passages.extend(passage);
            entry = passage.map(|passage| passage.entry);
        }
        self.through(bundles, &passages)
    }

    /// The walk along `bundles` through one passage between each two.
    fn through(&self, bundles: &[usize], passages: &[&Passage]) -> Result<Walk, WalkError> {
        if bundles.is_empty() {
            return Err(WalkError::Empty);
        }
        let mut pieces = Vec::new();
        for (index, &bundle) in bundles.iter().enumerate() {
            let before = index.checked_sub(1).and_then(|before| passages.get(before));
            let after = passages.get(index);
            let entry = before.map(|passage| passage.entry);
            let exit = after.map(|passage| passage.exit);
            let (entry, exit) = (entry.or(exit).unwrap_or(0), exit.or(entry).unwrap_or(0));
            pieces.extend(self.piece(bundle, entry, exit));
            let transition = after.and_then(|passage| passage.transition.clone());
            pieces.extend(transition.map(Piece::Plain));
        }
        let bundles = bundles.to_vec();
        Ok(Walk { bundles, pieces })
    }

    fn piece(&self, bundle: usize, entry: usize, exit: usize) -> Option<Piece> {
        let is_plain = entry == exit;
        let entry = self.submotion(bundle, entry)?.clone();
        let exit = self.submotion(bundle, exit)?.clone();
        Some(if is_plain {
            Piece::Plain(entry)
        } else {
            Piece::Blend {
                bundle,
                entry,
                exit,
            }
        })
    }

    fn check_bundle(&self, bundle: usize) -> Result<(), WalkError> {
        let n_bundles = self.bundles().len();
        if bundle < n_bundles {
            return Ok(());
        }
        Err(WalkError::Bundle { bundle, n_bundles })
    }
}

fn transition_frames(passage: &Passage) -> usize {
    passage
        .transition
        .as_ref()
        .map_or(0, |submotion| submotion.span.len())
}

/// Frames of the shortest transition along an edge.
fn shortest_transition(edge: &Edge) -> usize {
    edge.passages
        .iter()
        .map(transition_frames)
        .min()
        .unwrap_or(0)
}
