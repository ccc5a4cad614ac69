//! `motif search --template` as a user runs it, on the built-in corpus.

use std::fs;

use cli::corpus::Class;
use cli::templates;
use mtemplate::ClassTemplate;
use tempfile::TempDir;

use crate::command::{motif, text};
use crate::corpus::Fixture;
use crate::template_search::Corpus;

#[test]
fn the_command_finds_a_template_and_says_what_it_searched() {
    let corpus = Corpus::get();
    let dir = TempDir::new().unwrap();
    let mut template = corpus.template(Class::Squat);
    template.tau = Some(0.03);
    let path = dir.path().join("squat.mtpl");
    templates::save(&template, &path).unwrap();
    let library = Fixture::get().library();
    let run = |more: &[&str]| {
        let args = ["search", text(&library), "--template", text(&path)];
        motif(&[&args, more].concat())
    };
    let found = run(&["--top", "2"]);
    assert_eq!(found.code, 0, "{found:?}");
    assert!(
        found.stdout.contains("at a cost of up to 0.03"),
        "{}",
        found.stdout
    );
    assert!(
        found.stdout.contains("--top 0 lists all"),
        "{}",
        found.stdout
    );
    let json = run(&["--json", "--tau", "auto", "--top", "0"]).json()["result"].clone();
    assert_eq!(json["query"]["tau"], 0.03);
    assert_eq!(json["searched"]["share"], 1.0);
    let hits = json["hits"].as_array().unwrap();
    assert!(hits.iter().all(|hit| hit["cost"].as_f64().unwrap() <= 0.03));
    assert_eq!(hits[0]["rank"], 1);

    let file = dir.path().join("bent.toml");
    fs::write(
        &file,
        "[[keyframe]]\ncolumn = 10\nfeatures = { rknee_bent = 1, lknee_bent = 1 }\n",
    )
    .unwrap();
    let around = run(&["--keyframes", text(&file), "--explain-plan"]);
    assert_eq!(around.code, 0, "{around:?}");
    for needle in [
        "searched ",
        "% of the frames, around 1 keyframe",
        "column 10, stiffness 0.50: rknee_bent=1, lknee_bent=1",
        "0001-lower.shard",
    ] {
        assert!(
            around.stdout.contains(needle),
            "{needle} is not in\n{}",
            around.stdout
        );
    }
}

#[test]
fn lost_hits_are_told_on_request() {
    let corpus = Corpus::get();
    let dir = TempDir::new().unwrap();
    let path = dir.path().join("squat.mtpl");
    templates::save(&corpus.template(Class::Squat), &path).unwrap();
    let file = dir.path().join("bent.toml");
    // Seldom so at the first frame of a squat.
    let bent = "[[keyframe]]\ncolumn = 0\nfeatures = { rknee_bent = 1, rhand_fast = 1 }\n";
    fs::write(&file, bent).unwrap();
    let library = Fixture::get().library();
    let run = |more: &[&str]| {
        let args = ["search", text(&library), "--template", text(&path)];
        motif(&[&args, more].concat())
    };
    let all = run(&["--json"]).json()["result"].clone();
    assert_eq!(all.get("lost"), None);
    let around = ["--keyframes", text(&file), "--lost"];
    let json = run(&[&around[..], &["--json", "--top", "2"]].concat()).json();
    let lost = &json["result"]["lost"];
    assert_eq!(lost["of"], all["n_hits"]);
    assert!(lost["n_hits"].as_u64().unwrap() > 2);
    let listed = lost["hits"].as_array().unwrap();
    assert_eq!(listed.len(), 2);
    // As they are ranked among all; without --top 20 are listed, and there are fewer.
    let known = all["hits"].as_array().unwrap();
    assert!(listed.iter().all(|hit| known.contains(hit)));
    let told = run(&around);
    let (n_lost, of) = (&lost["n_hits"], &lost["of"]);
    let line = format!("{n_lost} lost of {of} hits without keyframes");
    assert!(told.stdout.contains(&line), "{}", told.stdout);
    let alone = run(&["--lost"]);
    assert_eq!(alone.code, 2, "{alone:?}");
    assert!(alone.stderr.contains("--keyframes"), "{}", alone.stderr);
}

#[test]
fn what_does_not_fit_is_said() {
    let corpus = Corpus::get();
    let dir = TempDir::new().unwrap();
    let template = corpus.template(Class::Squat);
    let path = dir.path().join("squat.mtpl");
    templates::save(&template, &path).unwrap();
    let other = ClassTemplate {
        feature_set: "mueller2006-table6".to_owned(),
        ..template.clone()
    };
    let other_path = dir.path().join("other.mtpl");
    templates::save(&other, &other_path).unwrap();
    let slow = ClassTemplate {
        rate: 60.0,
        ..template
    };
    let slow_path = dir.path().join("slow.mtpl");
    templates::save(&slow, &slow_path).unwrap();
    let library = Fixture::get().library();
    let keyframes = |toml: &str| {
        let file = dir.path().join("keyframes.toml");
        fs::write(&file, toml).unwrap();
        let args = [
            "search",
            text(&library),
            "--template",
            text(&path),
            "--keyframes",
            text(&file),
        ];
        motif(&args)
    };
    let refused = |template: &std::path::Path, more: &[&str]| {
        let args = ["search", text(&library), "--template", text(template)];
        motif(&[&args, more].concat())
    };
    for (run, code, message) in [
        (refused(&other_path, &[]), 2, "mueller2006-table6"),
        (
            refused(&slow_path, &[]),
            2,
            "60 words per second, the library has 30",
        ),
        (refused(&path, &["--tau", "auto"]), 2, "has no threshold"),
        (
            refused(&path, &["--tau=2"]),
            2,
            "expected auto or a number from 0 to 1",
        ),
        (
            refused(&path, &["--example", "x.amc"]),
            2,
            "cannot be used with",
        ),
        (refused(&path, &["--mirror"]), 2, "cannot be used with"),
        (
            refused(&path, &["--keyframes", "no_such.toml"]),
            4,
            "no_such.toml",
        ),
        (
            keyframes("[[keyframe]]\ncolumn = 1\nfeatures = { rknee_bend = 1 }\n"),
            3,
            ":3:14: ",
        ),
        (
            keyframes("[[keyframe]]\ncolumn = 1\nfeatures = { rknee_bent = 2 }\n"),
            3,
            "expected 0 or 1, found 2",
        ),
        (
            keyframes("[[keyframe]]\ncolumn = 1\nfeatures = { rknee_bent = 1, F20 = 0 }\n"),
            3,
            "both 0 and 1",
        ),
        (keyframes("[[keyframe]]\ncolum = 1\n"), 3, ":2:1: "),
        (
            keyframes("[[keyframe]]\ncolumn = 900\nfeatures = { F20 = 0 }\n"),
            2,
            "expected a column below",
        ),
        (
            motif(&[
                "search",
                text(&library),
                "--example",
                "x.amc",
                "--tau",
                "0.1",
            ]),
            2,
            "expected --template",
        ),
        (keyframes(""), 2, "expected one keyframe or more"),
    ] {
        assert_eq!(run.code, code, "{message}: {run:?}");
        assert!(
            run.stderr.contains(message),
            "{message} is not in\n{}",
            run.stderr
        );
    }
}
