//! An adaptive query of five segments over libraries of three sizes: the two engines, the choice
//! between them, and a linear scan over frames as anybody would write it.
#![allow(missing_docs)]

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use segidx::{Engine, Query, search_adaptive_with};

const QUERY_SEGMENTS: usize = 5;

/// Places where the run-length sequence of the masked words contains the query's.
fn linear_scan(documents: &[Vec<u64>], query: &[u64], care: u64) -> Vec<(usize, usize)> {
    let mut hits = Vec::new();
    for (doc, words) in documents.iter().enumerate() {
        let mut runs: Vec<(u64, usize)> = Vec::new();
        for (frame, word) in words.iter().enumerate() {
            if runs.last().is_none_or(|&(last, _)| last != word & care) {
                runs.push((word & care, frame));
            }
        }
        for window in runs.windows(query.len()) {
            if window
                .iter()
                .zip(query)
                .all(|((word, _), wanted)| word == wanted)
            {
                hits.push((doc, window[0].1));
            }
        }
    }
    hits
}

/// Frames of `words` that make the first `n` masked runs, and these runs' words.
fn first_runs(words: &[u64], care: u64, n: usize) -> (usize, Vec<u64>) {
    let mut runs: Vec<u64> = Vec::new();
    for (frame, word) in words.iter().enumerate() {
        if runs.last() != Some(&(word & care)) {
            if runs.len() == n {
                return (frame, runs);
            }
            runs.push(word & care);
        }
    }
    (words.len(), runs)
}

fn search(c: &mut Criterion) {
    let set = benches::features();
    let care = ["F18", "F21", "F2", "F6"]
        .iter()
        .filter_map(|f| set.select(f))
        .fold(0, |a, b| a | b);
    let mut group = c.benchmark_group("adaptive, 5 segments");
    for n_clips in [120, 480, 1920] {
        let documents = benches::documents(n_clips);
        let index = benches::index(&documents);
        let (example, runs, n_frames) = documents
            .iter()
            .map(|words| {
                let (n_frames, runs) = first_runs(words, care, QUERY_SEGMENTS);
                (words, runs, n_frames)
            })
            .find(|(_, runs, _)| runs.len() == QUERY_SEGMENTS)
            .expect("some clip has five segments");
        let query = Query::fuzzy(&example[..n_frames], care);
        let hits = search_adaptive_with(&index, &query, Engine::Auto);
        let n_hits = hits.expect("an intact shard").hits.len();
        assert_eq!(n_hits, linear_scan(&documents, &runs, care).len());
        group.throughput(Throughput::Elements(index.n_segments() as u64));
        for engine in [Engine::Auto, Engine::Lists, Engine::Scan] {
            let id = BenchmarkId::new(format!("{engine:?}"), n_clips);
            group.bench_function(id, |b| {
                b.iter(|| search_adaptive_with(black_box(&index), black_box(&query), engine));
            });
        }
        group.bench_function(BenchmarkId::new("naive linear scan", n_clips), |b| {
            b.iter(|| linear_scan(black_box(&documents), black_box(&runs), care));
        });
    }
    group.finish();
}

criterion_group!(benches, search);
criterion_main!(benches);
