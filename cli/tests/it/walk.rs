//! `motif walk` as a user runs it.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use bundles::BundleGraph;
use cli::corpus::Class;
use cli::corpus_files::ClipFile;
use cli::recording::{ReadOptions, load};
use mocap_io::Motion;
use serde_json::{Value, json};
use tempfile::TempDir;

use crate::command::{Output, motif, text};
use crate::corpus::Fixture;
use crate::jumps::Steps;

pub(crate) fn motion(path: &Path) -> Motion {
    let loaded = load(path, &ReadOptions::default()).unwrap();
    loaded.recording.motion().unwrap().clone()
}

#[track_caller]
pub(crate) fn result(run: &Output) -> Value {
    assert_eq!(run.code, 0, "{run:?}");
    run.json()["result"].clone()
}

/// By this method, some of the bundles of these few clips do not lead to all others.
const WITH_ENDS: [&str; 4] = ["--method", "paper", "--closure", "direct"];

/// Bundles of eva's walks, jogs and takes.
pub(crate) struct Bundles {
    dir: TempDir,
    clips: Vec<PathBuf>,
}

impl Bundles {
    pub(crate) fn get() -> &'static Bundles {
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
            args.extend(WITH_ENDS);
            args.extend(["--kappa", "40", "-o", text(&model), "--quiet"]);
            let run = motif(&args);
            assert_eq!(run.code, 0, "{run:?}");
            bundles
        })
    }

    fn model(&self) -> PathBuf {
        self.dir.path().join("eva.mbg")
    }

    /// Steps of the clips.
    pub(crate) fn steps(&self) -> Vec<Steps> {
        let clips = self.clips.iter();
        clips.map(|clip| Steps::of(&motion(clip))).collect()
    }

    pub(crate) fn walk(&self, way: &[&str], output: &Path) -> Output {
        let model = self.model();
        let mut args = vec!["walk", text(&model), "-o", text(output), "--json"];
        args.extend(way);
        motif(&args)
    }
}

pub(crate) fn ids(result: &Value) -> Vec<u64> {
    let ids = result["bundles"].as_array().unwrap();
    ids.iter().map(|id| id.as_u64().unwrap()).collect()
}

/// In the largest part of the graph whose bundles all lead to each other, where one can go on for ever.
#[test]
fn a_random_walk_does_not_end_early_and_says_where_it_stays() {
    let bundles = Bundles::get();
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("walk.csv");
    let model = cli::bundling::load(&bundles.model()).unwrap().model;
    let graph = model.graph();
    let leads_back = |ids: &&Vec<usize>| {
        let mut edges = graph.edges().iter();
        edges.any(|edge| ids.contains(&edge.from) && ids.contains(&edge.to))
    };
    let components = graph.components();
    let largest = components.iter().filter(leads_back).map(Vec::len).max();
    let largest = largest.expect("steps repeat");
    let n_bundles = graph.bundles().len();
    assert!(largest < n_bundles, "nothing is left out: {largest}");
    for seed in ["0", "1", "2"] {
        let walk = result(&bundles.walk(&["--random", "60", "--seed", seed], &file));
        let found = ids(&walk);
        assert_eq!(found.len(), 60);
        let holds = |ids: &&Vec<usize>| found.iter().all(|id| ids.contains(&(*id as usize)));
        let component = components.iter().find(holds).unwrap();
        assert_eq!(component.len(), largest);
        let frames = |ids: &mut dyn Iterator<Item = usize>| -> usize {
            let spans = ids.flat_map(|id| &graph.bundles()[id].submotions);
            spans.map(|submotion| submotion.span.len()).sum()
        };
        let expected = json!({
            "bundles": largest,
            "all_bundles": n_bundles,
            "frames": frames(&mut component.iter().copied()),
            "all_frames": frames(&mut (0..n_bundles)),
        });
        assert_eq!(walk["reach"], expected);
    }
    let named = result(&bundles.walk(&["--path", "B0"], &file));
    let risky = result(&bundles.walk(&["--random", "60", "--dead-ends"], &file));
    assert_eq!([&named["reach"], &risky["reach"]], [&Value::Null; 2]);

    let (model, output) = (bundles.model(), text(&file));
    let run = motif(&["walk", text(&model), "--random", "60", "-o", output]);
    let stays = format!("stays in the {largest} of {n_bundles} bundles");
    assert!(run.stdout.contains(&stays), "{run:?}");
}

