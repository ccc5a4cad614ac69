//! Which way a walk goes.

use bundles::{Bundle, BundleGraph, DeadEnds, Piece, RandomWalk, Walk, WalkError};
use serde::Serialize;

use crate::args::WalkArgs;
use crate::bundling::Bundled;

/// Where walks at random stay, so that they can go on for ever.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct ReachJson {
    /// Its bundles: each leads to all others.
    pub bundles: usize,
    /// All of the graph.
    pub all_bundles: usize,
    /// Frames of its bundles.
    pub frames: usize,
    /// Those of all bundles.
    pub all_frames: usize,
}

impl ReachJson {
    /// The strongly connected component of a bundle; `None` where no edge stays in it.
    pub(super) fn of(graph: &BundleGraph, bundle: usize) -> Option<ReachJson> {
        let components = graph.components();
        let ids = components.iter().find(|ids| ids.contains(&bundle))?;
        let stays = |&id: &usize| graph.edges_from(id).iter().any(|e| ids.contains(&e.to));
        let frames = |bundle: &Bundle| -> usize {
            let spans = bundle.submotions.iter().map(|s| s.span.len());
            spans.sum()
        };
        let own = ids.iter().filter_map(|&id| graph.bundles().get(id));
        ids.iter().any(stays).then(|| ReachJson {
            bundles: ids.len(),
            all_bundles: graph.bundles().len(),
            frames: own.map(frames).sum(),
            all_frames: graph.bundles().iter().map(frames).sum(),
        })
    }
}

/// The walk that was asked for.
pub(super) fn find(args: &WalkArgs, bundled: &Bundled) -> Result<Walk, WalkError> {
    let graph = bundled.model.graph();
    let random = |n_bundles: usize| {
        graph.random_walk(&RandomWalk {
            n_bundles,
            start: None,
            dead_ends: if args.dead_ends {
                DeadEnds::Allow
            } else {
                DeadEnds::Avoid
            },
            seed: args.seed,
        })
    };
    match (args.random, args.seconds, args.from.zip(args.to)) {
        (Some(n_bundles), ..) => random(n_bundles.get()),
        (None, Some(seconds), _) => lasting(wanted_frames(seconds, bundled), random),
        (None, None, Some((from, to))) => graph.shortest_walk(from, to),
        (None, None, None) => graph.walk_along(&args.path),
    }
}

/// The last bundle of a walk at random that is shorter than asked for.
pub(super) fn dead_end(args: &WalkArgs, bundled: &Bundled, walk: &Walk) -> Option<usize> {
    let is_short = match (args.random, args.seconds) {
        (Some(n_bundles), _) => walk.bundles.len() < n_bundles.get(),
        (None, Some(seconds)) => n_frames(walk) < wanted_frames(seconds, bundled),
        (None, None) => false,
    };
    walk.bundles.last().copied().filter(|_| is_short)
}

fn n_frames(walk: &Walk) -> usize {
    walk.pieces.iter().map(Piece::n_frames).sum()
}

fn wanted_frames(seconds: f64, bundled: &Bundled) -> usize {
    (seconds * bundled.rate).ceil() as usize
}

/// As many bundles as last `wanted` frames, or as there are on the way to a dead end. With one more
/// bundle, a walk goes the way it went, and on.
fn lasting(
    wanted: usize,
    random: impl Fn(usize) -> Result<Walk, WalkError>,
) -> Result<Walk, WalkError> {
    let lasts = |walk: &Walk| n_frames(walk) >= wanted;
    // Too few, and enough. Every bundle has a frame at least, so the doubling ends.
    let (mut few, mut enough) = (0, 1);
    loop {
        let walk = random(enough)?;
        if lasts(&walk) || walk.bundles.len() < enough {
            break;
        }
        (few, enough) = (enough, 2 * enough);
    }
    while enough - few > 1 {
        let middle = few + (enough - few) / 2;
        if lasts(&random(middle)?) {
            enough = middle;
        } else {
            few = middle;
        }
    }
    random(enough)
}
