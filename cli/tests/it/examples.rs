//! Searches with chosen features, with a folder of examples, and of the mirrored body.

use cli::commands::search::{SearchResult, Sides, What, search, search_all};
use cli::corpus::Class;
use cli::library::Library;
use cli::output::Voice;
use cli::recording::ReadOptions;
use cli::source::ClipRef;
use cli::take::Take;

use crate::command::{motif, text};
use crate::corpus::Fixture;

fn library() -> Library {
    Library::open(&Fixture::get().library()).unwrap()
}

fn clip(performer: &str, class: Class) -> ClipRef {
    ClipRef {
        path: Fixture::get().clip(performer, class),
        span: None,
    }
}

fn find(library: &Library, example: &ClipRef, what: &What<'_>) -> SearchResult {
    let options = ReadOptions::default();
    search(library, example, what, &options, Voice::default()).unwrap()
}

/// Clip, first and end frame of each hit that is, or is not, one of the mirrored example.
fn places(result: &SearchResult, mirrored: bool) -> Vec<(String, usize, usize)> {
    let hits = result.hits.iter().filter(|hit| hit.mirrored == mirrored);
    hits.map(|h| (h.clip.clone(), h.start, h.end)).collect()
}

#[test]
fn a_mirrored_body_has_the_words_of_a_mirrored_file() {
    let dir = tempfile::tempdir().unwrap();
    let library = library();
    let (set, rate) = (&library.features.set, library.rate);
    let options = ReadOptions::default();
    for class in [Class::KickLeft, Class::Wave, Class::Walk] {
        let example = clip("ben", class);
        let mirrored = dir.path().join(format!("{class}.bvh"));
        let converted = motif(&["convert", "--mirror", text(&example.path), text(&mirrored)]);
        assert_eq!(converted.code, 0, "{}", converted.stderr);
        let mirrored = ClipRef {
            path: mirrored,
            span: None,
        };
        let take = Take::load(&example, &options).unwrap();
        let words = |take: &Take| take.words(set, rate).unwrap().words;
        let expected = words(&Take::load(&mirrored, &options).unwrap());
        assert_eq!(words(&take.mirrored()), expected, "{class}");
        assert_eq!(words(&take.mirrored().mirrored()), words(&take), "{class}");
        assert_ne!(words(&take), expected, "{class}");
    }
}

#[test]
fn a_left_kick_finds_right_kicks_in_the_mirror_alone() {
    let library = library();
    let features = ["lfoot_raised", "lknee_bent"].map(str::to_owned);
    let left = clip("ben", Class::KickLeft);
    let plain = find(&library, &left, &What::new(&features));
    let what = What {
        sides: Sides::Both,
        ..What::new(&features)
    };
    let both = find(&library, &left, &what);
    assert_eq!(places(&both, false), places(&plain, false));
    let is_in = |result: &SearchResult, class: Class| {
        let mut of_class = Fixture::get()
            .files
            .iter()
            .filter(|f| f.class == Some(class));
        of_class.any(|file| result.hits.iter().any(|hit| hit.clip == text(&file.path)))
    };
    assert!(!is_in(&plain, Class::KickRight) && is_in(&both, Class::KickRight));
    // The mirrored example asks what the mirrored features ask of the mirrored body.
    let mirrored = places(&both, true);
    assert!(!mirrored.is_empty());
    assert!(
        mirrored
            .iter()
            .all(|place| !places(&plain, false).contains(place))
    );
}

#[test]
fn features_go_until_there_are_enough_hits() {
    let library = library();
    let example = clip("ben", Class::Squat);
    let all = find(&library, &example, &What::new(&[]));
    for enough in [1, 2, 10, 40] {
        let what = What {
            enough: Some(enough),
            ..What::new(&[])
        };
        let result = find(&library, &example, &what);
        let trail = result.trail.as_ref().unwrap();
        assert_eq!(trail[0].dropped, None);
        assert_eq!(trail[0].n_hits, all.n_hits);
        let (last, before) = trail.split_last().unwrap();
        assert!(before.iter().all(|step| step.n_hits < enough));
        assert!(last.n_hits >= enough, "{enough}: {trail:?}");
        for (step, next) in trail.iter().zip(&trail[1..]) {
            assert_eq!(step.n_features, next.n_features + 1);
            assert!(next.dropped.is_some() && step.n_segments >= next.n_segments);
        }
        assert_eq!(last.n_features, result.query.features.len());
        assert_eq!(last.n_hits, result.n_hits);
        // The same features by name give the same hits.
        let again = find(&library, &example, &What::new(&result.query.features));
        assert_eq!(places(&again, false), places(&result, false));
    }
}

