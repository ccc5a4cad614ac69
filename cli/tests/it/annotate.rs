//! `motif annotate`: templates learned from single clips label the long takes.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::OnceLock;

use cli::corpus::Class;
use cli::corpus_files::ClipFile;
use cli::library::NamedSet;
use cli::recording::ReadOptions;
use cli::selection;
use cli::source::ClipRef;
use cli::templates;
use cli::wire::clip_words;
use mtemplate::{ClassTemplate, LearnConfig, MotionTemplate, learn};
use serde_json::Value;
use tempfile::TempDir;

use crate::command::{motif, text};
use crate::corpus::Fixture;

/// Classes that are unlike each other.
const CLASSES: [Class; 4] = [
    Class::Squat,
    Class::KickLeft,
    Class::JumpingJack,
    Class::LieDown,
];

const SET: &str = "mueller2006";
const RATE: f64 = 30.0;

fn words(path: &Path) -> Vec<u64> {
    let set = NamedSet::find(SET).unwrap().set;
    let clip = ClipRef {
        path: path.to_owned(),
        span: None,
    };
    let words = clip_words(&clip, &ReadOptions::default(), &set, RATE).unwrap();
    words.words
}

/// What the single clips of a class have in common.
fn learned(files: &[ClipFile], class: Class) -> ClassTemplate {
    let set = NamedSet::find(SET).unwrap().set;
    let features = selection::names(&set, set.all());
    let clips = files.iter().filter(|file| file.class == Some(class));
    let motions: Vec<MotionTemplate> = clips
        .map(|file| MotionTemplate::from_words(&words(&file.path), features.len()).unwrap())
        .collect();
    let learned = learn(&motions, &LearnConfig::default()).unwrap();
    ClassTemplate {
        name: class.to_string(),
        feature_set: SET.to_owned(),
        rate: RATE,
        features,
        n_motions: Some(motions.len()),
        template: learned.template,
        tau: None,
        keyframes: Vec::new(),
    }
}

/// A folder with a template for each of [`CLASSES`].
fn templates_folder() -> &'static Path {
    static FOLDER: OnceLock<TempDir> = OnceLock::new();
    let folder = FOLDER.get_or_init(|| {
        let dir = tempfile::tempdir().unwrap();
        for class in CLASSES {
            let path = dir.path().join(format!("{class}.mtpl"));
            templates::save(&learned(&Fixture::get().files, class), &path).unwrap();
        }
        dir
    });
    folder.path()
}

fn takes() -> Vec<&'static ClipFile> {
    let files = Fixture::get().files.iter();
    files.filter(|file| file.class.is_none()).collect()
}

fn bvh_take() -> &'static ClipFile {
    let is_bvh = |take: &&ClipFile| take.path.extension().is_some_and(|e| e == "bvh");
    takes().into_iter().find(is_bvh).unwrap()
}

fn annotate(path: &Path, more: &[&str]) -> Value {
    let args = [
        "annotate",
        "--json",
        text(path),
        "--templates",
        text(templates_folder()),
    ];
    let run = motif(&[&args, more].concat());
    assert_eq!(run.code, 0, "{run:?}");
    run.json()["result"][0].clone()
}

fn frames(span: &Value) -> std::ops::Range<u64> {
    span["start"].as_u64().unwrap()..span["end"].as_u64().unwrap()
}

fn shared(a: &std::ops::Range<u64>, b: &std::ops::Range<u64>) -> u64 {
    a.end.min(b.end).saturating_sub(a.start.max(b.start))
}

