use bundles::{BundleGraph, DeadEnds, Piece, RandomWalk, Submotion, Walk, WalkError};
use proptest::prelude::*;

use crate::graph_laws::{graph_of, reach};
use crate::mapping_laws::mapped;

/// Sums of fewer than 100 lengths, in another order.
const ROUNDING: f64 = 1e-9;

fn ends(piece: &Piece) -> (&Submotion, &Submotion) {
    match piece {
        Piece::Plain(submotion) => (submotion, submotion),
        Piece::Blend { entry, exit, .. } => (entry, exit),
    }
}

/// Each piece ends with the pose the next one begins with, blends stay in their bundles, and
/// transitions are those of the edges.
#[track_caller]
fn assert_plays(graph: &BundleGraph, walk: &Walk) {
    for pair in walk.pieces.windows(2) {
        let (exit, entry) = (ends(&pair[0]).1, ends(&pair[1]).0);
        assert_eq!((exit.clip, exit.span.end), (entry.clip, entry.span.start));
    }
    let mut pieces = walk.pieces.iter().peekable();
    for (index, &bundle) in walk.bundles.iter().enumerate() {
        let piece = pieces.next().unwrap();
        let submotions = &graph.bundles()[bundle].submotions;
        assert!(submotions.contains(ends(piece).0) && submotions.contains(ends(piece).1));
        if let Piece::Blend {
            bundle: blended,
            entry,
            exit,
        } = piece
        {
            assert_eq!(*blended, bundle);
            assert!(entry != exit && index > 0 && index + 1 < walk.bundles.len());
        }
        let Some(&next) = walk.bundles.get(index + 1) else {
            continue;
        };
        let passages = &graph.edge(bundle, next).unwrap().passages;
        let is_entry = |piece: &Piece| graph.bundles()[next].submotions.contains(ends(piece).0);
        let transition = pieces.next_if(|piece| !is_entry(piece));
        assert!(passages.iter().any(|passage| {
            let taken = transition.map(|piece| ends(piece).0);
            passage.transition.as_ref() == taken && submotions[passage.exit] == *ends(piece).1
        }));
    }
    assert!(pieces.next().is_none());
}

/// Frames of the shortest way, by relaxing every edge as often as there are bundles.
fn shortest(graph: &BundleGraph, from: usize) -> Vec<Option<f64>> {
    let mut best = vec![None; graph.bundles().len()];
    best[from] = Some(graph.bundles()[from].mean_frames());
    for _ in graph.bundles() {
        for edge in graph.edges() {
            let Some(before) = best[edge.from] else {
                continue;
            };
            for passage in &edge.passages {
                let transition = passage.transition.as_ref().map_or(0, |t| t.span.len());
                let length: f64 =
                    before + transition as f64 + graph.bundles()[edge.to].mean_frames();
                if best[edge.to].is_none_or(|known: f64| length + ROUNDING < known) {
                    best[edge.to] = Some(length);
                }
            }
        }
    }
    best
}

fn length(graph: &BundleGraph, walk: &Walk) -> f64 {
    let nodes = walk
        .bundles
        .iter()
        .map(|&bundle| graph.bundles()[bundle].mean_frames());
    let steps = walk.bundles.windows(2).map(|pair| {
        let passages = graph.edge(pair[0], pair[1]).unwrap().passages.iter();
        let frames = passages.map(|p| p.transition.as_ref().map_or(0, |t| t.span.len()));
        frames.min().unwrap() as f64
    });
    nodes.sum::<f64>() + steps.sum::<f64>()
}

