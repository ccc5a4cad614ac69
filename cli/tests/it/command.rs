//! The command as a user runs it.

use std::fs;
use std::path::Path;

use assert_cmd::Command;
use cli::corpus::Class;
use serde_json::Value;

use crate::corpus::Fixture;

pub(crate) fn motif(args: &[&str]) -> Output {
    let output = Command::cargo_bin("motif")
        .unwrap()
        .args(args)
        .output()
        .unwrap();
    Output {
        code: output.status.code().unwrap(),
        stdout: String::from_utf8(output.stdout).unwrap(),
        stderr: String::from_utf8(output.stderr).unwrap(),
    }
}

#[derive(Debug)]
pub(crate) struct Output {
    pub(crate) code: i32,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Output {
    #[track_caller]
    pub(crate) fn json(&self) -> Value {
        let document: Value = serde_json::from_str(&self.stdout).unwrap();
        assert_eq!(document["motif"], env!("CARGO_PKG_VERSION"));
        document
    }
}

pub(crate) fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

pub(crate) const GOOD: &str = "HIERARCHY\nROOT Hips\n{\n OFFSET 0 0 0\n CHANNELS 3 Xrotation Yrotation Zrotation\n \
    JOINT LeftUpLeg\n {\n  OFFSET 10 0 0\n  CHANNELS 0\n  End Site\n  {\n   OFFSET 0 -90 0\n  }\n }\n}\n\
    MOTION\nFrames: 2\nFrame Time: 0.0333333\n0 0 0\n1 2 3\n";

#[test]
fn demo_tells_what_it_made_and_found() {
    let dir = tempfile::tempdir().unwrap();
    let target = dir.path().join("demo");
    let run = motif(&["demo", "--dir", text(&target)]);
    assert_eq!(run.code, 0, "{run:?}");
    for needle in [
        "225 single clips",
        "squat_01.amc",
        "Try next:",
        "no other motion",
    ] {
        assert!(
            run.stdout.contains(needle),
            "{needle} is not in\n{}",
            run.stdout
        );
    }
    for picture in ["strips.png", "features.png"] {
        let bytes = fs::read(target.join(picture)).unwrap();
        assert!(bytes.starts_with(b"\x89PNG"), "{picture}");
    }
    let again = motif(&["demo", "--dir", text(&target), "--json"]);
    assert_eq!(again.code, 0, "an earlier demo is replaced: {again:?}");
    let result = &again.json()["result"];
    assert_eq!(result["index"]["replaced"], 0);
    assert_eq!(result["searches"].as_array().unwrap().len(), 3);
}

#[test]
fn demo_leaves_foreign_folders_alone() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("thesis.txt"), "mine").unwrap();
    let run = motif(&["demo", "--dir", text(dir.path())]);
    assert_eq!(run.code, 2, "{run:?}");
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 1);
}

#[test]
fn search_gives_hits_as_laid_down() {
    let fixture = Fixture::get();
    let example = fixture.clip("anna", Class::Squat);
    let library = fixture.library();
    let args = [
        "search",
        text(&library),
        "--example",
        text(&example),
        "--features",
        "F20,F21",
        "vertical_extent_small",
    ];
    let run = motif(&[&args[..], &["--json", "--top", "3"]].concat());
    assert_eq!(run.code, 0, "{run:?}");
    let document = run.json();
    assert_eq!(document["command"], "search");
    assert_eq!(document["skipped"], Value::Array(Vec::new()));
    let result = &document["result"];
    assert_eq!(result["query"]["features"].as_array().unwrap().len(), 3);
    let hits = result["hits"].as_array().unwrap();
    assert_eq!(hits.len(), 3);
    assert!(result["n_hits"].as_u64().unwrap() > 3);
    let best = &hits[0];
    assert_eq!(best["clip"], text(&example));
    assert_eq!(
        (best["rank"].as_u64(), best["cost"].as_u64()),
        (Some(1), Some(0))
    );
    let (start, end) = (
        best["start"].as_f64().unwrap(),
        best["end"].as_f64().unwrap(),
    );
    assert_eq!(best["start_s"].as_f64().unwrap(), start / 120.0);
    assert_eq!(best["end_s"].as_f64().unwrap(), end / 120.0);
    let segments = best["segments"].as_array().unwrap();
    assert_eq!(
        segments.len(),
        result["query"]["segments"].as_array().unwrap().len()
    );
    let run = motif(&args);
    assert!(
        run.stdout.contains("rank") && run.stdout.contains("squat_01.amc"),
        "{}",
        run.stdout
    );
}

