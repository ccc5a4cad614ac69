//! Learning a class's template from motions as long and as alike as 26 squats of HDM05 (K about 45,
//! 39 features), on one thread, against the definition.
#![allow(missing_docs)]

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use mtemplate::{LearnConfig, MotionTemplate, Unwarp, learn};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

const N_FEATURES: usize = 39;
const N_POSES: usize = 15;
const SIZES: [usize; 3] = [6, 13, 26];

/// Motions through the same poses, each held for one to five frames, with one bit in fifty wrong.
fn class(n_motions: usize, seed: u64) -> Vec<MotionTemplate> {
    let mut dice = ChaCha8Rng::seed_from_u64(seed);
    let mask = (1 << N_FEATURES) - 1;
    let poses: Vec<u64> = (0..N_POSES)
        .scan(dice.next_u64(), |pose, _| {
            // A few features change from pose to pose.
            *pose ^= dice.next_u64() & dice.next_u64() & dice.next_u64();
            Some(*pose & mask)
        })
        .collect();
    let mut motion = || {
        let mut words = Vec::new();
        for pose in &poses {
            for _ in 0..1 + dice.next_u32() % 5 {
                let noise = (0..N_FEATURES).map(|bit| u64::from(dice.next_u32() % 50 == 0) << bit);
                words.push(pose ^ noise.sum::<u64>());
            }
        }
        MotionTemplate::from_words(&words, N_FEATURES).expect("39 features")
    };
    (0..n_motions).map(|_| motion()).collect()
}

/// One iteration by the definition, up to the averages' sums: an alignment for each reference and
/// each other motion.
fn textbook(motions: &[MotionTemplate]) -> f64 {
    let mut worst: f64 = 0.0;
    for reference in motions {
        for other in motions {
            worst = worst.max(distance(reference, other));
        }
    }
    worst
}

fn distance(reference: &MotionTemplate, other: &MotionTemplate) -> f64 {
    let (rows, columns) = (reference.n_columns(), other.n_columns());
    let mut reached = vec![vec![f64::INFINITY; columns + 1]; rows + 1];
    reached[0][0] = 0.0;
    for i in 0..rows {
        for j in 0..columns {
            let both = reference
                .values()
                .row(i)
                .into_iter()
                .zip(other.values().row(j))
                .map(|(a, b)| (a - b).abs())
                .sum::<f64>();
            let weight = (reference.weights()[i] + other.weights()[j]) / 2.0;
            let before = reached[i][j].min(reached[i + 1][j]).min(reached[i][j + 1]);
            reached[i + 1][j + 1] = both / N_FEATURES as f64 * weight + before;
        }
    }
    reached[rows][columns]
}

fn learning(criterion: &mut Criterion) {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .expect("a thread");
    let mut group = criterion.benchmark_group("templates_learn");
    group.sample_size(20);
    for n_motions in SIZES {
        let motions = class(n_motions, 6);
        for unwarp in [Unwarp::Exact, Unwarp::Balance] {
            let config = LearnConfig {
                unwarp,
                ..LearnConfig::default()
            };
            let id = BenchmarkId::new(format!("{unwarp:?}"), n_motions);
            group.bench_function(id, |bencher| {
                bencher.iter(|| pool.install(|| learn(black_box(&motions), &config)));
            });
        }
        let id = BenchmarkId::new("textbook alignments of one iteration", n_motions);
        group.bench_function(id, |bencher| bencher.iter(|| textbook(black_box(&motions))));
    }
    group.finish();
}

criterion_group!(benches, learning);
criterion_main!(benches);
