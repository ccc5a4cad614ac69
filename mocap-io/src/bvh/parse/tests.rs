use super::*;
use crate::skeleton::MAX_JOINTS;
use crate::{Channel, ParseErrorKind};

/// A root with six channels on lines 1 to 10, one frame on line 14.
const SMALL: &str = "HIERARCHY
ROOT Hips
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  End Site
  {
    OFFSET 0 170 0
  }
}
MOTION
Frames: 1
Frame Time: 0.0083333
1 2 3 4 5 6
";

fn small(from: &str, to: &str) -> String {
    assert!(SMALL.contains(from), "{from:?} is not in the sample");
    SMALL.replacen(from, to, 1)
}

/// With the last line replaced.
fn rows(rows: &str) -> String {
    small("1 2 3 4 5 6\n", rows)
}

#[track_caller]
fn parse(text: impl AsRef<[u8]>) -> Bvh {
    parse_bvh(text.as_ref()).unwrap_or_else(|e| panic!("{e}"))
}

#[track_caller]
fn check_error(text: impl AsRef<[u8]>, expected: &str) {
    match parse_bvh(text.as_ref()) {
        Err(error) => assert_eq!(error.to_string(), expected),
        Ok(_) => panic!("no error, expected {expected}"),
    }
}

/// Values of all rows, and the warnings.
#[track_caller]
fn check_rows(text: &str, expected: &[f64], warnings: &[&str]) {
    let bvh = parse(text);
    let found: Vec<String> = bvh.warnings.iter().map(Warning::to_string).collect();
    assert_eq!(found, warnings);
    assert_eq!(
        bvh.motion.channels.iter().copied().collect::<Vec<_>>(),
        expected
    );
}

#[track_caller]
fn check_same(text: impl AsRef<[u8]>) {
    assert_eq!(parse(text), parse(SMALL));
}

#[track_caller]
fn check_rate(frame_time: &str, hz: f64) {
    let found = parse(small("0.0083333", frame_time)).motion.rate.hz();
    assert_eq!(found, hz, "{frame_time}");
}

#[test]
fn a_small_file_says_what_it_says() {
    let bvh = parse(SMALL);
    assert_eq!(bvh.warnings, []);
    let joints = bvh.motion.skeleton.joints();
    assert_eq!(
        bvh.motion.skeleton.names().collect::<Vec<_>>(),
        ["Hips", "Hips_End"]
    );
    assert_eq!((joints[0].parent, joints[1].parent), (None, Some(0)));
    assert_eq!(joints[1].offset, [0.0, 170.0, 0.0]);
    assert!(joints[1].end_site && !joints[0].end_site);
    assert_eq!(bvh.motion.n_frames(), 1);
    assert_eq!(bvh.motion.rate_source, RateSource::File);
    assert_eq!(
        bvh.with_unit(LengthUnit::INCH).motion.unit_source,
        crate::UnitSource::Given
    );
}

#[test]
fn white_space_case_and_line_ends_do_not_matter() {
    check_same(SMALL.replace('\n', "\r\n"));
    check_same(SMALL.replace('\n', "\r"));
    check_same(SMALL.replace("  ", "\t").replace(' ', "\t \t"));
    check_same(format!("\u{feff}{SMALL}"));
    check_same(SMALL.trim_end());
    check_same(SMALL.replace("\n", "  \n\n"));
    check_same(small("{", "\t{ "));
    check_same(small("ROOT Hips\n{", "ROOT Hips {"));
    check_same(small("End Site", "End site"));
    check_same(small("End Site", "End Site "));
    check_same(small("End Site", "END SITE Hips_tip"));
    check_same(small("HIERARCHY", "hierarchy"));
    check_same(small("Frame Time:", "FRAME TIME :"));
    check_same(small("Frames: 1", "Frames:\t1"));
    check_same(small("Frames: 1", "Frames:1"));
    check_same(small("OFFSET 0 170 0", "OFFSET 0 170 0\n CHANNELS 0"));
}

#[test]
fn errors_count_lines_of_every_kind() {
    for line_end in ["\n", "\r\n", "\r"] {
        let text = rows("1 2 x\n").replace('\n', line_end);
        check_error(text, "14:5: expected a number, found \"x\"");
    }
    check_error(
        "\u{feff}HIERARCHY\nRUT",
        "2:1: expected ROOT, found \"RUT\"",
    );
}

