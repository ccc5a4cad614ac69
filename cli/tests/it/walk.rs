//! `motif walk` as a user runs it.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use cli::corpus::Class;
use cli::recording::{ReadOptions, load};
use mocap_io::{Motion, forward_kinematics};
use serde_json::Value;
use tempfile::TempDir;

use crate::command::{Output, motif, text};
use crate::corpus::Fixture;
use crate::jumps::Steps;

/// Files round channels to a few digits, and degrees to metres.
const FILE_TOLERANCE: f32 = 2e-3;

pub(crate) fn motion(path: &Path) -> Motion {
    let loaded = load(path, &ReadOptions::default()).unwrap();
    loaded.recording.motion().unwrap().clone()
}

#[track_caller]
pub(crate) fn result(run: &Output) -> Value {
    assert_eq!(run.code, 0, "{run:?}");
    run.json()["result"].clone()
}

/// Bundles of eva's walks, jogs and takes.
struct Bundles {
    dir: TempDir,
    clips: Vec<PathBuf>,
}

impl Bundles {
    fn get() -> &'static Bundles {
        static BUNDLES: OnceLock<Bundles> = OnceLock::new();
        BUNDLES.get_or_init(|| {
            let fixture = Fixture::get();
            let folder = fixture.corpus().join("eva");
            let is_on_foot = |class| matches!(class, None | Some(Class::Walk | Class::Jog));
            let own = fixture.files.iter().filter(|f| f.path.starts_with(&folder));
            let clips = own.filter(|f| is_on_foot(f.class)).map(|f| f.path.clone());
            let bundles = Bundles {
                dir: tempfile::tempdir().unwrap(),
                clips: clips.collect(),
            };
            let model = bundles.model();
            let mut args = vec!["bundle"];
            args.extend(bundles.clips.iter().map(|clip| text(clip)));
            args.extend(["--kappa", "40", "-o", text(&model), "--quiet"]);
            let run = motif(&args);
            assert_eq!(run.code, 0, "{run:?}");
            bundles
        })
    }

    fn model(&self) -> PathBuf {
        self.dir.path().join("eva.mbg")
    }

    fn walk(&self, way: &[&str], output: &Path) -> Output {
        let model = self.model();
        let mut args = vec!["walk", text(&model), "-o", text(output), "--json"];
        args.extend(way);
        motif(&args)
    }
}

fn ids(result: &Value) -> Vec<u64> {
    let ids = result["bundles"].as_array().unwrap();
    ids.iter().map(|id| id.as_u64().unwrap()).collect()
}

#[test]
fn a_random_walk_plays_in_every_format_and_does_not_jump() {
    let bundles = Bundles::get();
    let dir = tempfile::tempdir().unwrap();
    let files = ["amc", "bvh", "glb"].map(|e| dir.path().join(format!("walk.{e}")));
    let way = ["--random", "8", "--seed", "5"];
    let [amc, bvh, glb] = files
        .each_ref()
        .map(|file| result(&bundles.walk(&way, file)));
    for other in [&bvh, &glb] {
        assert_eq!(amc["bundles"], other["bundles"]);
        assert_eq!(amc["pieces"], other["pieces"]);
    }
    assert!(ids(&amc).len() > 1, "{amc}");
    assert_eq!(amc["files"].as_array().unwrap().len(), 2);
    assert_eq!(&fs::read(&files[2]).unwrap()[..4], b"glTF");

    let (played, same) = (motion(&files[0]), motion(&files[1]));
    let frames = amc["pieces"].as_array().unwrap().iter();
    let frames: u64 = frames.map(|piece| piece["frames"].as_u64().unwrap()).sum();
    assert_eq!(played.n_frames() as u64, frames + 1);
    assert_eq!(amc["frames"].as_u64().unwrap(), frames + 1);
    let root = |motion: &Motion, k: usize| {
        let places = forward_kinematics(motion);
        [0, 1, 2].map(|axis| places[[k, 0, axis]])
    };
    for k in [0, played.n_frames() / 2, played.n_frames() - 1] {
        let (a, b) = (root(&played, k), root(&same, k));
        let far = (0..3).map(|i| (a[i] - b[i]).abs()).fold(0.0, f32::max);
        assert!(far <= FILE_TOLERANCE, "{a:?} is not {b:?}");
    }
    let sources: Vec<Steps> = bundles
        .clips
        .iter()
        .map(|c| Steps::of(&motion(c)))
        .collect();
    // In the takes' own format: bones of another one turn by other names.
    let ratio = Steps::of(&same).assert_no_jump(&sources);
    println!(
        "{} bundles, steps up to {ratio:.2} of the takes'",
        ids(&amc).len()
    );
}

