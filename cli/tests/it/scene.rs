//! Scene descriptions, on the built-in corpus and on real files.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use cli::commands::search::scene::{SceneResult, search};
use cli::corpus::{Class, Label};
use cli::library::Library;
use cli::output::Voice;
use serde_json::Value;

use crate::command::{motif, text};
use crate::corpus::{Fixture, build};
use crate::real::data;

const KICK_PUNCH: &str = include_str!("../../examples/right_kick_left_punch.scene");

/// The example with the punch first.
fn punch_kick() -> String {
    let (kick, punch) = ("rfoot_raised[2]", "lelbow_bent[3]");
    let scene = KICK_PUNCH.replace(
        &format!("before {kick} {punch}"),
        &format!("before {punch} {kick}"),
    );
    assert_ne!(scene, KICK_PUNCH);
    scene
}

fn find(library: &Library, scene: &str) -> SceneResult {
    search(library, scene, 0, Voice::default()).unwrap()
}

/// Where the corpus's labels have `first` and then at once `second`.
fn performed(first: Class, second: Class) -> Vec<(PathBuf, Label, Label)> {
    let files = Fixture::get().files.iter();
    let in_a_row = files.flat_map(|file| {
        let pairs = file.labels.windows(2);
        let wanted = pairs.filter(move |pair| {
            (pair[0].class, pair[1].class) == (first, second)
                && pair[0].span.end == pair[1].span.start
        });
        wanted.map(|pair| (file.path.clone(), pair[0].clone(), pair[1].clone()))
    });
    in_a_row.collect()
}

fn lies_in(frames: [usize; 2], label: &Label) -> bool {
    label.span.start <= frames[0] && frames[1] <= label.span.end
}

#[test]
fn kick_and_punch_are_found_where_they_are_performed_and_nowhere_else() {
    let fixture = Fixture::get();
    let library = Library::open(&fixture.library()).unwrap();
    let (kick, punch) = (Class::KickRight, Class::PunchLeft);
    for (scene, first, second, n_takes) in [
        (KICK_PUNCH.to_owned(), kick, punch, 2),
        (punch_kick(), punch, kick, 1),
    ] {
        let expected = performed(first, second);
        assert_eq!(expected.len(), n_takes, "{first} {second}");
        let result = find(&library, &scene);
        assert_eq!((result.n_hits, result.n_clips), (n_takes, n_takes));
        for (path, one, other) in expected {
            let mut hits = result.hits.iter();
            let hit = hits.find(|h| Path::new(&h.hit.clip) == path).unwrap();
            let both = [one.span.start, other.span.end];
            assert!(
                both[0] <= hit.hit.start && hit.hit.end <= both[1],
                "{hit:?}"
            );
            let (kick, punch) = if first == kick {
                (one, other)
            } else {
                (other, one)
            };
            // The lines of the foot, the knee, the elbow and the hand.
            for (line, label) in [(0, &kick), (1, &kick), (2, &punch), (3, &punch)] {
                assert!(lies_in(hit.hit.segments[line], label), "{hit:?}");
            }
        }
    }
}

#[test]
fn every_right_kick_is_found_and_nothing_else() {
    let fixture = Fixture::get();
    let library = Library::open(&fixture.library()).unwrap();
    let kick = "rfoot_raised: 0 1 0; rknee_bent: 0 1 0 1 0; overlap rfoot_raised[2] rknee_bent[3]";
    let result = find(&library, kick);
    let mut n_kicks = 0;
    for file in &fixture.files {
        for label in file.labels.iter().filter(|l| l.class == Class::KickRight) {
            n_kicks += 1;
            let mut hits = result.hits.iter().map(|h| &h.hit);
            let is_here =
                hits.any(|h| Path::new(&h.clip) == file.path && lies_in([h.start, h.end], label));
            assert!(is_here, "{} {label:?}", file.path.display());
        }
    }
    assert_eq!(result.n_hits, n_kicks);
}

/// The scenes that people copy find what they say.
#[test]
fn the_scenes_of_help_and_readme_are_found() {
    let library = Library::open(&Fixture::get().library()).unwrap();
    let help = motif(&["search", "--help"]).stdout;
    for text in [&help, include_str!("../../../README.md")] {
        let lines = text.lines().map(str::trim_start);
        let scene: Vec<&str> = lines
            .skip_while(|line| !line.starts_with("rfoot_raised :"))
            .take_while(|line| !line.starts_with("```") && !line.starts_with("A line"))
            .collect();
        assert_eq!(scene.len(), 6, "{scene:?}");
        let result = find(&library, &scene.join("\n"));
        let clips: Vec<PathBuf> = result.hits.iter().map(|h| (&h.hit.clip).into()).collect();
        let performed = performed(Class::KickRight, Class::PunchLeft);
        let expected: Vec<PathBuf> = performed.into_iter().map(|(path, ..)| path).collect();
        assert_eq!(clips, expected);
    }
}