#[test]
fn nothing_found_is_exit_1() {
    let fixture = Fixture::get();
    let library = fixture.dir.path().join("jogs");
    let jogs = fixture.clip("anna", Class::Jog);
    assert_eq!(motif(&["index", text(&jogs), "-o", text(&library)]).code, 0);
    let example = fixture.clip("anna", Class::LieDown);
    let run = motif(&[
        "search",
        text(&library),
        "--example",
        text(&example),
        "--features",
        "F32",
    ]);
    assert_eq!(run.code, 1, "{run:?}");
    assert!(run.stdout.contains("nothing found"), "{}", run.stdout);
    let empty = tempfile::tempdir().unwrap();
    let run = motif(&["info", text(empty.path())]);
    assert_eq!(run.code, 1, "{run:?}");
}

#[test]
fn bad_usage_is_exit_2_and_says_what_would_do() {
    let fixture = Fixture::get();
    let (library, example) = (fixture.library(), fixture.clip("anna", Class::Squat));
    let search = |feature: &str| {
        motif(&[
            "search",
            text(&library),
            "--example",
            text(&example),
            "--features",
            feature,
        ])
    };
    let run = search("rkne_bent");
    assert_eq!(run.code, 2, "{run:?}");
    assert!(run.stderr.contains("rknee_bent"), "{}", run.stderr);
    assert_eq!(search("F40").code, 2);
    assert_eq!(motif(&["dance"]).code, 2);
    assert_eq!(motif(&["search", text(&library)]).code, 2);
    assert_eq!(motif(&["info", text(&example), "--unit", "parsec"]).code, 2);
    assert_eq!(
        motif(&["info", &format!("{}@9-3", example.display())]).code,
        2
    );
    assert_eq!(
        motif(&["info", &format!("{}@0-5", fixture.corpus().display())]).code,
        2
    );
    let run = motif(&[
        "index",
        text(&example),
        "-o",
        text(&library),
        "--rate",
        "60",
    ]);
    assert_eq!(run.code, 2, "{run:?}");
    let foreign = fixture.corpus();
    assert_eq!(
        motif(&["index", text(&example), "-o", text(&foreign)]).code,
        2
    );
}

#[test]
fn missing_files_are_exit_4() {
    let run = motif(&["info", "no/such/file.bvh"]);
    assert_eq!(run.code, 4, "{run:?}");
    assert!(run.stderr.contains("no/such/file.bvh"), "{}", run.stderr);
    assert_eq!(
        motif(&["search", "no/such/library", "--example", "x.bvh"]).code,
        4
    );
}

#[test]
fn a_broken_file_never_stops_a_batch() {
    let dir = tempfile::tempdir().unwrap();
    let clips = dir.path().join("clips");
    fs::create_dir(&clips).unwrap();
    fs::copy(
        Fixture::get().clip("eva", Class::Hop),
        clips.join("hop.bvh"),
    )
    .unwrap();
    fs::write(
        clips.join("broken.bvh"),
        GOOD.replace("OFFSET 10", "OFSET 10"),
    )
    .unwrap();
    let library = dir.path().join("library");
    let index = ["index", text(&clips), "-o", text(&library)];
    let run = motif(&[&index[..], &["--json"]].concat());
    assert_eq!(run.code, 0, "{run:?}");
    let document = run.json();
    assert_eq!(document["result"]["clips"], 1);
    let skipped = &document["skipped"][0];
    assert_eq!(skipped["path"], text(&clips.join("broken.bvh")));
    assert_eq!(
        (skipped["line"].as_u64(), skipped["column"].as_u64()),
        (Some(8), Some(3))
    );
    let byte = GOOD.find("OFFSET 10").unwrap();
    assert_eq!(skipped["byte"].as_u64(), Some(byte as u64));
    assert!(
        skipped["error"]
            .as_str()
            .unwrap()
            .contains("found \"OFSET\""),
        "{skipped}"
    );

    let run = motif(&index);
    assert!(run.stderr.contains("broken.bvh:8:3"), "{}", run.stderr);
    assert_eq!(motif(&[&index[..], &["--strict"]].concat()).code, 3);
    let only_broken = clips.join("broken.bvh");
    assert_eq!(motif(&["info", text(&only_broken)]).code, 3);
}