#[test]
fn numbers_have_any_usual_form() {
    let text = rows("-9.23872e-007 5.665364E-15 +.5 5. -0 1e2\n");
    let expected = [-9.23872e-7, 5.665364e-15, 0.5, 5.0, -0.0, 100.0];
    check_rows(&text, &expected, &[]);
}

#[test]
fn glued_numbers_are_two() {
    // SlimeVR-Server, issue 995.
    let text = rows("0.0 0.0 0.0-7.5094748 -5.449194 1e-3+2\n1 2 3 4 5-6\n")
        .replace("Frames: 1", "Frames: 2");
    let expected = [
        0.0, 0.0, 0.0, -7.5094748, -5.449194, 1e-3, 1.0, 2.0, 3.0, 4.0, 5.0, -6.0,
    ];
    // The first row has seven numbers: it is one value too long.
    check_error(&text, "14:1: expected 6 values for frame 1, found 7");
    let text = text.replace("+2", "");
    let warning = "14:12: BVH003: no blank between two numbers; they were read as two";
    check_rows(&text, &expected, &[warning]);
    check_error(
        rows("1.2.3 4 5 6 7\n"),
        "14:1: expected a number, found \"1.2.3\"",
    );
}

#[test]
fn the_rows_decide_how_many_frames_there_are() {
    let six = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
    let warning = "12:9: BVH012: header says 7 frames, 1 found";
    check_rows(&small("Frames: 1", "Frames: 7"), &six, &[warning]);
    let warning = "12:9: BVH012: header says 0 frames, 1 found";
    check_rows(&small("Frames: 1", "Frames: 0"), &six, &[warning]);
    check_rows(&rows("").replace("Frames: 1", "Frames: 0"), &[], &[]);
}

#[test]
fn a_huge_frame_count_allocates_nothing() {
    let warning = "12:9: BVH012: header says 9000000000000000 frames, 1 found";
    let six = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
    check_rows(
        &small("Frames: 1", "Frames: 9000000000000000"),
        &six,
        &[warning],
    );
}

#[test]
fn a_cut_last_row_is_dropped() {
    let six = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
    for (cut, found) in [
        ("-", 0),
        ("1 2", 2),
        ("1 2 ", 2),
        ("1 2 -", 2),
        ("1 2 3.5e", 2),
        ("1 2 3 4 5 .", 5),
    ] {
        let text = rows(&format!("1 2 3 4 5 6\n{cut}")).replace("Frames: 1", "Frames: 2");
        let warnings = [
            "12:9: BVH012: header says 2 frames, 1 found".to_owned(),
            format!("15:1: BVH013: the last row has {found} of 6 values; it was dropped"),
        ];
        check_rows(&text, &six, &[&warnings[0], &warnings[1]]);
    }
    check_error(
        rows("1 2 3 4 5 6 -"),
        "14:13: expected a number, found \"-\"",
    );
    check_error(
        rows("1 2\n1 2 3 4 5 6\n"),
        "14:1: expected 6 values for frame 1, found 2",
    );
}

#[test]
fn numbers_that_are_not_finite_are_refused() {
    for word in [
        "NaN",
        "nan",
        "-nan(ind)",
        "inf",
        "-inf",
        "+Infinity",
        "1e999",
        "-1.#IND",
        "1.#QNAN",
    ] {
        let expected = format!("14:3: expected a finite number, found {word:?}");
        check_error(rows(&format!("1 {word} 3 4 5 6\n")), &expected);
    }
    check_error(
        small("170", "NaN"),
        "8:14: expected a finite number, found \"NaN\"",
    );
    // At the start of a row they are no text before the rows, and behind the last row no epilogue.
    check_error(
        rows("nan 2 3 4 5 6\n"),
        "14:1: expected a finite number, found \"nan\"",
    );
    check_error(
        rows("1 2 3 4 5 6\nInf 2 3 4 5 6\n"),
        "15:1: expected a finite number, found \"Inf\"",
    );
    check_error(
        rows("1 1.#x 3 4 5 6\n"),
        "14:3: expected a finite number, found \"1.#x\"",
    );
}