/// The scene as the 2005 paper describes it, by the features of that paper.
const ON_THE_PAPERS_FEATURES: &str = "\
# right foot kick followed by a left hand punch
rfoot_raised : 0 1 0
rknee_bent   : 0 1 0 1 0
lhand_front  : * 0 1 0
overlap rfoot_raised[2] rknee_bent[3]
before  rfoot_raised[2] lhand_front[3]";

#[test]
fn the_papers_scene_is_found_by_its_own_features() {
    let fixture = Fixture::get();
    let folder = fixture.dir.path().join("library2005");
    let run = motif(&[
        "index",
        text(&fixture.corpus()),
        "-o",
        text(&folder),
        "--set",
        "mueller2005",
    ]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let result = find(&Library::open(&folder).unwrap(), ON_THE_PAPERS_FEATURES);
    // The best hits, before motions in which a hand comes forward much later.
    let performed = performed(Class::KickRight, Class::PunchLeft);
    for (path, kick, punch) in &performed {
        let best = &result.hits[..performed.len()];
        let hit = best.iter().find(|h| Path::new(&h.hit.clip) == path);
        let hit = &hit.unwrap_or_else(|| panic!("{}", path.display())).hit;
        assert!(
            kick.span.start <= hit.start && hit.end <= punch.span.end,
            "{hit:?}"
        );
    }
}

fn scene_file(name: &str, scene: &str) -> PathBuf {
    let path = Fixture::get().dir.path().join(name);
    fs::write(&path, scene).unwrap();
    path
}

#[test]
fn a_scene_is_a_file_or_a_text() {
    let library = Fixture::get().library();
    let file = scene_file("kick_punch.scene", KICK_PUNCH);
    let run = |args: &[&str]| motif(&[&["search", text(&library), "--scene"], args].concat());
    let from_file = run(&[text(&file), "--json"]);
    assert_eq!(from_file.code, 0, "{from_file:?}");
    let from_text = run(&[KICK_PUNCH, "--json"]);
    assert_eq!(from_file.stdout, from_text.stdout);

    let document = from_file.json();
    assert_eq!(document["command"], "search");
    let result = &document["result"];
    assert_eq!(result["query"]["scene"], KICK_PUNCH);
    let line = &result["query"]["lines"][2];
    assert_eq!(
        (&line["name"], &line["feature"]),
        (&"lelbow_bent".into(), &"lelbow_bent".into())
    );
    assert_eq!(line["progression"], "* 1 0 1");
    let hits = result["hits"].as_array().unwrap();
    assert_eq!(hits.len(), 2);
    for (i, hit) in hits.iter().enumerate() {
        assert_eq!(hit["rank"], i + 1);
        let cores = hit["segments"].as_array().unwrap();
        let frames = |at: usize| cores.iter().map(move |core| core[at].as_u64().unwrap());
        assert_eq!(hit["start"].as_u64(), frames(0).min());
        assert_eq!(hit["end"].as_u64(), frames(1).max());
        let lines = hit["lines"].as_array().unwrap();
        let n_positions: Vec<usize> = lines
            .iter()
            .map(|l| l["segments"].as_array().unwrap().len())
            .collect();
        assert_eq!(n_positions, [4, 6, 4, 4]);
        assert_eq!(lines[3]["name"], "lhand_moving_forwards");
        assert_eq!(lines[2]["segments"][0][0], 0, "* begins with the clip");
    }
    assert!(hits[0]["cost"].as_u64() <= hits[1]["cost"].as_u64());

    let spoken = run(&[text(&file), "--top", "1"]);
    for needle in [
        "2 hits in 2 clips",
        "take_01.amc",
        "lelbow_bent * 1 0 1",
        "and 1 more",
    ] {
        assert!(
            spoken.stdout.contains(needle),
            "{needle} is not in\n{}",
            spoken.stdout
        );
    }
}

#[test]
fn scenes_end_with_the_exit_codes_of_other_commands() {
    let library = Fixture::get().library();
    let run = |args: &[&str]| motif(&[&["search", text(&library)], args].concat());
    let check = |args: &[&str], code: i32, stderr: &str| {
        let run = run(args);
        assert_eq!(run.code, code, "{run:?}");
        assert!(
            run.stderr.contains(stderr),
            "{stderr} is not in\n{}",
            run.stderr
        );
    };
    let nothing = run(&["--scene", "F32: 0 1 0 1 0 1 0 1 0"]);
    assert_eq!(nothing.code, 1, "{nothing:?}");
    assert!(
        nothing.stdout.contains("nothing found"),
        "{}",
        nothing.stdout
    );
    check(
        &["--scene", "F32: 1 1; within 0s"],
        1,
        "--scene:1:8: 1 twice in a row is one run",
    );

    let nearest =
        "--scene:1:8: mueller2006 has no feature \"rkne_bent\"; the nearest name is rknee_bent";
    check(&["--scene", "F1: 0; rkne_bent: 1"], 2, nearest);
    check(
        &["--scene", "no_such.scene"],
        2,
        "no such file, and no scene",
    );
    check(
        &["--scene", "F1: 1", "--example", "x.bvh"],
        2,
        "cannot be used with",
    );
    check(
        &["--scene", "F1: 1", "--features", "F1"],
        2,
        "cannot be used with",
    );
    check(
        &["--scene", "F1: 1", "--mode", "exact"],
        2,
        "cannot be used with",
    );
    check(&[], 2, "--example");

    let broken = scene_file("broken.scene", "F1 : 0 1\nbefore F1[1] F1[3]\n");
    let message = "broken.scene:2:17: expected a position from 1 to 2 of F1, found 3";
    check(&["--scene", text(&broken)], 3, message);
    let binary = Fixture::get().dir.path().join("binary.scene");
    fs::write(&binary, [b'F', 0xff, b':']).unwrap();
    check(&["--scene", text(&binary)], 3, "expected UTF-8 text");
}

#[test]
fn quiet_and_json_keep_notes_to_themselves() {
    let library = Fixture::get().library();
    for option in ["--json", "-q"] {
        let run = motif(&["search", text(&library), "--scene", "F32: 0 0 1", option]);
        assert_eq!((run.code, run.stderr.as_str()), (0, ""), "{run:?}");
    }
    let run = motif(&["search", text(&library), "--scene", "F32: 0 0 1", "--json"]);
    assert_eq!(run.json()["skipped"], Value::Array(Vec::new()));
}

/// The kick of the paper with the left foot. In HDM05 the folders say which clips are kicks; in CMU subject 135 does
/// karate, and the descriptions call three of its clips kicks: front kick, mawashigeri, yokogeri. The numbers of hits
/// were counted by another implementation, which compares sets of frames; in the four kicks of HDM05 that are not among
/// them the knee stays bent throughout.
#[test]
fn real_left_kicks_are_found_among_other_motions() {
    let Some(data) = data() else { return };
    let dir = tempfile::tempdir().unwrap();
    let kick = "lfoot_raised: 0 1 0; lknee_bent: 0 1 0 1 0; overlap lfoot_raised[2] lknee_bent[3]";
    let clips = |folder: &str| {
        let library = dir.path().join(folder.replace('/', "_"));
        build(&[data.join(folder)], &library);
        let result = find(&Library::open(&library).unwrap(), kick);
        let mut by_clip: BTreeMap<String, usize> = BTreeMap::new();
        for hit in &result.hits {
            let clip = Path::new(&hit.hit.clip)
                .strip_prefix(data.join(folder))
                .unwrap();
            *by_clip.entry(clip.display().to_string()).or_default() += 1;
        }
        println!(
            "{folder}: {} hits in {} clips",
            result.n_hits,
            by_clip.len()
        );
        by_clip
    };
    let hdm05 = clips("hdm05");
    assert!(
        hdm05
            .keys()
            .all(|clip| clip.starts_with("kickLFront1Reps/")),
        "{hdm05:?}"
    );
    assert!(
        hdm05.values().all(|&n| n == 1),
        "one kick per clip: {hdm05:?}"
    );
    assert_eq!(hdm05.len(), 25, "{hdm05:?}");
    let karate = clips("cmu/135");
    assert_eq!(karate.values().sum::<usize>(), 7);
    let kicks: Vec<&str> = karate.keys().map(String::as_str).collect();
    assert_eq!(kicks, ["135_04.amc", "135_07.amc", "135_11.amc"]);
}
