use super::*;
use crate::parse_asf;

/// A root with six degrees of freedom, `a` with two, `bb` with one, `c` with none.
const SKELETON: &str = ":units
  length 1
  angle deg
:root
  order TX TY TZ RX RY RZ
:bonedata
  begin
    name a
    direction 0 1 0
    length 1
    dof rx rz
  end
  begin
    name bb
    direction 0 1 0
    length 1
    dof rx
  end
  begin
    name c
    direction 0 1 0
    length 1
  end
:hierarchy
  root a
  a bb c
";

const SMALL: &str = "#!OML:ASF small.asf
:FULLY-SPECIFIED
:DEGREES
1
root 1 2 3 4 5 6
a 7 8
bb 9
2
root 11 12 13 14 15 16
a 17 18
bb 19
";

const FIRST: [f64; 9] = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0];
const SECOND: [f64; 9] = [11.0, 12.0, 13.0, 14.0, 15.0, 16.0, 17.0, 18.0, 19.0];

fn asf() -> Asf {
    parse_asf(SKELETON.as_bytes()).unwrap()
}

fn small(from: &str, to: &str) -> String {
    assert!(SMALL.contains(from), "{from:?} is not in the sample");
    SMALL.replacen(from, to, 1)
}

#[track_caller]
fn check_of(asf: &Asf, text: impl AsRef<[u8]>, rows: &[[f64; 9]], warnings: &[&str]) {
    let amc = parse_amc(text.as_ref(), asf).unwrap_or_else(|e| panic!("{e}"));
    let found: Vec<String> = amc.warnings.iter().map(Warning::to_string).collect();
    assert_eq!(found, warnings);
    let values: Vec<f64> = amc.motion.channels.iter().copied().collect();
    assert_eq!(values, rows.concat());
}

#[track_caller]
fn check(text: impl AsRef<[u8]>, rows: &[[f64; 9]], warnings: &[&str]) {
    check_of(&asf(), text, rows, warnings);
}

#[track_caller]
fn check_error(text: impl AsRef<[u8]>, expected: &str) {
    match parse_amc(text.as_ref(), &asf()) {
        Err(error) => assert_eq!(error.to_string(), expected),
        Ok(_) => panic!("no error, expected {expected}"),
    }
}

#[test]
fn a_small_file_says_what_it_says() {
    check(SMALL, &[FIRST, SECOND], &[]);
    let amc = parse_amc(SMALL.as_bytes(), &asf()).unwrap();
    assert_eq!(amc.first_frame_number, Some(1));
    assert_eq!(amc.motion.rate.hz(), 120.0);
    assert_eq!(amc.motion.rate_source, RateSource::Default);
    assert_eq!(
        (amc.motion.unit, amc.motion.unit_source),
        (crate::LengthUnit::INCH, UnitSource::File)
    );
}

#[test]
fn white_space_and_line_ends_do_not_matter() {
    for text in [
        SMALL.replace('\n', "\r\n"),
        SMALL.replace('\n', "\r"),
        SMALL.replace(' ', "\t "),
        SMALL.replace('\n', " \n\n"),
        format!("\u{feff}{SMALL}"),
        SMALL.trim_end().to_owned(),
    ] {
        check(text, &[FIRST, SECOND], &[]);
    }
}

#[test]
fn the_header_is_optional_and_comments_may_stand_on_any_line() {
    check(small("#!OML:ASF small.asf\n", ""), &[FIRST, SECOND], &[]);
    check(
        small("#!OML:ASF small.asf\n:FULLY-SPECIFIED\n:DEGREES\n", ""),
        &[FIRST, SECOND],
        &[],
    );
    check(
        SMALL.replace('\n', "\n# 3 \u{e4} root\n"),
        &[FIRST, SECOND],
        &[],
    );
    check("", &[], &[]);
    check(":DEGREES\n", &[], &[]);
    let warning = "2:1: AMC004: unknown keyword \":odd\" was skipped";
    check(
        small(":FULLY-SPECIFIED", ":ODD 1 2"),
        &[FIRST, SECOND],
        &[warning],
    );
}

