//! One answer whatever the indexes and engines, and segments with features of their own.

use std::collections::BTreeSet;

use cli::args::{EngineArg, IndexArg, Mode, SegmentArgs};
use cli::commands::search::{Mismatches, SearchResult, Sides, What, search};
use cli::corpus::Class;
use cli::library::Library;
use cli::output::Voice;
use cli::recording::ReadOptions;
use cli::source::ClipRef;
use cli::wire::clip_words;
use segidx::{FuzzySet, Mask};

use crate::command::{motif, text};
use crate::corpus::Fixture;

const ENGINES: [EngineArg; 4] = [
    EngineArg::Auto,
    EngineArg::Lists,
    EngineArg::Pivot,
    EngineArg::Scan,
];
const INDEXES: [IndexArg; 3] = [IndexArg::Auto, IndexArg::Joint, IndexArg::Parts];

fn example(class: Class) -> ClipRef {
    let path = Fixture::get().clip("ben", class);
    ClipRef::parse(format!("{}@60-150", path.display()).as_ref()).unwrap()
}

fn find(library: &Library, example: &ClipRef, what: &What<'_>) -> SearchResult {
    let options = ReadOptions::default();
    search(library, example, what, &options, Voice::default()).unwrap()
}

#[test]
fn every_index_and_engine_gives_the_same_hits() {
    let library = Library::open(&Fixture::get().library()).unwrap();
    let mut n_hits = 0;
    let mut verified = 0;
    for class in [Class::Squat, Class::KickLeft, Class::Wave, Class::Walk] {
        let example = example(class);
        for features in [
            &["*knee*"][..],
            &["F1", "F2"],
            &["F3", "*knee*", "root_fast"],
            &["lower", "F1", "F2"],
            &["F17", "F3", "feet_far_apart"],
            &["upper"],
            &[],
        ] {
            let features: Vec<String> = features.iter().map(|&f| f.to_owned()).collect();
            for (mode, max) in [
                (Mode::Adaptive, None),
                (Mode::Exact, None),
                (Mode::Fuzzy, None),
                (Mode::Adaptive, Some(1)),
                (Mode::Fuzzy, Some(1)),
            ] {
                let plain = What {
                    mode,
                    sides: Sides::Both,
                    mismatches: max.map(|max| Mismatches { max, at: &[] }),
                    ..What::new(&features)
                };
                let options = ReadOptions::default();
                let Ok(expected) = search(&library, &example, &plain, &options, Voice::default())
                else {
                    // A query of one segment cannot be wrong in it.
                    assert!(max.is_some());
                    continue;
                };
                n_hits += expected.n_hits;
                let expected = serde_json::to_value(&expected).unwrap();
                for engine in ENGINES {
                    for indexes in INDEXES {
                        let what = What {
                            engine: engine.engine(),
                            indexes,
                            explain_plan: true,
                            ..plain
                        };
                        let mut result = find(&library, &example, &what);
                        let plan = result.plan.take().unwrap();
                        assert!(!plan.is_empty());
                        let name = format!("{class} {features:?} {mode:?} {engine:?} {indexes:?}");
                        let own = engine.engine();
                        for step in plan.iter().filter(|step| step.engine != Some("verify")) {
                            let is_own = step.engine
                                == Some(match own {
                                    segidx::Engine::Lists => "lists",
                                    segidx::Engine::Pivot => "pivot",
                                    segidx::Engine::Scan => "scan",
                                    segidx::Engine::Auto => step.engine.unwrap(),
                                });
                            assert!(is_own, "{name}: {plan:?}");
                            let is_joint = step.index == "0001.shard";
                            assert!(is_joint || indexes != IndexArg::Joint, "{name}: {plan:?}");
                        }
                        verified += plan.iter().filter(|s| s.engine == Some("verify")).count();
                        assert_eq!(serde_json::to_value(&result).unwrap(), expected, "{name}");
                    }
                }
            }
        }
    }
    assert!(n_hits > 1000 && verified > 50, "{n_hits} {verified}");
}

/// Runs of equal `word & care`, as their words and lengths.
fn runs(words: &[u64], care: u64) -> Vec<(u64, usize)> {
    let runs = words.chunk_by(|a, b| (a ^ b) & care == 0);
    runs.map(|run| (run[0] & care, run.len())).collect()
}

