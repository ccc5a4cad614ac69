//! The text form.

use mtemplate::ndarray::{Array1, Array2};
use mtemplate::{ClassError, ClassTemplate, Keyframe, MAX_COLUMNS, MotionTemplate, Place};
use proptest::prelude::*;

use crate::classes::class;

const SWEEP: &str = r#"motion_template = 1
name = "sweep" # by hand
feature_set = "three"
rate = 30
columns = 4

[features]
low  = "1"
bent = '0x2 1 *'

[[keyframe]]
column = 2
features = { bent = 1, low = 1 }
"#;

fn three(set: &str) -> Option<Vec<String>> {
    (set == "three").then(|| ["bent", "fast", "low"].map(str::to_owned).to_vec())
}

#[test]
fn a_few_lines_are_a_template() {
    let sweep = ClassTemplate::from_text(SWEEP, three).unwrap();
    assert_eq!(sweep.features, ["bent", "fast", "low"]);
    let values = sweep.template.values();
    assert_eq!(values.column(0).to_vec(), [0.0, 0.0, 1.0, 0.5]);
    assert_eq!(values.column(1).to_vec(), [0.5; 4]);
    assert_eq!(values.column(2).to_vec(), [1.0; 4]);
    assert_eq!(sweep.template.weights().to_vec(), [1.0; 4]);
    assert_eq!((sweep.n_motions, sweep.tau), (None, None));
    let keyframe = Keyframe {
        column: 2,
        care: 0b101,
        value: 0b101,
        stiffness: 1.0,
    };
    assert_eq!(sweep.keyframes, [keyframe]);
}

#[test]
fn without_a_set_the_rows_are_the_features_in_their_order() {
    let sweep = ClassTemplate::from_text(SWEEP, |_| None).unwrap();
    assert_eq!(sweep.features, ["low", "bent"]);
    assert_eq!(sweep.keyframes[0].care, 0b11);
    let over = sweep.over(&three("three").unwrap()).unwrap();
    assert_eq!(over, ClassTemplate::from_text(SWEEP, three).unwrap());
}

#[test]
fn the_text_is_as_documented() {
    let values = [[0.0, 0.5], [0.25, 0.5], [0.25, 0.5]];
    let class = ClassTemplate {
        name: "a \"b\"\n".to_owned(),
        feature_set: "two".to_owned(),
        rate: 29.97,
        features: vec!["knee".to_owned(), "left hand".to_owned()],
        template: MotionTemplate::new(
            Array2::from(values.to_vec()),
            Array1::from(vec![1.0, 1.0, 0.5]),
        )
        .unwrap(),
        n_motions: Some(26),
        tau: Some(0.06),
        keyframes: vec![Keyframe {
            column: 1,
            care: 3,
            value: 2,
            stiffness: 0.8,
        }],
    };
    let text = r#"motion_template = 1
name = "a \"b\"\u000A"
feature_set = "two"
rate = 29.97
columns = 3
n_motions = 26
tau = 0.06
weights = "1x2 0.5"

[features]
knee        = "0 0.25x2"
"left hand" = "*"

[[keyframe]]
column = 1
stiffness = 0.8
features = { knee = 0, "left hand" = 1 }
"#;
    assert_eq!(class.to_text().as_deref(), Ok(text));
    assert_eq!(ClassTemplate::from_text(text, |_| None), Ok(class));
}

#[test]
fn the_readme_holds() {
    let readme = include_str!("../../README.md");
    let text = readme.split("```toml\n").nth(1).unwrap();
    let text = text.split("```").next().unwrap();
    let squat = ClassTemplate::from_text(text, |_| None).unwrap();
    assert_eq!(squat.template.n_columns(), 48);
    assert_eq!((squat.n_motions, squat.tau), (Some(26), Some(0.06)));
    assert_eq!(squat.template.weights()[47], 0.25);
    let error = ClassTemplate::from_text(&text.replace("*x13", "*x14"), |_| None).unwrap_err();
    assert_eq!(error.to_string(), "11:32: expected 48 columns, found 49");
    assert!(readme.contains(&format!("`{error}`")));
}

