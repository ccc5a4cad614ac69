//! Indexes under some of the bits beside the index under all of them.

use std::ops::Range;

use proptest::collection::vec;
use proptest::prelude::*;
use segidx::{Hit, Index, IndexBuilder, Query, RestrictionError, Shard, search_adaptive};

/// Words of four bits, so that restrictions merge segments and words often.
fn documents() -> impl Strategy<Value = Vec<Vec<u64>>> {
    vec(vec(0..16u64, 0..40), 0..6)
}

fn builder_of(documents: &[Vec<u64>]) -> IndexBuilder {
    let mut builder = IndexBuilder::new();
    for (i, words) in documents.iter().enumerate() {
        builder.push(format!("clip {i}"), [7], words).unwrap();
    }
    builder
}

/// By definition: the index of the masked words, without names and metadata.
fn textbook(documents: &[Vec<u64>], bits: u64) -> Index {
    let mut builder = IndexBuilder::new();
    for words in documents {
        let words: Vec<u64> = words.iter().map(|word| word & bits).collect();
        builder.push("", [], &words).unwrap();
    }
    builder.build()
}

/// What two indexes of the same frames have in common.
fn plain(hits: Vec<Hit>) -> Vec<(u64, usize, Vec<Range<usize>>)> {
    let plain = |hit: Hit| (hit.cost, hit.doc.index(), hit.segments);
    hits.into_iter().map(plain).collect()
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 1_000,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn a_restriction_is_the_index_of_the_masked_words(
        documents in documents(),
        bits in prop_oneof![0..16u64, any::<u64>()],
    ) {
        let builder = builder_of(&documents);
        let restricted = builder.build_restricted(bits);
        prop_assert_eq!(&restricted, &textbook(&documents, bits));
        prop_assert_eq!(builder.build().verify_restriction(&restricted, bits), Ok(()));
    }

    #[test]
    fn adaptive_queries_within_the_bits_find_the_same_in_both(
        documents in documents(),
        bits in 0..16u64,
        care in 0..16u64,
        example in vec(0..16u64, 0..8),
    ) {
        let builder = builder_of(&documents);
        let query = Query::fuzzy(&example, care & bits);
        let whole = search_adaptive(&builder.build(), &query).unwrap();
        let part = search_adaptive(&builder.build_restricted(bits), &query).unwrap();
        prop_assert_eq!(plain(whole), plain(part));
    }

    /// Whatever differs, from one frame to one document, is found.
    #[test]
    fn only_the_restriction_passes_for_it(
        documents in documents(),
        others in documents(),
        bits in 0..16u64,
    ) {
        let other = textbook(&others, bits);
        let is_it = textbook(&documents, bits) == other;
        let verified = builder_of(&documents).build().verify_restriction(&other, bits);
        prop_assert_eq!(verified.is_ok(), is_it);
    }
}

#[test]
fn what_differs_is_named() {
    let documents = [vec![1, 2, 3], vec![], vec![1, 1, 2]];
    let whole = builder_of(&documents).build();
    let check = |others: &[Vec<u64>], expected: &str| {
        let error = whole.verify_restriction(&textbook(others, 0b10), 0b10);
        assert_eq!(error.unwrap_err().to_string(), expected);
    };
    check(
        &documents[..2],
        "expected 3 documents as in the whole index, found 2",
    );
    check(
        &[vec![1, 2, 3], vec![], vec![1, 2, 2]],
        "document 2: expected the segments of the whole index under 0x2, found others",
    );
}

#[test]
fn damage_is_told_from_disagreement() {
    let builder = builder_of(&[vec![1, 2, 3]]);
    let mut bytes = builder.build_restricted(1).as_bytes().to_vec();
    // The body is a page, and the last bytes belong to no section.
    *bytes.last_mut().unwrap() ^= 1;
    let damaged = Shard::open(bytes).unwrap();
    let verified = builder.build().verify_restriction(&damaged, 1);
    assert!(
        matches!(verified, Err(RestrictionError::Damaged(_))),
        "{verified:?}"
    );
}
