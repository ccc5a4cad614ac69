//! The 31 features of 2005 on real clips whose names say what a person sees in them.

use std::fs;
use std::path::{Path, PathBuf};

use cli::recording::{ReadOptions, load};
use relfeat::{BodyMap, FeatureSet, extract, source_frame};

use crate::real::data;

const SETS: [&str; 2] = ["mueller2005", "mueller2005-text"];
const WORDS_PER_SECOND: f64 = 30.0;

fn builtin(name: &str) -> FeatureSet {
    FeatureSet::builtin(name).unwrap()
}

fn amc_files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|e| e.unwrap().path());
    let mut files: Vec<PathBuf> = entries
        .filter(|p| p.extension().is_some_and(|e| e.eq_ignore_ascii_case("amc")))
        .collect();
    files.sort();
    files
}

/// The words of a clip of 120 frames per second, after a look whether the rig has every feature.
fn words(path: &Path, set: &FeatureSet) -> Vec<u64> {
    let recording = load(path, &ReadOptions::default()).unwrap().recording;
    let map = BodyMap::recognise(&recording.names()).unwrap();
    let positions = recording.positions();
    let found = extract(set, positions.view(), &map, 120.0, WORDS_PER_SECOND).unwrap();
    assert_eq!(found.unavailable, [], "{}", path.display());
    found.words
}

fn bits(set: &FeatureSet, features: &[&str]) -> u64 {
    let bit = |name: &&str| set.select(name).unwrap_or_else(|| panic!("{name}"));
    features.iter().map(bit).fold(0, |all, bit| all | bit)
}

fn have_together(words: &[u64], all: u64) -> bool {
    words.iter().any(|word| word & all == all)
}

fn never_have(words: &[u64], any: u64) -> bool {
    words.iter().all(|word| word & any == 0)
}

#[test]
fn real_rigs_have_all_31_features() {
    let Some(data) = data() else { return };
    for name in SETS {
        let set = builtin(name);
        let mut groups: Vec<(String, Vec<PathBuf>)> = Vec::new();
        for folder in ["hdm05", "cmu"] {
            let entries = fs::read_dir(data.join(folder)).unwrap();
            for path in entries.map(|e| e.unwrap().path()).filter(|p| p.is_dir()) {
                let label = path.file_name().unwrap().to_str().unwrap().to_owned();
                groups.push((label, amc_files(&path)));
            }
        }
        groups.sort();
        let n_clips: usize = groups.iter().map(|(_, files)| files.len()).sum();
        assert_eq!(n_clips, 288 + 195);
        let mut total = vec![0usize; set.features().len()];
        let mut n_words = 0;
        for (label, files) in groups {
            let words: Vec<u64> = files.iter().flat_map(|f| words(f, &set)).collect();
            let mut line = format!("{name} {label}:");
            for (bit, total) in total.iter_mut().enumerate() {
                let n_on = words.iter().filter(|w| **w >> bit & 1 == 1).count();
                *total += n_on;
                line += &format!(" {:.2}", n_on as f64 / words.len() as f64);
            }
            n_words += words.len();
            println!("{line}");
        }
        for (feature, n_on) in set.features().iter().zip(total) {
            let share = n_on as f64 / n_words as f64;
            println!("{name} {:<20} {share:.3} of all words", feature.name);
            assert!(0 < n_on && n_on < n_words, "{name} {}", feature.name);
        }
    }
}

/// In every clip of the folder some frame has all of `together`, and none has one of `never`.
#[track_caller]
fn check(folder: &Path, together: &[&str], never: &[&str]) {
    let files = amc_files(folder);
    assert!(!files.is_empty());
    for name in SETS {
        let set = builtin(name);
        for file in &files {
            let words = words(file, &set);
            let clip = file.file_stem().unwrap().display();
            assert!(have_together(&words, bits(&set, together)), "{name} {clip}");
            assert!(never_have(&words, bits(&set, never)), "{name} {clip}");
        }
    }
}

