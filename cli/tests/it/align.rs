//! `motif align` as a user runs it.

use std::fs;
use std::path::{Path, PathBuf};

use cli::corpus::Class;
use cli::recording::{ReadOptions, load};
use serde_json::Value;

use crate::command::{Output, motif, text};
use crate::corpus::Fixture;

/// Rows of a table with six digits behind the point, summed up.
const CSV_TOLERANCE: f64 = 1e-6;

fn n_frames(path: &Path) -> usize {
    load(path, &ReadOptions::default())
        .unwrap()
        .recording
        .n_frames()
}

/// Two walks by one performer, so on one skeleton.
fn walks(performer: &str) -> [PathBuf; 2] {
    let fixture = Fixture::get();
    let folder = fixture.corpus().join(performer);
    let walks = fixture
        .files
        .iter()
        .filter(|f| f.class == Some(Class::Walk));
    let mut walks = walks.filter(|f| f.path.starts_with(&folder));
    [0, 1].map(|_| walks.next().unwrap().path.clone())
}

#[track_caller]
fn result(run: &Output) -> Value {
    assert_eq!(run.code, 0, "{run:?}");
    run.json()["result"].clone()
}

#[test]
fn the_path_leads_from_both_first_frames_to_both_last_ones() {
    let [a, b] = walks("eva");
    let dir = tempfile::tempdir().unwrap();
    let (csv, json) = (
        dir.path().join("path.csv"),
        dir.path().join("new/path.json"),
    );
    let args = [
        "align",
        text(&a),
        text(&b),
        "-o",
        text(&csv),
        "-o",
        text(&json),
        "--json",
    ];
    let found = result(&motif(&args));
    assert_eq!(found["files"].as_array().unwrap().len(), 2);
    let alignment = &found["alignment"];
    let path = alignment["path"].as_array().unwrap();
    let ends = [&path[0], &path[path.len() - 1]]
        .map(|step| [&step["a"], &step["b"]].map(|f| f.as_u64().unwrap() as usize));
    assert_eq!(ends, [[0, 0], [n_frames(&a) - 1, n_frames(&b) - 1]]);

    let mut sum = 0.0;
    for step in path {
        let cost = step["cost"].as_f64().unwrap();
        let points: Vec<f64> = step["points"]
            .as_array()
            .unwrap()
            .iter()
            .map(|d| d.as_f64().unwrap())
            .collect();
        assert_eq!(points.len(), found["points"].as_array().unwrap().len());
        let mean = points.iter().sum::<f64>() / points.len() as f64;
        assert!((mean - cost).abs() <= CSV_TOLERANCE, "{mean} is not {cost}");
        let seconds = step["b"].as_f64().unwrap() / found["b"]["rate"].as_f64().unwrap();
        assert!((step["b_s"].as_f64().unwrap() - seconds).abs() <= CSV_TOLERANCE);
        sum += cost;
    }
    assert!((alignment["cost"].as_f64().unwrap() - sum).abs() <= CSV_TOLERANCE);
    let share = alignment["cells"]["share"].as_f64().unwrap();
    assert!(share > 0.0 && share < 1.0, "{share}");
    assert!(alignment["full_cost"].as_f64().unwrap() <= sum + CSV_TOLERANCE);

    let written: Value = serde_json::from_slice(&fs::read(&json).unwrap()).unwrap();
    assert_eq!(written["alignment"], *alignment);
    let table = fs::read_to_string(&csv).unwrap();
    let rows: Vec<&str> = table.lines().collect();
    assert!(
        rows[0].starts_with("a_frame,b_frame,a_s,b_s,cost,lhip,"),
        "{}",
        rows[0]
    );
    assert_eq!(rows.len(), path.len() + 1);
    for (row, step) in rows[1..].iter().zip(path) {
        let mut fields = row.split(',');
        assert_eq!(fields.next().unwrap(), step["a"].to_string());
        assert_eq!(fields.next().unwrap(), step["b"].to_string());
        let cost: f64 = fields.nth(2).unwrap().parse().unwrap();
        assert!((cost - step["cost"].as_f64().unwrap()).abs() <= CSV_TOLERANCE);
    }
}

