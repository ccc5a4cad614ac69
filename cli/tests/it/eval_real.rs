//! Templates on HDM05 against what is published about them.

use std::fs;
use std::path::Path;

use cli::eval::baseline::{Baseline, match_example};
use cli::eval::clips::{Clip, PosesKept, Reading, read};
use cli::eval::folders::Folders;
use cli::eval::metrics::{TAUS, average_precision, count_hits, separation};
use cli::eval::split::{Role, Split};
use cli::eval::{Documents, Method, Trial, learn_and_match_all};
use cli::output::Voice;
use cli::recording::ReadOptions;
use mtemplate::{ShortClips, Unwarp};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use relfeat::FeatureSet;

use crate::real::data;

struct Labelled {
    folders: Folders,
    clips: Vec<Clip>,
    n_features: usize,
}

impl Labelled {
    fn read(data: &Path, set: &str, poses: PosesKept) -> Labelled {
        let folders = Folders::find(&data.join("hdm05")).unwrap();
        let set = FeatureSet::builtin(set).unwrap();
        let reading = Reading {
            options: &ReadOptions::default(),
            set: &set,
            rate: 30.0,
            poses,
        };
        let (clips, skipped) = read(&folders, &reading, Voice::default());
        assert!(skipped.is_empty(), "{skipped:?}");
        let n_features = set.features().len();
        Labelled {
            folders,
            clips,
            n_features,
        }
    }

    fn trial<'a>(&'a self, roles: &'a [Role]) -> Trial<'a> {
        Trial {
            classes: &self.folders.classes,
            clips: &self.clips,
            roles,
            n_features: self.n_features,
        }
    }
}

/// A published row: K, and |H⁺| at six thresholds.
type Row = (usize, Vec<usize>);

/// Of squats, |H| up to the number of relevant clips stands in for |H⁺|, which is not printed.
fn published(data: &Path, class: &str) -> Option<Row> {
    if class == "squat1Reps" {
        return Some((48, vec![23, 24, 26, 26, 26, 26]));
    }
    let text = fs::read_to_string(data.join("labels/mce-table-part1.tsv")).unwrap();
    let cells = |line: &str| line.split('\t').map(str::to_owned).collect::<Vec<_>>();
    let mut rows = text.lines().map(cells);
    let row = rows.find(|row| row.get(1).is_some_and(|folder| folder == class))?;
    let hits = row[6].split('/').map(|n| n.parse().unwrap());
    Some((row[3].parse().unwrap(), hits.collect()))
}

/// Clips per class that the paper evaluates on (spec.md 0.1).
const EVALUATED: [(&str, usize); 9] = [
    ("depositFloorR", 16),
    ("elbowToKnee1RepsLelbowStart", 13),
    ("grabHighR", 14),
    ("hopBothLegs1hops", 18),
    ("jogLeftCircle4StepsRstart", 8),
    ("kickLFront1Reps", 14),
    ("lieDownFloor", 10),
    ("rotateArmsBothBackward1Reps", 8),
    ("squat1Reps", 26),
];

/// Table 1: class, N, mean length in frames of 30 Hz with one decimal, iterations.
const LEARNED: [(&str, usize, &str, usize); 2] = [
    ("lieDownFloor", 10, "165.0", 5),
    ("squat1Reps", 26, "47.3", 5),
];

/// Later cuts of the clips and thresholds edited since 2006 leave this much (an independent implementation of
/// the same definitions is off by 20 and 3).
const MAX_RELEVANT_OFF: usize = 24;
const MAX_LENGTH_OFF: usize = 3;