#[test]
fn takes_are_labelled_where_the_classes_are_performed() {
    for take in takes() {
        // At 0.06 one pair of arm circles passes for a jumping jack.
        let found = annotate(&take.path, &["--tau", "0.04"]);
        let spans = found["spans"].as_array().unwrap();
        for class in CLASSES {
            let performed: Vec<_> = take
                .labels
                .iter()
                .filter(|label| label.class == class)
                .collect();
            let named = |span: &&Value| span["label"] == class.to_string();
            let found: Vec<&Value> = spans.iter().filter(named).collect();
            assert_eq!(
                found.len(),
                performed.len(),
                "{class} in {}: {found:?}",
                take.path.display()
            );
            for label in performed {
                let label = label.span.start as u64..label.span.end as u64;
                let is_half =
                    |span: &&Value| 2 * shared(&frames(span), &label) >= label.end - label.start;
                assert!(
                    found.iter().any(is_half),
                    "{class} at {label:?} in {}: {found:?}",
                    take.path.display()
                );
            }
        }
    }
}

#[test]
fn exclusive_spans_do_not_overlap() {
    let take = takes()[0];
    // At this threshold almost everything matches.
    let all = annotate(&take.path, &["--tau", "0.3"]);
    let one = annotate(&take.path, &["--tau", "0.3", "--exclusive"]);
    let spans = |found: &Value| found["spans"].as_array().unwrap().clone();
    let overlaps = |spans: &[Value]| {
        spans
            .windows(2)
            .any(|two| frames(&two[0]).end > frames(&two[1]).start)
    };
    assert!(overlaps(&spans(&all)));
    assert!(!overlaps(&spans(&one)));
    let covered = |spans: Vec<Value>| {
        let frames: std::collections::BTreeSet<u64> = spans.iter().flat_map(frames).collect();
        frames.len()
    };
    assert_eq!(covered(spans(&all)), covered(spans(&one)));
}

#[test]
fn spans_are_written_as_csv_json_and_eaf() {
    let dir = tempfile::tempdir().unwrap();
    let take = bvh_take();
    let spans = annotate(&take.path, &[])["spans"].clone();
    let n_spans = spans.as_array().unwrap().len();
    let file = |name: &str| dir.path().join(name);
    for name in ["spans.csv", "spans.json", "spans.eaf"] {
        let out = file(name);
        let args = [
            "annotate",
            text(&take.path),
            "--templates",
            text(templates_folder()),
            "-o",
            text(&out),
        ];
        assert_eq!(motif(&args).code, 0);
    }
    let csv = fs::read_to_string(file("spans.csv")).unwrap();
    assert_eq!(
        csv.lines().next(),
        Some("clip,label,start,end,start_s,end_s,cost")
    );
    assert_eq!(csv.lines().count(), 1 + n_spans);
    let json: Value =
        serde_json::from_str(&fs::read_to_string(file("spans.json")).unwrap()).unwrap();
    assert_eq!(json[0]["spans"], spans);
    let eaf = fs::read_to_string(file("spans.eaf")).unwrap();
    assert_eq!(eaf.matches("<ALIGNABLE_ANNOTATION").count(), n_spans);
    let first = (spans[0]["start_s"].as_f64().unwrap() * 1000.0).round();
    assert!(eaf.contains(&format!("TIME_VALUE=\"{first}\"")), "{eaf}");

    let folder = format!("{}/", text(&file("each")));
    let anna = Fixture::get().corpus().join("anna");
    let args = [
        "annotate",
        text(&anna),
        "--templates",
        text(templates_folder()),
    ];
    let run = motif(&[&args[..], &["-o", &folder, "--format", "eaf"]].concat());
    assert_eq!(run.code, 0, "{run:?}");
    assert!(file("each/take_01.amc.eaf").exists(), "{run:?}");
    let run = motif(&[&args[..], &["-o", text(&file("all.eaf"))]].concat());
    assert_eq!(run.code, 2);
    assert!(run.stderr.contains("can hold one clip"), "{run:?}");
}