#[test]
fn a_byte_order_mark_and_other_line_ends_are_nothing_new() {
    let expected = ClassTemplate::from_text(SWEEP, three);
    let crlf = SWEEP.replace('\n', "\r\n");
    assert_eq!(ClassTemplate::from_text(&crlf, three), expected);
    assert_eq!(
        ClassTemplate::from_text(&format!("\u{feff}{SWEEP}"), three),
        expected
    );
    let rows = crlf.replace("'0x2 1 *'", "\"\"\"\r\n  0x2\r\n  1 2\"\"\"");
    let error = ClassTemplate::from_text(&rows, three).unwrap_err();
    let kind = "expected a run such as 0x12, 0.25x3, 1 or *, found \"2\"";
    assert_eq!(error.to_string(), format!("11:5: {kind}"));
    let marked = format!("\u{feff}{rows}");
    let error = ClassTemplate::from_text(&marked, three).unwrap_err();
    assert_eq!(error.to_string(), format!("11:5: {kind}"));
}

/// `SWEEP` with one piece replaced is an error at a line and column.
#[track_caller]
fn refused(from: &str, to: &str, expected: &str) {
    assert!(SWEEP.contains(from), "{from}");
    let error = ClassTemplate::from_text(&SWEEP.replacen(from, to, 1), three).unwrap_err();
    assert_eq!(error.to_string(), expected);
}

#[test]
fn errors_say_where_and_what() {
    refused(
        "= 1",
        "= 2",
        "1:19: expected version 1 of motion templates, found 2",
    );
    refused(
        "name",
        "nom",
        "2:1: unknown field `nom`, expected one of `motion_template`, `name`, \
        `feature_set`, `rate`, `columns`, `n_motions`, `tau`, `weights`, `features`, `keyframe`",
    );
    refused(
        "30",
        "-30",
        "4:8: expected a positive and finite rate, found -30",
    );
    refused("columns = 4", "", "1:1: missing field `columns`");
    refused(
        "columns = 4",
        "columns = 1_000_000",
        "5:11: expected at most 65536 columns, found 1000000",
    );
    refused("\"1\"", "\"1x3\"", "8:12: expected 4 columns, found 3");
    refused("0x2 1 *", "0x2 1x2 *", "9:17: expected 4 columns, found 5");
    refused(
        "0x2 1 *",
        "0x2 1.5 *",
        "9:13: expected a run such as 0x12, 0.25x3, 1 or *, found \"1.5\"",
    );
    refused(
        "'0x2 1 *'",
        "'''\n0x2\n  one *'''",
        "11:3: expected a run such as 0x12, 0.25x3, 1 or *, found \"one\"",
    );
    // What TOML would make of an escape stands nowhere in the file.
    refused(
        "\"1\"",
        "\"\\u0031\"",
        "8:9: expected a run such as 0x12, 0.25x3, 1 or *, found \"\\\\u0031\"",
    );
    refused(
        "bent =",
        "knee =",
        "9:1: expected a feature of three, found \"knee\"",
    );
    refused("bent =", "low =", "9:1: duplicate key");
    refused(
        "column = 2",
        "column = 4",
        "12:10: keyframe 0: expected a column below 4, found 4",
    );
    refused("bent = 1,", "bent = 2,", "13:21: expected 0 or 1, found 2");
    refused(
        "bent = 1,",
        "knee = 1,",
        "13:14: expected a feature of three, found \"knee\"",
    );
    refused(
        "column = 2",
        "column = 2\nstiffness = 0",
        "13:13: keyframe 0: expected a stiffness above 0 and up to 1, found 0",
    );
    refused(
        "{ bent = 1, low = 1 }",
        "{}",
        "11:1: keyframe 0: expected one feature or more, found none",
    );
    refused(
        "[[keyframe]]\ncolumn = 2",
        "[[keyframe]]\ncolumn = 3\nfeatures = { low = 1 }\n[[keyframe]]\ncolumn = 2",
        "15:10: keyframe 1: expected column 3 or a later one, found 2",
    );
    refused(
        "columns = 4",
        "columns = 4\ntau = nan",
        "6:7: expected a finite tau of 0 or more, found NaN",
    );
    refused(
        "columns = 4",
        "columns = 4\nn_motions = 0",
        "6:13: expected 1 to 4294967295 motions, found 0",
    );
    refused(
        "columns = 4",
        "columns = 4\nweights = \"1x3 0\"",
        "6:16: expected a positive weight with or without a count, such as 1x12, found \"0\"",
    );
    let empty = ClassTemplate::from_text("", three).unwrap_err();
    assert_eq!(
        empty.at,
        Place::Text {
            line: 1,
            column: 1,
            byte: 0
        }
    );
}

