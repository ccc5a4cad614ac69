//! Scenes against their definition: every combination of hits is tried, and frames are compared one by one.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use proptest::collection::vec;
use proptest::prelude::*;
use segidx::{
    FuzzySet, Index, IndexBuilder, Mask, Progression, Relation, RunRef, Scene, SceneHit,
    search_scene,
};

use crate::naive::{self, Set};

const BITS: u32 = 2;

/// `None` is unspecified, else a mask as (care, value).
type RawLine = Vec<Option<(u64, u64)>>;

#[derive(Clone, Debug)]
struct RawScene {
    lines: Vec<RawLine>,
    /// Kind, gap, and the two runs as (line, position).
    relations: Vec<RawRelation>,
    max_frames: Option<usize>,
}

#[derive(Clone, Copy, Debug)]
struct RawRelation {
    kind: u8,
    gap: usize,
    a: (usize, usize),
    b: (usize, usize),
}

/// Start and end (exclusive) of the run of every written position, of the hull and of the core.
#[derive(Clone, Debug)]
struct NaiveLineHit {
    positions: Vec<Range<usize>>,
    hull: Range<usize>,
    core: Range<usize>,
}

/// The hits of a line in one document, in order of time.
fn line_hits(words: &[u64], line: &RawLine) -> Vec<NaiveLineHit> {
    let first = line.iter().position(Option::is_some).unwrap();
    let last = line.iter().rposition(Option::is_some).unwrap();
    // Sets with the written positions they stand for.
    let mut merged: Vec<(Set, Vec<usize>)> = Vec::new();
    for (position, mask) in line.iter().enumerate() {
        if let Some((care, value)) = *mask {
            merged.push((naive::set_of_mask(care, value, BITS), vec![position]));
        }
    }
    while let Some(i) = (1..merged.len()).find(|&i| !merged[i - 1].0.is_disjoint(&merged[i].0)) {
        let (set, positions) = merged.remove(i);
        merged[i - 1].0.extend(set);
        merged[i - 1].1.extend(positions);
    }
    let sets: Vec<(Set, usize)> = merged.iter().map(|(set, _)| (set.clone(), 0)).collect();
    let mut hits = naive::search(&[words.to_vec()], &sets, naive::adaptive);
    hits.sort_by_key(|hit| hit.2[0].0);
    let of_hit = |runs: Vec<(usize, usize)>| {
        let (start, end) = (runs[0].0, runs[runs.len() - 1].1);
        let run_of = |position: usize| {
            let run = merged.iter().position(|(_, all)| all.contains(&position));
            match run {
                Some(run) => runs[run].0..runs[run].1,
                None if position < first => 0..start,
                None => end..words.len(),
            }
        };
        let has_open_end = last + 1 < line.len();
        NaiveLineHit {
            positions: (0..line.len()).map(run_of).collect(),
            hull: (if first > 0 { 0 } else { start })..(if has_open_end {
                words.len()
            } else {
                end
            }),
            core: match &runs[..] {
                [(start, end)] => *start..*end,
                [entered, .., left] => entered.1 - 1..left.0 + 1,
                [] => unreachable!(),
            },
        }
    };
    hits.into_iter().map(|(_, _, runs)| of_hit(runs)).collect()
}

fn frames(range: &Range<usize>) -> BTreeSet<usize> {
    range.clone().collect()
}

fn share_a_frame(a: &Range<usize>, b: &Range<usize>) -> bool {
    !frames(a).is_disjoint(&frames(b))
}

fn relation_holds(relation: &RawRelation, hits: &[&NaiveLineHit]) -> bool {
    let run = |(line, position): (usize, usize)| hits[line].positions[position].clone();
    let (a, b) = (run(relation.a), run(relation.b));
    match relation.kind {
        0 => share_a_frame(&a, &b),
        1 => a.end <= b.start,
        _ => (a.end..b.start).chain(b.end..a.start).count() <= relation.gap,
    }
}

fn are_connected(scene: &RawScene, a: usize, b: usize) -> bool {
    let mut reached = BTreeSet::from([a]);
    for _ in &scene.lines {
        for RawRelation { a, b, .. } in &scene.relations {
            if reached.contains(&a.0) || reached.contains(&b.0) {
                reached.extend([a.0, b.0]);
            }
        }
    }
    reached.contains(&b)
}

fn holds(scene: &RawScene, hits: &[&NaiveLineHit]) -> bool {
    let n = hits.len();
    let pairs = (0..n).flat_map(|a| (0..n).map(move |b| (a, b)));
    let unconnected = pairs.filter(|&(a, b)| !are_connected(scene, a, b));
    let is_short = scene
        .max_frames
        .is_none_or(|max| span_of(hits).len() <= max);
    is_short
        && scene.relations.iter().all(|r| relation_holds(r, hits))
        && unconnected.into_iter().all(|(a, b)| {
            share_a_frame(&hits[a].hull, &hits[b].hull)
                && share_a_frame(&hits[a].core, &hits[b].hull)
        })
}

