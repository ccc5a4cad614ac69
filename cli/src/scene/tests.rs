use super::*;
use relfeat::FeatureSet;

use SceneTextErrorKind as Kind;

fn set() -> FeatureSet {
    FeatureSet::builtin("mueller2006").unwrap()
}

#[track_caller]
fn check(text: &str, line: usize, column: usize, kind: Kind) {
    let error = parse(text, &set()).unwrap_err();
    assert_eq!(error.kind, kind, "{error}");
    let at = (error.at.line(), error.at.column());
    assert_eq!(at, (Some(line), Some(column)), "{error}");
}

#[track_caller]
fn check_expected(text: &str, column: usize, expected: &'static str, found: &str) {
    let found = found.to_owned();
    check(text, 1, column, Kind::Expected { expected, found });
}

const EXAMPLE: &str = "\
# right foot kick followed by a left hand punch
rfoot_raised : 0 1 0
rknee_bent   : 0 1 0 1 0
F8 as punch: * 1 0 1   # the left elbow
overlap rfoot_raised[2] rknee_bent[3]
before  rfoot_raised[2] punch[ 3 ]
within 1.5s rfoot_raised[2] punch[3]
within 4s
";

fn run(line: usize, position: usize) -> RunRef {
    RunRef { line, position }
}

#[test]
fn the_parts_of_a_scene() {
    let scene = parse(EXAMPLE, &set()).unwrap();
    let lines: Vec<_> = scene
        .lines
        .iter()
        .map(|line| (line.name.as_str(), line.feature_idx, line.progression()))
        .collect();
    let expected = [
        ("rfoot_raised", 16, "0 1 0"),
        ("rknee_bent", 19, "0 1 0 1 0"),
        ("punch", 7, "* 1 0 1"),
    ];
    assert_eq!(lines, expected.map(|(n, i, p)| (n, i, p.to_owned())));
    let relations: Vec<_> = scene.relations.iter().map(|r| (r.kind, r.a, r.b)).collect();
    let expected = [
        (RelationKind::Overlap, run(0, 1), run(1, 2)),
        (RelationKind::Before, run(0, 1), run(2, 2)),
        (RelationKind::Within(1.5), run(0, 1), run(2, 2)),
    ];
    assert_eq!(relations, expected);
    assert_eq!(scene.max_seconds, Some(4.0));
    assert_eq!(scene.notes, []);
    assert_eq!(scene.care(), 1 << 16 | 1 << 19 | 1 << 7);
}

#[test]
fn semicolons_blanks_and_order_do_not_matter() {
    let lines: Vec<&str> = EXAMPLE
        .lines()
        .map(|l| l.split('#').next().unwrap())
        .collect();
    let mut backward = lines.clone();
    backward.reverse();
    let scene = parse(EXAMPLE, &set()).unwrap();
    for text in [
        lines.join(";"),
        lines.join("\r\n"),
        lines.join("\r").replace(':', " :\t"),
    ] {
        assert_eq!(parse(&text, &set()).unwrap(), scene, "{text}");
    }
    let backward = parse(&backward.join("\n"), &set()).unwrap();
    assert_eq!(backward.lines.len(), 3);
    assert_eq!(backward.relations[2].a, run(2, 1));
}

#[test]
fn a_value_twice_is_noted_and_one_run() {
    let scene = parse(
        "rknee_bent : * * 0 0 1\nbefore rknee_bent[4] rknee_bent[5]",
        &set(),
    )
    .unwrap();
    let notes: Vec<_> = scene
        .notes
        .iter()
        .map(|(at, n)| (at.column(), n.as_str()))
        .collect();
    assert_eq!(notes, [(Some(20), "0 twice in a row is one run")]);
    let query = scene.query(30.0).unwrap();
    let runs: Vec<_> = (0..5).map(|p| query.lines()[0].run_of(p)).collect();
    assert_eq!(runs, [0, 0, 1, 1, 2].map(Some));
}

#[test]
fn a_duration_is_as_many_frames_as_fit() {
    let frames = |duration: &str, rate: f64| {
        let text = format!("F1: 1; within {duration}");
        parse(&text, &set())
            .unwrap()
            .query(rate)
            .unwrap()
            .max_frames()
    };
    assert_eq!(frames("1.5s", 30.0), Some(45));
    // 0.7 × 30 is less than 21 in doubles.
    assert_eq!(frames("0.7s", 30.0), Some(21));
    assert_eq!(frames("700ms", 30.0), Some(21));
    assert_eq!(frames("0.05s", 30.0), Some(1));
    assert_eq!(frames("0s", 30.0), Some(0));
    assert_eq!(frames("3s;within 2s;within 5s", 30.0), Some(60));
    let scene = parse("F1: 0 1; within 0.5s F1[1] F1[2]", &set()).unwrap();
    assert_eq!(
        scene.query(30.0).unwrap().relations(),
        [segidx::Relation::Within(15, run(0, 0), run(0, 1))]
    );
}

