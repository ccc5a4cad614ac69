//! Reading AMC and BVH text, against splitting at white space and `str::parse`.
#![allow(missing_docs)]

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use mocap_io::{Motion, parse_amc, parse_bvh, write_amc, write_bvh};

/// All words that are numbers, and nothing else of what a reader has to do.
fn numbers(text: &[u8]) -> Vec<f64> {
    let text = std::str::from_utf8(text).expect("ASCII");
    text.split_ascii_whitespace()
        .filter_map(|word| word.parse().ok())
        .collect()
}

/// Values as exporters print them: six decimals. The motion itself has all digits of a double.
const DECIMALS: f64 = 1e6;

fn rounded(mut motion: Motion) -> Motion {
    motion
        .channels
        .mapv_inplace(|v| (v * DECIMALS).round() / DECIMALS);
    motion
}

fn parse(c: &mut Criterion) {
    let exact = benches::take().motion;
    let exact_bvh = exact.to_parent_offsets();
    let (short, short_bvh) = (rounded(exact.clone()), rounded(exact_bvh.clone()));
    let mut group = c.benchmark_group("parse");
    let asf = benches::skeleton_of(&exact);
    for (name, as_amc, as_bvh) in [
        ("six decimals", short, short_bvh),
        ("all digits", exact, exact_bvh),
    ] {
        let mut amc = Vec::new();
        write_amc(&as_amc, &mut amc).expect("a vector takes everything");
        group.throughput(Throughput::Bytes(amc.len() as u64));
        group.bench_function(format!("amc, {name}"), |b| {
            b.iter(|| parse_amc(black_box(&amc), &asf))
        });
        group.bench_function(format!("amc, {name}, naive numbers only"), |b| {
            b.iter(|| numbers(black_box(&amc)))
        });
        let mut bvh = Vec::new();
        write_bvh(&as_bvh, &mut bvh).expect("a vector takes everything");
        group.throughput(Throughput::Bytes(bvh.len() as u64));
        group.bench_function(format!("bvh, {name}"), |b| {
            b.iter(|| parse_bvh(black_box(&bvh)))
        });
        group.bench_function(format!("bvh, {name}, naive numbers only"), |b| {
            b.iter(|| numbers(black_box(&bvh)))
        });
    }
    group.finish();
}

criterion_group!(benches, parse);
criterion_main!(benches);
