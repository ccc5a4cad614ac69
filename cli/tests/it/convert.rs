//! `motif convert` as a user runs it.

use std::fs;
use std::path::Path;

use cli::corpus::Class;
use cli::recording::{ReadOptions, load};
use ndarray::{Array3, Axis};

use crate::command::{motif, text};
use crate::corpus::Fixture;

/// Positions read back from text may differ by what the formats round, in metres.
const TEXT_TOLERANCE: f32 = 1e-4;

/// Positions by joint name, for the joints that both files have.
#[track_caller]
fn assert_same_positions(a: &Path, b: &Path) {
    let read = |path: &Path| load(path, &ReadOptions::default()).unwrap().recording;
    let (a, b) = (read(a), read(b));
    assert_eq!(a.n_frames(), b.n_frames());
    let (of_a, of_b): (Array3<f32>, Array3<f32>) = (a.positions(), b.positions());
    let names = b.names();
    let mut n_shared = 0;
    for (i, name) in a.names().into_iter().enumerate() {
        let Some(j) = names.iter().position(|n| *n == name) else {
            continue;
        };
        n_shared += 1;
        let ways = of_a.index_axis(Axis(1), i).to_owned() - of_b.index_axis(Axis(1), j);
        let worst = ways.iter().fold(0f32, |worst, way| worst.max(way.abs()));
        assert!(worst <= TEXT_TOLERANCE, "{name}: {worst} m");
    }
    assert!(n_shared >= 10, "{n_shared} joints in common");
}

#[test]
fn formats_are_chosen_by_extension_and_keep_the_motion() {
    let fixture = Fixture::get();
    let dir = tempfile::tempdir().unwrap();
    let bvh = fixture.clip("eva", Class::Walk);
    let amc = dir.path().join("walk.amc");
    let run = motif(&["convert", text(&bvh), text(&amc)]);
    assert_eq!(run.code, 0, "{run:?}");
    assert!(dir.path().join("walk.asf").exists());
    assert_same_positions(&bvh, &amc);
    let again = dir.path().join("again.bvh");
    assert_eq!(motif(&["convert", text(&bvh), text(&again)]).code, 0);
    assert_same_positions(&bvh, &again);
    for (name, magic) in [
        ("walk.glb", &b"glTF"[..]),
        ("walk.csv", b"frame,time_s,"),
        ("walk.npy", b"\x93NUMPY"),
        ("walk.npz", b"PK\x03\x04"),
    ] {
        let out = dir.path().join(name);
        let run = motif(&["convert", text(&bvh), text(&out)]);
        assert_eq!(run.code, 0, "{run:?}");
        assert!(fs::read(&out).unwrap().starts_with(magic), "{name}");
    }
}

#[test]
fn span_and_rate_are_those_asked_for() {
    let fixture = Fixture::get();
    let dir = tempfile::tempdir().unwrap();
    let amc = fixture.clip("anna", Class::Squat);
    let out = dir.path().join("squat.bvh");
    let clip = format!("{}@10-131", amc.display());
    let args = [
        "convert",
        &clip,
        text(&out),
        "--rate",
        "60",
        "--to-unit",
        "m",
    ];
    let run = motif(&[&args[..], &["--json"]].concat());
    assert_eq!(run.code, 0, "{run:?}");
    let one = &run.json()["result"][0];
    // 121 frames at 120 Hz are one second and its end.
    assert_eq!(
        (one["frames"].as_u64(), one["rate"].as_f64()),
        (Some(61), Some(60.0))
    );
    let info = motif(&["info", text(&out), "--json"]).json()["result"][0].clone();
    assert_eq!(info["frames"], 61);
    assert_eq!(info["rate"], 60.0);
    assert_eq!(info["unit"], "m");
}

#[test]
fn a_folder_becomes_a_folder() {
    let fixture = Fixture::get();
    let dir = tempfile::tempdir().unwrap();
    let clips = fixture.clip("ben", Class::Walk);
    let folder = clips.parent().unwrap();
    let out = dir.path().join("npy/");
    assert_eq!(motif(&["convert", text(folder), text(&out)]).code, 2);
    let run = motif(&["convert", text(folder), text(&out), "--to", "npy", "--json"]);
    assert_eq!(run.code, 0, "{run:?}");
    let made = run.json()["result"].as_array().unwrap().len();
    assert!(made > 10);
    assert_eq!(fs::read_dir(&out).unwrap().count(), made);
}

#[test]
fn nothing_is_written_over_what_is_read() {
    let fixture = Fixture::get();
    let dir = tempfile::tempdir().unwrap();
    let bvh = dir.path().join("walk.bvh");
    fs::copy(fixture.clip("eva", Class::Walk), &bvh).unwrap();
    let before = fs::read(&bvh).unwrap();
    let run = motif(&["convert", text(&bvh), text(&bvh), "--mirror"]);
    assert_eq!(run.code, 2, "{run:?}");
    assert_eq!(fs::read(&bvh).unwrap(), before);
    let amc = dir.path().join("walk.amc");
    assert_eq!(motif(&["convert", text(&bvh), text(&amc)]).code, 0);
    let (other, asf) = (dir.path().join("other.amc"), dir.path().join("walk.asf"));
    let before = fs::read(&asf).unwrap();
    assert_eq!(
        motif(&["convert", text(&amc), text(&other), "--mirror"]).code,
        0
    );
    assert_eq!(fs::read(&asf).unwrap(), before);
    let run = motif(&[
        "convert",
        text(&other),
        text(&dir.path().join("walk.bvh/x.odd")),
    ]);
    assert_eq!(run.code, 2, "{run:?}");
}
