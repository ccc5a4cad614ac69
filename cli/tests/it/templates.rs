//! Templates looked at and edited.

use std::fs;
use std::path::Path;

use cli::templates::load;
use mtemplate::{ANY, ClassTemplate};
use serde_json::Value;

use crate::command::{Output, motif, text};
use crate::learn::{Learned, PERFORMERS};

/// Runs `motif template …`, which must succeed.
#[track_caller]
pub(crate) fn template(args: &[&str]) -> Output {
    let run = motif(&[&["template"], args].concat());
    assert_eq!(run.code, 0, "{run:?}");
    run
}

pub(crate) fn row(template: &ClassTemplate, name: &str) -> Vec<f64> {
    let feature = template.features.iter().position(|other| other == name);
    template.template.values().column(feature.unwrap()).to_vec()
}

#[test]
fn a_template_is_shown_as_text_as_json_and_as_a_picture() {
    let learned = Learned::get();
    let dir = tempfile::tempdir().unwrap();
    let picture = dir.path().join("squat.png");
    let file = learned.file("squat");
    let shown = template(&["show", text(&file), "-o", text(&picture)]).stdout;
    let squat = learned.template("squat");
    let n_columns = squat.template.n_columns();
    assert!(
        shown.starts_with(&format!("squat: {n_columns} columns, ")),
        "{shown}"
    );
    let line = shown
        .lines()
        .find(|line| line.starts_with("F20 rknee_bent "))
        .unwrap();
    let cells = line.split('|').nth(1).unwrap();
    let quantized = row(&squat, "rknee_bent")
        .into_iter()
        .map(|value| match value {
            v if v <= 0.1 => '.',
            v if v >= 0.9 => '#',
            _ => ' ',
        });
    assert_eq!(cells, quantized.collect::<String>());
    let axis = shown.lines().find(|line| line.contains("|0.00 s"));
    assert!(axis.is_some_and(|axis| axis.contains(" 0.67 s")), "{shown}");
    assert!(fs::read(&picture).unwrap().starts_with(b"\x89PNG"));

    let json = template(&["show", "--json", text(&file)]).json();
    let knee = &json["result"]["features"][19];
    assert_eq!(knee["name"], "rknee_bent");
    let values: Vec<f64> = serde_json::from_value(knee["values"].clone()).unwrap();
    assert_eq!(values, row(&squat, "rknee_bent"));
    let drawn = cells.replace('.', "0").replace('#', "1").replace(' ', "*");
    assert_eq!(knee["cells"], drawn.as_str());
}

/// The left/right pairs of the paper's features, spec.md a.1, 1-based.
const MIRROR: [usize; 39] = [
    2, 1, 4, 3, 6, 5, 8, 7, 9, 10, 12, 11, 14, 13, 16, 15, 18, 17, 19, 21, 20, 22, 23, 24, 26, 25,
    28, 27, 30, 29, 31, 32, 34, 33, 36, 35, 37, 38, 39,
];

#[test]
fn a_mirrored_left_kick_is_a_right_kick() {
    let learned = Learned::get();
    let dir = tempfile::tempdir().unwrap();
    let (right, back) = (dir.path().join("right.mtpl"), dir.path().join("back.mtpl"));
    let left = learned.file("kick_left");
    template(&["mirror", text(&left), "-o", text(&right)]);
    template(&[
        "mirror",
        text(&right),
        "-o",
        text(&back),
        "--name",
        "kick_left",
    ]);
    assert_eq!(fs::read(&back).unwrap(), fs::read(&left).unwrap());
    let (left, right) = (load(&left).unwrap(), load(&right).unwrap());
    assert_eq!(right.name, "right");
    for (feature, mirror) in MIRROR.into_iter().enumerate() {
        let columns = |t: &ClassTemplate, i: usize| t.template.values().column(i).to_vec();
        assert_eq!(columns(&right, feature), columns(&left, mirror - 1));
    }
    // As with the paper's cartwheels: the template of the left ones finds the right ones mirrored.
    let clips = learned.clips("kick_right");
    let features = motif(&["features", "--json", text(&clips)]).json();
    for clip in features["result"].as_array().unwrap() {
        let word = |word: &Value| {
            let digits = word.as_str().unwrap().trim_start_matches("0x");
            u64::from_str_radix(digits, 16).unwrap()
        };
        let words: Vec<u64> = clip["words"].as_array().unwrap().iter().map(word).collect();
        let cheapest = |t: &ClassTemplate| {
            let curve = t.template.quantize(0.1).unwrap().distance_curve(&words);
            curve.costs().flatten().fold(f64::INFINITY, f64::min)
        };
        assert!(cheapest(&right) < cheapest(&left), "{}", clip["clip"]);
    }
}

#[test]
fn combined_classes_keep_what_they_share() {
    let learned = Learned::get();
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("rotate.mtpl");
    let forward = learned.file("arms/forward");
    let backward = learned.file("arms/backward");
    template(&["combine", text(&forward), text(&backward), "-o", text(&out)]);
    let both = load(&out).unwrap();
    assert_eq!(both.name, "rotate");
    assert_eq!(both.n_motions, Some(2 * PERFORMERS.len()));
    // Neither class bends a knee.
    assert!(row(&both, "rknee_bent").iter().all(|&value| value == 0.0));
    let itself = dir.path().join("itself.mtpl");
    template(&[
        "combine",
        text(&forward),
        text(&forward),
        "-o",
        text(&itself),
    ]);
    let shown = |path: &Path| template(&["show", "--json", text(path)]).json()["result"].clone();
    let (before, after) = (shown(&forward), shown(&itself));
    for feature in 0..39 {
        let cells = |shown: &Value| shown["features"][feature]["cells"].clone();
        assert_eq!(cells(&before), cells(&after));
    }
    // Another rate.
    let slow = dir.path().join("slow.mtpl");
    template(&[
        "new",
        "--length",
        "5",
        "--rate",
        "10",
        "--one",
        "F1",
        "-o",
        text(&slow),
    ]);
    let run = motif(&[
        "template",
        "combine",
        text(&forward),
        text(&slow),
        "-o",
        text(&out),
    ]);
    assert_eq!(run.code, 2, "{run:?}");
    assert!(
        run.stderr.contains("30 Hz of mueller2006 and 10 Hz"),
        "{run:?}"
    );
}

#[test]
fn a_restricted_template_asks_for_less() {
    let learned = Learned::get();
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("knees.mtpl");
    let file = learned.file("squat");
    let squat = learned.template("squat");
    let knees = ["--features", "*knee*", "--columns", "10-25"];
    template(&[&["restrict", text(&file), "-o", text(&out)], &knees[..]].concat());
    let part = load(&out).unwrap();
    assert_eq!(part.features, squat.features);
    for name in &squat.features {
        let expected = match name.contains("knee") {
            true => row(&squat, name)[10..25].to_vec(),
            false => vec![ANY; 15],
        };
        assert_eq!(row(&part, name), expected, "{name}");
    }
    // Columns are a thirtieth of a second long: 0.4 s is where the thirteenth begins.
    template(&[
        "restrict",
        text(&file),
        "--seconds",
        "0.4-0.5",
        "-o",
        text(&out),
    ]);
    let part = load(&out).unwrap();
    assert_eq!(row(&part, "rknee_bent"), row(&squat, "rknee_bent")[12..15]);
}
