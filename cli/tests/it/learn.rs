//! Templates learned from the built-in corpus and from real recordings.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use cli::corpus::Class;
use cli::templates::{load, load_all};
use mtemplate::{ANY, ClassTemplate};
use serde_json::Value;
use tempfile::TempDir;

use crate::command::{incomplete_rig, motif, text};
use crate::corpus::Fixture;
use crate::real::data;
use crate::templates::row;

/// Classes of the built-in corpus in folders, one clip of each performer, and templates of them.
pub(crate) struct Learned {
    pub(crate) dir: TempDir,
    json: Value,
}

const CLASSES: [(&str, Class); 5] = [
    ("arms/backward", Class::RotateArmsBackward),
    ("arms/forward", Class::RotateArmsForward),
    ("kick_left", Class::KickLeft),
    ("kick_right", Class::KickRight),
    ("squat", Class::Squat),
];
pub(crate) const PERFORMERS: [&str; 4] = ["anna", "ben", "chiyo", "eva"];

impl Learned {
    pub(crate) fn get() -> &'static Learned {
        static LEARNED: OnceLock<Learned> = OnceLock::new();
        LEARNED.get_or_init(|| {
            let dir = tempfile::tempdir().unwrap();
            let training = dir.path().join("training");
            for (folder, class) in CLASSES {
                for performer in PERFORMERS {
                    copy_clip(performer, class, &training.join(folder));
                }
            }
            let templates = dir.path().join("templates");
            let run = motif(&[
                "learn",
                "--json",
                "--by-folder",
                text(&training),
                "-o",
                text(&templates),
            ]);
            assert_eq!(run.code, 0, "{run:?}");
            let json = run.json();
            Learned { dir, json }
        })
    }

    pub(crate) fn clips(&self, folder: &str) -> PathBuf {
        self.dir.path().join("training").join(folder)
    }

    pub(crate) fn file(&self, folder: &str) -> PathBuf {
        self.dir
            .path()
            .join("templates")
            .join(format!("{folder}.mtpl"))
    }

    pub(crate) fn template(&self, folder: &str) -> ClassTemplate {
        load(&self.file(folder)).unwrap()
    }
}

/// Copies a clip, and its skeleton if that is a file of its own.
fn copy_clip(performer: &str, class: Class, folder: &Path) {
    fs::create_dir_all(folder).unwrap();
    let clip = Fixture::get().clip(performer, class);
    let name = clip.file_name().unwrap().to_str().unwrap();
    fs::copy(&clip, folder.join(format!("{performer}_{name}"))).unwrap();
    let skeleton = format!("{performer}.asf");
    let from = clip.with_file_name(&skeleton);
    if from.exists() {
        fs::copy(from, folder.join(skeleton)).unwrap();
    }
}

/// Sums of weights over a few iterations are off by this much at most.
const SUM_TOL: f64 = 1e-6;

#[test]
fn a_template_for_each_folder_as_long_as_its_motions_are_on_average() {
    let learned = Learned::get();
    let json = &learned.json;
    assert_eq!(json["command"], "learn");
    assert_eq!(json["skipped"], Value::Array(Vec::new()));
    let classes = json["result"].as_array().unwrap();
    let names: Vec<&str> = classes
        .iter()
        .map(|c| c["name"].as_str().unwrap())
        .collect();
    assert_eq!(names, CLASSES.map(|(name, _)| name));
    for class in classes {
        let template = load(Path::new(class["file"].as_str().unwrap())).unwrap();
        assert_eq!(class["n_motions"], PERFORMERS.len());
        assert_eq!(template.n_motions, Some(PERFORMERS.len()));
        assert_eq!(
            (template.feature_set.as_str(), template.rate),
            ("mueller2006", 30.0)
        );
        // The exact unwarp preserves the total weight: spec.md c.6.
        let mean = class["mean_length"].as_f64().unwrap();
        let columns = template.template.n_columns();
        assert_eq!(class["columns"], columns);
        assert_eq!(columns as f64, (mean - SUM_TOL).ceil(), "{class}");
        assert!(
            (template.template.weights().sum() - mean).abs() <= SUM_TOL,
            "{class}"
        );
        assert!((1..=10).contains(&class["iterations"].as_u64().unwrap()));
    }
    let paths = [learned.dir.path().join("templates")];
    let all = load_all(&paths).unwrap();
    assert_eq!(all.len(), CLASSES.len());
}

