use std::collections::{BTreeMap, BTreeSet};

use bundles::{BundleGraph, FrameMapping, Submotion, Substring, link};
use proptest::prelude::*;

use crate::mapping_laws::{Mapped, mapped};

pub(crate) fn graph_of(mapped: &Mapped) -> (FrameMapping, BundleGraph) {
    let mapping = mapped.run(2);
    let graph = link(&mapped.case.string, &mapped.partition, &mapping).unwrap();
    (mapping, graph)
}

/// Exit, entry and transition by first and last frame.
type Way = (usize, usize, Option<(usize, usize)>);

/// Every pair of submotions, with every degenerate one between them.
fn ways(mapped: &Mapped, mapping: &FrameMapping) -> BTreeMap<(usize, usize), Vec<Way>> {
    let span = |s: &Substring| {
        (
            mapping.frame(s.first).unwrap(),
            mapping.frame(s.last).unwrap(),
        )
    };
    let bundles: Vec<Vec<(usize, usize)>> = (mapped.partition.bundles.iter())
        .map(|bundle| bundle.members.iter().map(span).collect())
        .collect();
    let single: Vec<_> = mapped.partition.degenerate.iter().map(span).collect();
    let mut ways: BTreeMap<(usize, usize), Vec<Way>> = BTreeMap::new();
    for (from, exits) in bundles.iter().enumerate() {
        for (to, entries) in bundles.iter().enumerate() {
            for (exit, a) in exits.iter().enumerate() {
                for (entry, b) in entries.iter().enumerate() {
                    let all = ways.entry((from, to)).or_default();
                    if a.1 == b.0 {
                        all.push((exit, entry, None));
                    }
                    let between = single.iter().filter(|d| a.1 == d.0 && d.1 == b.0);
                    all.extend(between.map(|&d| (exit, entry, Some(d))));
                }
            }
        }
    }
    ways.retain(|_, all| !all.is_empty());
    ways
}

fn bounds(submotion: &Submotion) -> (usize, usize) {
    (submotion.span.start, submotion.span.end)
}

/// Which bundles can be reached from which by at least one edge (Warshall).
pub(crate) fn reach(graph: &BundleGraph) -> Vec<Vec<bool>> {
    let n = graph.bundles().len();
    let mut reach = vec![vec![false; n]; n];
    graph
        .edges()
        .iter()
        .for_each(|edge| reach[edge.from][edge.to] = true);
    for middle in 0..n {
        for from in 0..n {
            for to in 0..n {
                reach[from][to] |= reach[from][middle] && reach[middle][to];
            }
        }
    }
    reach
}

proptest! {
    #[test]
    fn edges_equal_the_definition(mapped in mapped()) {
        let (mapping, graph) = graph_of(&mapped);
        let mut expected = ways(&mapped, &mapping);
        for edge in graph.edges() {
            let mut all = expected.remove(&(edge.from, edge.to)).unwrap();
            all.sort();
            let found = edge.passages.iter().map(|passage| {
                (passage.exit, passage.entry, passage.transition.as_ref().map(bounds))
            });
            let mut found: Vec<Way> = found.collect();
            found.sort();
            prop_assert_eq!(found, all);
            prop_assert_eq!(graph.edge(edge.from, edge.to), Some(edge));
        }
        prop_assert!(expected.is_empty());
        prop_assert_eq!(graph.debug_validate(), Ok(()));
    }

    #[test]
    fn submotions_tile_each_clip(mapped in mapped()) {
        let (mapping, graph) = graph_of(&mapped);
        let string = &mapped.case.string;
        let nodes = graph.bundles().iter().flat_map(|bundle| &bundle.submotions);
        let passages = graph.edges().iter().flat_map(|edge| &edge.passages);
        let on_edges = passages.filter_map(|passage| passage.transition.as_ref());
        let mut all: Vec<&Submotion> = nodes.chain(on_edges).chain(graph.loose()).collect();
        all.sort_by_key(|submotion| submotion.span.start);
        let mut all = all.into_iter().peekable();
        for clip in 0..string.n_clips() {
            let span = string.clip_span(clip).unwrap();
            if span.len() < 2 {
                continue;
            }
            let mut frame = mapping.frame(span.start).unwrap();
            while let Some(submotion) = all.next_if(|submotion| submotion.clip == clip) {
                prop_assert_eq!(submotion.span.start, frame);
                frame = submotion.span.end;
            }
            prop_assert_eq!(Some(frame), mapping.frame(span.end - 1));
        }
        prop_assert_eq!(all.next(), None);
    }

    #[test]
    fn components_equal_the_definition(mapped in mapped()) {
        let (_, graph) = graph_of(&mapped);
        let reach = reach(&graph);
        let n = graph.bundles().len();
        let mutual = |a: usize| -> Vec<usize> {
            (0..n).filter(|&b| a == b || (reach[a][b] && reach[b][a])).collect()
        };
        let expected: BTreeSet<Vec<usize>> = (0..n).map(mutual).collect();
        prop_assert_eq!(graph.components(), expected.into_iter().collect::<Vec<_>>());
    }

    #[test]
    fn bundles_are_the_partitions(mapped in mapped()) {
        let (mapping, graph) = graph_of(&mapped);
        for (bundle, strings) in graph.bundles().iter().zip(&mapped.partition.bundles) {
            prop_assert_eq!(bundle.height(), strings.members.len());
            prop_assert_eq!(bundle.volume, strings.volume);
            for (submotion, member) in bundle.submotions.iter().zip(&strings.members) {
                prop_assert_eq!(Some(submotion.span.start), mapping.frame(member.first));
                prop_assert_eq!(Some(submotion.span.end), mapping.frame(member.last));
            }
            let lengths = bundle.submotions.iter().map(|s| s.span.len() as f64);
            let mean = lengths.sum::<f64>() / bundle.height() as f64;
            prop_assert_eq!(bundle.mean_frames(), mean);
        }
    }
}