#[test]
fn words_out_of_place() {
    let statement = "`FEATURE : 0 1 …`, overlap, before or within";
    let end = "the end of the statement";
    check_expected("F1 0 1 0", 1, statement, "\"F1\"");
    check_expected(": 0 1", 1, "a feature", "\":\"");
    check_expected("F1 as : 0", 7, "a name for the line", "\":\"");
    check_expected(
        "F1 F2 : 0",
        4,
        "`:`, or `as` and a name for the line",
        "\"F2\"",
    );
    check_expected("F1 :  # nothing", 5, "0, 1 or *", end);
    check_expected("F1 : 0 2", 8, "0, 1 or *", "\"2\"");
    check_expected("F1 : 010", 6, "0, 1 or *", "\"010\"");
    check_expected("F1: 0; before", 14, "a run such as rknee_bent[2]", end);
    check_expected("F1: 0; before F1", 17, "`[` and a position", end);
    check_expected("F1: 0; before F1 F1", 18, "`[` and a position", "\"F1\"");
    check_expected("F1: 0; before F1[-1]", 18, "a position from 1 on", "\"-1\"");
    check_expected("F1: 0; before F1[1 F1", 20, "`]`", "\"F1\"");
    let more = "the end of the statement, which is a line's or a `;`";
    check_expected("F1: 0 1; before F1[1] F1[2] F1", 29, more, "\"F1\"");
    for time in ["5", "s", "-1s", "infs", "1.2.3s", "1min"] {
        let text = format!("F1: 0; within {time}");
        check_expected(
            &text,
            15,
            "a time such as 1.5s or 250ms",
            &format!("{time:?}"),
        );
    }
}

#[test]
fn a_text_without_lines() {
    check("", 1, 1, Kind::NoLines);
    check("# nothing\n;;", 2, 3, Kind::NoLines);
    check("within 5s", 1, 10, Kind::NoLines);
    check("before a[1] b[1]", 1, 8, Kind::NoLines);
}

#[test]
fn names_that_do_not_exist_get_the_nearest() {
    let unknown = |found: &str, nearest: &str| Kind::UnknownFeature {
        found: found.to_owned(),
        set: "mueller2006".to_owned(),
        nearest: nearest.to_owned(),
        elsewhere: None,
    };
    check(
        "F1: 1\n rkne_bent : 0",
        2,
        2,
        unknown("rkne_bent", "rknee_bent"),
    );
    let kind = Kind::ManyFeatures {
        found: "lower".to_owned(),
        n_features: 12,
    };
    check("lower : 0 1", 1, 1, kind);
    let kind = Kind::UnknownLine {
        found: "kik".to_owned(),
        nearest: "kick".to_owned(),
    };
    check("F1 as kick: 0 1\nF2: 0\nbefore F2[1] kik[1]", 3, 14, kind);
}

/// The feature of the paper's example is one of 2005; a library of another set says where it is.
#[test]
fn a_feature_of_another_set_is_told_with_its_set() {
    let text = FeatureSet::builtin_toml("mueller2006").unwrap();
    let text = text
        .replace("\"mueller2006\"", "\"mine\"")
        .replace("rknee_bent", "rknee_folded");
    let mine = FeatureSet::from_toml(&text).unwrap_or_else(|e| panic!("{e}"));
    let error = parse("rknee_bent : 0 1", &mine).unwrap_err();
    let Kind::UnknownFeature { elsewhere, .. } = &error.kind else {
        panic!("{error}")
    };
    assert_eq!(*elsewhere, Some("mueller2006"));
    let message = error.to_string();
    assert!(
        message.contains("motif index --set mueller2006"),
        "{message}"
    );
}

#[test]
fn a_name_has_one_line() {
    let kind = |name: &str| Kind::Twice {
        name: name.to_owned(),
        first_line: 1,
    };
    check("F1: 0\nF1: 1", 2, 1, kind("F1"));
    check("F1: 0\nF2 as F1: 1", 2, 7, kind("F1"));
    assert!(parse("F1: 0\nF1 as again: 1", &set()).is_ok());
}

#[test]
fn stars_that_say_nothing() {
    check("F1: 0 * 1", 1, 7, Kind::Wildcard);
    check("F1: * 0 1 * * 0 *", 1, 11, Kind::Wildcard);
    check("F1: * *", 1, 5, Kind::Unspecified);
}

#[test]
fn positions_that_do_not_exist() {
    for found in ["0", "4", "99999999999999999999999"] {
        let kind = Kind::Position {
            name: "F1".to_owned(),
            n_positions: 3,
            found: found.to_owned(),
        };
        check(&format!("F1: 0 1 *\nbefore F1[{found}] F1[1]"), 2, 11, kind);
    }
}

#[test]
fn relations_against_the_order_of_a_line() {
    let never = |relation| Kind::Never {
        relation,
        name: "F1".to_owned(),
    };
    let line = "F1: 0 0 1 0";
    check(
        &format!("{line}\nbefore F1[3] F1[2]"),
        2,
        1,
        never("before"),
    );
    check(
        &format!("{line}\nbefore F1[1] F1[2]"),
        2,
        1,
        never("before"),
    );
    check(
        &format!("{line}\noverlap F1[1] F1[3]"),
        2,
        1,
        never("overlap"),
    );
    check(
        &format!("{line}\noverlap F1[2] F1[4]"),
        2,
        1,
        never("overlap"),
    );
    for holds in [
        "overlap F1[1] F1[2]",
        "before F1[2] F1[3]",
        "within 1s F1[4] F1[1]",
    ] {
        assert!(
            parse(&format!("{line}\n{holds}"), &set()).is_ok(),
            "{holds}"
        );
    }
}

#[test]
fn every_message_says_what_is_expected() {
    let error = parse("rknee_bnt : 0 1", &set()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "1:1: mueller2006 has no feature \"rknee_bnt\"; the nearest name is rknee_bent"
    );
    let error = parse("rknee_bent : 0 x", &set()).unwrap_err();
    assert_eq!(error.to_string(), "1:16: expected 0, 1 or *, found \"x\"");
}

proptest::proptest! {
    /// Any text is a scene or an error with a place inside of it.
    #[test]
    fn no_text_is_too_odd(text in "([fF1-3:;#*\\[\\] 01\né]|as|before|overlap|within|1s){0,24}") {
        match parse(&text, &set()) {
            Ok(scene) => assert!(scene.query(30.0).is_ok()),
            Err(error) => assert!(error.at.byte() <= text.len()),
        }
    }
}
