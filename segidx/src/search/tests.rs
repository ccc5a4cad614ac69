use super::{Kind, MismatchQuery, Plan, Query, SearchPlan, Sets};
use crate::{Engine, FuzzySet, Hit, Index, IndexBuilder, Mask};

fn search_exact_with(index: &Index, query: &Query, engine: Engine) -> Vec<Hit> {
    super::search_exact_with(index, query, engine).unwrap().hits
}

fn search_adaptive_with(index: &Index, query: &Query, engine: Engine) -> Vec<Hit> {
    super::search_adaptive_with(index, query, engine)
        .unwrap()
        .hits
}

fn search_exact(index: &Index, query: &Query) -> Vec<Hit> {
    super::search_exact(index, query).unwrap()
}

fn search_adaptive(index: &Index, query: &Query) -> Vec<Hit> {
    super::search_adaptive(index, query).unwrap()
}

fn index_of(documents: &[&[u64]]) -> Index {
    let mut builder = IndexBuilder::new();
    for words in documents {
        builder.push("", [], words).unwrap();
    }
    builder.build()
}

/// `(doc, cost, first frame, end frame)` of the hits.
#[track_caller]
fn check(hits: &[Hit], expected: &[(usize, u64, usize, usize)]) {
    let found: Vec<_> = hits
        .iter()
        .map(|hit| (hit.doc.index(), hit.cost, hit.span().start, hit.span().end))
        .collect();
    assert_eq!(found, expected);
}

const ENGINES: [Engine; 4] = [Engine::Auto, Engine::Lists, Engine::Pivot, Engine::Scan];

#[test]
fn a_query_without_positions_has_no_hits() {
    let index = index_of(&[&[1, 2, 3]]);
    for engine in ENGINES {
        check(&search_exact_with(&index, &Query::default(), engine), &[]);
        check(
            &search_adaptive_with(&index, &Query::default(), engine),
            &[],
        );
    }
}

#[test]
fn an_empty_index_has_no_hits() {
    for index in [index_of(&[]), index_of(&[&[], &[]])] {
        for engine in ENGINES {
            let query = Query::exact(&[1], 0);
            check(&search_exact_with(&index, &query, engine), &[]);
            check(&search_adaptive_with(&index, &query, engine), &[]);
        }
    }
}

#[test]
fn a_set_without_words_has_no_hits() {
    let index = index_of(&[&[1, 2]]);
    let query = Query::from_sets([
        (FuzzySet::from_words([1]), None),
        (FuzzySet::default(), None),
    ]);
    for engine in ENGINES {
        check(&search_exact_with(&index, &query, engine), &[]);
        check(&search_adaptive_with(&index, &query, engine), &[]);
    }
}

#[test]
fn equal_costs_are_ordered_by_document_then_start() {
    let index = index_of(&[&[9, 1, 9, 1, 1], &[1, 9], &[1]]);
    let query = Query::exact(&[1], u64::MAX);
    let expected = [(0, 0, 1, 2), (1, 0, 0, 1), (2, 0, 0, 1), (0, 1, 3, 5)];
    check(&search_exact(&index, &query), &expected);
    check(&search_adaptive(&index, &query), &expected);
}

#[test]
fn hits_end_with_the_document() {
    // Read through the boundary, the words would continue the run and complete the sequence.
    let index = index_of(&[&[1], &[1, 2], &[2, 3]]);
    for engine in ENGINES {
        let query = Query::exact(&[1, 2], u64::MAX);
        check(&search_exact_with(&index, &query, engine), &[(1, 0, 0, 2)]);
        check(
            &search_adaptive_with(&index, &query, engine),
            &[(1, 0, 0, 2)],
        );
    }
}

#[test]
fn a_query_without_care_finds_each_document_once() {
    let index = index_of(&[&[1, 2], &[], &[3]]);
    let query = Query::fuzzy(&[7, 8], 0);
    check(
        &search_adaptive(&index, &query),
        &[(0, 0, 0, 2), (2, 1, 0, 1)],
    );
}

