//! Bytes as documents and a query over words of three bits; every engine against the textbook twin of the tests.
//!
//! A byte below 0x80 is a frame with the word of its low three bits. 0xff ends a document. 0x80 begins the query:
//! the next byte is the care mask, the frames after it are the example.

#![no_main]

#[path = "../../tests/it/naive.rs"]
mod naive;

use libfuzzer_sys::fuzz_target;
use naive::{NaiveHit, Set};
use segidx::{Engine, Hit, Index, IndexBuilder, Query, search_adaptive_with, search_exact_with};

const BITS: u32 = 3;

/// The twins take cubic time and more.
const MAX_BYTES: usize = 64;

fuzz_target!(|bytes: &[u8]| {
    let bytes = &bytes[..bytes.len().min(MAX_BYTES)];
    let (clips, query) = match bytes.iter().position(|&byte| byte == 0x80) {
        Some(at) => (&bytes[..at], &bytes[at + 1..]),
        None => (bytes, &[][..]),
    };
    let words =
        |bytes: &[u8]| -> Vec<u64> { bytes.iter().map(|byte| u64::from(byte & 7)).collect() };
    let documents: Vec<Vec<u64>> = clips.split(|&byte| byte == 0xff).map(words).collect();
    let (care, example) = match query.split_first() {
        Some((&care, example)) => (u64::from(care & 7), words(&example[..example.len().min(8)])),
        None => (7, Vec::new()),
    };

    let index = index_of(&documents);
    assert_eq!(index.verify(), Ok(()));
    let sets: Vec<(Set, usize)> = naive::segments(&example)
        .iter()
        .map(|&(word, first, last)| (naive::set_of_mask(care, word, BITS), last + 1 - first))
        .collect();
    let exact = naive::search(&documents, &sets, naive::exact);
    let conjoined = naive::conjoin(sets, |n| n / 2);
    let adaptive = naive::search(&documents, &conjoined, naive::adaptive);
    for engine in [Engine::Auto, Engine::Lists, Engine::Pivot, Engine::Scan] {
        let hits = search_exact_with(&index, &Query::exact(&example, care), engine);
        assert_eq!(plain(&hits.expect("an intact shard").hits), exact);
        let hits = search_adaptive_with(&index, &Query::fuzzy(&example, care), engine);
        assert_eq!(plain(&hits.expect("an intact shard").hits), adaptive);
    }
});

fn index_of(documents: &[Vec<u64>]) -> Index {
    let mut builder = IndexBuilder::new();
    for words in documents {
        builder
            .push("", [], words)
            .expect("a few bytes are within the limits");
    }
    builder.build()
}

fn plain(hits: &[Hit]) -> Vec<NaiveHit> {
    hits.iter()
        .map(|hit| {
            let ranges = hit.segments.iter().map(|range| (range.start, range.end));
            (hit.cost, hit.doc.index(), ranges.collect())
        })
        .collect()
}
