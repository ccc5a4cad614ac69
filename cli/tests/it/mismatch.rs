//! `motif search --mismatches`, on the built-in corpus.

use std::collections::BTreeSet;

use cli::args::Mode;
use cli::commands::search::{Mismatches, SearchResult, What, search};
use cli::corpus::Class;
use cli::library::Library;
use cli::output::Voice;
use cli::recording::ReadOptions;
use cli::source::ClipRef;
use cli::wire::clip_words;
use serde_json::Value;

use crate::command::{motif, text};
use crate::corpus::Fixture;

/// Clip, first and end frame, the segments that differ.
type Place = (String, usize, usize, Vec<usize>);

/// `(word, number of words)` of every run of words that agree on `care`.
fn runs(words: &[u64], care: u64) -> Vec<(u64, usize)> {
    let runs = words.chunk_by(|a, b| (a ^ b) & care == 0);
    runs.map(|run| (run[0] & care, run.len())).collect()
}

/// The definition: all segments of all features that follow each other in a clip, against the query's.
fn places(library: &Library, query: &[u64], care: u64, may: Mismatches<'_>) -> BTreeSet<Place> {
    let mut places = BTreeSet::new();
    for clip in library.clips().unwrap() {
        let segments = runs(&library.words(clip.id).unwrap(), u64::MAX);
        let mut start = 0;
        for (k, segment) in segments.iter().enumerate() {
            let here = segments[k..].iter().take(query.len());
            let n_words: usize = here.clone().map(|s| s.1).sum();
            let pairs = here.zip(query).zip(1..);
            let wrong = pairs.filter(|((here, wanted), _)| here.0 & care != **wanted);
            let wrong: Vec<usize> = wrong.map(|(_, position)| position).collect();
            let is_allowed = |position| may.at.is_empty() || may.at.contains(position);
            if k + query.len() <= segments.len()
                && wrong.len() <= may.max
                && wrong.iter().all(is_allowed)
            {
                let words = start..start + n_words;
                let span = clip.meta.source_span(words, clip.n_words, library.rate);
                places.insert((clip.name.clone(), span.start, span.end, wrong));
            }
            start += segment.1;
        }
    }
    places
}

fn found(result: &SearchResult) -> BTreeSet<Place> {
    let hits = result.hits.iter();
    hits.map(|h| {
        (
            h.clip.clone(),
            h.start,
            h.end,
            h.mismatches.clone().unwrap(),
        )
    })
    .collect()
}

/// A moment of a motion: some segments, few enough that others come near them.
fn example(class: Class) -> ClipRef {
    let path = Fixture::get().clip("ben", class);
    ClipRef::parse(format!("{}@60-120", path.display()).as_ref()).unwrap()
}

#[test]
fn hits_are_those_of_the_definition() {
    let library = Library::open(&Fixture::get().library()).unwrap();
    let set = &library.features.set;
    let options = ReadOptions::default();
    let mut n_wrong = 0;
    for class in [Class::Squat, Class::KickLeft, Class::Wave] {
        let example = example(class);
        let words = clip_words(&example, &options, set, library.rate)
            .unwrap()
            .words;
        for name in ["lower", "upper"] {
            let care = set.select(name).unwrap();
            for mode in [Mode::Exact, Mode::Fuzzy] {
                let segmented_by = if mode == Mode::Exact { u64::MAX } else { care };
                let query = runs(&words, segmented_by).into_iter();
                let query: Vec<u64> = query.map(|(word, _)| word & care).collect();
                for (max, at) in [(0, &[][..]), (1, &[]), (2, &[]), (1, &[2]), (2, &[1, 3])] {
                    if max >= query.len() || at.iter().any(|&at| at > query.len()) {
                        continue;
                    }
                    let may = Mismatches { max, at };
                    let features = [name.to_owned()];
                    let what = What {
                        mode,
                        mismatches: Some(may),
                        ..What::new(&features)
                    };
                    let result =
                        search(&library, &example, &what, &options, Voice::default()).unwrap();
                    let expected = places(&library, &query, care, may);
                    assert_eq!(result.n_hits, expected.len());
                    assert_eq!(found(&result), expected, "{class} {name} {mode:?} {may:?}");
                    n_wrong += expected.iter().filter(|place| !place.3.is_empty()).count();
                }
            }
        }
    }
    assert!(n_wrong > 100, "only {n_wrong} hits differ anywhere");
}

