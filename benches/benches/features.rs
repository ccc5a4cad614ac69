//! All features of a take, against one pass per feature.
#![allow(missing_docs)]

use std::hint::black_box;

use benches::RATE;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use mocap_io::forward_kinematics;
use relfeat::{BodyMap, FeatureSet, extract, measure};

fn features(c: &mut Criterion) {
    let motion = benches::take().motion;
    let set = benches::features();
    let names: Vec<&str> = motion.skeleton.names().collect();
    let map = BodyMap::recognise(&names).expect("an Acclaim skeleton");
    let positions = forward_kinematics(&motion);
    let rate = motion.rate.hz();
    let mut group = c.benchmark_group("features");
    group.throughput(Throughput::Elements(positions.dim().0 as u64));
    group.bench_function("extract", |b| {
        b.iter(|| extract(&set, black_box(positions.view()), &map, rate, RATE));
    });
    group.bench_function("naive, one feature at a time", |b| {
        b.iter(|| one_at_a_time(&set, black_box(&positions), &map, rate));
    });
    group.finish();
}

/// Each feature alone, from the positions on; how many frames it is on at least.
fn one_at_a_time(
    set: &FeatureSet,
    positions: &ndarray::Array3<f32>,
    map: &BodyMap,
    rate: f64,
) -> usize {
    (0..set.features().len())
        .filter_map(|feature| measure(set, feature, positions.view(), map, rate))
        .map(|m| m.values.iter().filter(|&&v| m.enter.holds(v)).count())
        .sum()
}

criterion_group!(benches, features);
criterion_main!(benches);
