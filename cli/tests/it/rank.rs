//! `motif search --rank dtw`, on the built-in corpus.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use cli::align::pose::shared_points;
use cli::commands::search::{HitJson, MAX_POSE_RATE, Ranking, SearchResult, Sides, What, search};
use cli::corpus::Class;
use cli::library::Library;
use cli::output::Voice;
use cli::recording::ReadOptions;
use cli::source::ClipRef;
use cli::take::Take;
use relfeat::source_frame;

use crate::command::{motif, text};
use crate::corpus::{Fixture, build};

pub(crate) const ALL: Ranking = Ranking::Dtw { refine: 0 };

pub(crate) fn find(
    library: &Library,
    example: &Path,
    features: &[&str],
    ranking: Ranking,
) -> SearchResult {
    let features: Vec<String> = features.iter().map(|&f| f.to_owned()).collect();
    let what = What {
        ranking,
        ..What::new(&features)
    };
    ask(library, example, &what)
}

fn ask(library: &Library, example: &Path, what: &What<'_>) -> SearchResult {
    let example = ClipRef {
        path: example.to_owned(),
        span: None,
    };
    let options = ReadOptions::default();
    search(library, &example, what, &options, Voice::default()).unwrap()
}

type Place = (String, usize, usize);

fn place(hit: &HitJson) -> Place {
    (hit.clip.clone(), hit.start, hit.end)
}

#[test]
fn the_example_comes_first_and_the_others_by_distance() {
    let fixture = Fixture::get();
    let library = Library::open(&fixture.library()).unwrap();
    let example = fixture.clip("dan", Class::Squat);
    let features = ["F20", "F21"];
    let by_frames = find(&library, &example, &features, Ranking::Frames);
    assert!(by_frames.hits.iter().all(|hit| hit.dtw.is_none()));
    let by_dtw = find(&library, &example, &features, ALL);
    assert!(by_dtw.skipped.is_empty());
    let best = &by_dtw.hits[0];
    assert_eq!((best.dtw, best.rank), (Some(0.0), 1));
    assert_eq!(Path::new(&best.clip), example);
    let distances: Vec<f64> = by_dtw.hits.iter().map(|hit| hit.dtw.unwrap()).collect();
    assert!(distances.is_sorted());
    assert!(distances[1] > 0.0);
    let places = |result: &SearchResult| result.hits.iter().map(place).collect::<Vec<_>>();
    let sets = [&by_frames, &by_dtw].map(|r| places(r).into_iter().collect::<BTreeSet<_>>());
    assert_eq!(sets[0], sets[1]);
    assert!(sets[0].len() > 20);
    assert_ne!(places(&by_frames), places(&by_dtw));
}

#[test]
fn only_the_best_are_refined_and_the_others_follow_as_they_were() {
    let fixture = Fixture::get();
    let library = Library::open(&fixture.library()).unwrap();
    let example = fixture.clip("anna", Class::KickLeft);
    let features = ["lknee_bent", "rknee_bent"];
    let by_frames = find(&library, &example, &features, Ranking::Frames);
    let n = 7;
    let some = find(&library, &example, &features, Ranking::Dtw { refine: n });
    assert!(some.hits.len() > 2 * n);
    let (refined, rest) = some.hits.split_at(n);
    assert!(refined.iter().all(|hit| hit.dtw.is_some()));
    assert!(rest.iter().all(|hit| hit.dtw.is_none()));
    let sorted = |hits: &[HitJson]| hits.iter().map(place).collect::<BTreeSet<_>>();
    assert_eq!(sorted(refined), sorted(&by_frames.hits[..n]));
    let places = |hits: &[HitJson]| hits.iter().map(place).collect::<Vec<_>>();
    assert_eq!(places(rest), places(&by_frames.hits[n..]));
    let ranks = some.hits.iter().map(|hit| hit.rank);
    assert!(ranks.eq(1..=some.hits.len()));
}

/// The frames of a span: one per step of `rate`, the first frame being the first step.
fn frames(span: [usize; 2], source_rate: f64, rate: f64) -> Vec<usize> {
    let steps = (0..).map(|k| span[0] + source_frame(k, source_rate, rate));
    steps.take_while(|&frame| frame < span[1]).collect()
}

/// DTW by the textbook, and the mean over the pairs of its path.
fn mean_cost(n: usize, m: usize, distance: impl Fn(usize, usize) -> f64) -> f64 {
    let mut best = vec![vec![(f64::INFINITY, 0_u32); m]; n];
    for i in 0..n {
        for j in 0..m {
            let before = [(1, 1), (1, 0), (0, 1)]
                .into_iter()
                .filter_map(|(di, dj)| Some(best[i.checked_sub(di)?][j.checked_sub(dj)?]));
            let before = before.min_by(|a, b| a.0.total_cmp(&b.0));
            let (cost, steps) = before.unwrap_or((0.0, 0));
            best[i][j] = (cost + distance(i, j), steps + 1);
        }
    }
    let (cost, steps) = best[n - 1][m - 1];
    cost / f64::from(steps)
}

