use super::*;
use crate::{FuzzySet, IndexBuilder, Mask};

fn is(bit: u32, on: u64) -> Option<FuzzySet> {
    Some(Mask::new(1 << bit, on << bit).into())
}

fn pulse(bit: u32) -> Progression {
    Progression::new([is(bit, 0), is(bit, 1), is(bit, 0)]).unwrap()
}

fn at(line: usize, position: usize) -> RunRef {
    RunRef { line, position }
}

#[test]
fn written_positions_keep_their_runs() {
    let positions = [
        None,
        None,
        is(0, 0),
        is(0, 0),
        is(0, 1),
        is(0, 0),
        is(0, 0),
        None,
    ];
    let progression = Progression::new(positions).unwrap();
    assert_eq!((progression.n_positions(), progression.n_runs()), (8, 5));
    let runs: Vec<_> = (0..9).map(|p| progression.run_of(p)).collect();
    let expected = [0, 0, 1, 1, 2, 3, 3, 4].map(Some);
    assert_eq!(runs[..8], expected);
    assert_eq!(runs[8], None);
}

#[test]
fn open_ends_reach_to_the_edges_of_the_document() {
    let mut builder = IndexBuilder::new();
    builder.push("", [], &[1, 0, 1, 0, 0, 1]).unwrap();
    builder.push("", [], &[0, 1]).unwrap();
    let line = Progression::new([None, is(0, 0), is(0, 1), None]).unwrap();
    let scene = Scene::new(vec![line], Vec::new()).unwrap();
    let hits = search_scene(&builder.build(), &scene).unwrap();
    let found: Vec<_> = hits
        .iter()
        .map(|hit| (hit.doc.index(), hit.span.clone(), hit.lines[0].clone()))
        .collect();
    let expected = [
        (0, 1..3, vec![0..1, 1..2, 2..3, 3..6]),
        (0, 4..6, vec![0..3, 3..5, 5..6, 6..6]),
        (1, 0..2, vec![0..0, 0..1, 1..2, 2..2]),
    ];
    assert_eq!(found, expected);
}

#[test]
fn what_is_no_progression() {
    assert_eq!(
        Progression::new([None, None]),
        Err(SceneError::Unspecified { found: 2 })
    );
    assert_eq!(
        Progression::new([None, is(0, 1), None, is(0, 0)]),
        Err(SceneError::Gap { position: 2 })
    );
}

#[test]
fn what_is_no_scene() {
    assert_eq!(Scene::new(Vec::new(), Vec::new()), Err(SceneError::NoLines));
    let within = |a, b| Scene::new(vec![pulse(0)], vec![Relation::Within(1, a, b)]);
    assert_eq!(
        within(at(0, 2), at(1, 0)),
        Err(SceneError::Line {
            relation: 0,
            n_lines: 1,
            found: 1
        })
    );
    assert_eq!(
        within(at(0, 3), at(0, 0)),
        Err(SceneError::Position {
            relation: 0,
            line: 0,
            n_positions: 3,
            found: 3
        })
    );
}

#[test]
fn the_tighter_limit_holds() {
    let scene = Scene::new(vec![pulse(0)], Vec::new()).unwrap();
    assert_eq!(scene.max_frames(), None);
    assert_eq!(scene.clone().within(3).within(9).max_frames(), Some(3));
    assert_eq!(scene.within(9).within(3).max_frames(), Some(3));
}

#[test]
fn chains_of_relations_connect() {
    let before = |a, b| Relation::Before(at(a, 1), at(b, 1));
    let lines = (0..5).map(pulse).collect();
    let scene = Scene::new(lines, vec![before(4, 2), before(3, 1), before(1, 4)]).unwrap();
    assert_eq!(scene.components(), [0, 1, 1, 1, 1]);
}

/// n pulses of every bit side by side, so that each line has n hits and 4 lines have n⁴ combinations. With every span
/// kept once, the search stays within the n² spans that there can be.
#[test]
fn many_combinations_are_few_spans() {
    const N: usize = 60;
    let words: Vec<u64> = (0..N).flat_map(|_| [0, 0b1111, 0]).collect();
    let mut builder = IndexBuilder::new();
    builder.push("", [], &words).unwrap();
    let lines: Vec<Progression> = (0..4).map(pulse).collect();
    let anywhere = |b| Relation::Within(words.len(), at(0, 1), at(b, 1));
    let scene = Scene::new(lines, (1..4).map(anywhere).collect()).unwrap();
    let hits = search_scene(&builder.build(), &scene).unwrap();
    assert_eq!(hits.len(), N * (N + 1) / 2);
}