#[test]
fn what_cannot_be_read_is_not_written() {
    let sweep = ClassTemplate::from_text(SWEEP, three).unwrap();
    let check = |class: ClassTemplate, expected: ClassError| {
        assert_eq!(class.to_text(), Err(expected));
    };
    let mut class = sweep.clone();
    class.features.pop();
    check(
        class,
        ClassError::Names {
            n_features: 3,
            found: 2,
        },
    );
    let mut class = sweep.clone();
    class.features[2] = "bent".to_owned();
    let name = "bent".to_owned();
    check(class, ClassError::Repeated { name });
    let n = MAX_COLUMNS + 1;
    let template = MotionTemplate::new(Array2::zeros((n, 3)), Array1::ones(n)).unwrap();
    check(
        ClassTemplate {
            template,
            ..sweep.clone()
        },
        ClassError::Columns { found: n },
    );
    check(
        ClassTemplate {
            tau: Some(-1.0),
            ..sweep.clone()
        },
        ClassError::Tau { found: -1.0 },
    );
    let mut class = sweep;
    class.keyframes[0].value = 0b010;
    let error = class.to_text().unwrap_err().to_string();
    assert_eq!(
        error,
        "keyframe 0: expected bits of 3 features and values among them, found 0x2"
    );
}

proptest! {
    #[test]
    fn reading_gives_what_was_written(class in class()) {
        let text = class.to_text().unwrap();
        let all = |_: &str| Some(class.features.clone());
        let read = ClassTemplate::from_text(&text, all);
        prop_assert_eq!(read.as_ref(), Ok(&class));
        prop_assert_eq!(ClassTemplate::from_text(&text, |_| None), read);
        prop_assert_eq!(ClassTemplate::from_text(&text, all).unwrap().to_text(), Ok(text));
    }

    #[test]
    fn rows_may_stand_in_any_order(class in class(), key in any::<prop::sample::Index>()) {
        let mut rotated = class.features.clone();
        rotated.rotate_left(key.index(class.features.len()));
        let text = class.to_text().unwrap();
        let read = ClassTemplate::from_text(&text, |_| Some(rotated.clone())).unwrap();
        prop_assert_eq!(&read.features, &rotated);
        prop_assert_eq!(read.over(&class.features), Ok(class));
    }

    #[test]
    fn any_text_is_read_or_refused_at_a_place_in_it(text in "[a-z0-9x=\"*. \n\\[\\]é]{0,40}") {
        let text = format!("{SWEEP}{text}");
        if let Err(error) = ClassTemplate::from_text(&text, three) {
            let Place::Text { line, column, byte } = error.at else { panic!("no text") };
            let before = &text.as_bytes()[..byte];
            prop_assert_eq!(line, before.iter().filter(|&&b| b == b'\n').count() + 1);
            let start = before.iter().rposition(|&b| b == b'\n').map_or(0, |i| i + 1);
            prop_assert_eq!(column, byte - start + 1);
        }
    }
}