#[test]
fn real_tables_1_and_2_of_the_paper() {
    let Some(data) = data() else { return };
    let labelled = Labelled::read(&data, "mueller2006", PosesKept::No);
    let roles = Split::Paper.roles(&labelled.folders).unwrap();
    let trial = labelled.trial(&roles);
    let mut method = Method::default();
    method.learn.unwarp = Unwarp::Balance;
    let learned = learn_and_match_all(&trial, &method).unwrap();
    let (mut relevant_off, mut n_cells) = (0, 0);
    for (class, name) in trial.classes.iter().enumerate() {
        let learned = learned[class].as_ref().unwrap();
        let relevant = trial.relevance(class);
        if let Some((_, n)) = EVALUATED.iter().find(|row| row.0 == name) {
            assert_eq!(relevant.iter().filter(|r| **r).count(), *n, "{name}");
        }
        if let Some((_, n, length, iterations)) = LEARNED.iter().find(|row| row.0 == name) {
            let frames: Vec<usize> = trial
                .training(class)
                .map(|clip| clip.n_frames / 4)
                .collect();
            let mean = frames.iter().sum::<usize>() as f64 / frames.len() as f64;
            let found = (
                frames.len(),
                format!("{mean:.1}"),
                learned.learned.iterations,
            );
            assert_eq!(found, (*n, (*length).to_owned(), *iterations), "{name}");
        }
        let Some((n_columns, expected)) = published(&data, name) else {
            continue;
        };
        let count = |tau| count_hits(&learned.responses, &relevant, tau).relevant_hits;
        let found = TAUS.map(count);
        let length = learned.learned.template.n_columns();
        println!("{name}: K {length}, paper {n_columns}; H+ {found:?}, paper {expected:?}");
        assert!(length.abs_diff(n_columns) <= MAX_LENGTH_OFF, "{name}");
        n_cells += found.len();
        let pairs = found.iter().zip(&expected);
        relevant_off += pairs.map(|(a, b)| a.abs_diff(*b)).sum::<usize>();
    }
    println!("off by {relevant_off} over {n_cells} cells");
    assert_eq!(n_cells, 54);
    assert!(relevant_off <= MAX_RELEVANT_OFF);
}

fn by_actor(labelled: &Labelled, test: &[&str]) -> Vec<Role> {
    let test = test.iter().map(|&actor| actor.to_owned()).collect();
    Split::Actor { test, part: None }
        .roles(&labelled.folders)
        .unwrap()
}

fn method(documents: Documents) -> Method {
    Method {
        documents,
        ..Method::default()
    }
}

fn mean_average_precision(trial: &Trial<'_>, method: &Method) -> f64 {
    let learned = learn_and_match_all(trial, method).unwrap();
    let precision = |(class, learned): (usize, &Option<cli::eval::Learned>)| {
        let responses = &learned.as_ref().unwrap().responses;
        average_precision(responses, &trial.relevance(class)).unwrap()
    };
    let precisions = learned.iter().enumerate().map(precision);
    precisions.sum::<f64>() / learned.len() as f64
}

const APART: [Documents; 2] = [
    Documents::Apart(ShortClips::Unmatched),
    Documents::Apart(ShortClips::Held),
];

const LEARNED_FROM: [&str; 3] = ["bd", "bk", "dg"];
const TESTED: [&str; 2] = ["mm", "tr"];

/// What an independent implementation reached that leaves short clips unmatched, and what is wanted.
const OTHERS_MEAN: f64 = 0.945;
const WANTED_MEAN: f64 = 0.95;