/// Costs are sums of the same numbers; only of paths that cost the same another may be taken, with other steps.
const ROUNDING: f64 = 1e-9;

#[test]
fn distances_are_those_of_the_definition() {
    let fixture = Fixture::get();
    let library = Library::open(&fixture.library()).unwrap();
    let options = ReadOptions::default();
    // Ben is recorded at 120 Hz; among the others are taller and smaller ones, and other rates.
    let example = fixture.clip("ben", Class::Squat);
    let result = find(&library, &example, &["relbow_bent"], ALL);
    let load = |path: &str| {
        let path = PathBuf::from(path);
        Take::load(&ClipRef { path, span: None }, &options).unwrap()
    };
    let asked = load(example.to_str().unwrap());
    let query = &result.query;
    let mut rates = BTreeSet::new();
    for hit in result.hits.iter().step_by(20) {
        let take = load(&hit.clip);
        let rate = asked.rate().min(take.rate()).min(MAX_POSE_RATE);
        rates.insert(take.rate() as u32);
        let span = [query.start, query.end];
        let points = shared_points(&asked.map, &take.map).unwrap();
        let (of_query, of_hit) = (
            frames(span, asked.rate(), rate),
            frames([hit.start, hit.end], take.rate(), rate),
        );
        let size = |take: &Take, frames: &[usize]| take.body().size(&points, frames).unwrap();
        let scale = size(&asked, &of_query) / size(&take, &of_hit);
        let (a, _) = asked.body().poses(&points, &of_query, 1.0);
        let (b, _) = take.body().poses(&points, &of_hit, scale);
        let distance = |i: usize, j: usize| a.distance(i, &b, j);
        let expected = mean_cost(a.n_frames(), b.n_frames(), distance);
        let found = hit.dtw.unwrap();
        assert!(
            (found - expected).abs() <= ROUNDING,
            "{found} {expected} {hit:?}"
        );
    }
    assert!(rates.len() > 1, "all clips have the same rate");
}

#[test]
fn the_order_does_not_depend_on_the_number_of_threads() {
    let fixture = Fixture::get();
    let library = Library::open(&fixture.library()).unwrap();
    let example = fixture.clip("eva", Class::Squat);
    let results = [1, 3].map(|n| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(n)
            .build()
            .unwrap();
        let result = pool.install(|| find(&library, &example, &["F20", "F21"], ALL));
        let hits = result.hits.iter();
        hits.map(|hit| (place(hit), hit.dtw.map(f64::to_bits)))
            .collect::<Vec<_>>()
    });
    assert_eq!(results[0], results[1]);
}

/// A library of some squats, on their own.
fn squats(dir: &Path) -> (Vec<PathBuf>, PathBuf) {
    let fixture = Fixture::get();
    let mut files = Vec::new();
    for name in ["anna", "ben", "chiyo"] {
        let clip = fixture.clip(name, Class::Squat);
        let folder = dir.join(name);
        fs::create_dir_all(&folder).unwrap();
        let siblings = fs::read_dir(clip.parent().unwrap()).unwrap();
        let asf = siblings.map(|e| e.unwrap().path());
        for path in asf
            .filter(|p| p.extension().is_some_and(|e| e == "asf"))
            .chain([clip.clone()])
        {
            fs::copy(&path, folder.join(path.file_name().unwrap())).unwrap();
        }
        files.push(folder.join(clip.file_name().unwrap()));
    }
    let library = dir.join("lib");
    build(&[dir.to_owned()], &library);
    (files, library)
}

fn run(library: &Path, example: &Path, more: &[&str]) -> crate::command::Output {
    let search = ["search", text(library), "--example", text(example)];
    // Never on in any of these, so that all of them are hits.
    let features = ["--features", "spine_horizontal", "--rank", "dtw"];
    motif(&[&search[..], &features, more].concat())
}