#[test]
fn real_exercises_have_the_features_of_their_names() {
    let Some(data) = data() else { return };
    let class = |name: &str| data.join("hdm05").join(name);
    // The arms are held out in front.
    let down = ["rknee_bent", "lknee_bent", "rhand_front", "lhand_front"];
    check(&class("squat1Reps"), &down, &["legs_crossed"]);
    check(
        &class("kickLFront1Reps"),
        &["lfoot_raised"],
        &["rfoot_raised"],
    );
    check(&class("kickLFront1Reps"), &["lfoot_fast"], &[]);
    check(&class("grabHighR"), &["rhand_raised"], &["lhand_raised"]);
    check(&class("depositFloorR"), &["rhand_touching_leg"], &[]);
    check(&class("depositFloorR"), &["torso_bent"], &[]);
    check(
        &class("elbowToKnee1RepsLelbowStart"),
        &["rknee_bent"],
        &["lknee_bent", "lfoot_raised"],
    );
    let up = ["rhand_raised", "lhand_raised", "rhand_fast", "lhand_fast"];
    let still = ["rfoot_raised", "lfoot_raised", "rknee_bent", "lknee_bent"];
    check(&class("rotateArmsBothBackward1Reps"), &up, &still);
    check(
        &class("rotateArmsBothBackward1Reps"),
        &["rarm_sideways", "larm_sideways"],
        &[],
    );
    check(
        &class("lieDownFloor"),
        &["rfoot_raised", "lfoot_raised"],
        &[],
    );
    check(
        &class("hopBothLegs1hops"),
        &["rfoot_fast", "lfoot_fast", "root_fast"],
        &["legs_crossed"],
    );
    for foot in ["rfoot_fast", "lfoot_fast"] {
        check(
            &class("jogLeftCircle4StepsRstart"),
            &[foot, "root_fast"],
            &[],
        );
    }
}

/// The kick of the paper's Figure 10, with the left foot: lowered, raised, lowered.
#[test]
fn real_kicks_go_as_the_paper_describes_them() {
    let Some(data) = data() else { return };
    for name in SETS {
        let set = builtin(name);
        let raised = bits(&set, &["lfoot_raised"]);
        for file in amc_files(&data.join("hdm05/kickLFront1Reps")) {
            let mut states: Vec<bool> =
                words(&file, &set).iter().map(|w| w & raised != 0).collect();
            states.dedup();
            assert_eq!(states, [false, true, false], "{name} {}", file.display());
        }
    }
}

/// A foot is raised towards the root: in a squat, which lowers the root, both are. Never without the
/// knee.
#[test]
fn real_squats_raise_feet_only_on_bent_knees() {
    let Some(data) = data() else { return };
    for name in SETS {
        let set = builtin(name);
        for side in ["r", "l"] {
            let raised = bits(&set, &[&format!("{side}foot_raised")]);
            let bent = bits(&set, &[&format!("{side}knee_bent")]);
            let mut n_clips = 0;
            for file in amc_files(&data.join("hdm05/squat1Reps")) {
                let words = words(&file, &set);
                n_clips += usize::from(have_together(&words, raised));
                let is_bent = |word: &u64| word & raised == 0 || word & bent != 0;
                assert!(words.iter().all(is_bent), "{name} {}", file.display());
            }
            println!("{name}: {side}foot_raised in {n_clips} of 52 squats");
        }
    }
}

/// Trials of a subject whose description begins with a word.
fn trials(data: &Path, subject: &str, begins: &str) -> Vec<PathBuf> {
    let text = fs::read_to_string(data.join("labels/cmu-descriptions.csv")).unwrap();
    let mut files = Vec::new();
    for line in text.lines() {
        let mut cells = line.splitn(3, ',');
        let (Some(s), Some(trial), Some(rest)) = (cells.next(), cells.next(), cells.next()) else {
            continue;
        };
        if s == subject.trim_start_matches('0') && rest.trim_start_matches('"').starts_with(begins)
        {
            let trial: usize = trial.parse().unwrap();
            files.push(data.join(format!("cmu/{subject}/{subject}_{trial:02}.amc")));
        }
    }
    files.retain(|f| f.is_file());
    files
}

/// The paper, sections 3 and 4: in a walk the toes of each foot fall behind the other leg in turn,
/// between which both are in front; "no pose with feature vector (0,0) appears".
#[test]
fn real_walks_have_the_papers_feature_sequence() {
    let Some(data) = data() else { return };
    let set = builtin("mueller2005-text");
    let (right, left) = (bits(&set, &["rfoot_front"]), bits(&set, &["lfoot_front"]));
    let both = right | left;
    let cycle = [both, left, both, right];
    let mut files = trials(&data, "16", "walk");
    files.extend(trials(&data, "02", "walk"));
    assert!(files.len() > 20, "{files:?}");
    for file in files {
        let mut sequence: Vec<u64> = words(&file, &set).iter().map(|w| w & both).collect();
        sequence.dedup();
        assert!(sequence.len() >= 8, "{}", file.display());
        let is_cycle = |first: usize| {
            let expected = cycle.iter().cycle().skip(first);
            sequence.iter().zip(expected).all(|(a, b)| a == b)
        };
        assert!((0..4).any(is_cycle), "{}: {sequence:?}", file.display());
    }
}