#[test]
fn rounded_frame_times_are_taken_as_the_rate_that_was_meant() {
    for text in [
        "0.0083333",
        "0.008333",
        ".0083333",
        "0.00833",
        "0.008333333333333333",
    ] {
        check_rate(text, 120.0);
    }
    for text in [".03333", "0.0333333", "0.033", "0.03333333"] {
        check_rate(text, 30.0);
    }
    check_rate("0.0417", 24.0);
    check_rate("0.041667", 24.0);
    check_rate("0.011111", 90.0);
    check_rate("0.01", 100.0);
    // Whole to the last bit: nothing was rounded.
    check_rate("0.002", 500.0);
    check_rate("0.001", 1000.0);
    check_rate("1e-4", 1e4);
    check_rate("1", 1.0);
}

#[test]
fn other_frame_times_are_kept() {
    // 23.976 frames per second is no 24, 119.904 is neither 120 nor 119.88.
    for text in [
        "0.0417083750417",
        "0.00834",
        "0.008342",
        "0.0083333333334",
        "8.3333e-3",
        "0.75",
    ] {
        check_rate(text, text.parse::<f64>().unwrap().recip());
    }
}

#[test]
fn a_frame_time_with_an_exponent_reads_back() {
    for frame_time in [".2e-3", "8.3333e-3", "9.99e-1"] {
        let motion = parse(small("0.0083333", frame_time)).motion;
        let mut again = Vec::new();
        crate::write_bvh(&motion, &mut again).unwrap();
        assert_eq!(parse(again).motion, motion, "{frame_time}");
    }
}

#[test]
fn each_joint_has_its_own_channels_and_order() {
    let text = "HIERARCHY ROOT a { OFFSET 0 0 0 CHANNELS 3 Zrotation Yrotation Xrotation
        JOINT b { OFFSET 1 0 0 CHANNELS 0
        JOINT c { OFFSET 1 0 0 CHANNELS 1 Yrotation
        JOINT d { OFFSET 1 0 0 CHANNELS 6 xposition YPOSITION zPosition Xrotation Zrotation Yrotation
        JOINT e { OFFSET 1 0 0 } } } } }
        MOTION Frames: 1\nFrame Time: 1\n0 1 2 3 4 5 6 7 8 9";
    let bvh = parse(text);
    let channels: Vec<String> = bvh
        .motion
        .skeleton
        .joints()
        .iter()
        .map(|j| {
            j.channels
                .iter()
                .map(Channel::to_string)
                .collect::<Vec<_>>()
                .join(" ")
        })
        .collect();
    assert_eq!(
        channels,
        [
            "Zrotation Yrotation Xrotation",
            "",
            "Yrotation",
            "Xposition Yposition Zposition Xrotation Zrotation Yrotation",
            ""
        ]
    );
    assert_eq!(bvh.motion.skeleton.first_channel(3), Some(4));
    assert_eq!(
        bvh.motion.channels.row(0).to_vec(),
        (0..10).map(f64::from).collect::<Vec<_>>()
    );
}

#[test]
fn several_roots_and_end_sites_are_kept_apart() {
    let text = "HIERARCHY
        ROOT a { OFFSET 0 0 0 CHANNELS 0
            End Site { OFFSET 1 0 0 } End Site { OFFSET 2 0 0 } End Site { OFFSET 3 0 0 } }
        ROOT b { OFFSET 5 0 0 CHANNELS 1 Xrotation End Site { OFFSET 4 0 0 } }
        MOTION Frames: 1\nFrame Time: 1\n90";
    let skeleton = parse(text).motion.skeleton;
    let names: Vec<&str> = skeleton.names().collect();
    assert_eq!(names, ["a", "a_End", "a_End2", "a_End3", "b", "b_End"]);
    let bones: Vec<(usize, usize)> = skeleton.bones().collect();
    assert_eq!(bones, [(0, 1), (0, 2), (0, 3), (4, 5)]);
}

#[track_caller]
fn check_name(bytes: &[u8], name: &str) {
    let (before, after) = SMALL.split_once("Hips").unwrap();
    let text = [before.as_bytes(), bytes, after.as_bytes()].concat();
    assert_eq!(parse(text).motion.skeleton.joints()[0].name, name);
}

#[test]
fn names_are_whole() {
    check_name(b"mixamorig:Hips", "mixamorig:Hips");
    check_name(b"Bip01.L.Hand", "Bip01.L.Hand");
    check_name(b"  headphone 1 \t", "headphone 1");
    check_name("Hüfte".as_bytes(), "Hüfte");
    check_name(b"H\xfcfte", "Hüfte");
    check_name(b"\x8d\x98", "\u{8d}\u{98}");
}