/// Runs `annotate --stream` with `input`, in JSON lines.
fn stream(input: &[u8], more: &[&str]) -> (Option<i32>, Vec<Value>, String) {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("motif"));
    command.args([
        "annotate",
        "--stream",
        "--json",
        "--templates",
        text(templates_folder()),
    ]);
    let mut child = command
        .args(more)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // A child that has read enough closes its end.
    let _ = child.stdin.take().unwrap().write_all(input);
    let output = child.wait_with_output().unwrap();
    let lines = String::from_utf8(output.stdout).unwrap();
    let spans = lines
        .lines()
        .map(|line| serde_json::from_str(line).unwrap());
    (
        output.status.code(),
        spans.collect(),
        String::from_utf8(output.stderr).unwrap(),
    )
}

fn by_frames(mut spans: Vec<Value>) -> Vec<Value> {
    spans.sort_by_key(|span| {
        (
            frames(span).start,
            frames(span).end,
            span["label"].to_string(),
        )
    });
    spans
}

#[test]
fn streamed_frames_are_labelled_as_the_file_is() {
    let dir = tempfile::tempdir().unwrap();
    let take = bvh_take();
    let whole = by_frames(
        annotate(&take.path, &[])["spans"]
            .as_array()
            .unwrap()
            .clone(),
    );
    assert!(!whole.is_empty());
    let (code, spans, errors) = stream(&fs::read(&take.path).unwrap(), &[]);
    assert_eq!(
        (code, by_frames(spans)),
        (Some(0), whole.clone()),
        "{errors}"
    );

    let csv: PathBuf = dir.path().join("take.csv");
    assert_eq!(motif(&["convert", text(&take.path), text(&csv)]).code, 0);
    let (code, spans, errors) = stream(&fs::read(&csv).unwrap(), &[]);
    assert_eq!((code, by_frames(spans)), (Some(0), whole), "{errors}");

    let lines: String = words(&take.path)
        .iter()
        .map(|word| format!("{word:#x}\n"))
        .collect();
    let (code, spans, errors) = stream(lines.as_bytes(), &[]);
    assert_eq!(code, Some(0), "{errors}");
    // Without frames, the frames are the words.
    let costs = |spans: &[Value]| {
        spans
            .iter()
            .map(|s| s["cost"].to_string())
            .collect::<Vec<_>>()
    };
    let again = stream(&fs::read(&csv).unwrap(), &[]).1;
    assert_eq!(costs(&spans), costs(&again));
}

#[test]
fn what_a_stream_cannot_be_is_said_with_its_line() {
    let check = |input: &str, code: i32, message: &str| {
        let (found, _, errors) = stream(input.as_bytes(), &[]);
        assert_eq!(found, Some(code), "{errors}");
        assert!(errors.contains(message), "{errors}");
    };
    check("", 3, "expected frames or words, found the end");
    check(
        "0x1\n0x2\nfour\n",
        3,
        "expected a word such as 0x2f, found \"four\"",
    );
    check(
        "frame,time_s\n",
        3,
        "line 1: expected HIERARCHY, a header with columns such as root_x",
    );
    check(
        "hip_x,hip_y,hip_z\n0,0,0\n",
        3,
        "expected a column time_s, or --source-rate",
    );
    check(
        "HIERARCHY\nROOT Hips\n",
        3,
        "expected \"Frame Time:\", found the end",
    );
    check(
        "time_s,a_x,a_y,a_z\n0,0,0,0\n0.1,1,1,1\n",
        3,
        "no known rig has these names: a",
    );
}

#[test]
fn templates_that_cannot_be_used_are_said() {
    let dir = tempfile::tempdir().unwrap();
    let take = bvh_take();
    let empty = [
        "annotate",
        text(&take.path),
        "--templates",
        text(dir.path()),
    ];
    let run = motif(&empty);
    assert_eq!(run.code, 2);
    assert!(run.stderr.contains("expected templates"), "{run:?}");
    let args = [
        "annotate",
        text(&take.path),
        "--templates",
        text(templates_folder()),
        "--tau",
        "auto",
    ];
    let run = motif(&args);
    assert_eq!(run.code, 2);
    assert!(run.stderr.contains("has no threshold"), "{run:?}");
}