#[test]
fn real_blows_and_kicks_are_fast_and_on_their_side() {
    let Some(data) = data() else { return };
    let trial = |name: &str| {
        data.join("cmu")
            .join(&name[..2])
            .join(format!("{name}.amc"))
    };
    for name in SETS {
        let set = builtin(name);
        let right = bits(&set, &["rhand_front", "rhand_fast"]);
        let left = bits(&set, &["lhand_front", "lhand_fast"]);
        for boxing in ["14_02", "17_10"] {
            let words = words(&trial(boxing), &set);
            assert!(
                have_together(&words, right) && have_together(&words, left),
                "{boxing}"
            );
        }
        // "punch/strike": the right hand's.
        let words = words(&trial("02_05"), &set);
        assert!(have_together(&words, right), "{name}");
        if name == "mueller2005" {
            assert!(never_have(&words, bits(&set, &["lhand_front"])));
        }
    }
    let set = builtin("mueller2005-text");
    let (right, left) = (bits(&set, &["rfoot_raised"]), bits(&set, &["lfoot_raised"]));
    let kicks = trials(&data, "10", "soccer");
    assert_eq!(kicks.len(), 5);
    for file in kicks {
        let words = words(&file, &set);
        assert!(
            have_together(&words, right) && never_have(&words, left),
            "{}",
            file.display()
        );
    }
}

/// What each labelled action has at some time in each of its spans, and what never.
const ACTIONS: [(&str, &[&str], &[&str]); 7] = [
    (
        "JumpJack",
        &[
            "rarm_sideways",
            "larm_sideways",
            "rhand_raised",
            "lhand_raised",
            "rleg_sideways",
            "lleg_sideways",
            "rfoot_fast",
            "lfoot_fast",
        ],
        &["rhand_touching_leg", "lhand_touching_leg", "torso_bent"],
    ),
    (
        "Twist",
        &["relbow_bent", "lelbow_bent"],
        &["rknee_bent", "lknee_bent", "torso_bent"],
    ),
    (
        "ArmCircle",
        &[
            "rhand_raised",
            "lhand_raised",
            "rarm_sideways",
            "larm_sideways",
        ],
        &["rknee_bent", "lknee_bent", "torso_bent"],
    ),
    (
        "ToeTouchOneHand",
        &["rhand_touching_leg", "lhand_touching_leg", "torso_bent"],
        &["rknee_bent", "lknee_bent"],
    ),
    // One thigh at a time does not bend the torso.
    (
        "KneeRaise",
        &["rknee_bent", "lknee_bent"],
        &["torso_bent", "rhand_touching_leg", "lhand_touching_leg"],
    ),
    (
        "Squat",
        &["rknee_bent", "lknee_bent", "torso_bent"],
        &["legs_crossed"],
    ),
    (
        "Jog",
        &["rfoot_fast", "lfoot_fast", "rknee_bent", "lknee_bent"],
        &["torso_bent"],
    ),
];

/// Labelled spans of CMU 13_29 to 13_31: 1-based frames, both ends included.
#[test]
fn real_labelled_actions_have_their_features() {
    let Some(data) = data() else { return };
    let text = fs::read_to_string(data.join("labels/mocap6-subject13.csv")).unwrap();
    for name in SETS {
        let set = builtin(name);
        for line in text.lines().skip(1) {
            let cells: Vec<&str> = line.split(',').collect();
            let [trial, first, last, action] = cells.as_slice() else {
                panic!("{line}")
            };
            let span = first.parse::<usize>().unwrap() - 1..last.parse().unwrap();
            let words = words(&data.join(format!("cmu/13/{trial}.amc")), &set);
            let words: Vec<u64> = (0..words.len())
                .filter(|&k| span.contains(&source_frame(k, 120.0, WORDS_PER_SECOND)))
                .map(|k| words[k])
                .collect();
            let (_, sometimes, never) = ACTIONS.iter().find(|a| a.0 == *action).unwrap();
            for feature in *sometimes {
                assert!(
                    have_together(&words, bits(&set, &[feature])),
                    "{name} {line}: {feature}"
                );
            }
            for feature in *never {
                assert!(
                    never_have(&words, bits(&set, &[feature])),
                    "{name} {line}: {feature}"
                );
            }
        }
    }
}
