//! `motif eval` on the built-in corpus.

use std::fs;
use std::path::Path;

use cli::corpus::Class;
use tempfile::TempDir;

use crate::command::motif;
use crate::corpus::Fixture;

/// A sub-folder for each class, with the clips of all performers, as `anna_kick_left_01.amc`.
fn labelled(classes: &[Class]) -> TempDir {
    let fixture = Fixture::get();
    let dir = tempfile::tempdir().unwrap();
    for file in &fixture.files {
        let Some(class) = file.class.filter(|class| classes.contains(class)) else {
            continue;
        };
        let folder = dir.path().join(class.name());
        fs::create_dir_all(&folder).unwrap();
        let relative = file.path.strip_prefix(fixture.corpus()).unwrap();
        let performer = relative.iter().next().unwrap().to_str().unwrap();
        let name = relative.file_name().unwrap().to_str().unwrap();
        fs::copy(&file.path, folder.join(format!("{performer}_{name}"))).unwrap();
        for entry in fs::read_dir(file.path.parent().unwrap()).unwrap() {
            let skeleton = entry.unwrap().path();
            if skeleton.extension().is_some_and(|e| e == "asf") {
                fs::copy(&skeleton, folder.join(format!("{performer}.asf"))).unwrap();
            }
        }
    }
    dir
}

fn path(dir: &TempDir) -> &str {
    dir.path().to_str().unwrap()
}

#[test]
fn performers_are_tested_who_were_not_learned_from() {
    let classes = [Class::Squat, Class::KickLeft, Class::KickRight, Class::Hop];
    let dir = labelled(&classes);
    let args = [
        "eval",
        path(&dir),
        "--split",
        "actor",
        "--test",
        "anna,ben",
        "--baselines",
    ];
    let output = motif(&[&args[..], &["--json"]].concat());
    assert_eq!(output.code, 0, "{}", output.stderr);
    let document = output.json();
    let result = &document["result"];
    let found = result["classes"].as_array().unwrap();
    assert_eq!(found.len(), classes.len());
    for class in found {
        // Five performers, three clips each.
        assert_eq!(
            (class["train"].as_u64(), class["test"].as_u64()),
            (Some(9), Some(6)),
            "{class}"
        );
        assert!(class["template_frames"].as_u64().unwrap() > 1);
        assert_eq!(class["tau"], 0.06);
        assert_eq!(class["taus"].as_array().unwrap().len(), 6);
        let methods = class["baselines"].as_array().unwrap().iter();
        let methods: Vec<&str> = methods.map(|b| b["method"].as_str().unwrap()).collect();
        assert_eq!(methods, ["RF", "Q", "3D"]);
    }
    // Every test clip is taken for some class or none.
    let confusion = &result["confusion"];
    let counts = confusion["counts"].as_array().unwrap().iter();
    let taken: u64 = counts
        .flat_map(|row| row.as_array().unwrap())
        .map(|n| n.as_u64().unwrap())
        .sum();
    let none = confusion["none"].as_array().unwrap().iter();
    let none: u64 = none.map(|n| n.as_u64().unwrap()).sum();
    assert_eq!(taken + none, 24);
    let text = motif(&args);
    assert_eq!(text.code, 0);
    assert!(
        text.stdout.contains("mean average precision"),
        "{}",
        text.stdout
    );
}

#[track_caller]
fn check_refused(dir: &Path, args: &[&str], message: &str) {
    let all = [&["eval", dir.to_str().unwrap()], args].concat();
    let output = motif(&all);
    assert_eq!(output.code, 2, "{}", output.stderr);
    assert!(output.stderr.contains(message), "{}", output.stderr);
}

#[test]
fn what_cannot_be_evaluated_is_refused() {
    let dir = labelled(&[Class::Squat]);
    let dir = dir.path();
    check_refused(dir, &["--split", "actor"], "expected some, not all, of");
    check_refused(
        dir,
        &["--split", "actor", "--test", "zoe"],
        "no such actor; part 1",
    );
    check_refused(
        dir,
        &["--split", "actor", "--test", "a", "--actor-part", "9"],
        "not all names",
    );
    check_refused(dir, &["--test", "anna"], "--test is for --split actor");
    check_refused(dir, &["--seed", "1"], "--seed is for --split file");
    check_refused(dir, &["--tau", "2"], "from 0 to 1");
    check_refused(dir, &["--delta", "0.5"], "below 0.5");
    let empty = tempfile::tempdir().unwrap();
    check_refused(empty.path(), &[], "expected a sub-folder");
}

#[test]
fn test_clips_can_be_one_stream() {
    let dir = labelled(&[Class::Squat, Class::Hop]);
    let costs = |short_clips: &str| {
        let args = ["eval", path(&dir), "--short-clips", short_clips, "--json"];
        let output = motif(&args);
        assert_eq!(output.code, 0, "{}", output.stderr);
        output.json()["result"]["classes"].clone()
    };
    let (apart, joined) = (costs("unmatched"), costs("joined"));
    // The best match may reach into the neighbours, where a cheaper one is.
    assert_ne!(apart, joined);
    for (apart, joined) in apart
        .as_array()
        .unwrap()
        .iter()
        .zip(joined.as_array().unwrap())
    {
        for given in ["class", "train", "test", "template_frames"] {
            assert_eq!(apart[given], joined[given]);
        }
        assert_eq!(joined["ap"], 1.0, "{joined}");
    }
}
