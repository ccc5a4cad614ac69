//! The page of motion bundles, with the clips of the library that their submotions are in.

use bundles::BundleGraph;

use super::clips::Clips;
use super::search::fact;
use crate::bundling::Bundled;
use crate::report::document::{BundleNode, BundlesPage, Place};
use crate::report::graph;

/// Bundles are named as `motif bundle` names them. Submotions in clips that the library does not have, or not as
/// they were, are left out.
pub(super) fn page(bundled: &Bundled, clips: &Clips) -> BundlesPage {
    let graph = bundled.model.graph();
    let nodes = graph.bundles().iter().enumerate().map(|(i, bundle)| {
        let places = bundle.submotions.iter().filter_map(|submotion| {
            let (clip, frames) = bundled.source(submotion)?;
            let id = clips.id(&clip.clip().display())?;
            let meta = &clips.rows().get(id as usize)?.clip.meta;
            (meta.content == clip.content).then(|| Place::new(id, frames, meta.source_rate))
        });
        BundleNode {
            id: name(i),
            height: bundle.height(),
            mean_frames: bundle.mean_frames(),
            volume: bundle.volume,
            spans: places.collect(),
            next: next(graph, i),
        }
    });
    let nodes: Vec<BundleNode> = nodes.collect();
    let n_submotions: usize = nodes.iter().map(|node| node.height).sum();
    let n_shown: usize = nodes.iter().map(|node| node.spans.len()).sum();
    let mut facts = vec![
        fact("clips", bundled.clips.len()),
        fact("bundles", nodes.len()),
        fact("submotions", n_submotions),
        fact("edges", graph.edges().len()),
    ];
    if n_shown < n_submotions {
        let gone = n_submotions - n_shown;
        facts.push(fact("not in the library", format!("{gone} submotions")));
    }
    let drawn = graph::drawn(nodes.len());
    facts.extend(drawn.map(|(name, value)| fact(name, value)));
    BundlesPage {
        facts,
        svg: graph::svg(graph),
        nodes,
        walks: Vec::new(),
    }
}

fn next(graph: &BundleGraph, bundle: usize) -> Vec<String> {
    let edges = graph.edges_from(bundle).iter();
    edges.map(|edge| name(edge.to)).collect()
}

fn name(bundle: usize) -> String {
    format!("B{bundle}")
}
