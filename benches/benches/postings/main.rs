//! Where the segments that a query starts from could come from: lists, bitmaps of features, scans.
//!
//! Each group asserts that all forms find the same segments. Outside of test mode the bytes of the
//! forms are printed first. The universes are the corpus with one or two features of each document
//! turned over, which makes about as many distinct words as real clips have.
#![allow(missing_docs)]

use std::hint::black_box;
use std::time::Duration;

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, BenchmarkId, Criterion, criterion_group, criterion_main};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use segidx::{Engine, Index, Query, search_adaptive_with, search_exact};

mod bitmaps;
mod lists;
mod places;
mod segments;

use bitmaps::Bitmaps;
use lists::{PackedLists, RawLists};
use segments::{PackedNumbers, Position, Segments};

const FEATURES: usize = 39;
const POSITIONS: usize = 5;
/// About 22,000 segments.
const CLIPS: usize = 480;
/// Times the clips for about 1,000,000 segments.
const COPIES: usize = 46;

struct Universe {
    documents: Vec<Vec<u64>>,
    segments: Segments,
    index: Index,
    numbers: PackedNumbers,
    raw: RawLists,
    packed: PackedLists,
    bitmaps: Bitmaps,
}

impl Universe {
    /// Copies of the clips, each document with some of its features turned over.
    fn of(clips: &[Vec<u64>], n_copies: usize, n_turned: usize) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let mut documents = Vec::new();
        for clip in std::iter::repeat_n(clips, n_copies).flatten() {
            let turned = (0..n_turned).fold(0, |turned, _| {
                turned ^ 1_u64 << (random.next_u64() % FEATURES as u64)
            });
            documents.push(clip.iter().map(|word| word ^ turned).collect());
        }
        let segments = Segments::of(&documents);
        let raw = RawLists::of(&segments);
        Self {
            index: benches::index(&documents),
            numbers: PackedNumbers::of(&segments),
            packed: PackedLists::of(&raw),
            bitmaps: Bitmaps::of(&segments, FEATURES),
            documents,
            segments,
            raw,
        }
    }

    fn print_bytes(&self) {
        let n = self.segments.len();
        println!(
            "\n{n} segments, {} words, bytes:",
            self.segments.distinct.len()
        );
        for (form, bytes) in [
            ("bitmaps of features", self.bitmaps.bytes()),
            ("raw lists", self.raw.bytes()),
            ("packed lists", self.packed.bytes()),
            ("packed word numbers", self.numbers.bytes()),
            ("words as they are", size_of_val(&self.segments.words[..])),
            ("a whole shard", self.index.as_bytes().len()),
        ] {
            println!(
                "  {form:<22}{bytes:>10}{:>7.2} per segment",
                bytes as f64 / n as f64
            );
        }
    }

    /// Segments of one document from the middle on, as many as a query has.
    fn example(&self) -> usize {
        let is_whole = |at: &usize| !self.segments.is_first[at + 1..at + POSITIONS].contains(&true);
        let middle = self.segments.len() / 2;
        (middle..).find(is_whole).expect("a document in the middle")
    }
}

/// Universes by name; in test mode the small one alone, since it takes all code there is.
fn universes() -> Vec<(&'static str, Universe)> {
    let is_test = std::env::args().any(|argument| argument == "--test");
    let clips = benches::documents(if is_test { 120 } else { CLIPS });
    let mut universes = vec![("22k", Universe::of(&clips, 1, 1))];
    if !is_test {
        universes.push(("1M", Universe::of(&clips, COPIES, 2)));
        universes
            .iter()
            .for_each(|(_, universe)| universe.print_bytes());
    }
    universes
}

/// How many segments were visited, and what tells them apart.
#[derive(Debug, Default, PartialEq)]
struct Visited {
    n: usize,
    sum: usize,
}

impl Visited {
    fn add(&mut self, segment: usize) {
        self.n += 1;
        self.sum += segment;
    }
}

type Form<'a> = (&'static str, Box<dyn Fn(&mut Visited) + 'a>);

/// There are many rows, and they differ by factors.
fn brief(group: &mut BenchmarkGroup<'_, WallTime>) {
    group.sample_size(20);
    group.warm_up_time(Duration::from_millis(200));
    group.measurement_time(Duration::from_millis(800));
}

/// Times the forms of one question, the first of them the naive one.
fn race(c: &mut Criterion, group: &str, question: &str, forms: &[Form<'_>]) {
    let mut group = c.benchmark_group(group);
    brief(&mut group);
    let visited = |form: &Form<'_>| {
        let mut visited = Visited::default();
        form.1(&mut visited);
        visited
    };
    let expected = visited(&forms[0]);
    let question = format!("{question}, {} found", expected.n);
    for form in forms {
        assert_eq!(visited(form), expected, "{}, {question}", form.0);
        group.bench_function(BenchmarkId::new(form.0, &question), |b| {
            b.iter(|| visited(black_box(form)));
        });
    }
    group.finish();
}