#[test]
fn the_rate_is_taken_where_it_stands() {
    let with = |rate: &str| small(":DEGREES", &format!(":SAMPLES-PER-SECOND {rate}"));
    let amc = parse_amc(with("59.94").as_bytes(), &asf()).unwrap();
    assert_eq!(
        (amc.motion.rate.hz(), amc.motion.rate_source),
        (59.94, RateSource::File)
    );
    check_error(
        with("0"),
        "3:21: the rate must be positive and finite, found 0",
    );
    check_error(
        with(""),
        "3:21: expected a number, found the end of the line",
    );
}

#[test]
fn bones_may_come_in_another_order_in_each_frame() {
    let text = small(
        "root 11 12 13 14 15 16\na 17 18\nbb 19",
        "bb 19\nroot 11 12 13 14 15 16\na 17 18",
    );
    check(text, &[FIRST, SECOND], &[]);
}

#[test]
fn frame_numbers_name_frames_and_do_not_order_them() {
    let from_700 = SMALL
        .replace("\n1\n", "\n700\n")
        .replace("\n2\n", "\n701\n");
    check(&from_700, &[FIRST, SECOND], &[]);
    let amc = parse_amc(from_700.as_bytes(), &asf()).unwrap();
    assert_eq!(amc.first_frame_number, Some(700));
    let warning = "8:1: AMC003: expected frame 2, found frame 5; frames were taken in file order";
    check(
        SMALL.replace("\n2\n", "\n5\n"),
        &[FIRST, SECOND],
        &[warning],
    );
    // Only the first place is reported.
    let more = SMALL.replace("\n2\n", "\n5\n") + "9\nbb 9\nroot 1 2 3 4 5 6\na 7 8\n";
    check(more, &[FIRST, SECOND, FIRST], &[warning]);
    check_error(
        small("\n1\n", "\nx\n"),
        "4:1: expected a frame number, found \"x\"",
    );
    check_error(
        small("\n1\n", "\n1 1\n"),
        "4:1: expected a frame number, found \"1\"",
    );
    check_error(
        small("\n1\n", "\n99999999999999999999\n"),
        "4:1: expected a frame number, found \"99999999999999999999\"",
    );
}

#[track_caller]
fn check_cut(text: &str) {
    let warning = "8:1: AMC001: the file is cut off within frame 2; 1 whole frames were kept";
    check(text, &[FIRST], &[warning]);
}

#[test]
fn a_cut_last_frame_is_dropped() {
    let end = SMALL.find("\n2\n").unwrap() + 3;
    check_cut(&SMALL[..end]);
    for rest in [
        "ro",
        "root",
        "root 11 12 -",
        "root 11 12 13",
        "root 11 12 13 14 1.5e",
        "root 11 12 13 14 15 16\n",
        "root 11 12 13 14 15 16\na 17 18\n# no more",
        "root 11 12 13 14 15 16\na 17 18\nb",
        "a 17 18\nroot 11 12 13 14 15 16\nbb",
    ] {
        check_cut(&(SMALL[..end].to_owned() + rest));
    }
    // What is left of a name is another bone's name.
    let skeleton = SKELETON.replace("bb", "ab");
    let text = SMALL[..end].replace("bb", "ab") + "root 11 12 13 14 15 16\na 17 18\na";
    let warning = "8:1: AMC001: the file is cut off within frame 2; 1 whole frames were kept";
    check_of(
        &parse_asf(skeleton.as_bytes()).unwrap(),
        text,
        &[FIRST],
        &[warning],
    );
    let nothing = "4:1: AMC001: the file is cut off within frame 1; 0 whole frames were kept";
    check(&SMALL[..SMALL.find("root 1 ").unwrap()], &[], &[nothing]);
}

#[test]
fn a_bone_that_never_moves_keeps_its_rest_pose() {
    let text = SMALL.replace("bb 9\n", "").replace("bb 19\n", "");
    let still = |mut row: [f64; 9]| {
        row[8] = 0.0;
        row
    };
    let warning = "10:1: AMC002: bone \"bb\" has no values in any frame; it keeps its rest pose";
    check(text, &[still(FIRST), still(SECOND)], &[warning]);
}

#[test]
fn a_frame_with_other_bones_than_the_first_is_an_error() {
    check_error(
        small("bb 19\n", "3\nroot 1 2 3 4 5 6\n"),
        "11:1: frame 2 has no values for bone \"bb\"",
    );
    let expected = "expected a bone that the first frame has, found \"bb\"";
    check_error(small("bb 9\n", ""), &format!("10:1: {expected}"));
    // As many bones as in the first frame, but not the same.
    check_error(
        small("bb 9\n", "").replace("a 17 18\n", ""),
        &format!("9:1: {expected}"),
    );
    check_error("1\n2\n3\n", "2:1: expected a bone, found \"2\"");
}

