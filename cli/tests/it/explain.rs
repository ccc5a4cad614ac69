//! `motif search --explain`, on the built-in corpus.

use std::collections::BTreeSet;
use std::fs;

use cli::args::Mode;
use cli::commands::search::{HitJson, Mismatches, SearchResult, Sides, What, search};
use cli::corpus::Class;
use cli::library::Library;
use cli::output::Voice;
use cli::recording::ReadOptions;
use cli::source::ClipRef;
use cli::wire::{ClipMeta, clip_words};

use crate::command::{motif, text};
use crate::corpus::Fixture;

fn example(class: Class) -> ClipRef {
    ClipRef {
        path: Fixture::get().clip("ben", class),
        span: None,
    }
}

fn ask(library: &Library, example: &ClipRef, what: &What<'_>) -> SearchResult {
    let what = What {
        explain: true,
        ..*what
    };
    let options = ReadOptions::default();
    search(library, example, &what, &options, Voice::default()).unwrap()
}

/// The features of each segment: equal, different, masked.
fn features(hit: &HitJson) -> Vec<[BTreeSet<String>; 3]> {
    let segments = hit.explained.as_ref().unwrap().segments.iter();
    let set = |names: &[String]| names.iter().cloned().collect();
    segments
        .map(|s| {
            let masked = s.masked.iter().map(|m| m.feature.clone());
            [set(&s.equal), set(&s.different), masked.collect()]
        })
        .collect()
}

#[test]
fn adaptive_hits_are_equal_in_all_that_is_compared() {
    let library = Library::open(&Fixture::get().library()).unwrap();
    let set = &library.features.set;
    let mut n_hits = 0;
    for class in [Class::Squat, Class::KickLeft, Class::Wave, Class::Jog] {
        for patterns in [&["F20", "F21"][..], &["upper"], &["root_fast"]] {
            let patterns: Vec<String> = patterns.iter().map(|&f| f.to_owned()).collect();
            let example = example(class);
            let what = What {
                sides: Sides::Both,
                ..What::new(&patterns)
            };
            let result = ask(&library, &example, &what);
            let compared: u64 = patterns
                .iter()
                .filter_map(|p| set.select(p))
                .fold(0, |a, b| a | b);
            for hit in &result.hits {
                let care = if hit.mirrored {
                    set.mirrored(compared)
                } else {
                    compared
                };
                let expected: BTreeSet<String> =
                    cli::selection::names(set, care).into_iter().collect();
                let rest = cli::selection::names(set, set.all() & !care)
                    .into_iter()
                    .collect();
                for [equal, different, masked] in features(hit) {
                    assert_eq!((&equal, different.len()), (&expected, 0), "{hit:?}");
                    assert_eq!(masked, rest);
                }
                let segments = &hit.explained.as_ref().unwrap().segments;
                let frames: Vec<[usize; 2]> = segments.iter().map(|s| s.frames).collect();
                assert_eq!(frames, hit.segments);
                if !hit.mirrored {
                    let frames: Vec<[usize; 2]> = segments.iter().map(|s| s.query_frames).collect();
                    assert_eq!(frames, result.query.segments);
                }
                n_hits += 1;
            }
        }
    }
    assert!(n_hits > 200, "only {n_hits} hits");
}

#[test]
fn masked_features_agree_as_the_words_of_clip_and_example_do() {
    let library = Library::open(&Fixture::get().library()).unwrap();
    let set = &library.features.set;
    let example = example(Class::Squat);
    let asked = clip_words(&example, &ReadOptions::default(), set, library.rate).unwrap();
    let patterns = ["F20".to_owned(), "F21".to_owned()];
    let result = ask(&library, &example, &What::new(&patterns));
    let clips = library.clips().unwrap();
    let mut others = BTreeSet::new();
    for hit in &result.hits {
        let clip = clips.iter().find(|clip| clip.name == hit.clip).unwrap();
        let words = library.words(clip.id).unwrap();
        // Clips are whole files, so words count from the first frame; the last word ends with the file.
        let word = |frame: usize, meta: &ClipMeta, n_words: usize| match frame as u64 {
            end if end == meta.source_frames => n_words,
            _ => (frame as f64 * library.rate / meta.source_rate).round() as usize,
        };
        for segment in &hit.explained.as_ref().unwrap().segments {
            let found = segment.frames.map(|f| word(f, &clip.meta, words.len()));
            let wanted = segment.query_frames;
            let wanted = wanted.map(|f| word(f, &asked.meta, asked.words.len()));
            let found = &words[found[0]..found[1]];
            let wanted = &asked.words[wanted[0]..wanted[1]];
            for masked in &segment.masked {
                let bit = set.select(&masked.feature).unwrap();
                let agrees = |k: usize| {
                    let middle = (k as f64 + 0.5) / found.len() as f64;
                    let nearest = (middle * wanted.len() as f64).floor() as usize;
                    (found[k] ^ wanted[nearest]) & bit == 0
                };
                let n = (0..found.len()).filter(|&k| agrees(k)).count();
                let share = n as f64 / found.len() as f64;
                assert_eq!(masked.agreement, share, "{} {}", hit.clip, masked.feature);
                others.insert((share * 100.0) as usize);
            }
        }
    }
    let best = result.hits[0].explained.as_ref().unwrap();
    let mut masked = best.segments.iter().flat_map(|s| &s.masked);
    assert!(
        masked.all(|m| m.agreement == 1.0),
        "the example is like itself"
    );
    assert!(others.len() > 10, "{others:?}");
}

