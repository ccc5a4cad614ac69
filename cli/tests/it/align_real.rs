//! `motif align` on real clips, against DTW over the full matrix.

use std::fs;
use std::path::{Path, PathBuf};

use cli::align::pair::Pair;
use cli::align::{Resolution, align, full_cost};
use cli::recording::ReadOptions;
use cli::source::ClipRef;
use cli::take::Take;
use relfeat::FeatureSet;

use crate::real::data;

/// The share of the matrix that may be computed, every stage counted.
const MAX_SHARE: f64 = 0.15;

/// By how much the path may cost more than the best of all.
const MAX_EXCESS: f64 = 0.01;

/// The share of pairs whose path must not cost more than that.
const MIN_WITHIN: f64 = 0.95;

/// The same sum of a few hundred distances made in another order, relative to it.
const ROUNDING: f64 = 1e-12;

/// Pairs per class.
const PAIRS: usize = 60;

/// The clips of a folder, in order of their names.
fn clips_in(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|e| e.unwrap().path());
    let mut clips: Vec<PathBuf> = entries
        .filter(|p| p.extension().is_some_and(|e| e == "amc"))
        .collect();
    clips.sort();
    clips
}

/// The trials of CMU subjects 7 and 16 that are described as walks.
fn walks(data: &Path) -> Vec<PathBuf> {
    let text = fs::read_to_string(data.join("labels/cmu-descriptions.csv")).unwrap();
    let is_walk = |path: &PathBuf| {
        let stem = path.file_stem().unwrap().to_str().unwrap();
        let (subject, trial) = stem.split_once('_').unwrap();
        let row = format!(
            "{},{},",
            subject.parse::<u32>().unwrap(),
            trial.parse::<u32>().unwrap()
        );
        let row = text.lines().find(|line| line.starts_with(&row)).unwrap();
        row.contains("walk")
    };
    let clips = ["07", "16"].map(|subject| clips_in(&data.join("cmu").join(subject)));
    clips.concat().into_iter().filter(is_walk).collect()
}

/// All pairs of different clips in order, every so-manieth of them, so that `PAIRS` remain.
fn pairs(n_clips: usize) -> Vec<(usize, usize)> {
    let all: Vec<(usize, usize)> = (0..n_clips)
        .flat_map(|i| (i + 1..n_clips).map(move |j| (i, j)))
        .collect();
    (0..PAIRS).map(|k| all[k * all.len() / PAIRS]).collect()
}

#[derive(Default)]
struct Measured {
    shares: Vec<f64>,
    excesses: Vec<f64>,
}

impl Measured {
    fn print(&self, class: &str) {
        let max = |values: &[f64]| values.iter().fold(0f64, |max, &v| max.max(v));
        let n = self.shares.len() as f64;
        println!(
            "{class:28} {n:5} {:5.1} % {:5.1} % {:7.1} % {:6.2} %",
            100.0 * self.shares.iter().sum::<f64>() / n,
            100.0 * max(&self.shares),
            100.0 * self.within(),
            100.0 * max(&self.excesses),
        );
    }

    /// The share of pairs that cost next to nothing more.
    fn within(&self) -> f64 {
        let n_within = self.excesses.iter().filter(|e| **e <= MAX_EXCESS).count();
        n_within as f64 / self.excesses.len() as f64
    }
}

fn measure(clips: &[PathBuf], resolution: &impl Fn(f64) -> Resolution) -> Measured {
    let set = FeatureSet::builtin("mueller2006").unwrap();
    let take = |path: &PathBuf| {
        let clip = ClipRef {
            path: path.clone(),
            span: None,
        };
        Take::load(&clip, &ReadOptions::default()).unwrap()
    };
    let takes: Vec<Take> = clips.iter().map(take).collect();
    let mut measured = Measured::default();
    for (i, j) in pairs(takes.len()) {
        let (a, b) = (&takes[i], &takes[j]);
        let pair = Pair::new(a, b, &set, a.rate().min(b.rate()))
            .unwrap()
            .unwrap();
        let found = align(pair.a.side(), pair.b.side(), &resolution(pair.rate))
            .unwrap()
            .unwrap();
        let best = full_cost(&pair.a.poses, &pair.b.poses).unwrap().unwrap();
        assert_eq!(
            found.cells.full,
            (pair.a.frames.len() * pair.b.frames.len()) as u64
        );
        measured.shares.push(found.cells.share());
        measured.excesses.push(found.cost / best - 1.0);
        if std::env::var("SHOW").is_ok() {
            println!(
                "mean {:.3} {:.4}",
                found.cost / found.steps.len() as f64,
                found.cost / best - 1.0
            );
        }
    }
    measured
}

