//! What `motif search --rank dtw` is good for: hits of the example's class come earlier.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

use cli::commands::search::{HitJson, Ranking};
use cli::corpus::Class;
use cli::library::Library;
use cli::recording::ReadOptions;

use crate::corpus::Fixture;
use crate::rank::{ALL, find};
use crate::real::data;

/// The mean of the precisions at the places of the relevant hits.
fn average_precision(relevant: impl Iterator<Item = bool>) -> f64 {
    let mut precisions = Vec::new();
    for (n_before, is_relevant) in relevant.enumerate() {
        if is_relevant {
            precisions.push((precisions.len() + 1) as f64 / (n_before + 1) as f64);
        }
    }
    precisions.iter().sum::<f64>() / precisions.len().max(1) as f64
}

/// Average precisions of a search, by frames and by DTW, over the same hits, and seconds for both.
struct Compared {
    n_hits: usize,
    n_relevant: usize,
    precision: [f64; 2],
    seconds: [f64; 2],
}

impl Compared {
    fn new(
        library: &Library,
        example: &Path,
        features: &[&str],
        is_relevant: impl Fn(&HitJson) -> bool,
    ) -> Compared {
        let mut seconds = [0.0; 2];
        let mut counts = (0, 0);
        let rankings = [Ranking::Frames, ALL];
        let precision = [0, 1].map(|k| {
            let start = Instant::now();
            let result = find(library, example, features, rankings[k]);
            seconds[k] = start.elapsed().as_secs_f64();
            // The example itself is no find.
            let others = || {
                result
                    .hits
                    .iter()
                    .filter(|hit| Path::new(&hit.clip) != example)
            };
            counts = (
                others().count(),
                others().filter(|hit| is_relevant(hit)).count(),
            );
            average_precision(others().map(&is_relevant))
        });
        Compared {
            n_hits: counts.0,
            n_relevant: counts.1,
            precision,
            seconds,
        }
    }
}

/// Prints a line per class and gives the mean average precision by frames and by DTW over all searches with relevant
/// and other hits; what has only one kind has no order.
fn tell(searches: &BTreeMap<String, Vec<Compared>>) -> [f64; 2] {
    let mut all: Vec<[f64; 2]> = Vec::new();
    for (class, searches) in searches {
        let mixed = searches
            .iter()
            .filter(|s| 0 < s.n_relevant && s.n_relevant < s.n_hits);
        let precisions: Vec<[f64; 2]> = mixed.map(|s| s.precision).collect();
        if precisions.is_empty() {
            continue;
        }
        let mean =
            |k: usize| precisions.iter().map(|p| p[k]).sum::<f64>() / precisions.len() as f64;
        let median = |k: usize| {
            let mut seconds: Vec<f64> = searches.iter().map(|s| s.seconds[k]).collect();
            seconds.sort_by(f64::total_cmp);
            seconds[seconds.len() / 2] * 1e3
        };
        let hits: usize = searches.iter().map(|s| s.n_hits).sum();
        println!(
            "{class:<30} {:>3} searches, {:>3} mixed, {:>5} hits: average precision by frames {:.3}, by dtw {:.3}; \
            ms per search {:.1} and {:.0}",
            searches.len(),
            precisions.len(),
            hits,
            mean(0),
            mean(1),
            median(0),
            median(1),
        );
        all.extend(precisions);
    }
    let mean = |k: usize| all.iter().map(|p| p[k]).sum::<f64>() / all.len() as f64;
    println!(
        "{} mixed searches: by frames {:.3}, by dtw {:.3}",
        all.len(),
        mean(0),
        mean(1)
    );
    [mean(0), mean(1)]
}

/// Features that several classes share, so that hits are of several classes.
const BROAD: [&[&str]; 2] = [
    &["rknee_bent", "lknee_bent"],
    &["relbow_bent", "lelbow_bent"],
];

#[test]
fn hits_of_the_examples_class_come_earlier_than_by_frames() {
    let fixture = Fixture::get();
    let library = Library::open(&fixture.library()).unwrap();
    let mut searches: BTreeMap<String, Vec<Compared>> = BTreeMap::new();
    for class in Class::ALL {
        let example = fixture.clip("ben", class);
        // A hit is relevant if more than half of it shows the class.
        let is_relevant = |hit: &HitJson| {
            let file = fixture
                .files
                .iter()
                .find(|f| f.path == Path::new(&hit.clip));
            let labels = file.unwrap().labels.iter().filter(|l| l.class == class);
            let shared = labels.map(|l| {
                let (start, end) = (l.span.start.max(hit.start), l.span.end.min(hit.end));
                end.saturating_sub(start)
            });
            2 * shared.sum::<usize>() > hit.end - hit.start
        };
        for features in BROAD {
            let compared = Compared::new(&library, &example, features, is_relevant);
            searches
                .entry(class.to_string())
                .or_default()
                .push(compared);
        }
    }
    let [by_frames, by_dtw] = tell(&searches);
    assert!(by_dtw > by_frames, "{by_dtw} {by_frames}");
}

#[test]
fn real_hits_of_the_examples_class_come_earlier_than_by_frames() {
    let Some(data) = data() else { return };
    let dir = tempfile::tempdir().unwrap();
    let outcome = crate::corpus::index(&[data.join("hdm05")], dir.path(), &ReadOptions::default());
    assert!(outcome.skipped.is_empty(), "{:?}", outcome.skipped);
    let library = Library::open(dir.path()).unwrap();
    let mut searches: BTreeMap<String, Vec<Compared>> = BTreeMap::new();
    let mut folders: BTreeMap<PathBuf, Vec<PathBuf>> = BTreeMap::new();
    for clip in library.clips().unwrap() {
        let path = PathBuf::from(clip.name);
        folders
            .entry(path.parent().unwrap().to_owned())
            .or_default()
            .push(path);
    }
    for (folder, clips) in &folders {
        let class = folder.file_name().unwrap().to_str().unwrap();
        // Several clips of the larger classes, so that several people are asked for.
        for example in clips.iter().step_by(20) {
            for features in BROAD {
                let is_relevant = |hit: &HitJson| Path::new(&hit.clip).parent() == Some(folder);
                let compared = Compared::new(&library, example, features, is_relevant);
                searches.entry(class.to_owned()).or_default().push(compared);
            }
        }
    }
    let [by_frames, by_dtw] = tell(&searches);
    assert!(by_dtw >= by_frames, "{by_dtw} {by_frames}");
}