/// The definition of adaptive hits, by brute force: per set a run of words in it, as long as can be, one after the
/// other.
fn adaptive(words: &[u64], sets: &[FuzzySet]) -> Vec<(usize, usize)> {
    let mut hits = Vec::new();
    for start in 0..words.len() {
        if start > 0 && sets[0].matches(words[start - 1]) {
            continue;
        }
        let mut at = start;
        let fits = sets.iter().all(|set| {
            let n = words[at..]
                .iter()
                .take_while(|word| set.matches(**word))
                .count();
            at += n;
            n > 0
        });
        if fits {
            hits.push((start, at));
        }
    }
    hits
}

#[test]
fn segments_with_features_and_alternatives_of_their_own_are_searched_by_definition() {
    let library = Library::open(&Fixture::get().library()).unwrap();
    let set = &library.features.set;
    let bit = |name: &str| set.select(name).unwrap();
    let path = Fixture::get().clip("ben", Class::KickLeft);
    let example = ClipRef { path, span: None };
    let words = clip_words(&example, &ReadOptions::default(), set, library.rate).unwrap();
    let features = ["lknee_bent", "lfoot_raised"].map(str::to_owned);
    let care = bit("lknee_bent") | bit("lfoot_raised");
    let query = runs(&words.words, care);
    assert!(query.len() > 3, "{query:?}");
    let mask = |care: u64, value: u64| FuzzySet::from(Mask::new(care, value));
    let plain: Vec<FuzzySet> = query.iter().map(|&(word, _)| mask(care, word)).collect();

    let mut only = plain.clone();
    only[1] = mask(bit("lknee_bent"), query[1].0);
    let mut either = plain.clone();
    let other = query[0].0 ^ bit("lfoot_raised");
    either[0] = either[0].union(&mask(care, other));
    let value = u8::from(other & bit("lfoot_raised") != 0);

    for (segments, alternatives, sets) in [
        (&[][..], &[][..], plain),
        (&["2:lknee_bent"], &[], only.clone()),
        (&["2:-lfoot*"], &[], only),
        (&[], &[format!("1:lfoot_raised={value}")], either),
    ] {
        // Neighbours that share a word are one.
        let mut conjoined: Vec<FuzzySet> = Vec::new();
        for mut next in sets {
            while let Some(last) = conjoined.pop_if(|last| last.intersects(&next)) {
                next = last.union(&next);
            }
            conjoined.push(next);
        }
        let mut expected = BTreeSet::new();
        for clip in library.clips().unwrap() {
            for (start, end) in adaptive(&library.words(clip.id).unwrap(), &conjoined) {
                let span = clip
                    .meta
                    .source_span(start..end, clip.n_words, library.rate);
                expected.insert((clip.name.clone(), span.start, span.end));
            }
        }
        let args = SegmentArgs {
            segments: segments.iter().map(|&s| s.to_owned()).collect(),
            alternatives: alternatives.to_vec(),
        };
        let what = What {
            segments: &args,
            ..What::new(&features)
        };
        let result = find(&library, &example, &what);
        let hits = result.hits.iter().map(|h| (h.clip.clone(), h.start, h.end));
        assert_eq!(hits.collect::<BTreeSet<_>>(), expected, "{args:?}");
        assert!(!expected.is_empty());
    }
}

#[test]
fn segments_are_refused_that_do_not_exist_or_are_not_understood() {
    let library = Fixture::get().library();
    let example = Fixture::get().clip("ben", Class::Squat);
    let check = |option: &str, value: &str, message: &str| {
        let run = motif(&[
            "search",
            text(&library),
            "--example",
            text(&example),
            "--features",
            "F20",
            option,
            value,
        ]);
        assert_eq!(run.code, 2, "{run:?}");
        assert!(run.stderr.contains(message), "{}", run.stderr);
    };
    check(
        "--segment",
        "99:F1",
        "expected a segment of the query, from 1 to",
    );
    check(
        "--segment",
        "F1",
        "expected the number of a segment, a colon",
    );
    check("--segment", "1:F99", "has no feature \"F99\"");
    check("--or", "1:F20", "expected features with = and 0 or 1");
    check("--or", "1:F20=2", "expected features with = and 0 or 1");
    check("--or", "0:F20=1", "found 0");
}