#[test]
fn hits_whose_files_are_gone_or_changed_stand_behind_the_others() {
    let dir = tempfile::tempdir().unwrap();
    let (files, library) = squats(dir.path());
    let example = dir.path().join("example.amc");
    fs::copy(&files[0], &example).unwrap();
    fs::copy(
        files[0].with_file_name("anna.asf"),
        dir.path().join("example.asf"),
    )
    .unwrap();
    let json = |more: &[&str]| {
        let run = run(&library, &example, &[more, &["--json"]].concat());
        assert_eq!(run.code, 0, "{run:?}");
        run.json()
    };
    let whole = json(&[]);
    assert_eq!(whole["skipped"].as_array().unwrap().len(), 0);
    let hits = whole["result"]["hits"].as_array().unwrap().clone();
    assert_eq!(hits[0]["dtw"], 0.0);
    assert_eq!(hits[0]["clip"], text(&files[0]));
    let n_hits = hits.len();

    // The best is gone, another one is shorter now.
    fs::remove_file(&files[0]).unwrap();
    let short = fs::read_to_string(&files[1]).unwrap();
    let end = short.rfind("\n100\n").unwrap();
    fs::write(&files[1], &short[..=end]).unwrap();
    let less = json(&[]);
    let skipped = less["skipped"].as_array().unwrap();
    let named: BTreeSet<&str> = skipped
        .iter()
        .map(|s| s["path"].as_str().unwrap())
        .collect();
    assert_eq!(named, BTreeSet::from([text(&files[0]), text(&files[1])]));
    let changed = skipped
        .iter()
        .find(|s| s["path"] == text(&files[1]))
        .unwrap();
    let error = changed["error"].as_str().unwrap();
    assert!(
        error.contains("frames that were indexed, found 99"),
        "{error}"
    );
    let hits = less["result"]["hits"].as_array().unwrap();
    assert_eq!(hits.len(), n_hits);
    let is_left = |hit: &serde_json::Value| named.contains(hit["clip"].as_str().unwrap());
    let n_refined = hits.iter().filter(|hit| hit.get("dtw").is_some()).count();
    assert!(0 < n_refined && n_refined < n_hits);
    assert!(hits[..n_refined].iter().all(|hit| !is_left(hit)));
    assert!(hits[n_refined..].iter().all(is_left));

    let spoken = run(&library, &example, &[]);
    assert!(
        spoken.stderr.contains("2 files were skipped"),
        "{}",
        spoken.stderr
    );
    assert!(
        spoken.stderr.contains("could not be compared"),
        "{}",
        spoken.stderr
    );
    assert!(spoken.stdout.contains("dtw"), "{}", spoken.stdout);
    assert_eq!(run(&library, &example, &["--strict"]).code, 3);
}

/// Files have four digits, so a mirrored copy is not the same to the last bit: joints are less than this apart.
const WRITTEN: f64 = 1e-3;

#[test]
fn a_mirrored_hit_is_compared_with_the_mirrored_example() {
    let fixture = Fixture::get();
    let dir = tempfile::tempdir().unwrap();
    let example = fixture.clip("eva", Class::KickRight);
    let mirrored = dir.path().join("mirrored.bvh");
    let made = motif(&["convert", text(&example), text(&mirrored), "--mirror"]);
    assert_eq!(made.code, 0, "{made:?}");
    let library = dir.path().join("lib");
    build(std::slice::from_ref(&mirrored), &library);
    let library = Library::open(&library).unwrap();
    let features = ["rfoot_raised".to_owned(), "rknee_bent".to_owned()];
    let what = What {
        sides: Sides::Both,
        ranking: ALL,
        ..What::new(&features)
    };
    let result = ask(&library, &example, &what);
    let best = &result.hits[0];
    assert!(best.mirrored && best.dtw.unwrap() <= WRITTEN, "{best:?}");
    // Without looking at the other side the kick of the other leg is far away.
    let options = ReadOptions::default();
    let load = |path: &Path| {
        let clip = ClipRef {
            path: path.to_owned(),
            span: None,
        };
        Take::load(&clip, &options).unwrap()
    };
    let (a, b) = (load(&example), load(&mirrored));
    let points = shared_points(&a.map, &b.map).unwrap();
    let frames = frames([0, a.span.end], a.rate(), 30.0);
    let (a_poses, _) = a.body().poses(&points, &frames, 1.0);
    let (b_poses, _) = b.body().poses(&points, &frames, 1.0);
    let distance = |i: usize, j: usize| a_poses.distance(i, &b_poses, j);
    let as_given = mean_cost(a_poses.n_frames(), b_poses.n_frames(), distance);
    assert!(as_given > 10.0 * WRITTEN, "{as_given}");
}

#[test]
fn what_cannot_be_refined_is_bad_usage() {
    let fixture = Fixture::get();
    let (library, example) = (fixture.library(), fixture.clip("ben", Class::Squat));
    let search = ["search", text(&library), "--example", text(&example)];
    let refine = motif(&[&search[..], &["--refine", "3"]].concat());
    assert_eq!(refine.code, 2, "{refine:?}");
    assert!(
        refine.stderr.contains("--refine: expected --rank dtw"),
        "{}",
        refine.stderr
    );
    let scene = [
        "search",
        text(&library),
        "--scene",
        "F1: 0",
        "--rank",
        "dtw",
    ];
    assert_eq!(motif(&scene).code, 2);
}