fn span_of(hits: &[&NaiveLineHit]) -> Range<usize> {
    let start = hits.iter().map(|hit| hit.core.start).min().unwrap();
    let end = hits.iter().map(|hit| hit.core.end).max().unwrap();
    start..end
}

/// `(cost, document, span, runs of the lines)` in order.
type Plain = (usize, usize, (usize, usize), Vec<Vec<Range<usize>>>);

fn naive_scene(documents: &[Vec<u64>], scene: &RawScene) -> Vec<Plain> {
    let mut found = Vec::new();
    for (doc, words) in documents.iter().enumerate() {
        let lines: Vec<Vec<NaiveLineHit>> =
            scene.lines.iter().map(|l| line_hits(words, l)).collect();
        // Combinations in lexicographic order, so that the first with a span is the one that is kept.
        let mut combinations: Vec<Vec<&NaiveLineHit>> = vec![Vec::new()];
        for hits in &lines {
            combinations = combinations
                .iter()
                .flat_map(|chosen| hits.iter().map(|hit| [&chosen[..], &[hit]].concat()))
                .collect();
        }
        let mut spans: BTreeMap<(usize, usize), Vec<Vec<Range<usize>>>> = BTreeMap::new();
        for hits in combinations.iter().filter(|hits| holds(scene, hits)) {
            let span = span_of(hits);
            let runs = || hits.iter().map(|hit| hit.positions.clone()).collect();
            spans.entry((span.start, span.end)).or_insert_with(runs);
        }
        let of_span = |((start, end), runs)| (end - start, doc, (start, end), runs);
        found.extend(spans.into_iter().map(of_span));
    }
    found.sort_by_key(|hit| (hit.0, hit.1, hit.2));
    found
}

fn index_of(documents: &[Vec<u64>]) -> Index {
    let mut builder = IndexBuilder::new();
    for words in documents {
        builder.push("", [], words).unwrap();
    }
    builder.build()
}

fn scene_of(raw: &RawScene) -> Scene {
    let set = |mask: &Option<(u64, u64)>| {
        mask.map(|(care, value)| FuzzySet::from(Mask::new(care, value)))
    };
    let line = |line: &RawLine| Progression::new(line.iter().map(set)).unwrap();
    let relation = |raw: &RawRelation| {
        let run = |(line, position)| RunRef { line, position };
        let (a, b) = (run(raw.a), run(raw.b));
        match raw.kind {
            0 => Relation::Overlap(a, b),
            1 => Relation::Before(a, b),
            _ => Relation::Within(raw.gap, a, b),
        }
    };
    let lines = raw.lines.iter().map(line).collect();
    let relations = raw.relations.iter().map(relation).collect();
    let scene = Scene::new(lines, relations).unwrap();
    match raw.max_frames {
        Some(max) => scene.within(max),
        None => scene,
    }
}

fn plain(hits: &[SceneHit]) -> Vec<Plain> {
    let of_hit = |hit: &SceneHit| {
        let span = (hit.span.start, hit.span.end);
        (hit.span.len(), hit.doc.index(), span, hit.lines.clone())
    };
    hits.iter().map(of_hit).collect()
}

fn found(documents: &[Vec<u64>], scene: &RawScene) -> Vec<Plain> {
    plain(&search_scene(&index_of(documents), &scene_of(scene)).unwrap())
}

fn spans(hits: &[Plain]) -> BTreeSet<(usize, (usize, usize))> {
    hits.iter().map(|hit| (hit.1, hit.2)).collect()
}

fn documents() -> impl Strategy<Value = Vec<Vec<u64>>> {
    let word = || 0..1u64 << BITS;
    let stretched = vec((word(), 1..4usize), 0..8).prop_map(|runs| {
        let frames = runs.into_iter().map(|(word, n)| vec![word; n]);
        frames.flatten().collect()
    });
    vec(prop_oneof![vec(word(), 0..16), stretched], 0..4)
}

/// Mostly one bit going on and off, as scene descriptions have it, sometimes any masks.
fn line() -> impl Strategy<Value = RawLine> {
    let alternating = (0..BITS, 0..2u64, 1..5usize).prop_map(|(bit, first, n)| {
        let value = |i: usize| (first + i as u64) % 2;
        (0..n).map(|i| (1 << bit, value(i) << bit)).collect()
    });
    let masks = vec((0..1u64 << BITS, 0..1u64 << BITS), 1..4);
    let specified = prop_oneof![3 => alternating, 1 => masks];
    (specified, 0..2usize, 0..2usize).prop_map(|(masks, before, after): (Vec<_>, _, _)| {
        let open = |n| std::iter::repeat_n(None, n);
        let specified = masks.into_iter().map(Some);
        open(before).chain(specified).chain(open(after)).collect()
    })
}