fn run(args: &[&str]) -> crate::command::Output {
    let example = example(Class::Squat);
    let span = example.span.unwrap();
    let example = format!("{}@{}-{}", example.path.display(), span.start, span.end);
    let library = Fixture::get().library();
    let search = ["search", text(&library), "--example", &example];
    motif(&[&search, args].concat())
}

#[test]
fn differing_segments_are_told_only_where_they_are_asked_for() {
    let lower = ["--features", "lower", "--mode", "fuzzy", "--top", "0"];
    let exact = run(&[&lower[..], &["--json"]].concat());
    assert_eq!(exact.code, 0, "{exact:?}");
    let exact = exact.json()["result"].clone();
    for gone in ["max_mismatches", "at"] {
        assert_eq!(exact["query"].get(gone), None);
    }
    let n_segments = exact["query"]["segments"].as_array().unwrap().len();
    assert!(n_segments > 1);

    let one = run(&[&lower[..], &["--mismatches", "1", "--at", "1,2", "--json"]].concat());
    assert_eq!(one.code, 0, "{one:?}");
    let one = one.json()["result"].clone();
    assert_eq!(one["query"]["max_mismatches"], 1);
    assert_eq!(one["query"]["at"], Value::from(vec![1, 2]));
    let is_exact = |hit: &&Value| hit["mismatches"] == Value::Array(Vec::new());
    let one = one["hits"].as_array().unwrap();
    let place = |hit: &Value| [&hit["clip"], &hit["start"], &hit["cost"]].map(Value::clone);
    let among: Vec<_> = one.iter().filter(is_exact).map(place).collect();
    let exact = exact["hits"].as_array().unwrap();
    assert!(exact.iter().all(|hit| hit.get("mismatches").is_none()));
    assert_eq!(among, exact.iter().map(place).collect::<Vec<_>>());
    assert!(among.len() < one.len(), "no other segment stands for one");
    for hit in one {
        let wrong = hit["mismatches"].as_array().unwrap();
        assert!(wrong.len() <= 1 && wrong.iter().all(|at| *at == 1 || *at == 2));
    }

    let spoken = run(&[&lower[..], &["--mismatches", "1", "--at", "1,2"]].concat());
    for needle in ["up to 1 of segments 1, 2 may differ", "differing"] {
        assert!(spoken.stdout.contains(needle), "{}", spoken.stdout);
    }
    let spoken = run(&lower);
    assert!(!spoken.stdout.contains("differ"), "{}", spoken.stdout);
}

#[test]
fn impossible_mismatches_are_bad_usage() {
    let check = |args: &[&str], message: &str| {
        let run = run(args);
        assert_eq!(run.code, 2, "{run:?}");
        assert!(run.stderr.contains(message), "{message}\n{}", run.stderr);
    };
    let fuzzy = ["--features", "lower", "--mode", "fuzzy"];
    let result = run(&[&fuzzy[..], &["--json"]].concat()).json()["result"].clone();
    let n = result["query"]["segments"].as_array().unwrap().len();
    let with = |more: &[&str], message: &str| check(&[&fuzzy[..], more].concat(), message);
    let (all, beyond) = (n.to_string(), (n + 1).to_string());
    with(
        &["--mismatches", &all],
        &format!("--mismatches: expected fewer than the query's segments, {n}, found {n}"),
    );
    for at in ["0", &beyond] {
        let message = format!("--at: expected a segment of the query, from 1 to {n}, found {at}");
        with(&["--mismatches", "1", "--at", at], &message);
    }
    with(&["--at", "1"], "--mismatches");
    let adaptive = "expected --mode exact or --mode fuzzy, found adaptive";
    check(&["--mismatches", "1"], adaptive);
    check(&["--mode", "adaptive", "--mismatches", "1"], adaptive);

    let library = Fixture::get().library();
    let scene = [
        "search",
        text(&library),
        "--scene",
        "F1: 0",
        "--mismatches",
        "1",
    ];
    let run = motif(&scene);
    assert_eq!(run.code, 2, "{run:?}");
    assert!(run.stderr.contains("cannot be used with"), "{}", run.stderr);
}
