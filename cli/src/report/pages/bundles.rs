//! Motion bundles and walks through their graph.

use std::collections::BTreeMap;
use std::path::Path;

use bundles::{DeadEnds, RandomWalk, Walk};
use mocap_io::FrameRate;

use crate::bundling::Bundled;
use crate::commands::bundle::summary;
use crate::commands::walk::read_clip;
use crate::failure::Failure;
use crate::recording::{ReadOptions, body_map};
use crate::report::clip::Drawn;
use crate::report::document::{BundleNode, BundlesPage, Fact, PageWalk, Place, WalkStep};
use crate::report::graph;
use crate::report::make::Maker;
use crate::walking::{WalkClip, WalkClips, play, sides};

/// Seeds of the walks, and bundles on the way of each.
const SEEDS: [u64; 2] = [0, 1];
const WALK_BUNDLES: usize = 12;

/// Bundles, their graph, and two walks at random; walks that cannot be played are left out.
///
/// # Errors
/// [`Failure`] for clips that are not those that the bundles were made from.
pub fn page(maker: &mut Maker<'_>, path: &Path, bundled: &Bundled) -> Result<BundlesPage, Failure> {
    let mut clips: WalkClips = BTreeMap::new();
    let mut ids = BTreeMap::new();
    let ranges = bundled.model.graph().clips().iter();
    for (index, (clip, range)) in bundled.clips.iter().zip(ranges).enumerate() {
        let options = maker.how.options;
        let rate = FrameRate::from_hz(bundled.rate);
        let (loaded, motion) = read_clip(clip, rate, options)?;
        let map = body_map(&clip.path, &loaded.recording, options).ok();
        let first = range.start;
        clips.insert(index, WalkClip { motion, map, first });
        let with_skeleton = ReadOptions {
            asf: clip.asf.clone().or_else(|| options.asf.clone()),
            ..options.clone()
        };
        let drawn = Drawn::load(&clip.clip(), &with_skeleton, maker.how.rate)?;
        ids.insert(index, maker.builder.add(&drawn));
    }
    let mut walks = Vec::new();
    for seed in SEEDS {
        walks.extend(walk(maker, bundled, &clips, seed));
    }
    Ok(BundlesPage {
        facts: facts(path, bundled),
        svg: graph::svg(bundled.model.graph()),
        nodes: nodes(bundled, &ids),
        walks,
    })
}

fn facts(path: &Path, bundled: &Bundled) -> Vec<Fact> {
    let summary = summary(bundled, path);
    let share = 100.0 * summary.bundled_frames as f64 / summary.frames.max(1) as f64;
    let mut facts = vec![
        ("file", summary.file.clone()),
        ("clips", summary.clips.to_string()),
        ("frames", summary.frames.to_string()),
        ("pose clusters", summary.clusters.to_string()),
        ("letters", summary.string_length.to_string()),
        ("bundles", summary.bundles.len().to_string()),
        ("edges", summary.edges.len().to_string()),
        ("frames in bundles", format!("{share:.1} %")),
    ];
    facts.extend(graph::drawn(summary.bundles.len()));
    let fact = |(name, value): (&str, String)| Fact {
        name: name.to_owned(),
        value,
    };
    facts.into_iter().map(fact).collect()
}

fn name(bundle: usize) -> String {
    format!("B{bundle}")
}

fn nodes(bundled: &Bundled, ids: &BTreeMap<usize, u32>) -> Vec<BundleNode> {
    let graph = bundled.model.graph();
    let nodes = graph.bundles().iter().enumerate().map(|(id, bundle)| {
        let spans = bundle.submotions.iter().filter_map(|submotion| {
            let (_, frames) = bundled.source(submotion)?;
            let clip = *ids.get(&submotion.clip)?;
            Some(Place::new(clip, frames, bundled.rate))
        });
        BundleNode {
            id: name(id),
            height: bundle.height(),
            mean_frames: bundle.mean_frames(),
            volume: bundle.volume,
            spans: spans.collect(),
            next: graph
                .edges_from(id)
                .iter()
                .map(|edge| name(edge.to))
                .collect(),
        }
    });
    nodes.collect()
}

fn walk(
    maker: &mut Maker<'_>,
    bundled: &Bundled,
    clips: &WalkClips,
    seed: u64,
) -> Option<PageWalk> {
    let walk = bundled.model.graph().random_walk(&RandomWalk {
        n_bundles: WALK_BUNDLES,
        start: None,
        dead_ends: DeadEnds::Avoid,
        seed,
    });
    let walk = walk.ok()?;
    let motion = play(&walk, clips).ok()?;
    let title = format!("walk {}", seed + 1);
    let drawn = Drawn::of_motion(title.clone(), &motion, maker.how.rate);
    Some(PageWalk {
        clip: maker.builder.add_made(&drawn),
        title,
        path: steps(&walk, bundled),
    })
}

/// The bundles of a walk with the seconds at which each begins.
fn steps(walk: &Walk, bundled: &Bundled) -> Vec<WalkStep> {
    let mut at = 0;
    let mut steps = Vec::new();
    for piece in &walk.pieces {
        let (entry, _) = sides(piece);
        let mut holders = bundled.model.graph().bundles().iter();
        if let Some(bundle) = holders.position(|bundle| bundle.submotions.contains(entry)) {
            steps.push(WalkStep {
                bundle: name(bundle),
                start_s: at as f64 / bundled.rate,
            });
        }
        at += piece.n_frames();
    }
    steps
}
