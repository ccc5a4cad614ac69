//! Bundles of seeded motion strings, against a search of every pair of substrings; frames, graph.
#![allow(missing_docs)]

mod naive;

use std::hint::black_box;

use benches::strings::spelt;
use bundles::{
    Closure, ExtractOptions, MappingOptions, SeedInstance, extract, link, map_frames, max_letters,
};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};

/// Frames and letters; the last as large as the paper's largest example.
const SIZES: [(usize, usize); 3] = [(1_825, 60), (3_650, 125), (7_300, 250)];
/// Frames and letters the baseline bears.
const SMALL: (usize, usize) = (600, 30);
const MAX_FRAMES: f64 = 200.0;

fn extraction(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("bundle_extract");
    group.sample_size(10);
    for (n_frames, n_letters) in SIZES.into_iter().chain([SMALL]) {
        let spelt = spelt(n_frames, n_letters, 1);
        let options = ExtractOptions::new(max_letters(&spelt.string, MAX_FRAMES));
        group.throughput(Throughput::Elements(n_frames as u64));
        for closure in [Closure::Transitive, Closure::Direct] {
            let options = ExtractOptions { closure, ..options };
            let id = BenchmarkId::new(format!("{closure:?}"), n_frames);
            group.bench_function(id, |bencher| {
                bencher.iter(|| extract(black_box(&spelt.string), &spelt.access, &options));
            });
        }
    }
    let spelt = spelt(SMALL.0, SMALL.1, 1);
    let options = ExtractOptions {
        closure: Closure::Direct,
        seed: SeedInstance::First,
        ..ExtractOptions::new(max_letters(&spelt.string, MAX_FRAMES))
    };
    let found = extract(&spelt.string, &spelt.access, &options).expect("valid options");
    let members: Vec<_> = found
        .bundles
        .iter()
        .map(|bundle| bundle.members.clone())
        .collect();
    assert_eq!(
        naive::bundles(&spelt.string, &spelt.access, &options),
        members
    );
    group.bench_function(BenchmarkId::new("naive", SMALL.0), |bencher| {
        bencher.iter(|| naive::bundles(black_box(&spelt.string), &spelt.access, &options));
    });
    group.finish();
}

fn graph(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("bundle_graph");
    group.sample_size(10);
    for (n_frames, n_letters) in SIZES {
        let spelt = spelt(n_frames, n_letters, 1);
        let options = ExtractOptions::new(max_letters(&spelt.string, MAX_FRAMES));
        let found = extract(&spelt.string, &spelt.access, &options).expect("valid options");
        let (string, poses) = (&spelt.string, spelt.poses.view());
        let choose = || map_frames(string, &found, poses, &MappingOptions::default());
        let mapping = choose().expect("a pose for each frame");
        group.throughput(Throughput::Elements(n_frames as u64));
        group.bench_function(BenchmarkId::new("frames", n_frames), |bencher| {
            bencher.iter(choose);
        });
        group.bench_function(BenchmarkId::new("link", n_frames), |bencher| {
            bencher.iter(|| link(black_box(string), &found, &mapping));
        });
    }
    group.finish();
}

criterion_group!(benches, extraction, graph);
criterion_main!(benches);