#[test]
fn broken_hierarchies_say_where() {
    check_error("", "1:1: expected HIERARCHY, found the end of the file");
    check_error(
        "HIERARCHY",
        "1:10: expected ROOT, found the end of the file",
    );
    check_error(
        "HIERARCHY\nHIERARCHY",
        "2:1: expected ROOT, found \"HIERARCHY\"",
    );
    check_error(
        small("ROOT Hips", "ROOT"),
        "2:5: expected a joint name, found the end of the line",
    );
    check_error(small("{", ""), "4:3: expected {, found \"OFFSET\"");
    check_error(
        small("OFFSET", "OFSET"),
        "4:3: expected OFFSET, CHANNELS, JOINT, End Site or }, found \"OFSET\"",
    );
    check_error(
        small("OFFSET 0 0 0", "OFFSET 0 0"),
        "5:3: expected a number, found \"CHANNELS\"",
    );
    check_error(
        small("OFFSET 0 170 0", "JOINT a"),
        "8:5: expected OFFSET or }, found \"JOINT\"",
    );
    check_error(
        small("MOTION", "JOINT a"),
        "11:1: expected ROOT or MOTION, found \"JOINT\"",
    );
    let cut = &SMALL[..SMALL.find("MOTION").unwrap() - 3];
    check_error(
        cut,
        "9:4: expected OFFSET, CHANNELS, JOINT, End Site or }, found the end of the file",
    );
}

#[test]
fn channels_are_counted_known_and_single() {
    let channels = |with: &str| {
        small(
            "6 Xposition Yposition Zposition Zrotation Xrotation Yrotation",
            with,
        )
    };
    let range = "the number of channels must be a whole number, not negative, found";
    check_error(channels("-1"), &format!("5:12: {range} -1"));
    check_error(channels("2.5"), &format!("5:12: {range} 2.5"));
    check_error(
        channels("NaN"),
        "5:12: expected a finite number, found \"NaN\"",
    );
    check_error(
        channels("1 Wrotation"),
        "5:14: unknown channel \"Wrotation\"; known are Xposition, Yposition, Zposition, Xrotation, \
         Yrotation and Zrotation",
    );
    check_error(
        channels("2 Xrotation XROTATION"),
        "5:24: channel \"Xrotation\" appears twice",
    );
    check_error(
        small("OFFSET 0 170 0", "CHANNELS 1 Xrotation"),
        "8:14: the number of channels of an End Site must be 0, found 1",
    );
    let cut = channels("2 Xrotation")
        .split_once("Xrotation")
        .unwrap()
        .0
        .to_owned();
    check_error(
        cut + "Xrotation",
        "5:23: expected a channel, found the end of the file",
    );
}

#[test]
fn deep_files_neither_overflow_the_stack_nor_take_quadratic_time() {
    let n = MAX_JOINTS - 1;
    let text = "HIERARCHY\nROOT a\n{\n".to_owned()
        + &"JOINT a\n{\nOFFSET 0 1 0\n".repeat(n)
        + &"}\n".repeat(n + 1)
        + "MOTION\nFrames: 0\nFrame Time: 1\n";
    let motion = parse(&text).motion;
    assert_eq!(motion.skeleton.joints().len(), n + 1);
    assert_eq!(motion.skeleton.joints()[n].parent, Some(n - 1));
    let mut again = Vec::new();
    crate::write_bvh(&motion, &mut again).unwrap();
    // Indented all the way down, it would have hundreds of megabytes.
    assert!(again.len() < 300 * n);
    assert_eq!(parse(&again).motion, motion);
}

#[test]
fn many_end_sites_take_linear_time() {
    let n = MAX_JOINTS - 1;
    let text = "HIERARCHY\nROOT a\n{\n".to_owned()
        + &"End Site { OFFSET 0 1 0\n}\n".repeat(n)
        + "}\nMOTION\nFrames: 0\nFrame Time: 1\n";
    let skeleton = parse(&text).motion.skeleton;
    assert_eq!(skeleton.joints().len(), n + 1);
    assert_eq!(skeleton.joints()[n].name, format!("a_End{n}"));
}

#[test]
fn no_more_joints_than_a_figure_could_have() {
    let text = "HIERARCHY ROOT a { ".to_owned() + &"JOINT b {} ".repeat(MAX_JOINTS) + "} MOTION";
    let error = parse_bvh(text.as_bytes()).unwrap_err();
    let (what, limit) = ("joints", MAX_JOINTS);
    assert_eq!(error.kind, ParseErrorKind::TooMany { what, limit });
}