/// Lying down has no way back.
#[test]
fn where_every_way_ends_a_walk_ends_early_and_says_so() {
    let dir = tempfile::tempdir().unwrap();
    let model = dir.path().join("down.mbg");
    let is_down = |file: &&ClipFile| {
        let own = file.path.starts_with(Fixture::get().corpus().join("ben"));
        own && file.class == Some(Class::LieDown)
    };
    let mut args = vec!["bundle", "--kappa", "3", "-o", text(&model)];
    args.extend(WITH_ENDS);
    let clips = Fixture::get().files.iter().filter(is_down);
    args.extend(clips.map(|file| text(&file.path)));
    assert_eq!(motif(&args).code, 0);
    let graph = cli::bundling::load(&model).unwrap().model;
    let graph = graph.graph();
    assert_eq!(graph.edges().len(), 1, "one bundle, then the other");
    let (from, to) = (graph.edges()[0].from, graph.edges()[0].to);
    assert_ne!(from, to);

    let file = dir.path().join("walk.bvh");
    for seed in ["0", "1", "2", "3"] {
        let walk = ["walk", text(&model), "--random", "10", "--seed", seed];
        let run = motif(&[&walk[..], &["-o", text(&file), "--json"]].concat());
        let found = result(&run);
        let way = ids(&found);
        let all = [from as u64, to as u64];
        // From any bundle, to the end.
        assert!(way == all || way == all[1..], "{way:?}");
        assert_eq!(found["reach"], Value::Null);
    }
    let run = motif(&["walk", text(&model), "--random", "10", "-o", text(&file)]);
    let early = format!("the walk ends early: nothing follows B{to}");
    assert!(run.stderr.contains(&early), "{run:?}");
}

#[test]
fn a_walk_lasts_as_long_as_it_is_asked_to() {
    let bundles = Bundles::get();
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("walk.csv");
    let seed = ["--seed", "4"];
    let frames = |result: &Value| result["frames"].as_u64().unwrap();
    let walk = |way: &[&str]| result(&bundles.walk(&[way, &seed].concat(), &file));
    for seconds in ["0.01", "7.5"] {
        let lasting = walk(&["--seconds", seconds]);
        let seconds: f64 = seconds.parse().unwrap();
        assert!(lasting["seconds"].as_f64().unwrap() >= seconds);
        let n = ids(&lasting).len();
        let same = walk(&["--random", &n.to_string()]);
        assert_eq!(ids(&same), ids(&lasting));
        if n > 1 {
            // One bundle less would be too short.
            let shorter = walk(&["--random", &(n - 1).to_string()]);
            assert!(shorter["seconds"].as_f64().unwrap() < seconds);
            assert!(frames(&shorter) < frames(&lasting));
        }
    }
    for wrong in ["0", "-1", "nan", "inf", "4000", "x"] {
        let wrong = format!("--seconds={wrong}");
        assert_eq!(bundles.walk(&[&wrong], &file).code, 2, "{wrong}");
    }
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
    // A bundle counts its mean frames, so that the motion itself may be a little longer.
    let model = cli::bundling::load(&bundles.model()).unwrap().model;
    let length = |result: &Value| length(model.graph(), &ids(result));
    assert!(length(&shortest) <= length(&path));
}

/// Mean frames of the bundles on a way, and frames of the shortest transitions between them.
fn length(graph: &BundleGraph, ids: &[u64]) -> f64 {
    let ids: Vec<usize> = ids.iter().map(|&id| id.try_into().unwrap()).collect();
    let bundles = ids.iter().map(|&id| graph.bundles()[id].mean_frames());
    let transitions = ids.windows(2).map(|pair| {
        let passages = graph.edge(pair[0], pair[1]).unwrap().passages.iter();
        let frames = passages.map(|p| p.transition.as_ref().map_or(0, |t| t.span.len()));
        frames.min().unwrap() as f64
    });
    bundles.sum::<f64>() + transitions.sum::<f64>()
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