#[test]
fn bones_are_known_and_single() {
    check_error(small("a 17", "x 17"), "10:1: unknown bone \"x\"");
    check_error(
        small("root 11", "roots 11"),
        "9:1: unknown bone \"roots\"; the nearest name is \"root\"",
    );
    check_error(small("bb 19", "a 17 18"), "11:1: bone \"a\" appears twice");
}

#[test]
fn values_are_counted() {
    check_error(
        small("a 17 18", "a 17"),
        "10:1: expected 2 values for bone \"a\", found 1",
    );
    check_error(
        small("a 17 18", "a 17 18 19"),
        "10:1: expected 2 values for bone \"a\", found 3",
    );
    check_error(
        small("a 17 18", "a"),
        "10:1: expected 2 values for bone \"a\", found 0",
    );
    check_error(
        small("bb 9", "c 1\nbb 9"),
        "7:1: expected 0 values for bone \"c\", found 1",
    );
    check_error(
        small("a 17 18", "a 17 x"),
        "10:6: expected a number, found \"x\"",
    );
    check_error(
        small("a 17 18", "a 17 nan"),
        "10:6: expected a finite number, found \"nan\"",
    );
    check_error(
        small("bb 19\n", "bb 19 -"),
        "11:7: expected a number, found \"-\"",
    );
}

#[test]
fn radians_are_degrees_in_the_motion() {
    let pi = std::f64::consts::PI;
    let text = format!(":RADIANS\n1\nroot 1 2 3 {pi} 0 0\na 0 {pi}\nbb -{pi}\n");
    let row = [1.0, 2.0, 3.0, 180.0, 0.0, 0.0, 0.0, 180.0, -180.0];
    let warning = "1:1: AMC005: the skeleton says degrees, the motion says radians; the motion's word was used";
    check(&text, &[row], &[warning]);
    let radian_asf = parse_asf(SKELETON.replace("angle deg", "angle rad").as_bytes()).unwrap();
    check_of(&radian_asf, &text, &[row], &[]);
    check_of(
        &radian_asf,
        text.replace(":RADIANS", "# as the skeleton"),
        &[row],
        &[],
    );
    check_error(
        text.replace("bb -", "bb 1e308 "),
        "5:4: expected a finite number, found \"1e308\"",
    );
}

#[test]
fn names_may_begin_with_digits_and_have_any_bytes() {
    let skeleton = SKELETON.replace("bb", "2nd");
    let asf = parse_asf(skeleton.as_bytes()).unwrap();
    check_of(&asf, SMALL.replace("bb", "2nd"), &[FIRST, SECOND], &[]);
    let latin = |text: &str| -> Vec<u8> {
        let bytes = text.replace("bb", "b\u{1}").into_bytes();
        bytes
            .into_iter()
            .map(|b| if b == 1 { 0xfc } else { b })
            .collect()
    };
    let asf = parse_asf(&latin(SKELETON)).unwrap();
    assert_eq!(asf.skeleton.joints()[2].name, "bü");
    check_of(&asf, latin(SMALL), &[FIRST, SECOND], &[]);
}

#[test]
fn oddities_throughout_take_linear_time() {
    let frame = &SMALL[SMALL.find("root").unwrap()..SMALL.find("2\n").unwrap()];
    let n = 20_000;
    let text: String = (0..n).map(|i| format!("{}\n{frame}", 4 * i + 1)).collect();
    let amc = parse_amc(text.as_bytes(), &asf()).unwrap();
    assert_eq!((amc.motion.n_frames(), amc.warnings.len()), (n, 1));
    let odd = ":odd\n".repeat(100_000) + &text;
    let warnings = parse_amc(odd.as_bytes(), &asf()).unwrap().warnings;
    // What is too much to list is counted: a hundred thousand keywords and a frame number.
    let n = 100_001 - (warnings.len() - 1);
    assert_eq!(warnings.last().unwrap().kind, WarningKind::More { n });
    assert_eq!(warnings.last().unwrap().code(), "TXT001");
}