/// Measures and prints every class, and asserts what holds for all of them together.
fn measure_classes(data: &Path, resolution: impl Fn(f64) -> Resolution) -> Vec<Measured> {
    println!(
        "{:28} {:>5} {:>7} {:>7} {:>9} {:>8}",
        "class", "pairs", "mean", "max", "within 1 %", "worst"
    );
    let classes = ["squat1Reps", "jogLeftCircle4StepsRstart", "grabHighR"];
    let classes = classes.map(|class| (class, clips_in(&data.join("hdm05").join(class))));
    let classes = classes
        .into_iter()
        .chain([("walk (CMU 7, 16)", walks(data))]);
    let mut all = Measured::default();
    let mut each = Vec::new();
    for (class, clips) in classes {
        let measured = measure(&clips, &resolution);
        measured.print(class);
        all.shares.extend(&measured.shares);
        all.excesses.extend(&measured.excesses);
        each.push(measured);
    }
    all.print("all");
    assert!(all.shares.len() >= 200);
    assert!(all.shares.iter().all(|&share| share <= MAX_SHARE));
    assert!(all.within() >= MIN_WITHIN);
    // A band can only miss the best path.
    assert!(all.excesses.iter().all(|&excess| excess >= -ROUNDING));
    each
}

#[test]
fn real_alignments_cost_hardly_more_than_full_dtw_and_compute_a_fraction() {
    let Some(data) = data() else { return };
    let classes = measure_classes(&data, Resolution::new);
    assert!(classes.iter().all(|class| class.within() >= MIN_WITHIN));
}

/// What happens to clips of many minutes, forced on clips of a few seconds.
#[test]
fn real_alignments_are_as_good_when_segments_are_joined_first() {
    let Some(data) = data() else { return };
    measure_classes(&data, |rate| Resolution {
        max_segment_cells: 25,
        ..Resolution::new(rate)
    });
}

/// A clip's frames and those of the same performance in another format, `offset` frames later there.
#[track_caller]
fn assert_same_performance(a: &Path, b: &Path, offset: isize) {
    let take = |path: &Path| {
        let clip = ClipRef {
            path: path.to_owned(),
            span: None,
        };
        Take::load(&clip, &ReadOptions::default()).unwrap()
    };
    let set = FeatureSet::builtin("mueller2006").unwrap();
    let pair = Pair::new(&take(a), &take(b), &set, 120.0).unwrap().unwrap();
    let found = align(pair.a.side(), pair.b.side(), &Resolution::new(120.0))
        .unwrap()
        .unwrap();
    let n_apart = |&(i, j): &(usize, usize)| {
        let (i, j) = (pair.a.frames[i] as isize, pair.b.frames[j] as isize);
        i + offset != j
    };
    let n_wrong = found.steps.iter().filter(|step| n_apart(step)).count();
    let n_expected = offset.unsigned_abs();
    println!("{}: {n_wrong} of {} steps", b.display(), found.steps.len());
    assert!(n_wrong <= n_expected, "{n_wrong}, expected {n_expected}");
}

/// Facts from the data's README: which frame of the one file is which of the other.
#[test]
fn real_formats_of_one_performance_are_aligned_frame_by_frame() {
    let Some(data) = data() else { return };
    let amc = data.join("cmu/05/05_13.amc");
    // One T-pose frame in front.
    assert_same_performance(&amc, &data.join("bvh/cgspeed/05/05_13.bvh"), 1);
    let take = data.join("c3d/hdm05-take");
    let [amc, c3d] = ["amc", "c3d"].map(|e| take.join("HDM_dg_06-03_03_120").with_extension(e));
    assert_same_performance(&amc, &c3d, 0);
}
