//! Keyframe search against its definition, frame by frame.

use std::ops::Range;

use proptest::collection::vec;
use proptest::prelude::*;
use segidx::{Index, IndexBuilder, KeyframeHit, KeyframeQuery, Mask, Shard, search_keyframes};

use crate::naive::{self, Run};

const BITS: u32 = 3;
const WORDS: u64 = 1 << BITS;

fn index_of(documents: &[Vec<u64>]) -> Index {
    let mut builder = IndexBuilder::new();
    for words in documents {
        builder.push("clip", [], words).unwrap();
    }
    builder.build()
}

/// Words that are rare, that come in runs, and that are all the same.
fn clip() -> impl Strategy<Value = Vec<u64>> {
    let runs = vec((0..WORDS, 1..6usize), 0..8).prop_map(|runs| {
        let runs = runs.into_iter();
        runs.flat_map(|(word, n)| vec![word; n]).collect()
    });
    prop_oneof![
        4 => runs,
        2 => vec(0..WORDS, 0..24),
        1 => vec(0..2u64, 0..24),
        1 => (0..WORDS, 0..9usize).prop_map(|(word, n)| vec![word; n]),
    ]
}

/// Ordinary gaps, gaps of none and of any length, and empty ones.
fn gap() -> impl Strategy<Value = (usize, usize)> {
    prop_oneof![
        6 => (0..5usize, 0..6usize).prop_map(|(least, more)| (least, least + more)),
        1 => (0..3usize).prop_map(|least| (least, usize::MAX)),
        1 => (2..5usize).prop_map(|least| (least, least - 1)),
    ]
}

fn asked() -> impl Strategy<Value = Vec<(u64, u64, (usize, usize))>> {
    vec((0..WORDS, 0..WORDS, gap()), 1..5)
}

fn query(asked: &[(u64, u64, (usize, usize))]) -> KeyframeQuery {
    let mut asked = asked.iter();
    let (care, value, _) = asked.next().unwrap();
    let first = KeyframeQuery::new(Mask::new(*care, *value));
    asked.fold(first, |query, (care, value, (least, most))| {
        query.then(*least..=*most, Mask::new(*care, *value))
    })
}

fn sets(asked: &[(u64, u64, (usize, usize))]) -> Vec<naive::Set> {
    let set = |(care, value, _): &(u64, u64, _)| naive::set_of_mask(*care, *value, BITS);
    asked.iter().map(set).collect()
}

/// Document, first and last frame of both ranges.
fn raw(hits: &[KeyframeHit]) -> Vec<(usize, Run, Run)> {
    let ends = |range: &Range<usize>| (range.start, range.end - 1);
    let raw = |hit: &KeyframeHit| (hit.doc.index(), ends(&hit.first), ends(&hit.last));
    hits.iter().map(raw).collect()
}

/// Many documents without any hit, so that a keyframe is rare and only the places around it are read.
fn diluted(documents: &[Vec<u64>], n: usize) -> Vec<Vec<u64>> {
    let filler = std::iter::repeat_n(vec![WORDS, WORDS + 1, WORDS, WORDS + 1, WORDS], n);
    documents.iter().cloned().chain(filler).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn hits_are_all_chains(
        documents in vec(clip(), 0..4),
        asked in asked(),
        n_more in prop_oneof![Just(0usize), Just(200)],
    ) {
        let gaps: Vec<(usize, usize)> = asked[1..].iter().map(|(_, _, gap)| *gap).collect();
        let mut expected = Vec::new();
        for (doc, words) in documents.iter().enumerate() {
            let chains = naive::chains(words, &sets(&asked), &gaps);
            let hits = naive::chain_hits(&chains).into_iter();
            expected.extend(hits.map(|(first, last)| (doc, first, last)));
        }
        // The words of the filler differ in a higher bit, which no mask looks at but this one.
        let asked: Vec<_> = asked.iter().map(|&(care, value, gap)| (care | WORDS, value, gap)).collect();
        let index = index_of(&diluted(&documents, n_more));
        let answer = search_keyframes(&index, &query(&asked)).unwrap();
        prop_assert_eq!(raw(&answer.hits), expected);
        prop_assert!(answer.n_segments <= index.n_segments());
    }

    #[test]
    fn greedy_hits_are_those_of_the_rule(
        documents in vec(clip(), 0..4),
        asked in asked(),
        max_frames in 0..30usize,
        n_more in prop_oneof![Just(0usize), Just(200)],
        segmented_by in vec(0..WORDS, 4),
    ) {
        let mut expected = Vec::new();
        // Segments go by the bits of their mask at least.
        let bits: Vec<u64> = asked.iter().zip(&segmented_by).map(|((care, ..), bits)| care | bits).collect();
        for (doc, words) in documents.iter().enumerate() {
            for (first, last) in naive::greedy_chains(words, &sets(&asked), &bits, max_frames) {
                expected.push((doc, (first, first), (last, last)));
            }
        }
        let asked: Vec<_> = asked.iter().map(|&(care, value, gap)| (care | WORDS, value, gap)).collect();
        let query = query(&asked).greedy(max_frames, segmented_by);
        let mut builder = IndexBuilder::new();
        for words in diluted(&documents, n_more) {
            builder.push("clip", [], &words).unwrap();
        }
        for index in [builder.build(), builder.build_restricted(query.care())] {
            prop_assert_eq!(raw(&search_keyframes(&index, &query).unwrap().hits), expected.clone());
        }
    }

    #[test]
    fn an_index_of_the_bits_looked_at_gives_the_same(
        documents in vec(clip(), 0..4),
        asked in asked(),
    ) {
        let query = query(&asked);
        let mut builder = IndexBuilder::new();
        for words in &documents {
            builder.push("clip", [], words).unwrap();
        }
        let restricted = builder.build_restricted(query.care());
        let hits = search_keyframes(&restricted, &query).unwrap().hits;
        prop_assert_eq!(hits, search_keyframes(&index_of(&documents), &query).unwrap().hits);
    }
}

#[test]
fn a_rare_keyframe_is_looked_for_by_its_lists() {
    let mut long: Vec<u64> = (0..4000).map(|frame| frame % 2).collect();
    long[2000] = 0b110;
    let index = index_of(&[long]);
    let query = KeyframeQuery::new(Mask::word(1)).then(1..=9, Mask::new(0b100, 0b100));
    let answer = search_keyframes(&index, &query).unwrap();
    assert_eq!((answer.pivot, answer.n_accepted), (Some(1), vec![2000, 1]));
    assert!(answer.n_segments < 20, "{}", answer.n_segments);
    // Every other frame from nine before it can be the first.
    let firsts: Vec<usize> = answer.hits.iter().map(|hit| hit.first.start).collect();
    assert_eq!(firsts, [1991, 1993, 1995, 1997, 1999]);
    assert!(answer.hits.iter().all(|hit| hit.last == (2000..2001)));
}

#[test]
fn damage_is_an_error() {
    let mut bytes = index_of(&[vec![1, 1, 2, 3]]).as_bytes().to_vec();
    let last = bytes.len() - 40;
    bytes[last] ^= 1;
    let shard = Shard::open(bytes).unwrap();
    let query = KeyframeQuery::new(Mask::word(1)).then(1..=2, Mask::word(2));
    assert!(search_keyframes(&shard, &query).is_err());
}
