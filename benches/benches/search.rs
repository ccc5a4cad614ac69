//! An adaptive query of five segments over libraries of three sizes: the engines, the choice
//! between them, and a linear scan over frames as anybody would write it. Before that, a table of
//! the engines over queries of every kind: medians of runs in turn.
#![allow(missing_docs)]

use std::hint::black_box;

use cpu_time::ThreadTime;
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use segidx::{
    Answer, Engine, Index, MismatchQuery, Query, search_adaptive_with, search_exact_with,
    search_mismatch_with,
};

const QUERY_SEGMENTS: usize = 5;
const ENGINES: [Engine; 4] = [Engine::Auto, Engine::Lists, Engine::Pivot, Engine::Scan];

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
        for engine in ENGINES {
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

/// What to look for, and how.
enum Kind {
    Exact,
    Adaptive,
    /// The most mismatches, in the segmentation by these bits.
    Mismatch(usize, u64),
}

impl Kind {
    fn search(&self, index: &Index, query: &Query, engine: Engine) -> Answer {
        let answer = match *self {
            Kind::Exact => search_exact_with(index, query, engine),
            Kind::Adaptive => search_adaptive_with(index, query, engine),
            Kind::Mismatch(max, care) => {
                let query = MismatchQuery::new(query.clone(), max).expect("more segments");
                search_mismatch_with(index, &query.restricted_to(care), engine)
            }
        };
        answer.expect("an intact shard")
    }
}

/// Medians in microseconds of this thread, in the order of [`ENGINES`], the engines running in turn.
fn medians(rounds: usize, search: impl Fn(Engine) -> Answer) -> [f64; 4] {
    let mut times = [(); 4].map(|()| Vec::with_capacity(rounds));
    for _ in 0..rounds {
        for (engine, times) in ENGINES.into_iter().zip(&mut times) {
            let start = ThreadTime::now();
            black_box(search(engine));
            times.push(start.elapsed().as_secs_f64() * 1e6);
        }
    }
    times.map(|mut times| {
        times.sort_by(f64::total_cmp);
        times[rounds / 2]
    })
}

/// Prints how long each engine takes for queries cut from the first clip that has enough segments.
fn engines(_: &mut Criterion) {
    let is_test = std::env::args().any(|arg| arg == "--test");
    let (n_clips, rounds) = if is_test { (120, 1) } else { (1920, 15) };
    let documents = benches::documents(n_clips);
    let set = benches::features();
    let bits = |names: &[&str]| {
        let bits = names.iter().filter_map(|name| set.select(name));
        bits.fold(0, |a, b| a | b)
    };
    let lower = (15..=26).map(|i| bits(&[&format!("F{i}")])).sum::<u64>();
    let (one, four) = (bits(&["F18"]), bits(&["F18", "F21", "F2", "F6"]));
    let legs = bits(&["F15", "F16", "F20", "F21"]);
    println!("query | hits | Lists, Pivot, Scan, Auto (us) | chosen | chosen / best");
    for (name, index_bits) in [("39 features", u64::MAX), ("lower set", lower)] {
        let restrict = |words: &Vec<u64>| words.iter().map(|word| word & index_bits).collect();
        let documents: Vec<Vec<u64>> = documents.iter().map(restrict).collect();
        let index = benches::index(&documents);
        println!(
            "{name}: {} segments, {} words",
            index.n_segments(),
            index.n_lists()
        );
        for (what, kind, care, n) in [
            ("exact", Kind::Exact, u64::MAX, 1),
            ("exact", Kind::Exact, u64::MAX, 5),
            ("adaptive, 1 feature", Kind::Adaptive, one, 1),
            ("adaptive, 1 feature", Kind::Adaptive, one, 3),
            ("adaptive, 4 features", Kind::Adaptive, four, 5),
            ("adaptive, 4 of the legs", Kind::Adaptive, legs, 5),
            ("adaptive, lower set", Kind::Adaptive, lower, 7),
            ("1 mismatch", Kind::Mismatch(1, u64::MAX), u64::MAX, 5),
            ("3 mismatches", Kind::Mismatch(3, u64::MAX), u64::MAX, 7),
            (
                "1 mismatch, 4 of the legs",
                Kind::Mismatch(1, legs),
                legs,
                5,
            ),
            (
                "2 mismatches, lower set",
                Kind::Mismatch(2, lower),
                lower,
                7,
            ),
        ] {
            let examples = documents.iter().map(|words| {
                let (n_frames, runs) = first_runs(words, care, n);
                (&words[..n_frames], runs.len())
            });
            let Some((example, _)) = examples.into_iter().find(|&(_, n_runs)| n_runs == n) else {
                continue;
            };
            let query = Query::fuzzy(example, care);
            let answer = kind.search(&index, &query, Engine::Auto);
            for engine in ENGINES {
                assert_eq!(kind.search(&index, &query, engine).hits, answer.hits);
            }
            let [auto, times @ ..] = medians(rounds, |engine| kind.search(&index, &query, engine));
            let chosen = answer.plan.map(|plan| plan.engine);
            let chosen = ENGINES.iter().position(|&engine| Some(engine) == chosen);
            let chosen = chosen.expect("a query with positions") - 1;
            let best = times.into_iter().fold(f64::INFINITY, f64::min);
            println!(
                "{what}, {n} segments | {} | {:.0}, {:.0}, {:.0}, {auto:.0} | {:?} | {:.2}",
                answer.hits.len(),
                times[0],
                times[1],
                times[2],
                ENGINES[chosen + 1],
                times[chosen] / best
            );
        }
    }
}

criterion_group!(benches, engines, search);
criterion_main!(benches);