#[test]
fn the_same_seed_walks_the_same_way_and_its_path_can_be_asked_for() {
    let bundles = Bundles::get();
    let dir = tempfile::tempdir().unwrap();
    let [a, b, c] = ["a.bvh", "b.bvh", "c.bvh"].map(|name| dir.path().join(name));
    let way = ["--random", "5", "--seed", "2"];
    let random = result(&bundles.walk(&way, &a));
    result(&bundles.walk(&way, &b));
    assert_eq!(fs::read(&a).unwrap(), fs::read(&b).unwrap());

    let named: Vec<String> = ids(&random).iter().map(|id| format!("B{id}")).collect();
    let path = result(&bundles.walk(&["--path", &named.join(",")], &c));
    assert_eq!(path["bundles"], random["bundles"]);

    let (from, to) = (&named[0], &named[named.len() - 1]);
    let shortest = result(&bundles.walk(&["--from", from, "--to", to], &c));
    let found = ids(&shortest);
    assert_eq!(
        [found[0], found[found.len() - 1]],
        [ids(&random)[0], ids(&random)[named.len() - 1]]
    );
    assert!(shortest["frames"].as_u64() <= path["frames"].as_u64());
}

#[test]
fn locked_feet_skate_less() {
    let bundles = Bundles::get();
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("walk.bvh");
    let way = ["--random", "8", "--seed", "5"];
    let free = result(&bundles.walk(&way, &file));
    assert_eq!(free["skate_after"], Value::Null);
    let locked = result(&bundles.walk(&[&way[..], &["--footlock"]].concat(), &file));
    assert_eq!(free["skate_before"], locked["skate_before"]);
    let [before, after] = ["skate_before", "skate_after"].map(|key| locked[key].as_f64().unwrap());
    println!("{before:.3} m/s, locked {after:.3} m/s");
    assert!(after < before, "{after} of {before}");
}

#[test]
fn what_is_not_there_is_refused() {
    let bundles = Bundles::get();
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("walk.bvh");
    for (way, code) in [
        (&["--path", "B99999"][..], 2),
        (&["--path", "x"], 2),
        (&["--from", "B0"], 2),
        (&[], 2),
        (&["--random", "3", "--path", "B0"], 2),
    ] {
        assert_eq!(bundles.walk(way, &file).code, code, "{way:?}");
    }
    assert_eq!(
        bundles
            .walk(&["--random", "3"], &dir.path().join("walk.txt"))
            .code,
        2
    );
    assert!(!file.exists());
    // Over its own source.
    let good = result(&bundles.walk(&["--path", "B0"], &file));
    let clip = PathBuf::from(good["pieces"][0]["clip"].as_str().unwrap());
    let before = fs::read(&clip).unwrap();
    let run = bundles.walk(&["--path", "B0"], &clip);
    assert_eq!(run.code, 2, "{run:?}");
    assert!(run.stderr.contains("would be written over"), "{run:?}");
    assert_eq!(fs::read(&clip).unwrap(), before);
}

#[test]
fn clips_that_changed_since_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let source = Fixture::get().clip("ben", Class::JumpingJack);
    let (clip, model) = (dir.path().join("a.bvh"), dir.path().join("a.mbg"));
    assert_eq!(motif(&["convert", text(&source), text(&clip)]).code, 0);
    let made = motif(&["bundle", text(&clip), "-o", text(&model), "--kappa", "12"]);
    assert_eq!(made.code, 0, "{made:?}");
    let output = dir.path().join("walk.bvh");
    let args = ["walk", text(&model), "--path", "B0", "-o", text(&output)];
    assert_eq!(motif(&args).code, 0, "{:?}", motif(&args));
    let shorter = format!("{}@0-60", source.display());
    assert_eq!(motif(&["convert", &shorter, text(&clip)]).code, 0);
    let run = motif(&args);
    assert_eq!(run.code, 3, "{run:?}");
    assert!(
        run.stderr.contains("not what the bundles were made from"),
        "{run:?}"
    );
}