#[test]
fn features_differ_in_the_segments_that_are_mismatches() {
    let library = Library::open(&Fixture::get().library()).unwrap();
    let example =
        ClipRef::parse(format!("{}@60-120", example(Class::Squat).path.display()).as_ref())
            .unwrap();
    let patterns = ["lower".to_owned()];
    let mut n_different = 0;
    for mode in [Mode::Exact, Mode::Fuzzy] {
        let what = What {
            mode,
            mismatches: Some(Mismatches { max: 1, at: &[] }),
            ..What::new(&patterns)
        };
        for hit in ask(&library, &example, &what).hits {
            let numbered = features(&hit).into_iter().zip(1..);
            let different = numbered.filter(|([_, different, _], _)| !different.is_empty());
            let different: Vec<usize> = different.map(|(_, segment)| segment).collect();
            assert_eq!(Some(&different), hit.mismatches.as_ref());
            n_different += different.len();
        }
    }
    assert!(n_different > 20, "only {n_different}");
}

#[test]
fn hits_are_explained_only_if_asked() {
    let fixture = Fixture::get();
    let dir = tempfile::tempdir().unwrap();
    let (library, example) = (fixture.library(), fixture.clip("ben", Class::Squat));
    let run = |more: &[&str]| {
        let search = ["search", text(&library), "--example", text(&example)];
        let features = ["--features", "root_fast", "--top", "15"];
        let run = motif(&[&search[..], &features, more].concat());
        assert_eq!(run.code, 0, "{run:?}");
        run
    };
    let plain = run(&["--json"]).json()["result"].clone();
    let mut told = run(&["--json", "--explain"]).json()["result"].clone();
    for hit in told["hits"].as_array_mut().unwrap() {
        let explained = hit.as_object_mut().unwrap().remove("explained").unwrap();
        let explained = explained.as_array().unwrap();
        assert_eq!(explained.len(), hit["segments"].as_array().unwrap().len());
        for (segment, number) in explained.iter().zip(1..) {
            assert_eq!(segment["segment"], number);
            assert_eq!(segment["equal"], serde_json::json!(["root_fast"]));
            let share = segment["masked"][0]["agreement"].as_f64().unwrap();
            assert!((0.0..=1.0).contains(&share));
        }
    }
    assert_eq!(plain, told, "nothing else changes");

    let plain = run(&[]).stdout;
    let told = run(&["--explain"]).stdout;
    let lines: Vec<&str> = told
        .lines()
        .filter(|line| line.contains("1 feature equal"))
        .collect();
    assert_eq!(lines.len(), 15, "{told}");
    assert!(
        lines[0].ends_with("1 feature equal; 38 masked, alike 100 %"),
        "{told}"
    );
    let rest = told.lines().filter(|line| !line.contains("feature equal"));
    assert!(rest.eq(plain.lines()), "{told}");

    let png = dir.path().join("hits.png");
    let drawn = run(&["--explain-png", text(&png)]);
    assert!(drawn.stderr.contains("wrote"), "{}", drawn.stderr);
    assert_eq!(drawn.stdout, told);
    let decoder = png::Decoder::new(std::io::BufReader::new(fs::File::open(&png).unwrap()));
    let info = decoder.read_info().unwrap();
    let (width, height) = info.info().size();
    assert!(width > 800 && height > 400, "{width} x {height}");

    let nowhere = dir.path().join("no/such/folder.png");
    let search = ["search", text(&library), "--example", text(&example)];
    let failed = motif(&[&search[..], &["--explain-png", text(&nowhere)]].concat());
    assert_eq!(failed.code, 4, "{failed:?}");
    let scene = ["search", text(&library), "--scene", "F1: 0", "--explain"];
    assert_eq!(motif(&scene).code, 2);
}