#[test]
fn adaptive_search_conjoins_an_exact_query() {
    let index = index_of(&[&[0b00, 0b01, 0b11, 0b10, 0b00]]);
    let exact = Query::exact(&[0b00, 0b01, 0b10], 0b10);
    let hits = search_adaptive(&index, &exact);
    assert_eq!(hits, search_adaptive(&index, &exact.conjoined()));
    assert_eq!(hits[0].segments, [0..2, 2..4]);
}

#[test]
fn sets_without_length_cost_nothing() {
    let index = index_of(&[&[1, 1, 1, 2, 2]]);
    let query = Query::from_sets([
        (Mask::word(1).into(), None),
        (Mask::word(2).into(), Some(7)),
    ]);
    check(&search_adaptive(&index, &query), &[(0, 5, 0, 5)]);
}

#[test]
fn segment_numbers_count_through_the_index_and_in_the_document() {
    let index = index_of(&[&[1, 2], &[], &[3, 1, 2]]);
    let hits = search_exact(&index, &Query::exact(&[1, 2], u64::MAX));
    let numbers = |hit: &Hit| (hit.first_segment, hit.first_segment_in_doc);
    assert_eq!(numbers(&hits[1]), (3, 1));
    assert_eq!(index.locate(3), Ok(Some((hits[1].doc, 1))));
}

/// The engine and the positions it starts from.
#[track_caller]
fn check_plan(
    (index, query, kind): (&Index, &Query, Kind<'_>),
    engine: Engine,
    expected: (Engine, &[usize]),
) {
    let view = index.view();
    let dictionary = view.dictionary().unwrap();
    let sets = Sets::new(dictionary, query.positions(), kind.care());
    let SearchPlan { engine, pivots, .. } = Plan::new(
        (&view, dictionary),
        &sets,
        query.positions(),
        (engine, kind),
    )
    .done;
    assert_eq!((engine, &pivots[..]), expected);
}

#[test]
fn searches_start_at_the_rarest_position() {
    let words: Vec<u64> = (0..100).map(|i| if i == 60 { 7 } else { i % 3 }).collect();
    let index = index_of(&[&words]);
    let query = Query::exact(&[2, 7, 1], u64::MAX);
    let exact = (&index, &query, Kind::Exact);
    check_plan(exact, Engine::Pivot, (Engine::Pivot, &[1]));
    check_plan(exact, Engine::Scan, (Engine::Scan, &[1]));
    check_plan(exact, Engine::Lists, (Engine::Lists, &[]));
    // Where one bit holds for every other segment, reading all of them in order is cheaper.
    let query = Query::fuzzy(&[0, 1, 0], 1);
    let adaptive = (&index, &query, Kind::Adaptive);
    check_plan(adaptive, Engine::Auto, (Engine::Scan, &[1]));
    check_plan(adaptive, Engine::Pivot, (Engine::Pivot, &[1]));
}

#[test]
fn a_rare_word_in_a_long_shard_is_looked_up() {
    let words: Vec<u64> = (0..5_000)
        .map(|i| if i == 600 { 7 } else { i % 3 })
        .collect();
    let index = index_of(&[&words]);
    let query = Query::exact(&[2, 7, 1], u64::MAX);
    check_plan(
        (&index, &query, Kind::Exact),
        Engine::Auto,
        (Engine::Pivot, &[1]),
    );
}

#[test]
fn mismatch_searches_start_at_the_rarest_positions_that_any_hit_must_match_one_of() {
    let words: Vec<u64> = (0..100)
        .map(|i| match i {
            60 => 7,
            20 | 40 => 8,
            i => i % 3,
        })
        .collect();
    let index = index_of(&[&words]);
    let query = Query::exact(&[2, 7, 1, 8, 0], u64::MAX);
    let pivots = |query: &MismatchQuery, expected: &[usize]| {
        let searched = (&index, query.query(), Kind::Mismatch(query));
        check_plan(searched, Engine::Pivot, (Engine::Pivot, expected));
    };
    let of = |m| MismatchQuery::new(query.clone(), m).unwrap();
    pivots(&of(1), &[1, 3]);
    pivots(&of(1).at([1, 2, 4]).unwrap(), &[3]);
    pivots(&of(3), &[1, 3, 0, 2]);
}