#[test]
fn a_rig_that_nobody_knows_is_named() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("odd.bvh");
    fs::write(
        &file,
        GOOD.replace("Hips", "Zork").replace("LeftUpLeg", "Blorb"),
    )
    .unwrap();
    let run = motif(&["features", text(&file)]);
    assert_eq!(run.code, 3, "{run:?}");
    assert!(run.stderr.contains("Zork, Blorb"), "{}", run.stderr);
    let run = motif(&["info", text(&file)]);
    assert_eq!(run.code, 0, "{run:?}");
    assert!(run.stdout.contains("no known rig"), "{}", run.stdout);
}

/// Two frames of a body with six body points, the least that is taken for one.
pub(crate) fn incomplete_rig() -> String {
    let joint = |name: &str, offset: &str, child: &str| {
        format!("JOINT {name}\n{{ OFFSET {offset}\nCHANNELS 0\n{child}}}\n")
    };
    let hand = joint("RightHand", "25 0 0", "");
    let forearm = joint("RightForeArm", "30 0 0", &hand);
    let arm = joint("RightArm", "0 50 0", &forearm) + &joint("Neck", "0 50 0", "");
    GOOD.replace("JOINT LeftUpLeg", &format!("{arm} JOINT LeftUpLeg"))
}

#[test]
fn an_incomplete_rig_says_which_features_it_lacks() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("legs.bvh");
    fs::write(&file, incomplete_rig()).unwrap();
    let run = motif(&["features", text(&file), "--json"]);
    let result = &run.json()["result"][0];
    let unavailable: Vec<&str> = result["unavailable"]
        .as_array()
        .unwrap()
        .iter()
        .filter_map(Value::as_str)
        .collect();
    assert!(
        unavailable.contains(&"rknee_bent") && !unavailable.contains(&"root_fast"),
        "{unavailable:?}"
    );

    // Such a clip is not found by features that it lacks, and not searched for by them.
    let fixture = Fixture::get();
    let library = dir.path().join("library");
    assert_eq!(motif(&["index", text(&file), "-o", text(&library)]).code, 0);
    let squat = fixture.clip("anna", Class::Squat);
    let run = motif(&[
        "search",
        text(&library),
        "--example",
        text(&squat),
        "--features",
        "F20",
        "--json",
    ]);
    assert_eq!(run.json()["result"]["n_unsearched"], 1);
    let template = dir.path().join("bent.mtpl");
    let text_form = "motion_template = 1\nname = \"bent\"\nfeature_set = \"mueller2006\"\nrate = 30\ncolumns = 4\n\
        [features]\nrknee_bent = \"1\"\n";
    fs::write(&template, text_form).unwrap();
    let args = ["search", text(&library), "--template", text(&template)];
    let run = motif(&[&args[..], &["--json"]].concat());
    assert_eq!(run.json()["result"]["n_unsearched"], 1);
    let run = motif(&args);
    assert_eq!(run.code, 1, "{run:?}");
    assert!(
        run.stdout.contains("1 clip could not be searched"),
        "{run:?}"
    );
    let whole = fixture.library();
    let run = motif(&[
        "search",
        text(&whole),
        "--example",
        text(&file),
        "--features",
        "F20",
    ]);
    assert_eq!(run.code, 3, "{run:?}");
    assert!(
        run.stderr.contains("rknee_bent") && run.stderr.contains("rankle"),
        "{}",
        run.stderr
    );
}