#[test]
fn frames_are_those_of_the_source_within_the_span_and_at_the_rate_asked_for() {
    let fixture = Fixture::get();
    let amc = fixture.clip("anna", Class::Squat);
    let clips = [
        format!("{}@10-131", amc.display()),
        format!("{}@30-90", amc.display()),
    ];
    let args = ["align", &clips[0], &clips[1], "--rate", "30", "--json"];
    let found = result(&motif(&args));
    assert_eq!(found["rate"], 30.0);
    assert_eq!(
        (&found["a"]["start"], &found["a"]["end"]),
        (&Value::from(10), &Value::from(131))
    );
    for step in found["alignment"]["path"].as_array().unwrap() {
        let (a, b) = (step["a"].as_u64().unwrap(), step["b"].as_u64().unwrap());
        assert!((10..131).contains(&a) && (30..90).contains(&b));
        // Every fourth frame of 120 Hz, counted from the beginning of the file.
        assert_eq!((a % 4, b % 4), (0, 0));
    }
    assert_eq!(
        motif(&["align", &clips[0], &clips[1], "--rate", "240"]).code,
        2
    );
    let beyond = format!("{}@0-100000", amc.display());
    assert_eq!(motif(&["align", &beyond, &clips[1]]).code, 3);
}

#[test]
fn a_clip_is_itself_and_a_single_frame_is_enough() {
    let clip = Fixture::get().clip("anna", Class::Walk);
    let found = result(&motif(&["align", text(&clip), text(&clip), "--json"]));
    let alignment = &found["alignment"];
    assert_eq!(
        (&alignment["cost"], &alignment["excess"]),
        (&Value::from(0.0), &Value::from(0.0))
    );
    let path = alignment["path"].as_array().unwrap();
    assert!(path.iter().all(|step| step["a"] == step["b"]));

    let one = format!("{}@7-8", clip.display());
    let found = result(&motif(&["align", &one, &one, "--json"]));
    assert_eq!(found["alignment"]["path"].as_array().unwrap().len(), 1);
    let found = result(&motif(&["align", &one, text(&clip), "--json"]));
    assert_eq!(
        found["alignment"]["path"].as_array().unwrap().len(),
        n_frames(&clip)
    );
}

#[test]
fn a_blend_lies_between_the_clips_in_any_format() {
    let [a, b] = walks("anna");
    let dir = tempfile::tempdir().unwrap();
    let out = |name: &str| dir.path().join(name);
    for weight in ["0", "0.25", "1"] {
        let bvh = out("blend.bvh");
        let run = motif(&[
            "align",
            text(&a),
            text(&b),
            "--blend",
            weight,
            "-o",
            text(&bvh),
        ]);
        assert_eq!(run.code, 0, "{run:?}");
        let w: f64 = weight.parse().unwrap();
        // Frames less one are intervals; those mix.
        let expected = (1.0 - w) * (n_frames(&a) - 1) as f64 + w * (n_frames(&b) - 1) as f64;
        assert_eq!(n_frames(&bvh), expected.round() as usize + 1);
        let found = result(&motif(&["align", text(&bvh), text(&a), "--json"]));
        let between = found["alignment"]["mean_distance"].as_f64().unwrap();
        let whole = result(&motif(&["align", text(&a), text(&b), "--json"]));
        let whole = whole["alignment"]["mean_distance"].as_f64().unwrap();
        assert!(
            between <= w.max(0.1) * whole + BLEND_TOLERANCE,
            "{weight}: {between} of {whole}"
        );
    }
    let (amc, path, glb) = (out("b.amc"), out("b.csv"), out("b.glb"));
    let files = ["-o", text(&amc), "-o", text(&path), "-o", text(&glb)];
    let run = motif(&[&["align", text(&a), text(&b), "--blend", "0.5"], &files[..]].concat());
    assert_eq!(run.code, 0, "{run:?}");
    assert!(n_frames(&amc) > 1 && out("b.asf").exists());
    assert!(fs::read(&glb).unwrap().starts_with(b"glTF"));
    assert!(fs::read_to_string(&path).unwrap().starts_with("a_frame,"));
}

