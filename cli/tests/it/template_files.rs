//! Templates by hand, and their two forms.

use std::fs;
use std::path::Path;

use cli::templates::{load, load_all, save};

use crate::command::{motif, text};
use crate::learn::Learned;
use crate::templates::{row, template};

#[test]
fn sweeping_with_a_hand_brush_is_one_line() {
    // Paper 3, section 5.4: length 50, 0.5 but for F13 (right hand fast), F32 (spine horizontal) and
    // F33 (right hand lowered), which are one.
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("sweep.mtpl");
    let named = ["--name", "sweeping", "--length", "50"];
    let ones = ["--one", "F13,F32,F33", "-o", text(&out)];
    let json = template(&[&["new", "--json"], &named[..], &ones[..]].concat()).json();
    assert_eq!(
        json["result"]["features"],
        serde_json::json!(["rhand_fast", "spine_horizontal", "rhand_lowered"])
    );
    let sweep = load(&out).unwrap();
    assert_eq!(
        (sweep.name.as_str(), sweep.n_motions, sweep.tau),
        ("sweeping", None, None)
    );
    assert_eq!(
        (sweep.template.n_columns(), sweep.template.n_features()),
        (50, 39)
    );
    for (number, column) in (1..).zip(sweep.template.values().columns()) {
        let expected = if [13, 32, 33].contains(&number) {
            1.0
        } else {
            0.5
        };
        assert!(column.iter().all(|&value| value == expected), "F{number}");
    }
    // The same by hand.
    let written = fs::read_to_string(&out).unwrap();
    assert_eq!(
        written
            .lines()
            .filter(|line| line.ends_with("= \"1\""))
            .count(),
        3
    );
    let by_hand = dir.path().join("by_hand.mtpl");
    let lines = "motion_template = 1\nname = \"sweeping\"\nfeature_set = \"mueller2006\"\nrate = 30\n\
        columns = 50\n[features]\nrhand_fast = \"1\"\nrhand_lowered = \"1\"\nspine_horizontal = \"1\"\n";
    fs::write(&by_hand, lines).unwrap();
    assert_eq!(load(&by_hand).unwrap(), sweep);
}

#[test]
fn spans_of_a_new_template_are_painted() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("bend.mtpl");
    template(&[
        "new",
        "--length",
        "8",
        "--one",
        "rknee_bent@2-6",
        "--zero",
        "F13",
        "F14@7-8",
        "--at",
        "0-3",
        "-o",
        text(&out),
    ]);
    let bend = load(&out).unwrap();
    assert_eq!(
        row(&bend, "rknee_bent"),
        [0.5, 0.5, 1.0, 1.0, 1.0, 1.0, 0.5, 0.5]
    );
    assert_eq!(
        row(&bend, "rhand_fast"),
        [0.0, 0.0, 0.0, 0.5, 0.5, 0.5, 0.5, 0.5]
    );
    assert_eq!(
        row(&bend, "lhand_fast"),
        [0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.0]
    );
}

#[test]
fn both_forms_hold_the_same_and_damage_is_placed() {
    let learned = Learned::get();
    let dir = tempfile::tempdir().unwrap();
    let (binary, back) = (dir.path().join("squat.mtpb"), dir.path().join("back.mtpl"));
    let file = learned.file("squat");
    template(&["convert", text(&file), text(&binary)]);
    template(&["convert", text(&binary), text(&back)]);
    assert_eq!(fs::read(&back).unwrap(), fs::read(&file).unwrap());
    let mut bytes = fs::read(&binary).unwrap();
    bytes[500] ^= 4;
    fs::write(&binary, bytes).unwrap();
    let run = motif(&["template", "show", text(&binary)]);
    assert_eq!(run.code, 3);
    assert!(
        run.stderr.contains("squat.mtpb:byte 20: expected checksum"),
        "{run:?}"
    );
    let changed = fs::read_to_string(&file)
        .unwrap()
        .replacen("lhand_fast", "lhand_fst", 1);
    let line = 1 + changed
        .lines()
        .position(|line| line.contains("lhand_fst"))
        .unwrap();
    fs::write(&back, changed).unwrap();
    let run = motif(&["template", "show", text(&back)]);
    assert_eq!(run.code, 3);
    let expected =
        format!("back.mtpl:{line}:1: expected a feature of mueller2006, found \"lhand_fst\"");
    assert!(run.stderr.contains(&expected), "{run:?}");
    assert_eq!(
        motif(&["template", "show", text(&dir.path().join("none"))]).code,
        4
    );
    assert!(load_all(&[dir.path().join("none")]).is_err());
}