#[test]
fn features_come_in_four_forms_that_agree() {
    let fixture = Fixture::get();
    let dir = tempfile::tempdir().unwrap();
    let clip = fixture.clip("dan", Class::Squat);
    let run = motif(&["features", text(&clip), "--json"]);
    let words: Vec<u64> = run.json()["result"][0]["words"]
        .as_array()
        .unwrap()
        .iter()
        .map(|w| u64::from_str_radix(w.as_str().unwrap().trim_start_matches("0x"), 16).unwrap())
        .collect();
    let write = |name: &str| {
        let path = dir.path().join(name);
        let run = motif(&["features", text(&clip), "-o", text(&path)]);
        assert_eq!(run.code, 0, "{run:?}");
        fs::read(path).unwrap()
    };
    let csv = String::from_utf8(write("a.csv")).unwrap();
    let rows: Vec<Vec<&str>> = csv
        .lines()
        .skip(1)
        .map(|l| l.split(',').collect())
        .collect();
    assert_eq!(rows.len(), words.len());
    for (k, row) in rows.iter().enumerate() {
        // 60 Hz: every second frame.
        assert_eq!(row[1], (2 * k).to_string());
        let word = row[3..]
            .iter()
            .rev()
            .fold(0u64, |w, bit| w << 1 | u64::from(*bit == "1"));
        assert_eq!(word, words[k]);
    }
    let npy = write("a.npy");
    let array: ndarray::Array2<u8> = ndarray_npy::ReadNpyExt::read_npy(&npy[..]).unwrap();
    assert_eq!(array.dim(), (words.len(), 39));
    assert!(
        array
            .indexed_iter()
            .all(|((t, bit), &v)| u64::from(v) == words[t] >> bit & 1)
    );
    let json: Value = serde_json::from_slice(&write("a.json")).unwrap();
    assert_eq!(json[0]["words"].as_array().unwrap().len(), words.len());
    assert!(write("a.png").starts_with(b"\x89PNG"));

    let folder = dir.path().join("all/");
    let anna = fixture.corpus().join("anna");
    let run = motif(&[
        "features",
        text(&anna),
        "-o",
        text(&folder),
        "--format",
        "npy",
    ]);
    assert_eq!(run.code, 0, "{run:?}");
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 47);
    let one_file = dir.path().join("all.npy");
    assert_eq!(
        motif(&["features", text(&anna), "-o", text(&one_file)]).code,
        2
    );
}

#[test]
fn info_says_where_rate_and_unit_come_from() {
    let fixture = Fixture::get();
    let amc = fixture.clip("ben", Class::Walk);
    let info = motif(&["info", text(&amc), "--json"]).json()["result"][0].clone();
    assert_eq!(
        (info["format"].as_str(), info["rate"].as_f64()),
        (Some("ASF/AMC"), Some(120.0))
    );
    assert_eq!(
        (info["rate_source"].as_str(), info["unit_source"].as_str()),
        (Some("default"), Some("file"))
    );
    assert_eq!(info["body_map"]["placed"], 24);
    let bvh = fixture.clip("eva", Class::Walk);
    let info = motif(&["info", text(&bvh), "--json"]).json()["result"][0].clone();
    assert_eq!(
        (info["format"].as_str(), info["rate"].as_f64()),
        (Some("BVH"), Some(60.0))
    );
    assert_eq!(
        (info["unit"].as_str(), info["unit_source"].as_str()),
        (Some("cm"), Some("guessed"))
    );
    assert_eq!(info["unavailable_features"].as_array().unwrap().len(), 0);
    let info = motif(&["info", text(&bvh), "--json", "--unit", "inch"]).json()["result"][0].clone();
    assert_eq!(
        (info["unit"].as_str(), info["unit_source"].as_str()),
        (Some("inch"), Some("given"))
    );
}

#[test]
fn every_command_has_help_with_an_example() {
    for command in [
        &["convert"][..],
        &["demo"],
        &["info"],
        &["features"],
        &["index"],
        &["learn"],
        &["library"],
        &["library", "info"],
        &["library", "verify"],
        &["library", "compact"],
        &["library", "remove"],
        &["search"],
        &["template"],
        &["template", "show"],
        &["template", "mirror"],
        &["template", "combine"],
        &["template", "restrict"],
        &["template", "new"],
        &["template", "convert"],
    ] {
        let run = motif(&[command, &["--help"]].concat());
        assert_eq!(run.code, 0);
        assert!(run.stdout.contains("Example: motif"), "{command:?}");
        for option in ["--json", "--threads", "--quiet", "--verbose", "--strict"] {
            assert!(run.stdout.contains(option), "{command:?} {option}");
        }
    }
}