#[test]
fn too_many_hits_to_ask_for_leave_one_feature_that_changes() {
    let library = library();
    let what = What {
        enough: Some(usize::MAX),
        ..What::new(&[])
    };
    let result = find(&library, &clip("ben", Class::Squat), &what);
    assert_eq!(result.query.features.len(), 1);
    assert!(result.query.segments.len() > 1);
}

#[test]
fn every_clip_of_a_folder_is_an_example() {
    let library = library();
    let folder = Fixture::get().clip("ben", Class::Squat);
    let folder = ClipRef {
        path: folder.parent().unwrap().to_owned(),
        span: None,
    };
    let features = ["F20".to_owned(), "F21".to_owned()];
    let what = What::new(&features);
    let options = ReadOptions::default();
    let (all, skipped) = search_all(&library, &folder, &what, &options, Voice::default()).unwrap();
    assert!(skipped.is_empty() && all.searches.len() > 1);
    for one in &all.searches {
        let alone = ClipRef::parse(one.query.clip.as_ref()).unwrap();
        let alone = find(&library, &alone, &what);
        assert_eq!(
            serde_json::to_value(one).unwrap(),
            serde_json::to_value(alone).unwrap()
        );
    }
}

#[test]
fn a_folder_is_searched_from_the_command_line_and_broken_clips_are_named() {
    let dir = tempfile::tempdir().unwrap();
    let good = dir.path().join("good.bvh");
    let example = clip("ben", Class::Squat);
    let converted = motif(&["convert", text(&example.path), text(&good)]);
    assert_eq!(converted.code, 0, "{}", converted.stderr);
    std::fs::write(dir.path().join("bad.bvh"), "HIERARCHY\nROOT").unwrap();
    let library = Fixture::get().library();
    let run = |extra: &[&str]| {
        let folder = ["search", text(&library), "--example", text(dir.path())];
        let features = ["--features", "*knee_bent"];
        motif(&[&folder[..], &features, extra].concat())
    };
    let json = run(&["--json"]);
    let value = json.json();
    assert_eq!(value["result"]["searches"].as_array().unwrap().len(), 1);
    let features = value["result"]["searches"][0]["query"]["features"].as_array();
    assert_eq!(features.unwrap().len(), 2);
    assert!(
        value["skipped"][0]["path"]
            .as_str()
            .unwrap()
            .ends_with("bad.bvh")
    );
    let plain = run(&[]);
    assert_eq!(plain.code, 0);
    assert!(plain.stdout.starts_with("1 example\n"), "{}", plain.stdout);
    assert!(plain.stderr.contains("bad.bvh"));
}

#[test]
fn an_excerpt_is_ranked_by_the_runs_it_was_cut_out_of() {
    let library = library();
    let features = ["*knee_bent", "*foot_fast"].map(str::to_owned);
    for class in [Class::Squat, Class::KickLeft, Class::Walk] {
        let path = Fixture::get().clip("ben", class);
        for (start, end) in [(30, 90), (45, 160), (61, 133)] {
            let example = format!("{}@{start}-{end}", path.display());
            let example = ClipRef::parse(example.as_ref()).unwrap();
            let result = find(&library, &example, &What::new(&features));
            // Somewhere among the best is the place it was cut out of, which costs nothing.
            let mut free = result.hits.iter().take_while(|hit| hit.cost == 0);
            let is_own = |hit: &cli::commands::search::HitJson| {
                hit.clip == text(&path) && hit.start <= start && end <= hit.end
            };
            assert!(free.any(is_own), "{class} {start} {end}");
            assert_eq!((result.query.start, result.query.end), (start, end));
        }
    }
}