/// The features that a query is about: all bits, or the chosen ones.
fn cares() -> [(&'static str, u64); 4] {
    const CHOSEN: [&str; 12] = [
        "F18", "F21", "F2", "F6", "F1", "F5", "F7", "F11", "F15", "F17", "F25", "F31",
    ];
    let set = benches::features();
    let care = |n: usize| {
        let bits = CHOSEN[..n].iter().filter_map(|name| set.select(name));
        bits.fold(0, |all, bits| all | bits)
    };
    [
        ("1 feature", care(1)),
        ("4 features", care(4)),
        ("12 features", care(12)),
        ("all features", u64::MAX),
    ]
}

/// Every segment that one position accepts.
fn one_position(c: &mut Criterion, name: &str, u: &Universe) {
    for (features, care) in cares() {
        let value = u.segments.words[u.example()];
        let position = Position { care, value };
        let forms: [Form<'_>; 7] = [
            (
                "scan words",
                Box::new(|v| u.segments.scan(position, |s| v.add(s))),
            ),
            (
                "scan packed numbers",
                Box::new(|v| u.numbers.scan(&u.segments, position, |s| v.add(s))),
            ),
            (
                "raw lists",
                Box::new(|v| u.raw.union(&u.segments, position, |s| v.add(s))),
            ),
            (
                "raw lists in order",
                Box::new(|v| u.raw.merge(&u.segments, position, |s| v.add(s))),
            ),
            (
                "packed lists",
                Box::new(|v| u.packed.union(&u.segments, position, |s| v.add(s))),
            ),
            ("shard's lists", Box::new(|v| shard_lists(u, position, v))),
            (
                "bitmaps",
                Box::new(|v| u.bitmaps.scan(position, |s| v.add(s))),
            ),
        ];
        race(
            c,
            &format!("one position, {name} segments"),
            features,
            &forms,
        );
    }
}

/// Through the public function of a shard, which allocates each list.
fn shard_lists(u: &Universe, position: Position, visited: &mut Visited) {
    for &word in u
        .segments
        .distinct
        .iter()
        .filter(|&&word| position.holds(word))
    {
        let list = u.index.list(word).expect("an intact shard");
        list.iter()
            .for_each(|&segment| visited.add(segment as usize));
    }
}

/// The last segments of all places that have the words of the query.
fn five_words(c: &mut Criterion, name: &str, u: &Universe) {
    let length = |segment: usize| u.raw.list(u.segments.numbers[segment] as usize).len();
    let rarest = |at: usize| (at..at + POSITIONS).map(length).min();
    let is_whole = |at: &usize| !u.segments.is_first[at + 1..at + POSITIONS].contains(&true);
    let places = (0..u.segments.len() - POSITIONS).filter(is_whole);
    let common = places.max_by_key(|&at| rarest(at)).expect("places");
    for (question, at) in [("rare words", u.example()), ("common words", common)] {
        let words = &u.segments.words[at..at + POSITIONS];
        let positions: Vec<Position> = words.iter().map(|&word| exactly(word)).collect();
        let query = Query::exact(words, u64::MAX);
        let forms: [Form<'_>; 6] = [
            (
                "scan words",
                Box::new(|v| places::scan_for(&u.segments, words, v)),
            ),
            (
                "raw lists",
                Box::new(|v| places::intersect(u, words, |list| u.raw.list(list).to_vec(), v)),
            ),
            (
                "packed lists",
                Box::new(|v| places::intersect(u, words, |list| u.packed.list(list), v)),
            ),
            (
                "packed list of the rarest",
                Box::new(|v| places::from_rarest(u, words, v)),
            ),
            (
                "bitmaps",
                Box::new(|v| u.bitmaps.exact(&positions, |s| v.add(s))),
            ),
            (
                "search_exact",
                Box::new(|v| {
                    let hits = search_exact(&u.index, &query).expect("an intact shard");
                    hits.iter()
                        .for_each(|hit| v.add(hit.first_segment + POSITIONS - 1));
                }),
            ),
        ];
        race(c, &format!("five words, {name} segments"), question, &forms);
    }
}

fn exactly(value: u64) -> Position {
    Position {
        care: u64::MAX,
        value,
    }
}

/// The ends of all adaptive hits, one past their last segments.
fn five_runs(c: &mut Criterion, name: &str, u: &Universe) {
    for (features, care) in cares()
        .into_iter()
        .filter(|(_, care)| care.count_ones() > 1)
    {
        let Some((frames, positions)) = example_of_runs(u, care) else {
            continue;
        };
        let query = Query::fuzzy(&frames, care);
        let whole = |engine| search_adaptive_with(&u.index, &query, engine).expect("intact");
        let n_hits = whole(Engine::Auto).hits.len();
        let forms: [Form<'_>; 3] = [
            (
                "scan words",
                Box::new(|v| places::runs_in_words(&u.segments, &positions, v)),
            ),
            (
                "scan packed numbers",
                Box::new(|v| places::runs_in_numbers(u, &positions, v)),
            ),
            (
                "bitmaps",
                Box::new(|v| u.bitmaps.adaptive(&positions, |s| v.add(s))),
            ),
        ];
        let group = format!("five runs, {name} segments");
        race(c, &group, features, &forms);
        let mut group = c.benchmark_group(group);
        brief(&mut group);
        for engine in [Engine::Auto, Engine::Scan] {
            let id = format!("search_adaptive {engine:?}");
            let question = format!("{features}, {n_hits} found");
            group.bench_function(BenchmarkId::new(id, question), |b| {
                b.iter(|| whole(black_box(engine)));
            });
        }
        group.finish();
    }
}

/// The frames of the first runs of some document, and what they accept.
fn example_of_runs(u: &Universe, care: u64) -> Option<(Vec<u64>, Vec<Position>)> {
    let documents = &u.documents[u.documents.len() / 2..];
    documents.iter().find_map(|document| {
        let runs = document.chunk_by(|a, b| a & care == b & care);
        let runs: Vec<&[u64]> = runs.take(POSITIONS).collect();
        let positions = runs.iter().map(|run| Position {
            care,
            value: run[0],
        });
        let positions: Vec<Position> = positions.collect();
        (runs.len() == POSITIONS).then(|| (runs.concat(), positions))
    })
}

fn postings(c: &mut Criterion) {
    for (name, universe) in universes() {
        one_position(c, name, &universe);
        five_words(c, name, &universe);
        five_runs(c, name, &universe);
    }
}

criterion_group!(benches, postings);
criterion_main!(benches);