fn raw_scene() -> impl Strategy<Value = RawScene> {
    let run = || (any::<usize>(), any::<usize>());
    let relation = (0..3u8, 0..5usize, run(), run());
    let limit = prop_oneof![2 => Just(None), 1 => (0..12usize).prop_map(Some)];
    (vec(line(), 1..4), vec(relation, 0..4), limit).prop_map(|(lines, relations, max_frames)| {
        let pick = |(line, position): (usize, usize)| {
            let line = line % lines.len();
            (line, position % lines[line].len())
        };
        let relation = |(kind, gap, a, b)| RawRelation {
            kind,
            gap,
            a: pick(a),
            b: pick(b),
        };
        RawScene {
            relations: relations.into_iter().map(relation).collect(),
            lines,
            max_frames,
        }
    })
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 6_000,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn a_scene_is_what_its_definition_says(documents in documents(), scene in raw_scene()) {
        prop_assert_eq!(found(&documents, &scene), naive_scene(&documents, &scene));
    }

    #[test]
    fn hits_satisfy_every_relation(documents in documents(), scene in raw_scene()) {
        for hit in search_scene(&index_of(&documents), &scene_of(&scene)).unwrap() {
            let n_frames = documents[hit.doc.index()].len();
            prop_assert!(hit.span.start < hit.span.end && hit.span.end <= n_frames);
            prop_assert!(hit.lines.iter().flatten().all(|run| run.end <= n_frames));
            prop_assert_eq!(hit.cores.iter().map(|core| core.start).min(), Some(hit.span.start));
            prop_assert_eq!(hit.cores.iter().map(|core| core.end).max(), Some(hit.span.end));
            prop_assert!(scene.max_frames.is_none_or(|max| hit.span.len() <= max));
            for r in &scene.relations {
                let [a, b] = [r.a, r.b].map(|(line, position)| hit.lines[line][position].clone());
                let holds = match r.kind {
                    0 => a.start.max(b.start) < a.end.min(b.end),
                    1 => a.end <= b.start,
                    _ => b.start <= a.end + r.gap && a.start <= b.end + r.gap,
                };
                prop_assert!(holds, "{r:?} in {hit:?}");
            }
        }
    }

    #[test]
    fn a_relation_among_connected_lines_never_adds_hits(documents in documents(), scene in raw_scene()) {
        for n in 0..scene.relations.len() {
            let fewer = RawScene { relations: scene.relations[..n].to_vec(), ..scene.clone() };
            let more = RawScene { relations: scene.relations[..=n].to_vec(), ..scene.clone() };
            let added = scene.relations[n];
            if are_connected(&fewer, added.a.0, added.b.0) {
                let (before, after) = (found(&documents, &fewer), found(&documents, &more));
                prop_assert!(spans(&after).is_subset(&spans(&before)));
            }
        }
        let unlimited = RawScene { max_frames: None, ..scene.clone() };
        let all = spans(&found(&documents, &unlimited));
        prop_assert!(spans(&found(&documents, &scene)).is_subset(&all));
    }

    #[test]
    fn documents_are_searched_apart(documents in documents(), scene in raw_scene()) {
        let together = found(&documents, &scene);
        let mut apart = Vec::new();
        for (doc, words) in documents.iter().enumerate() {
            let alone = found(std::slice::from_ref(words), &scene);
            apart.extend(alone.into_iter().map(|(cost, _, span, lines)| (cost, doc, span, lines)));
        }
        apart.sort_by_key(|hit| (hit.0, hit.1, hit.2));
        prop_assert_eq!(together, apart);
    }
}

/// The random scenes do find things: a twin that agrees on nothing but empty lists would show nothing.
#[test]
fn random_scenes_have_hits() {
    use proptest::strategy::ValueTree;
    use proptest::test_runner::TestRunner;
    let mut runner = TestRunner::deterministic();
    let (mut n_found, mut n_joined) = (0, 0);
    for _ in 0..500 {
        let documents = documents().new_tree(&mut runner).unwrap().current();
        let scene = raw_scene().new_tree(&mut runner).unwrap().current();
        let is_found = !found(&documents, &scene).is_empty();
        n_found += usize::from(is_found);
        n_joined += usize::from(is_found && scene.lines.len() > 1 && !scene.relations.is_empty());
    }
    assert!(n_found > 100 && n_joined > 25, "{n_found}, {n_joined}");
}