#[test]
fn real_actors_who_were_not_learned_from() {
    let Some(data) = data() else { return };
    let labelled = Labelled::read(&data, "mueller2006", PosesKept::No);
    let roles = by_actor(&labelled, &TESTED);
    let trial = labelled.trial(&roles);
    let means = APART.map(|rule| mean_average_precision(&trial, &method(rule)));
    println!(
        "mean average precision: short clips unmatched {:.4}, held {:.4}",
        means[0], means[1]
    );
    assert!(means[0] >= OTHERS_MEAN);
    assert!(means[1] >= WANTED_MEAN);
    let joined = method(Documents::Joined);
    let published = mean_average_precision(&trial, &joined);
    println!("one stream, in order of class and file name: {published:.4}");
    assert!(published >= WANTED_MEAN);

    // What stands beside a clip is chance: in other orders.
    let mut means: Vec<f64> = (0..N_ORDERS)
        .map(|seed| {
            let mut order: Vec<usize> = (0..labelled.clips.len()).collect();
            let mut dice = ChaCha8Rng::seed_from_u64(seed);
            order.sort_by_cached_key(|_| dice.next_u64());
            let clips: Vec<Clip> = order.iter().map(|&k| labelled.clips[k].clone()).collect();
            let roles: Vec<Role> = order.iter().map(|&k| roles[k]).collect();
            let trial = Trial {
                clips: &clips,
                ..labelled.trial(&roles)
            };
            mean_average_precision(&trial, &joined)
        })
        .collect();
    means.sort_by(f64::total_cmp);
    let median = means[means.len() / 2];
    println!("one stream, {N_ORDERS} random orders: median {median:.4}, all {means:.3?}");
    assert!(median >= WANTED_MEAN);
}

/// Random orders of the clips.
const N_ORDERS: u64 = 21;

/// Every so many words of the test clips are kept: as if all their motions were done so much faster.
const SPEEDS: [usize; 2] = [1, 2];

/// Whether short clips are to be held shows in the actors that are learned from, each left out in turn: it costs
/// nothing there, where no clip is too short, and much is gained when they move faster.
#[test]
fn real_short_clips_are_held_for_those_learned_from() {
    let Some(data) = data() else { return };
    let labelled = Labelled::read(&data, "mueller2006", PosesKept::No);
    let is_tested = by_actor(&labelled, &TESTED);
    for speed in SPEEDS {
        let mut means = [0.0; 2];
        for actor in LEARNED_FROM {
            let roles = by_actor(&labelled, &[actor]);
            let mut clips = Vec::new();
            let mut kept = Vec::new();
            for ((clip, role), tested) in labelled.clips.iter().zip(roles).zip(&is_tested) {
                if *tested == Role::Train {
                    let mut clip = clip.clone();
                    if role == Role::Test {
                        clip.words = clip.words.into_iter().step_by(speed).collect();
                    }
                    clips.push(clip);
                    kept.push(role);
                }
            }
            let trial = Trial {
                clips: &clips,
                ..labelled.trial(&kept)
            };
            for (mean, rule) in means.iter_mut().zip(APART) {
                *mean += mean_average_precision(&trial, &method(rule)) / LEARNED_FROM.len() as f64;
            }
        }
        let [unmatched, held] = means;
        println!("at {speed} times the speed: unmatched {unmatched:.4}, held {held:.4}");
        assert!(held >= unmatched);
        assert!(speed == 1 || held > unmatched);
    }
}

#[test]
fn real_templates_separate_better_than_examples() {
    let Some(data) = data() else { return };
    let labelled = Labelled::read(&data, "mueller2006", PosesKept::Yes);
    let roles = by_actor(&labelled, &TESTED);
    let trial = labelled.trial(&roles);
    for rule in [APART[0], APART[1], Documents::Joined] {
        let learned = learn_and_match_all(&trial, &method(rule)).unwrap();
        for (class, name) in trial.classes.iter().enumerate() {
            let relevant = trial.relevance(class);
            let responses = &learned[class].as_ref().unwrap().responses;
            let own = separation(responses, &relevant).value().unwrap();
            for baseline in Baseline::ALL {
                let responses = match_example(&trial, class, baseline, rule);
                let other = separation(&responses.unwrap().unwrap(), &relevant).value();
                let about = format!(
                    "{name}, {rule:?}: {own:.2}, {} {other:.2?}",
                    baseline.name()
                );
                println!("{about}");
                assert!(other.is_none_or(|other| own > other), "{about}");
            }
        }
    }
}
