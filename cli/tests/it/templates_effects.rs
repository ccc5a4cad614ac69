//! What mirroring and combining do to templates (2006 paper, section 5.4).

use cli::commands::demo::SEED;
use cli::corpus::{Class, plan};
use cli::eval::clips::{PosesKept, Reading, read};
use cli::eval::folders::Folders;
use cli::output::Voice;
use cli::recording::ReadOptions;
use mocap_io::forward_kinematics;
use mtemplate::{LearnConfig, MatchConfig, MotionTemplate, QuantizedTemplate, learn};
use relfeat::{BodyMap, FeatureSet, extract};

use crate::real::data;

/// The stricter of the thresholds that the paper's Table 5 quotes; at 0.06 a few kicks pass for the other side.
const TAU: f64 = 0.02;
const DELTA: f64 = 0.1;
const RATE: f64 = 30.0;

fn features() -> FeatureSet {
    FeatureSet::builtin("mueller2006").unwrap()
}

/// Words of the corpus's clips of a class: performers to learn from, and the others.
fn corpus(class: Class) -> [Vec<Vec<u64>>; 2] {
    const LEARNED_FROM: [&str; 3] = ["anna", "ben", "chiyo"];
    let set = features();
    let mut words = [Vec::new(), Vec::new()];
    for recording in plan().iter().filter(|r| r.class() == Some(class)) {
        let motion = recording.clip(SEED).unwrap().motion;
        let names: Vec<&str> = motion.skeleton.names().collect();
        let map = BodyMap::recognise(&names).unwrap();
        let positions = forward_kinematics(&motion);
        let of_clip = extract(&set, positions.view(), &map, motion.rate.hz(), RATE).unwrap();
        let is_test = !LEARNED_FROM.contains(&recording.performer().name);
        words[usize::from(is_test)].push(of_clip.words);
    }
    assert!(words.iter().all(|part| !part.is_empty()));
    words
}

fn template(clips: &[Vec<u64>]) -> MotionTemplate {
    let n_features = features().features().len();
    let motions = clips
        .iter()
        .map(|words| MotionTemplate::from_words(words, n_features));
    let motions: Vec<MotionTemplate> = motions.collect::<Result<_, _>>().unwrap();
    learn(&motions, &LearnConfig::default()).unwrap().template
}

fn mirrored(template: &MotionTemplate) -> MotionTemplate {
    let set = features();
    let permutation: Vec<usize> = set.features().iter().map(|f| f.mirror).collect();
    template.mirrored(&permutation).unwrap()
}

fn quantized(template: &MotionTemplate) -> QuantizedTemplate {
    template.quantize(DELTA).unwrap()
}

/// How many of the clips have a hit.
fn n_found(template: &MotionTemplate, clips: &[Vec<u64>]) -> usize {
    let template = quantized(template);
    let config = MatchConfig::up_to(TAU);
    let found = clips
        .iter()
        .filter(|words| !template.find_matches(words, &config).is_empty());
    found.count()
}

/// The least cost in each clip; clips that are too short are left out.
fn costs(template: &MotionTemplate, clips: &[Vec<u64>]) -> Vec<f64> {
    let template = quantized(template);
    let least = |words: &Vec<u64>| {
        template
            .distance_curve(words)
            .costs()
            .flatten()
            .min_by(f64::total_cmp)
    };
    clips.iter().filter_map(least).collect()
}

#[test]
fn a_mirrored_template_finds_the_other_side() {
    let [learned_from, left] = corpus(Class::KickLeft);
    let [_, right] = corpus(Class::KickRight);
    let of_left = template(&learned_from);
    let of_right = mirrored(&of_left);
    println!(
        "left {:?} {:?}",
        costs(&of_left, &left),
        costs(&of_left, &right)
    );
    println!(
        "right {:?} {:?}",
        costs(&of_right, &left),
        costs(&of_right, &right)
    );
    assert_eq!(
        [n_found(&of_left, &left), n_found(&of_left, &right)],
        [left.len(), 0]
    );
    assert_eq!(
        [n_found(&of_right, &left), n_found(&of_right, &right)],
        [0, right.len()]
    );
}

#[test]
fn a_combined_template_loses_the_direction() {
    let [learned_forward, forward] = corpus(Class::RotateArmsForward);
    let [learned_backward, backward] = corpus(Class::RotateArmsBackward);
    let of_forward = template(&learned_forward);
    let of_backward = template(&learned_backward);
    let of_both = template(&[learned_forward, learned_backward].concat());
    for one in [&of_forward, &of_backward, &of_both] {
        println!("{:?} {:?}", costs(one, &forward), costs(one, &backward));
    }
    let found = |template| [n_found(template, &forward), n_found(template, &backward)];
    assert_eq!(found(&of_forward), [forward.len(), 0]);
    assert_eq!(found(&of_backward), [0, backward.len()]);
    assert_eq!(found(&of_both), [forward.len(), backward.len()]);
}

#[test]
fn real_left_kicks_mirrored_are_right_kicks() {
    let Some(data) = data() else { return };
    let mut folders = Folders::find(&data.join("hdm05")).unwrap();
    let kick = folders
        .classes
        .iter()
        .position(|class| class == "kickLFront1Reps")
        .unwrap();
    folders.files.retain(|file| file.class == kick);
    let set = features();
    let reading = Reading {
        options: &ReadOptions::default(),
        set: &set,
        rate: RATE,
        poses: PosesKept::No,
    };
    let (clips, skipped) = read(&folders, &reading, Voice::default());
    assert!(skipped.is_empty(), "{skipped:?}");
    let left: Vec<Vec<u64>> = clips.into_iter().map(|clip| clip.words).collect();
    let of_left = template(&left);
    let of_right = mirrored(&of_left);
    let demo = [Class::KickLeft, Class::KickRight].map(|class| corpus(class).concat());
    println!("HDM05, left kicks: {:?}", costs(&of_right, &left));
    println!("demo, left kicks: {:?}", costs(&of_right, &demo[0]));
    println!("demo, right kicks: {:?}", costs(&of_right, &demo[1]));
    assert_eq!(n_found(&of_right, &left), 0);
    assert!(2 * n_found(&of_right, &demo[1]) > demo[1].len());
    // The demo's kicks are drawn and not recorded, so they cost more; but the side decides.
    let dearest = costs(&of_right, &demo[1]).into_iter().fold(0.0, f64::max);
    let lefts = [&left[..], &demo[0][..]].concat();
    let cheapest = costs(&of_right, &lefts)
        .into_iter()
        .fold(f64::INFINITY, f64::min);
    assert!(dearest < cheapest, "{dearest} {cheapest}");
}