/// A blend follows a smoothed path, and is aligned anew: poses may shift by a frame's motion, in metres.
const BLEND_TOLERANCE: f64 = 0.01;

#[test]
fn clips_of_different_skeletons_rates_and_formats_are_aligned_but_not_blended() {
    let fixture = Fixture::get();
    let (amc, bvh) = (
        fixture.clip("anna", Class::Squat),
        fixture.clip("eva", Class::Squat),
    );
    let found = result(&motif(&["align", text(&amc), text(&bvh), "--json"]));
    assert_eq!(
        (&found["rate"], &found["a"]["rate"]),
        (&Value::from(60.0), &Value::from(120.0))
    );
    // The same motion by another body.
    assert!(found["alignment"]["mean_distance"].as_f64().unwrap() < 0.15);
    let dir = tempfile::tempdir().unwrap();
    let (out, csv) = (dir.path().join("x.bvh"), dir.path().join("x.csv"));
    let args = [
        "align",
        text(&amc),
        text(&bvh),
        "--blend",
        "0.5",
        "-o",
        text(&csv),
        "-o",
        text(&out),
    ];
    let run = motif(&args);
    assert_eq!(run.code, 3, "{run:?}");
    assert!(run.stderr.contains("cannot be blended"), "{run:?}");
    assert!(!out.exists() && !csv.exists());
}

#[test]
fn different_motions_are_nothing_found() {
    let fixture = Fixture::get();
    let (a, b) = (
        fixture.clip("anna", Class::JumpingJack),
        fixture.clip("anna", Class::LieDown),
    );
    let run = motif(&["align", text(&a), text(&b)]);
    assert_eq!(run.code, 1, "{run:?}");
    assert!(run.stdout.contains("too different"), "{run:?}");
    let run = motif(&["align", text(&a), text(&b), "--json"]);
    assert_eq!(run.code, 1);
    let found = run.json()["result"].clone();
    assert!(
        found["alignment"].is_null()
            && found["reason"].as_str().unwrap().contains("--max-distance")
    );
    let run = motif(&["align", text(&a), text(&b), "--max-distance", "3"]);
    assert_eq!(run.code, 0, "{run:?}");
}

#[test]
fn what_cannot_be_written_is_bad_usage() {
    let dir = tempfile::tempdir().unwrap();
    let [a, b] = walks("eva").map(|walk| {
        let copy = dir.path().join(walk.file_name().unwrap());
        fs::copy(walk, &copy).unwrap();
        copy
    });
    let before = fs::read(&a).unwrap();
    let run = |more: &[&str]| motif(&[&["align", text(&a), text(&b)], more].concat());
    for (args, what) in [
        (&["-o", "x.bvh"][..], "--blend"),
        (&["-o", "x.png"][..], "expected .csv or .json"),
        (&["--blend", "0.5"][..], "-o"),
        (&["--blend", "0.5", "-o", "x.csv"][..], "-o"),
        (&["--blend", "1.5", "-o", "x.bvh"][..], "from 0 to 1"),
        (&["--blend", "0.5", "-o", text(&a)][..], "written over"),
        (&["--set", "nonsense"][..], "nonsense"),
    ] {
        let run = run(args);
        assert_eq!(run.code, 2, "{args:?}: {run:?}");
        assert!(run.stderr.contains(what), "{args:?}: {run:?}");
    }
    assert_eq!(fs::read(&a).unwrap(), before);
    assert_eq!(motif(&["align", text(&a), "missing.bvh"]).code, 4);
}
