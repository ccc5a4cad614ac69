//! `motif info` as the doctor.

use std::fs;
use std::path::Path;

use cli::corpus::Class;
use serde_json::Value;

use crate::command::{motif, text};
use crate::corpus::Fixture;
use crate::real::data;

#[track_caller]
fn info(path: &Path, more: &[&str]) -> Value {
    let run = motif(&[&["info", text(path), "--json"], more].concat());
    assert_eq!(run.code, 0, "{run:?}");
    run.json()["result"][0].clone()
}

#[test]
fn a_code_is_explained() {
    let run = motif(&["info", "--explain", "bvh012"]);
    assert_eq!(run.code, 0, "{run:?}");
    assert!(
        run.stdout.starts_with("BVH012: ") && run.stdout.contains("What to do"),
        "{run:?}"
    );
    let run = motif(&["info", "--explain", "BVH012", "--json"]);
    assert_eq!(run.json()["result"]["code"], "BVH012");
    let run = motif(&["info", "--explain", "BVH999"]);
    assert_eq!(run.code, 2);
    assert!(run.stderr.contains("BVH012"), "{run:?}");
    assert_eq!(motif(&["info"]).code, 2);
}

#[test]
fn every_warning_has_code_line_and_column() {
    let fixture = Fixture::get();
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("cut.bvh");
    let whole = fs::read_to_string(fixture.clip("eva", Class::Walk)).unwrap();
    let (head, _) = whole.split_once("Frame Time:").unwrap();
    let header_line = head.lines().count();
    // Half of the file: the count in the header is wrong, and a row is cut in two.
    fs::write(&file, &whole[..whole.len() / 2]).unwrap();
    let found = info(&file, &[]);
    let codes: Vec<&str> = found["warnings"]
        .as_array()
        .unwrap()
        .iter()
        .map(|w| w["code"].as_str().unwrap())
        .collect();
    assert_eq!(codes, ["BVH012", "BVH013"]);
    assert_eq!(found["warnings"][0]["line"], header_line);
    assert!(found["warnings"][0]["column"].as_u64().unwrap() > 1);
    assert_eq!(motif(&["info", text(&file), "--strict"]).code, 3);
}

#[test]
fn what_a_file_says_can_be_overruled_on_every_command() {
    let fixture = Fixture::get();
    let dir = tempfile::tempdir().unwrap();
    let bvh = fixture.clip("eva", Class::Walk);
    let found = info(&bvh, &["--rate", "30", "--unit", "mm", "--up", "-y"]);
    assert_eq!(
        (&found["rate"], &found["rate_source"]),
        (&30.0.into(), &"given".into())
    );
    assert_eq!(
        (&found["unit"], &found["unit_source"]),
        (&"mm".into(), &"given".into())
    );
    assert_eq!(
        (&found["up"], &found["up_source"]),
        (&"-Y".into(), &"given".into())
    );
    assert_eq!(info(&bvh, &["--source-rate", "30"])["rate"], 30.0);
    assert_eq!(
        motif(&["info", text(&bvh), "--rate", "30", "--fps", "30"]).code,
        2
    );
    assert_eq!(motif(&["info", text(&bvh), "--rate", "0"]).code, 2);

    // Half the rate, twice the time: as many words from a library of half the rate.
    let words = |args: &[&str]| {
        let run = motif(&[&["features", text(&bvh), "--json"], args].concat());
        assert_eq!(run.code, 0, "{run:?}");
        run.json()["result"][0]["words"].as_array().unwrap().len()
    };
    assert_eq!(
        words(&["--source-rate", "30", "--rate", "30"]),
        words(&["--rate", "60"])
    );

    let common = [
        "--source-rate",
        "60",
        "--unit",
        "cm",
        "--up",
        "y",
        "--rig",
        "acclaim-bvh",
    ];
    let library = dir.path().join("lib");
    let out = dir.path().join("out.csv");
    for command in [
        vec!["index", text(&bvh), "-o", text(&library)],
        vec!["search", text(&library), "--example", text(&bvh)],
        vec!["convert", text(&bvh), text(&out)],
        vec!["features", text(&bvh)],
        vec!["info", text(&bvh)],
    ] {
        let run = motif(&[&command[..], &common[..]].concat());
        assert_eq!(run.code, 0, "{command:?}: {run:?}");
    }
}