proptest! {
    #[test]
    fn shortest_walks_equal_the_definition(mapped in mapped()) {
        let (_, graph) = graph_of(&mapped);
        let n = graph.bundles().len();
        for from in 0..n.min(6) {
            for (to, expected) in shortest(&graph, from).into_iter().enumerate() {
                match (graph.shortest_walk(from, to), expected) {
                    (Ok(walk), Some(expected)) => {
                        prop_assert_eq!(walk.bundles.first(), Some(&from));
                        prop_assert_eq!(walk.bundles.last(), Some(&to));
                        prop_assert!((length(&graph, &walk) - expected).abs() < ROUNDING);
                        assert_plays(&graph, &walk);
                    }
                    (Err(error), None) => {
                        prop_assert_eq!(error, WalkError::Unreachable { from, to });
                    }
                    other => prop_assert!(false, "{other:?}"),
                }
            }
        }
    }

    #[test]
    fn random_walks_last(mapped in mapped(), seed: u64, start in 0_usize..8) {
        let (_, graph) = graph_of(&mapped);
        let n = graph.bundles().len();
        let reach = reach(&graph);
        let is_cyclic = |id: usize| reach[id][id];
        let is_live = |id: usize| is_cyclic(id) || (0..n).any(|to| reach[id][to] && is_cyclic(to));
        for start in [None, Some(start)].into_iter().filter(|s| s.is_none_or(|s| s < n)) {
            let options = RandomWalk { n_bundles: 30, start, dead_ends: DeadEnds::Avoid, seed };
            let walk = graph.random_walk(&options);
            if n == 0 {
                prop_assert_eq!(walk, Err(WalkError::Empty));
                continue;
            }
            let walk = walk.unwrap();
            assert_plays(&graph, &walk);
            prop_assert_eq!(graph.random_walk(&options).unwrap(), walk.clone());
            let first = walk.bundles[0];
            prop_assert!(start.is_none_or(|start| start == first));
            prop_assert!(start.is_some() || is_cyclic(first) || !(0..n).any(is_cyclic));
            if is_live(first) {
                prop_assert_eq!(walk.bundles.len(), 30);
            } else if walk.bundles.len() < 30 {
                prop_assert!(graph.edges_from(*walk.bundles.last().unwrap()).is_empty());
            }
            if let Some(at) = walk.bundles.iter().position(|&id| is_cyclic(id)) {
                let home = walk.bundles[at];
                prop_assert!(walk.bundles[at..].iter().all(|&id| reach[home][id] && reach[id][home]));
            }
            let anywhere = RandomWalk { dead_ends: DeadEnds::Allow, ..options };
            assert_plays(&graph, &graph.random_walk(&anywhere).unwrap());
        }
    }

    #[test]
    fn walks_along_ids_play(mapped in mapped(), seed: u64) {
        let (_, graph) = graph_of(&mapped);
        let options = RandomWalk { n_bundles: 8, start: None, dead_ends: DeadEnds::Allow, seed };
        let Ok(random) = graph.random_walk(&options) else {
            return Ok(());
        };
        let walk = graph.walk_along(&random.bundles).unwrap();
        assert_plays(&graph, &walk);
        prop_assert_eq!(&walk.bundles, &random.bundles);
        prop_assert!(
            frames_of_transitions(&graph, &walk) <= frames_of_transitions(&graph, &random)
        );
    }

    #[test]
    fn frames_run_from_pose_to_pose(a in 1_usize..60, b in 1_usize..60) {
        let submotion = |start: usize, length| Submotion { clip: 0, span: start..start + length };
        let (entry, exit) = (submotion(5, a), submotion(100, b));
        let piece = Piece::Blend { bundle: 0, entry, exit };
        let n = piece.n_frames();
        prop_assert!(a.min(b) <= n && n <= a.max(b));
        let frames: Vec<_> = (0..=n).map(|k| piece.frame(k).unwrap()).collect();
        prop_assert_eq!(piece.frame(n + 1), None);
        prop_assert_eq!((frames[0].entry, frames[0].weight), (5.0, 0.0));
        prop_assert_eq!((frames[n].exit, frames[n].weight), ((100 + b) as f64, 1.0));
        for pair in frames.windows(2) {
            prop_assert!(pair[0].weight < pair[1].weight);
            let step = |x: f64, y: f64, length: usize| (y - x - length as f64 / n as f64).abs();
            prop_assert!(step(pair[0].entry, pair[1].entry, a) < ROUNDING);
            prop_assert!(step(pair[0].exit, pair[1].exit, b) < ROUNDING);
        }
    }
}

/// Frames of the pieces that are no submotion of a bundle.
fn frames_of_transitions(graph: &BundleGraph, walk: &Walk) -> usize {
    let nodes: Vec<&Submotion> = graph
        .bundles()
        .iter()
        .flat_map(|bundle| &bundle.submotions)
        .collect();
    let on_edges = walk
        .pieces
        .iter()
        .filter(|piece| !nodes.contains(&ends(piece).0));
    on_edges.map(Piece::n_frames).sum()
}
