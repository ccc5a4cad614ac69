//! Stretches around keyframes over libraries of three sizes: by the index of all features and by that of one part, and
//! by looking at every frame.
#![allow(missing_docs)]

use std::hint::black_box;
use std::ops::Range;

use cli::keyframes::groups;
use cli::wire::keyframe_query;
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use mtemplate::{AutomaticConfig, MotionTemplate, Preselection, choose_keyframes};
use segidx::{Index, IndexBuilder, KeyframeQuery, search_keyframes};

/// Frames of the excerpt that keyframes are chosen from.
const EXCERPT: usize = 60;

/// Stretches of each document by an index.
fn by_index(
    index: &Index,
    query: &KeyframeQuery,
    (preselection, documents): (&Preselection, &[Vec<u64>]),
) -> Vec<Vec<Range<usize>>> {
    let mut stretches = vec![Vec::new(); documents.len()];
    let hits = search_keyframes(index, query)
        .expect("an intact shard")
        .hits;
    for hit in hits {
        let doc = hit.doc.index();
        let n_frames = documents[doc].len();
        stretches[doc].push(preselection.stretch(hit.first.start, hit.last.end - 1, n_frames));
    }
    stretches.iter_mut().for_each(Preselection::merge);
    stretches
}

fn by_frames(preselection: &Preselection, documents: &[Vec<u64>]) -> Vec<Vec<Range<usize>>> {
    let documents = documents.iter();
    documents
        .map(|words| preselection.stretches(words))
        .collect()
}

/// Two keyframes of the first excerpt that has them in one part of the feature set, and the part.
fn keyframes(documents: &[Vec<u64>], n_features: usize, groups: &[u64]) -> (Preselection, u64) {
    let config = AutomaticConfig::interactive();
    let excerpts = documents
        .iter()
        .flat_map(|words| words.chunks_exact(EXCERPT));
    let chosen = excerpts.filter_map(|words| {
        let template = MotionTemplate::from_words(words, n_features).ok()?;
        groups.iter().find_map(|&group| {
            let keyframes = choose_keyframes(&template, &[group], &config).ok()?;
            let preselection = Preselection::new(&keyframes, EXCERPT).ok()?;
            (keyframes.len() == 2).then_some((preselection, group))
        })
    });
    chosen
        .into_iter()
        .next()
        .expect("some excerpt has two keyframes")
}

fn search(c: &mut Criterion) {
    let set = benches::features();
    let groups = groups(&set);
    let mut group = c.benchmark_group("two keyframes");
    for n_clips in [120, 480, 1920] {
        let documents = benches::documents(n_clips);
        let (preselection, part) = keyframes(&documents, set.features().len(), &groups);
        let query = keyframe_query(&preselection);
        let mut builder = IndexBuilder::new();
        for words in &documents {
            builder.push("", [], words).expect("few documents");
        }
        let indexes = [
            ("all features", builder.build()),
            ("one part", builder.build_restricted(part)),
        ];
        let expected = by_frames(&preselection, &documents);
        let n_frames: usize = documents.iter().map(Vec::len).sum();
        group.throughput(Throughput::Elements(n_frames as u64));
        let asked = (&preselection, documents.as_slice());
        for (name, index) in &indexes {
            assert_eq!(by_index(index, &query, asked), expected);
            group.bench_function(BenchmarkId::new(*name, n_clips), |b| {
                b.iter(|| by_index(black_box(index), black_box(&query), asked));
            });
        }
        group.bench_function(BenchmarkId::new("every frame", n_clips), |b| {
            b.iter(|| by_frames(black_box(&preselection), black_box(&documents)));
        });
    }
    group.finish();
}

criterion_group!(benches, search);
criterion_main!(benches);