#[test]
fn a_rig_is_saved_changed_and_given_back() {
    let fixture = Fixture::get();
    let dir = tempfile::tempdir().unwrap();
    let bvh = fixture.clip("eva", Class::Walk);
    let rig = dir.path().join("mine.toml");
    let found = info(&bvh, &["--save-rig", text(&rig)]);
    assert_eq!(found["body_map"]["score"], 1.0);
    let saved = fs::read_to_string(&rig).unwrap();
    let mine = saved.replace(
        &format!("name = {}", found["body_map"]["rig"]),
        "name = \"mine\"",
    );
    let without: Vec<&str> = mine
        .lines()
        .filter(|line| !line.starts_with("lwrist"))
        .collect();
    fs::write(&rig, without.join("\n")).unwrap();
    let found = info(&bvh, &["--rig", text(&rig)]);
    assert_eq!(found["body_map"]["rig"], "mine");
    assert_eq!(found["body_map"]["missing"][0]["point"], "lwrist");
    assert!(
        found["unavailable_features"]
            .as_array()
            .unwrap()
            .contains(&"lelbow_bent".into())
    );

    fs::write(&rig, saved.replace("lwrist", "lwirst")).unwrap();
    let run = motif(&["info", text(&bvh), "--rig", text(&rig)]);
    assert_eq!(run.code, 3, "{run:?}");
    assert!(run.stderr.contains("lwrist"), "{run:?}");
    assert_eq!(motif(&["info", text(&bvh), "--rig", "nobody"]).code, 2);
}

#[test]
fn a_file_by_another_name_is_known_by_its_beginning() {
    let fixture = Fixture::get();
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("walk.txt");
    fs::copy(fixture.clip("eva", Class::Walk), &file).unwrap();
    assert_eq!(info(&file, &[])["format"], "BVH");
    fs::write(&file, "Dear diary").unwrap();
    assert_eq!(motif(&["info", text(&file)]).code, 2);
}

#[test]
fn real_the_doctor_finds_what_is_odd() {
    let Some(data) = data() else { return };
    let found = info(&data.join("bvh/cgspeed/02/02_01.bvh"), &[]);
    // The conversion puts a T-pose in front.
    assert_eq!(found["jumps"]["frames"], Value::from(vec![1]));
    assert_eq!(found["floor"]["plausible"], true);
    let found = info(&data.join("bvh/animated-drawings/fair1/dab.bvh"), &[]);
    assert_eq!(
        (&found["up"], &found["up_source"]),
        (&"Z".into(), &"guessed".into())
    );
    assert_eq!(found["unit_plausible"], false);

    let gait = data.join("c3d/c3d-org/sample_03/gait-raw.c3d");
    let found = info(&gait, &[]);
    assert_eq!(found["format"], "C3D");
    assert_eq!(found["body_map"]["rig"], "plug-in-gait");
    let gaps = found["markers"]["gaps"]["count"].as_u64().unwrap();
    assert!(gaps > 0);
    // A marker that is never there stays missing whatever is asked.
    let filled = info(&gait, &["--fill", "10s"]);
    assert_eq!(
        filled["markers"]["gaps"]["count"].as_u64().unwrap()
            + filled["markers"]["filled"].as_u64().unwrap(),
        gaps
    );
    let take = info(&data.join("c3d/hdm05-take/HDM_dg_06-03_03_120.c3d"), &[]);
    assert_eq!(take["body_map"]["rig"], "hdm05-cmu-markers");
    assert_eq!(take["unavailable_features"], Value::Array(Vec::new()));
}