#[test]
fn a_set_of_ones_own_is_named_by_its_file() {
    let dir = tempfile::tempdir().unwrap();
    let set = dir.path().join("mine.toml");
    let own = relfeat::FeatureSet::builtin_toml("mueller2005").unwrap();
    fs::write(&set, own.replacen("\"mueller2005\"", "\"mine\"", 1)).unwrap();
    let (out, mirrored) = (dir.path().join("a.mtpl"), dir.path().join("b.mtpl"));
    let new = [
        "new",
        "--length",
        "3",
        "--one",
        "F1",
        "--set",
        text(&set),
        "-o",
        text(&out),
    ];
    template(&new);
    let run = motif(&["template", "mirror", text(&out), "-o", text(&mirrored)]);
    assert_eq!(run.code, 2, "{run:?}");
    assert!(
        run.stderr.contains("name its TOML file with --set"),
        "{run:?}"
    );
    template(&[
        "mirror",
        text(&out),
        "-o",
        text(&mirrored),
        "--set",
        text(&set),
    ]);
    let mirrored = load(&mirrored).unwrap();
    let ones: Vec<usize> = (0..mirrored.features.len())
        .filter(|&feature| mirrored.template.values()[[0, feature]] == 1.0)
        .collect();
    // The first two are the right foot and the left foot.
    assert_eq!(ones, [1]);
    // A file with only some of the rows is laid out over the set.
    let mut part = mirrored.clone();
    part.features = mirrored.features[..2].to_vec();
    let values = mirrored
        .template
        .values()
        .slice(ndarray::s![.., ..2])
        .to_owned();
    let weights = mirrored.template.weights().to_owned();
    part.template = mtemplate::MotionTemplate::new(values, weights).unwrap();
    save(&part, &out).unwrap();
    let again = dir.path().join("c.mtpl");
    template(&[
        "restrict",
        text(&out),
        "--set",
        text(&set),
        "-o",
        text(&again),
        "--name",
        "b",
    ]);
    assert_eq!(load(&again).unwrap(), mirrored);
}

#[test]
fn commands_that_make_no_sense_are_refused() {
    let learned = Learned::get();
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("x.mtpl");
    let (squat, clips) = (learned.file("squat"), learned.clips("squat"));
    let (squat, clips, out) = (text(&squat), text(&clips), text(&out));
    let folder = text(dir.path());
    for args in [
        &["learn", clips, "-o", folder][..],
        &["learn", clips, "--rate", "0", "-o", out],
        &["learn", clips, "--by-folder", clips, "-o", out],
        &[
            "template",
            "restrict",
            squat,
            "--features",
            "rkne_bent",
            "-o",
            out,
        ],
        &[
            "template",
            "restrict",
            squat,
            "--columns",
            "0-100000",
            "-o",
            out,
        ],
        &[
            "template",
            "restrict",
            squat,
            "--seconds",
            "50-60",
            "-o",
            out,
        ],
        &["template", "new", "--length", "0", "-o", out],
        &[
            "template", "new", "--length", "10", "--one", "F1", "--zero", "F1@9-10", "-o", out,
        ],
        &[
            "template", "new", "--length", "10", "--one", "F1@5", "-o", out,
        ],
        &["template", "combine", squat, "-o", out],
        &["template", "show", squat, "-o", out],
        &["learn", "--by-folder", squat, "-o", out],
    ] {
        let run = motif(args);
        assert_eq!(run.code, 2, "{args:?}: {run:?}");
        assert!(!Path::new(out).exists());
    }
}
