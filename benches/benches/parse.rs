//! Reading AMC and BVH text, against splitting at white space and `str::parse`.
#![allow(missing_docs)]

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use mocap_io::{parse_amc, parse_bvh, write_amc, write_bvh};

/// All words that are numbers, and nothing else of what a reader has to do.
fn numbers(text: &[u8]) -> Vec<f64> {
    let text = std::str::from_utf8(text).expect("ASCII");
    text.split_ascii_whitespace()
        .filter_map(|word| word.parse().ok())
        .collect()
}

fn parse(c: &mut Criterion) {
    let motion = benches::take().motion;
    let mut group = c.benchmark_group("parse");
    let asf = benches::skeleton_of(&motion);
    let mut amc = Vec::new();
    write_amc(&motion, &mut amc).expect("a vector takes everything");
    group.throughput(Throughput::Bytes(amc.len() as u64));
    group.bench_function("amc", |b| b.iter(|| parse_amc(black_box(&amc), &asf)));
    group.bench_function("amc, naive numbers only", |b| {
        b.iter(|| numbers(black_box(&amc)))
    });
    let mut bvh = Vec::new();
    write_bvh(&motion.to_parent_offsets(), &mut bvh).expect("a vector takes everything");
    group.throughput(Throughput::Bytes(bvh.len() as u64));
    group.bench_function("bvh", |b| b.iter(|| parse_bvh(black_box(&bvh))));
    group.bench_function("bvh, naive numbers only", |b| {
        b.iter(|| numbers(black_box(&bvh)))
    });
    group.finish();
}

criterion_group!(benches, parse);
criterion_main!(benches);
