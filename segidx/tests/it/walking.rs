//! The walking motion of the 2005 paper, sections 4 and 5. Vectors are printed there as F_r over F_l; here F_r is
//! bit 1 and F_l bit 0. Segment numbers are the paper's, from 1.

use segidx::{FuzzySet, Hit, Index, IndexBuilder, Query, segment};

/// Eq. 3.
const FEATURE_SEQUENCE: [u64; 10] = [0b11, 0b01, 0b11, 0b10, 0b11, 0b01, 0b11, 0b10, 0b11, 0b01];

/// The paper gives no frame counts; these differ between neighbours.
const LENGTHS: [usize; 10] = [4, 9, 2, 8, 3, 7, 2, 9, 4, 6];

fn search_exact(index: &Index, query: &Query) -> Vec<Hit> {
    segidx::search_exact(index, query).unwrap()
}

fn search_adaptive(index: &Index, query: &Query) -> Vec<Hit> {
    segidx::search_adaptive(index, query).unwrap()
}

fn walk() -> Vec<u64> {
    let runs = FEATURE_SEQUENCE.iter().zip(LENGTHS);
    runs.flat_map(|(&word, len)| std::iter::repeat_n(word, len))
        .collect()
}

fn index() -> Index {
    let mut builder = IndexBuilder::new();
    builder.push("walk", [], &walk()).unwrap();
    builder.build()
}

fn fuzzy_query() -> Query {
    let foot_behind = FuzzySet::from_words([0b00, 0b01]);
    let foot_in_front = FuzzySet::from_words([0b10, 0b11]);
    Query::from_sets([
        (foot_behind.clone(), None),
        (foot_in_front, None),
        (foot_behind, None),
    ])
}

/// The first segments of the hits, increasing, from 1.
fn numbers(hits: &[Hit]) -> Vec<usize> {
    let mut numbers: Vec<usize> = hits.iter().map(|hit| hit.first_segment + 1).collect();
    numbers.sort_unstable();
    numbers
}

#[test]
fn the_feature_sequence_of_the_walk_is_eq_3() {
    let words: Vec<u64> = segment(&walk())
        .iter()
        .map(|segment| segment.word)
        .collect();
    assert_eq!(words, FEATURE_SEQUENCE);
}

#[test]
fn the_inverted_lists_are_those_of_section_5_1() {
    let index = index();
    let list = |word| -> Vec<u32> { index.list(word).unwrap().iter().map(|k| k + 1).collect() };
    assert_eq!(list(0b11), [1, 3, 5, 7, 9]);
    assert_eq!(list(0b01), [2, 6, 10]);
    assert_eq!(list(0b10), [4, 8]);
    assert_eq!(list(0b00), []);
}

#[test]
fn the_exact_hits_are_those_of_eq_8() {
    let query = Query::exact(&[0b10, 0b11, 0b01], u64::MAX);
    assert_eq!(numbers(&search_exact(&index(), &query)), [4, 8]);
}

#[test]
fn there_are_no_fuzzy_hits_without_adaptive_segmentation() {
    assert_eq!(search_exact(&index(), &fuzzy_query()), []);
}

#[test]
fn the_adaptive_hits_are_those_of_section_5_2() {
    let hits = search_adaptive(&index(), &fuzzy_query());
    assert_eq!(numbers(&hits), [2, 6]);
    // Segments 2 | 3-5 | 6. What the paper prints as k4 = 6 is its k3.
    let frames: Vec<usize> = LENGTHS
        .iter()
        .scan(0, |end, len| {
            *end += len;
            Some(*end)
        })
        .collect();
    let expected = [
        frames[0]..frames[1],
        frames[1]..frames[4],
        frames[4]..frames[5],
    ];
    assert_eq!(hits[0].segments, expected);
    // Segments 6 | 7-9 | 10.
    assert_eq!(hits[1].span(), frames[4]..frames[9]);
}

#[test]
fn the_adaptive_hits_are_the_exact_hits_of_the_first_component() {
    let mut builder = IndexBuilder::new();
    let right: Vec<u64> = walk().iter().map(|word| word >> 1).collect();
    builder.push("walk", [], &right).unwrap();
    let coarse = search_exact(&builder.build(), &Query::exact(&[0, 1, 0], u64::MAX));
    let spans = |hits: &[Hit]| -> Vec<_> { hits.iter().map(Hit::span).collect() };
    let mut coarse = spans(&coarse);
    coarse.sort_unstable_by_key(|span| span.start);
    assert_eq!(spans(&search_adaptive(&index(), &fuzzy_query())), coarse);
}
