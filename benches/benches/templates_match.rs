//! Distance curves, endings and streams of matches, against the textbook's table.
#![allow(missing_docs)]

use std::hint::black_box;

use criterion::measurement::WallTime;
use criterion::{
    BenchmarkGroup, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main,
};
use mtemplate::{MatchConfig, MatchStream, MotionTemplate, QuantizedTemplate, StreamMatcher};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

const FEATURES: usize = 39;
const COLUMNS: usize = 100;
const LENGTHS: [usize; 3] = [1_000, 5_000, 25_000];
const TAU: f64 = 0.06;
/// Templates that run over one stream, and words of that stream: 100 s at 30 Hz.
const TEMPLATES: usize = 64;
const STREAM: usize = 3_000;

/// Words in which a feature is another one in the next frame with a probability of 0.04.
fn flipping(n: usize, seed: u64) -> Vec<u64> {
    let mut dice = ChaCha8Rng::seed_from_u64(seed);
    let mut word = dice.next_u64() >> (64 - FEATURES);
    let mut next = || {
        for feature in 0..FEATURES {
            word ^= u64::from(dice.next_u32().is_multiple_of(25)) << feature;
        }
        word
    };
    (0..n).map(|_| next()).collect()
}

/// Words of the built-in corpus, which stay for some frames.
fn moving(n: usize) -> Vec<u64> {
    let words = benches::documents(40).concat();
    words.iter().copied().cycle().take(n).collect()
}

fn template(words: &[u64]) -> QuantizedTemplate {
    let template = MotionTemplate::from_words(words, FEATURES).and_then(|t| t.quantize(0.1));
    template.expect("words of as many features")
}

/// D(k,l) in a whole table of real numbers; infinite where no path leads.
fn textbook(template: &QuantizedTemplate, words: &[u64]) -> Vec<f64> {
    let n_columns = template.n_columns();
    let mut table = vec![vec![f64::INFINITY; words.len()]; n_columns];
    for k in 0..n_columns {
        for (l, &word) in words.iter().enumerate() {
            let cost = template.local_cost(k, word).unwrap_or(f64::INFINITY);
            let from = |columns: usize, frames: usize| {
                let before = k.checked_sub(columns).zip(l.checked_sub(frames));
                before.map_or(f64::INFINITY, |(k, l)| table[k][l])
            };
            let best = (from(1, 1) + cost).min(from(1, 2) + cost);
            let best = best.min(from(2, 1) + 2.0 * cost);
            table[k][l] = if k == 0 { cost } else { best };
        }
    }
    table.pop().unwrap_or_default()
}

fn curves(group: &mut BenchmarkGroup<'_, WallTime>, template: &QuantizedTemplate, all: &[u64]) {
    /// Of rounded weights, see `mtemplate::COST_ERROR`.
    const ROUNDING: f64 = mtemplate::COST_ERROR * COLUMNS as f64;
    for n in LENGTHS {
        let words = &all[..n];
        let curve = template.distance_curve(words);
        for (found, expected) in curve.costs().zip(textbook(template, words)) {
            assert_eq!(found.is_some(), expected.is_finite());
            assert!(found.is_none_or(|found| (found - expected).abs() <= ROUNDING));
        }
        group.throughput(Throughput::Elements((COLUMNS * n) as u64));
        group.bench_function(BenchmarkId::new("curve", n), |bench| {
            bench.iter(|| template.distance_curve(black_box(words)));
        });
        group.bench_function(BenchmarkId::new("endings", n), |bench| {
            bench.iter(|| template.endings(black_box(words)));
        });
        group.bench_function(BenchmarkId::new("matches", n), |bench| {
            let config = MatchConfig::up_to(TAU);
            bench.iter(|| template.find_matches(black_box(words), &config));
        });
        group.bench_function(BenchmarkId::new("word by word", n), |bench| {
            bench.iter(|| {
                let mut matcher = StreamMatcher::new(template);
                let endings = black_box(words).iter().map(|word| matcher.push(*word));
                endings.flatten().count()
            });
        });
        group.bench_function(BenchmarkId::new("naive", n), |bench| {
            bench.iter(|| textbook(template, black_box(words)));
        });
    }
}

fn of_flipping_words(c: &mut Criterion) {
    let mut group = c.benchmark_group("templates/flipping");
    group.sample_size(20);
    let words = flipping(LENGTHS[2], 2);
    curves(&mut group, &template(&flipping(COLUMNS, 1)), &words);
}

fn of_moving_words(c: &mut Criterion) {
    let mut group = c.benchmark_group("templates/moving");
    group.sample_size(20);
    let words = moving(LENGTHS[2] + COLUMNS);
    let (first, words) = words.split_at(COLUMNS);
    curves(&mut group, &template(first), words);
}

/// All templates over one stream; elements are words, 30 of which are a second.
fn many_streams(c: &mut Criterion) {
    let mut group = c.benchmark_group("templates/many");
    group.sample_size(10);
    group.throughput(Throughput::Elements(STREAM as u64));
    let words = moving(STREAM + TEMPLATES * COLUMNS);
    let (poses, words) = words.split_at(TEMPLATES * COLUMNS);
    let templates: Vec<QuantizedTemplate> = poses.chunks_exact(COLUMNS).map(template).collect();
    group.bench_function(BenchmarkId::new("streams", TEMPLATES), |bench| {
        bench.iter(|| {
            let streams = templates
                .iter()
                .map(|template| MatchStream::new(template, TAU));
            let mut streams: Vec<MatchStream> = streams.collect();
            let mut n_matches = 0;
            for word in words {
                for stream in &mut streams {
                    n_matches += stream.push(black_box(*word)).len();
                }
            }
            let rest = streams.into_iter().map(|stream| stream.finish().len());
            n_matches + rest.sum::<usize>()
        });
    });
}

criterion_group!(benches, of_flipping_words, of_moving_words, many_streams);
criterion_main!(benches);