#[test]
fn a_squat_bends_both_knees_and_stands_up_again() {
    let squat = Learned::get().template("squat");
    for knee in ["rknee_bent", "lknee_bent"] {
        let row = row(&squat, knee);
        assert_eq!((row[0], row[row.len() - 1]), (0.0, 0.0), "{knee}");
        assert!(row.contains(&1.0), "{knee}: {row:?}");
    }
}

#[test]
fn one_motion_is_its_feature_matrix_and_a_span_is_a_part_of_it() {
    let dir = tempfile::tempdir().unwrap();
    let clip = Fixture::get().clip("eva", Class::Squat);
    let file = dir.path().join("one.mtpl");
    for (example, file) in [
        (text(&clip).to_owned(), file.clone()),
        (
            format!("{}@20-80", text(&clip)),
            dir.path().join("part.mtpb"),
        ),
    ] {
        let run = motif(&[
            "learn",
            "--json",
            &example,
            "-o",
            text(&file),
            "--name",
            "a squat",
        ]);
        assert_eq!(run.code, 0, "{run:?}");
        let features = motif(&["features", "--json", &example]).json();
        let words = features["result"][0]["words"].as_array().unwrap();
        let template = load(&file).unwrap();
        assert_eq!(template.name, "a squat");
        assert_eq!(template.template.n_columns(), words.len());
        for (column, word) in words.iter().enumerate() {
            let word = word.as_str().unwrap().trim_start_matches("0x");
            let word = u64::from_str_radix(word, 16).unwrap();
            for feature in 0..39 {
                let expected = if word >> feature & 1 == 1 { 1.0 } else { 0.0 };
                assert_eq!(template.template.values()[[column, feature]], expected);
            }
        }
    }
}

#[test]
fn learning_does_not_depend_on_the_number_of_threads() {
    let learned = Learned::get();
    let dir = tempfile::tempdir().unwrap();
    let mut files = Vec::new();
    for threads in ["1", "3"] {
        let file = dir.path().join(format!("{threads}.mtpl"));
        let clips = learned.clips("squat");
        let run = motif(&[
            "learn",
            "--threads",
            threads,
            text(&clips),
            "-o",
            text(&file),
            "--name",
            "squat",
            "--unwarp",
            "balance",
        ]);
        assert_eq!(run.code, 0, "{run:?}");
        files.push(fs::read(file).unwrap());
    }
    assert_eq!(files[0], files[1]);
    assert_ne!(files[0], fs::read(learned.file("squat")).unwrap());
}

#[test]
fn broken_files_are_left_out_and_named() {
    let dir = tempfile::tempdir().unwrap();
    let training = dir.path().join("training");
    copy_clip("eva", Class::Squat, &training.join("squat"));
    let broken = training.join("squat/broken.bvh");
    fs::write(&broken, "HIERARCHY\nROT Hips\n").unwrap();
    fs::create_dir_all(training.join("bad")).unwrap();
    fs::copy(&broken, training.join("bad/broken.bvh")).unwrap();
    let out = dir.path().join("templates");
    let args = [
        "learn",
        "--json",
        "--by-folder",
        text(&training),
        "-o",
        text(&out),
    ];
    let run = motif(&args);
    assert_eq!(run.code, 0, "{run:?}");
    let json = run.json();
    assert_eq!(json["skipped"].as_array().unwrap().len(), 2);
    assert_eq!(
        (&json["skipped"][0]["line"], &json["skipped"][0]["column"]),
        (&2.into(), &1.into())
    );
    // A folder without a clip that can be read has no template.
    assert_eq!(json["result"].as_array().unwrap().len(), 1);
    assert_eq!(json["result"][0]["n_motions"], 1);
    assert!(!out.join("bad.mtpl").exists());
    assert_eq!(motif(&[&args[..], &["--strict"]].concat()).code, 3);
    let run = motif(&["learn", text(&broken), "-o", text(&out.join("none.mtpl"))]);
    assert_eq!(run.code, 3, "{run:?}");
}

