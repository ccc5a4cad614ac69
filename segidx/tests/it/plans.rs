//! What searches say they did.

use segidx::{
    Answer, Engine, Index, MismatchQuery, Query, search_adaptive_with, search_exact_with,
    search_mismatch_with,
};

use crate::mismatch::index_of;

const LIST_ENGINES: [Engine; 2] = [Engine::Lists, Engine::Pivot];

/// Three clips in which word 5 is rare, in 1 + 12 + 12 segments.
fn index() -> Index {
    let often: Vec<u64> = (0..12).map(|i| [1, 2, 3][i % 3]).collect();
    let mut with_five = often.clone();
    with_five[4] = 5;
    index_of(&[vec![1], often, with_five])
}

#[test]
fn a_chosen_engine_runs() {
    let (index, query) = (index(), Query::exact(&[1, 2], u64::MAX));
    for engine in [Engine::Lists, Engine::Pivot, Engine::Scan] {
        let plan = search_exact_with(&index, &query, engine).unwrap().plan;
        assert_eq!(plan.unwrap().engine, engine);
    }
    let plan = search_exact_with(&index, &query, Engine::Auto)
        .unwrap()
        .plan
        .unwrap();
    let least = plan
        .estimated
        .lists
        .min(plan.estimated.pivot)
        .min(plan.estimated.scan);
    let chosen = match plan.engine {
        Engine::Lists => plan.estimated.lists,
        Engine::Pivot => plan.estimated.pivot,
        Engine::Scan => plan.estimated.scan,
        Engine::Auto => panic!("nothing ran"),
    };
    assert_eq!(chosen, least);
}

#[test]
fn nothing_to_do_is_no_plan() {
    let nothing = search_exact_with(&index(), &Query::default(), Engine::Auto).unwrap();
    assert_eq!(nothing, Answer::default());
    let query = Query::exact(&[1], u64::MAX);
    let nothing = search_adaptive_with(&index_of(&[]), &query, Engine::Auto).unwrap();
    assert_eq!(nothing, Answer::default());
}

/// `(lists, postings, candidates)` of the list engines.
#[track_caller]
fn check(answers: [Answer; 2], n_hits: usize, expected: [(usize, usize, usize); 2]) {
    for (answer, expected) in answers.into_iter().zip(expected) {
        assert_eq!(answer.hits.len(), n_hits);
        let plan = answer.plan.unwrap();
        let counts = (plan.n_lists, plan.n_postings, plan.n_candidates);
        assert_eq!(counts, expected, "{:?}", plan.engine);
    }
}

#[test]
fn plans_count_lists_and_postings() {
    let index = index();
    // 1: 1 + 4 + 4 segments, 2: 4 + 3, 3: 4 + 4, 5: one.
    let query = Query::exact(&[1, 5, 3], u64::MAX);
    let answers = LIST_ENGINES.map(|engine| search_exact_with(&index, &query, engine).unwrap());
    check(answers, 1, [(3, 9 + 1 + 8, 18), (1, 1, 1)]);
    // The last list is not read when nothing is left to join with.
    let query = Query::exact(&[5, 1, 2], u64::MAX);
    let answers = LIST_ENGINES.map(|engine| search_exact_with(&index, &query, engine).unwrap());
    check(answers, 0, [(2, 1 + 9, 10), (1, 1, 1)]);
    // 2 and 3 against 1 and 5, in bit 1: 7 + 8 segments in 4 + 4 runs, one of them of a single 3, and 9 + 1 in
    // 1 + 4 + 5 runs, of which 5 is one.
    let query = Query::fuzzy(&[2, 1], 0b10);
    let answers = LIST_ENGINES.map(|engine| search_adaptive_with(&index, &query, engine).unwrap());
    let n_runs = (4 + 4) + (1 + 4 + 4);
    check(answers, 6, [(4, 15 + 10, n_runs), (2, 10, 10)]);
}

#[test]
fn a_scan_reads_every_segment_at_least_once() {
    let index = index();
    let query = MismatchQuery::new(Query::exact(&[1, 5, 3], u64::MAX), 1).unwrap();
    let plan = search_mismatch_with(&index, &query, Engine::Scan)
        .unwrap()
        .plan
        .unwrap();
    assert_eq!((plan.n_lists, plan.n_postings), (0, 0));
    assert!(plan.n_segments >= index.n_segments());
    assert_eq!(plan.pivots.len(), 2);
}
