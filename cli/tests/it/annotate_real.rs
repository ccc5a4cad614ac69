//! Templates of one database label another, and templates of one take label others, checked against
//! the labels that Fox, Hughes, Sudderth and Jordan (2014) gave three takes of CMU's subject 13.

use std::ops::Range;
use std::path::{Path, PathBuf};

use cli::annotation::Labeller;
use cli::library::NamedSet;
use cli::recording::ReadOptions;
use cli::selection;
use cli::source::{ClipRef, Span, find_clips};
use cli::take::Take;
use cli::wire::clip_words;
use mtemplate::{ClassTemplate, LearnConfig, MotionTemplate, learn};
use relfeat::FeatureSet;

use crate::real::data;

const SET: &str = "mueller2006";
const RATE: f64 = 30.0;
/// δ and τ of the paper's experiments (2006, sections 5.2 and 5.4).
const DELTA: f64 = 0.1;
const TAU: f64 = 0.06;

fn set() -> FeatureSet {
    NamedSet::find(SET).unwrap().set
}

fn class(name: &str, clips: &[ClipRef], mirrored: bool) -> ClassTemplate {
    let set = set();
    let features = selection::names(&set, set.all());
    let motions: Vec<MotionTemplate> = clips
        .iter()
        .map(|clip| {
            let words = clip_words(clip, &ReadOptions::default(), &set, RATE).unwrap();
            MotionTemplate::from_words(&words.words, features.len()).unwrap()
        })
        .collect();
    let template = learn(&motions, &LearnConfig::default()).unwrap().template;
    let template = match mirrored {
        true => {
            let features = set.features().iter();
            let mirror: Vec<usize> = features.map(|feature| feature.mirror).collect();
            template.mirrored(&mirror).unwrap()
        }
        false => template,
    };
    ClassTemplate {
        name: name.to_owned(),
        feature_set: SET.to_owned(),
        rate: RATE,
        features,
        template,
        n_motions: Some(motions.len()),
        tau: None,
        keyframes: Vec::new(),
    }
}

/// Rows of the label file: action and frames (0-based, end exclusive) of a trial.
fn labels(data: &Path, trial: &str) -> Vec<(String, Range<usize>)> {
    let mut csv = csv::Reader::from_path(data.join("labels/mocap6-subject13.csv")).unwrap();
    let rows = csv.records().map(Result::unwrap);
    let of_trial = rows.filter(|row| &row[0] == trial);
    of_trial
        .map(|row| {
            let frame = |i: usize| row[i].parse::<usize>().unwrap();
            (row[3].to_owned(), frame(1) - 1..frame(2))
        })
        .collect()
}

fn trial(data: &Path, name: &str) -> PathBuf {
    data.join("cmu/13").join(format!("{name}.amc"))
}

fn whole(path: PathBuf) -> ClipRef {
    ClipRef { path, span: None }
}

/// Frames of each span of a template in a trial.
fn spans(data: &Path, templates: Vec<ClassTemplate>, name: &str) -> Vec<Range<usize>> {
    let with_tau: Vec<_> = templates.into_iter().map(|t| (t, TAU)).collect();
    let labeller = Labeller::new(&with_tau, DELTA, None).unwrap();
    let take = Take::load(&whole(trial(data, name)), &ReadOptions::default()).unwrap();
    let found = labeller.annotate(&take).unwrap();
    found.spans.into_iter().map(|span| span.frames).collect()
}

/// Frames that are labelled rightly, wrongly, and not at all though they should be; an activity that
/// no span touches is a failure, as is a span that lies outside the activity by half.
#[track_caller]
fn check(activity: &str, trial: &str, labels: &[(String, Range<usize>)], spans: &[Range<usize>]) {
    let is_labelled = |frame: usize| {
        labels
            .iter()
            .any(|(name, span)| name == activity && span.contains(&frame))
    };
    let n_frames = labels.last().unwrap().1.end;
    let is_spanned = |frame: usize| spans.iter().any(|span| span.contains(&frame));
    let count = |labelled, spanned| {
        let frames = 0..n_frames;
        frames
            .filter(|&f| is_labelled(f) == labelled && is_spanned(f) == spanned)
            .count()
    };
    println!(
        "{activity:16} in {trial}: {} spans, {} frames right, {} wrong, {} missed of {n_frames}: {spans:?}",
        spans.len(),
        count(true, true),
        count(false, true),
        count(true, false),
    );
    for (name, span) in labels.iter().filter(|(name, _)| name == activity) {
        let touches = |found: &Range<usize>| found.start < span.end && span.start < found.end;
        assert!(
            spans.iter().any(touches),
            "{trial}: {name} at {span:?} is not found"
        );
    }
    for span in spans {
        let within = span.clone().filter(|&frame| is_labelled(frame)).count();
        assert!(
            2 * within > span.len(),
            "{trial}: {span:?} is no {activity}"
        );
    }
}

/// What a squat is about: legs, spine and height. In 13_29 and 13_30 the hands are held up, which no
/// squat of HDM05 does.
const LEGS_AND_TRUNK: [&str; 16] = [
    "F15", "F16", "F17", "F18", "F19", "F20", "F21", "F22", "F23", "F24", "F25", "F26", "F29",
    "F30", "F32", "F37",
];

#[test]
fn real_squats_of_hdm05_label_those_of_cmu() {
    let Some(data) = data() else { return };
    let clips = find_clips(&[data.join("hdm05/squat1Reps")]).unwrap();
    let squat = class("squat", &clips, false);
    let features = selection::select(&set(), &LEGS_AND_TRUNK.map(str::to_owned)).unwrap();
    let legs = squat
        .restricted(features, 0..squat.template.n_columns())
        .unwrap();
    for name in ["13_29", "13_30"] {
        let spans = spans(&data, vec![legs.clone()], name);
        check("Squat", name, &labels(&data, name), &spans);
        // Two each, as one sees them.
        assert_eq!(spans.len(), 2);
    }
}

/// Repetitions in 13_29, in source frames, as they show in its feature matrix; those of the left side
/// are looked for mirrored as well.
const REPETITIONS: [(&str, &[Range<usize>]); 4] = [
    ("Twist", &[500..680, 940..1140]),
    ("KneeRaise", &[2800..2980, 3120..3310, 3440..3650]),
    ("ArmCircle", &[1212..1340, 1340..1480, 1480..1660]),
    ("ToeTouchOneHand", &[1960..2190, 2420..2640]),
];

#[test]
fn real_exercises_of_one_take_are_found_in_others() {
    let Some(data) = data() else { return };
    for (activity, repetitions) in REPETITIONS {
        let clip = |span: &Range<usize>| ClipRef {
            path: trial(&data, "13_29"),
            span: Some(Span {
                start: span.start,
                end: span.end,
            }),
        };
        let clips: Vec<ClipRef> = repetitions.iter().map(clip).collect();
        let templates = || [false, true].map(|mirrored| class(activity, &clips, mirrored));
        for name in ["13_30", "13_31"] {
            check(
                activity,
                name,
                &labels(&data, name),
                &spans(&data, templates().to_vec(), name),
            );
        }
    }
}