#[test]
fn features_that_a_rig_lacks_do_not_matter() {
    let dir = tempfile::tempdir().unwrap();
    let folder = dir.path().join("squat");
    copy_clip("eva", Class::Squat, &folder);
    fs::write(folder.join("legs.bvh"), incomplete_rig()).unwrap();
    let out = dir.path().join("squat.mtpl");
    let run = motif(&["learn", "--json", text(&folder), "-o", text(&out)]);
    assert_eq!(run.code, 0, "{run:?}");
    let legs = motif(&["features", "--json", text(&folder.join("legs.bvh"))]).json();
    let unavailable = &run.json()["result"][0]["unavailable"];
    assert_eq!(unavailable, &legs["result"][0]["unavailable"]);
    let unavailable: Vec<String> = serde_json::from_value(unavailable.clone()).unwrap();
    assert!(unavailable.contains(&"rknee_bent".to_owned()));
    let squat = load(&out).unwrap();
    for name in &squat.features {
        let matters = row(&squat, name).iter().any(|&value| value != ANY);
        assert_eq!(matters, !unavailable.contains(name), "{name}");
    }
}

#[test]
fn real_recordings_of_a_class_become_a_template() {
    let Some(data) = data() else { return };
    let folder = data.join("hdm05/squat1Reps");
    let mut clips: Vec<PathBuf> = fs::read_dir(&folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| {
            path.extension()
                .is_some_and(|e| e.eq_ignore_ascii_case("amc"))
        })
        .collect();
    clips.sort();
    clips.truncate(5);
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("squat.mtpl");
    let clips: Vec<&str> = clips.iter().map(|path| text(path)).collect();
    let run = motif(&[&["learn", "--json", "-o", text(&out)], &clips[..]].concat());
    assert_eq!(run.code, 0, "{run:?}");
    let class = &run.json()["result"][0];
    println!("{class}");
    assert_eq!(class["n_motions"], 5);
    let mean = class["mean_length"].as_f64().unwrap();
    assert_eq!(class["columns"].as_f64(), Some((mean - SUM_TOL).ceil()));
    let squat = load(&out).unwrap();
    assert!(row(&squat, "rknee_bent").contains(&1.0) && row(&squat, "lknee_bent").contains(&1.0));
}

#[test]
fn thresholds_and_keyframes_are_learned_from_what_is_something_else() {
    let learned = Learned::get();
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("kick.mtpl");
    let (kicks, squats) = (learned.clips("kick_left"), learned.clips("squat"));
    let args = [
        "learn",
        "--json",
        text(&kicks),
        "-o",
        text(&file),
        "--tau",
        "auto",
        "--keyframes",
    ];
    let run = motif(&args);
    assert_eq!(run.code, 2);
    assert!(run.stderr.contains("--negatives"), "{run:?}");

    let other = learned.clips("kick_right");
    let negatives = ["--negatives", text(&squats), text(&other)];
    let run = motif(&[&args[..], &negatives].concat());
    assert_eq!(run.code, 0, "{run:?}");
    let template = load(&file).unwrap();
    let tau = template.tau.unwrap();
    assert_eq!(run.json()["result"][0]["tau"], tau);
    assert!(!template.keyframes.is_empty());

    // The threshold lets the left kicks in and keeps the others out.
    let found = |clips: &Path| {
        let args = [
            "annotate",
            "--json",
            text(clips),
            "--templates",
            text(&file),
            "--tau",
            "auto",
        ];
        let result = motif(&args).json()["result"].clone();
        let clips = result.as_array().unwrap().iter();
        clips
            .filter(|clip| !clip["spans"].as_array().unwrap().is_empty())
            .count()
    };
    assert_eq!(found(&kicks), PERFORMERS.len());
    assert_eq!([found(&squats), found(&other)], [0, 0]);

    let run = motif(&["learn", text(&kicks), "-o", text(&file), "--tau", "0.04"]);
    assert_eq!(run.code, 0, "{run:?}");
    assert_eq!(load(&file).unwrap().tau, Some(0.04));
}
