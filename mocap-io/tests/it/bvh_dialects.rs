//! What exporters, editors and people make of BVH: read, read with a coded warning, or refused.

use mocap_io::{Bvh, RateSource, parse_bvh};

const SMALL: &str = "HIERARCHY
ROOT Hips
{
  OFFSET 0 0 0
  CHANNELS 3 Zrotation Xrotation Yrotation
  JOINT Leg
  {
    OFFSET 0 -50 0
    CHANNELS 1 Xrotation
    End Site
    {
      OFFSET 0 -40.5 0
    }
  }
}
MOTION
Frames: 2
Frame Time: 0.01
1 2 3 4.5
5 6 7 8.5
";

const VALUES: [f64; 8] = [1.0, 2.0, 3.0, 4.5, 5.0, 6.0, 7.0, 8.5];

fn small(from: &str, to: &str) -> String {
    assert!(SMALL.contains(from), "{from:?} is not in the sample");
    SMALL.replacen(from, to, 1)
}

/// With other rows.
fn rows(rows: &str) -> String {
    small("1 2 3 4.5\n5 6 7 8.5\n", rows)
}

#[track_caller]
fn read(text: impl AsRef<[u8]>) -> Bvh {
    let text = text.as_ref();
    parse_bvh(text).unwrap_or_else(|e| panic!("{e} in\n{}", String::from_utf8_lossy(text)))
}

fn codes(bvh: &Bvh) -> Vec<&'static str> {
    bvh.warnings.iter().map(mocap_io::Warning::code).collect()
}

/// The same skeleton, values and rate as the sample, with these warnings.
#[track_caller]
fn check(text: impl AsRef<[u8]>, expected: &[&str]) {
    let (bvh, sample) = (read(text), read(SMALL));
    assert_eq!(codes(&bvh), expected);
    assert_eq!(bvh.motion, sample.motion);
}

/// These values, whatever the skeleton, with these warnings.
#[track_caller]
fn check_values(text: impl AsRef<[u8]>, values: &[f64], expected: &[&str]) {
    let bvh = read(text);
    let found: Vec<f64> = bvh.motion.channels.iter().copied().collect();
    assert_eq!((found.as_slice(), codes(&bvh)), (values, expected.to_vec()));
}

/// Line, column and message.
#[track_caller]
fn check_refused(text: impl AsRef<[u8]>, expected: &str) {
    match parse_bvh(text.as_ref()) {
        Err(error) => assert_eq!(error.to_string(), expected),
        Ok(bvh) => panic!("read with {:?}, expected {expected}", codes(&bvh)),
    }
}

#[test]
fn the_sample_is_read_without_a_warning() {
    check_values(SMALL, &VALUES, &[]);
    assert_eq!(read(SMALL).motion.rate.hz(), 100.0);
}

#[test]
fn what_can_only_mean_one_thing_needs_no_warning() {
    for text in [
        SMALL.replace("  ", "\t"),
        SMALL.replace('\n', "\r\n"),
        SMALL.replace('\n', "\r"),
        SMALL.replace('\n', "\n\n"),
        SMALL.trim_end().to_owned(),
        format!("\u{feff}  \n\t{SMALL}"),
        format!("{SMALL}\n \n\0\0\0\u{1a}"),
        small("End Site", "end site"),
        small("End Site", "End Site LegTip"),
        small("End Site\n    {\n", "end site{ "),
        small("    End Site\n    {\n", "    End\n    {\n"),
        small("    End Site\n    {\n", "    EndSite\n    {\n"),
        small(
            "CHANNELS 3 Zrotation Xrotation Yrotation",
            "channels\n3 Zrotation\nXROTATION\n yRotation",
        ),
        small(
            "  OFFSET 0 0 0\n  CHANNELS 3 Zrotation Xrotation Yrotation\n",
            "CHANNELS 3 Zrotation Xrotation Yrotation OFFSET 0 0\n0\n",
        ),
        small(
            "      OFFSET 0 -40.5 0\n    }\n  }\n}",
            "OFFSET 0 -40.5 0}}}",
        ),
        small("Frames: 2", "Frames :\t2"),
        small("Frames: 2", "frames 2"),
        small("Frame Time: 0.01", "Frame  Time\t:0.01"),
        small("Frame Time: 0.01", "FrameTime:  1E-2  "),
        small("Frames: 2\nFrame Time: 0.01", "Frame Time: 0.01\nFrames: 2"),
        small("Frames: 2\n", "Frames: 2 "),
        rows("1 2 3 4.5 \t\n\n\n  5\t6 +7. 85e-1\n\n"),
        rows("1. 2.0 3 4.500000000000000000000000\n5 6 0007 .85e+01"),
    ] {
        check(text, &[]);
    }
}

#[test]
fn missing_and_additional_lines() {
    check(small("HIERARCHY\n", ""), &["BVH001"]);
    check(small("MOTION\n", ""), &["BVH001"]);
    check(format!("BVH 1.0\nby hand\n{SMALL}"), &["BVH004"]);
    check(small("Frames: 2", "Frames: 2 frames"), &["BVH004"]);
    check(small("0.01", "0.01 (100 fps)"), &["BVH004"]);
    check(small("0.01\n", "0.01\nSource: a: b 7\n"), &["BVH004"]);
    check(format!("{SMALL}}}\nEND OF FILE 1 2 3\n"), &["BVH004"]);
    check(small("Frames: 2\n", ""), &["BVH014"]);
    check(small("Frames: 2\n", "Frames:\n"), &["BVH014"]);
    check(small("Frames: 2\n", "Frames: many\n"), &["BVH014"]);
    check(small("Frames: 2\n", "Frames: -1\n"), &["BVH014"]);
    check(small("Frames: 2\n", "Frames: 1.5\n"), &["BVH014"]);
    check(small("Frames: 2\n", "Frames: 1e99\n"), &["BVH014"]);
    check(small("Frames: 2\n", "Frames: 3\n"), &["BVH012"]);
    check(small("Frames: 2\n", "Frames: 0\n"), &["BVH012"]);
    check(small("Frames: 2\n", "Frames: 9\nFrames: 2\n"), &["BVH008"]);
    check(small("MOTION", "}\n}\nMOTION"), &["BVH011"]);
    check(small("  }\n}\nMOTION", "  }\nMOTION"), &["BVH010"]);
    check(small("    }\n  }\n}\nMOTION", "MOTION"), &["BVH010"]);
    // Text in the middle is no epilogue, and neither is a last row that the header announces.
    check_refused(
        rows("1 2 3 4.5\nx\n5 6 7 8.5\n"),
        "20:1: expected a number, found \"x\"",
    );
    check_refused(
        rows("1 2 3 4.5\nx 6 7 8.5\n"),
        "20:1: expected a number, found \"x\"",
    );
    check_refused("BVH 1.0\n", "1:1: expected HIERARCHY, found \"BVH\"");
    // Where a brace is missing within a tree, nobody knows where it belongs.
    check_refused(
        small("    }\n  }\n}\nMOTION", "JOINT a { OFFSET 0 0 0 } MOTION"),
        "13:1: expected OFFSET or }, found \"JOINT\"",
    );
    check_refused(
        small("ROOT Hips\n{", "ROOT Hips"),
        "3:3: expected {, found \"OFFSET\"",
    );
}

#[test]
fn a_skeleton_alone_has_no_frames() {
    let text = SMALL.split("MOTION").next().unwrap();
    let bvh = read(text);
    assert_eq!(codes(&bvh), ["BVH020"]);
    assert_eq!(bvh.motion.skeleton, read(SMALL).motion.skeleton);
    assert_eq!(bvh.motion.n_frames(), 0);
    check_values(rows("").replace("Frames: 2", "Frames: 0"), &[], &[]);
    // A file that is cut off within its hierarchy is no skeleton.
    check_refused(
        text.trim_end().trim_end_matches('}'),
        "15:1: expected OFFSET, CHANNELS, JOINT, End Site or }, found the end of the file",
    );
}

#[test]
fn comments_are_skipped_with_one_warning() {
    let everywhere: String = SMALL
        .lines()
        .map(|line| format!("# {{ 7\n{line} // note\n// ROOT\n"))
        .collect();
    check(everywhere, &["BVH002"]);
    check(small("ROOT Hips", "ROOT Hips # the pelvis {"), &["BVH002"]);
    check(small("ROOT Hips", "ROOT Hips\0 \t\0//x"), &["BVH002"]);
    // A sign within a name is part of it.
    for name in ["Hips#1", "#Hips", "a/b", "a //", "Hips #1"] {
        let bvh = read(small("Hips", name));
        let expected = name.trim_end_matches(" //");
        assert_eq!(bvh.motion.skeleton.joints()[0].name, expected);
    }
}

#[track_caller]
fn check_assumed_rate(text: &str, code: &str) {
    let bvh = read(text);
    assert_eq!(codes(&bvh), [code], "{text}");
    assert_eq!(bvh.motion.rate.hz(), 30.0);
    assert_eq!(bvh.motion.rate_source, RateSource::Default);
    assert_eq!(bvh.motion.channels, read(SMALL).motion.channels);
}

#[test]
fn frame_times_that_cannot_be_meant_are_replaced() {
    for word in [
        "0", "0.0", "-0.01", "5", "33.3333", "120", "1e-9", "1e-320", "1e300", "1.0001",
    ] {
        check_assumed_rate(&small("0.01", word), "BVH016");
    }
    check_assumed_rate(&small("Frame Time: 0.01\n", ""), "BVH015");
    check_assumed_rate(&small("Frame Time: 0.01\n", "Frame Time:\n"), "BVH015");
    for (word, hz) in [("1", 1.0), ("0.0001", 10_000.0), ("0.5", 2.0)] {
        let bvh = read(small("0.01", word));
        assert_eq!((codes(&bvh), bvh.motion.rate.hz()), (vec![], hz));
        assert_eq!(bvh.motion.rate_source, RateSource::File);
    }
    // A repeated line counts, even if the first one did not.
    let bvh = read(small(
        "Frame Time: 0.01",
        "Frame Time: 0.02\nFrame Time: 0.01",
    ));
    assert_eq!((codes(&bvh), bvh.motion.rate.hz()), (vec!["BVH008"], 100.0));
    check_refused(
        small("0.01", "nan"),
        "18:13: expected a finite number, found \"nan\"",
    );
    check_refused(
        small("0.01", "0.01s"),
        "18:13: expected a number, found \"0.01s\"",
    );
}

#[test]
fn commas_are_points_or_blanks() {
    let decimal = SMALL.replace('.', ",");
    check(decimal.as_bytes(), &["BVH005"]);
    check(decimal.replace("1 2 3 4,5", "1, 2, 3, 4,5"), &["BVH005"]);
    check(rows("1,2,3,4.5\n5,6,7,8.5\n"), &["BVH005"]);
    check(rows("1, 2, 3, 4.5\n5, 6, 7, 8.5,\n"), &["BVH005"]);
    // Names keep theirs.
    let bvh = read(decimal.replace("Leg", "Leg,1,5"));
    assert_eq!(bvh.motion.skeleton.joints()[1].name, "Leg,1,5");
    // With points elsewhere, a comma between digits would be a blank, and the row too long.
    check_refused(
        rows("1 2 3 4,5\n5 6 7 8.5\n"),
        "19:7: expected a number, found \"4,5\"",
    );
}

#[test]
fn no_break_spaces_are_blanks() {
    check(small("Frame Time: ", "Frame Time:\u{a0}"), &["BVH006"]);
    let latin: Vec<u8> = rows("1\u{1}2 3\u{1}4.5\n5 6 7 8.5\n").into_bytes();
    let latin: Vec<u8> = latin
        .into_iter()
        .map(|b| if b == 1 { 0xa0 } else { b })
        .collect();
    check(latin, &["BVH006"]);
}

#[test]
fn text_of_two_bytes_a_character_is_named() {
    for mark in ["", "\u{feff}"] {
        let text = format!("{mark}{SMALL}");
        for to_bytes in [u16::to_le_bytes, u16::to_be_bytes] {
            let bytes: Vec<u8> = text.encode_utf16().flat_map(to_bytes).collect();
            check_refused(
                bytes,
                "1:1: expected UTF-8 or Latin-1 text, found UTF-16; save the file in one of them",
            );
        }
    }
}

#[test]
fn channels_are_those_that_are_listed() {
    check(small("CHANNELS 3 Z", "CHANNELS 6 Z"), &["BVH007"]);
    check(small("CHANNELS 3 Z", "CHANNELS 1 Z"), &["BVH007"]);
    check(small("CHANNELS 3 Z", "CHANNELS 99999999999 Z"), &["BVH007"]);
    check(small("CHANNELS 3 Z", "CHANNELS Z"), &["BVH007"]);
    let split = "CHANNELS 1 Zrotation\nCHANNELS 2 Xrotation Yrotation";
    check(
        small("CHANNELS 3 Zrotation Xrotation Yrotation", split),
        &["BVH008"],
    );
    check(
        small("OFFSET 0 -50 0", "OFFSET 1 1 1\nOFFSET 0 -50 0"),
        &["BVH008"],
    );
    check_refused(
        small("Xrotation Yrotation", "Xrotation Zrotation"),
        "5:34: channel \"Zrotation\" appears twice",
    );
    let known = "known are Xposition, Yposition, Zposition, Xrotation, Yrotation and Zrotation";
    check_refused(
        small("Xrotation Yrotation", "Xrotation Wrotation"),
        &format!("5:34: unknown channel \"Wrotation\"; {known}"),
    );
}

#[test]
fn scale_channels_are_left_out() {
    let text = small(
        "CHANNELS 1 Xrotation",
        "CHANNELS 4 Xscale Yscale Xrotation Zscale",
    );
    check(
        text.replace("3 4.5", "3 1 1 4.5 1")
            .replace("7 8.5", "7 1 1 8.5 1"),
        &["BVH018"],
    );
    // What is left has nothing to count frames by.
    let only = "HIERARCHY ROOT a { OFFSET 0 0 0 CHANNELS 1 Xscale } MOTION\nFrames: 2\nFrame Time: 1\n1\n2\n";
    check_values(only, &[], &["BVH018"]);
    assert_eq!(read(only).motion.n_frames(), 0);
}

#[test]
fn joints_without_offset_stand_at_their_parent() {
    check(small("  OFFSET 0 0 0\n", ""), &["BVH009"]);
    let bvh = read(small("      OFFSET 0 -40.5 0\n", ""));
    assert_eq!(codes(&bvh), ["BVH009"]);
    assert_eq!(bvh.motion.skeleton.joints()[2].offset, [0.0; 3]);
}

#[test]
fn glued_numbers_are_two_in_offsets_as_well() {
    check(small("OFFSET 0 -50 0", "OFFSET 0-50 0"), &["BVH003"]);
    check(rows("1 2 3+4.5\n5 6 7+8.5\n"), &["BVH003"]);
}

#[test]
fn names_appear_once_in_a_figure() {
    let bvh = read(small("Leg", "Hips"));
    assert_eq!(codes(&bvh), ["BVH019"]);
    assert_eq!(bvh.warnings[0].at.line(), Some(6));
    // Two figures of one rig have all names in common.
    let tree = &SMALL[SMALL.find("ROOT").unwrap()..SMALL.find("MOTION").unwrap()];
    let two = small("MOTION", &format!("{tree}MOTION"));
    let two = two
        .replace("4.5\n", "4.5 1 2 3 4\n")
        .replace("8.5\n", "8.5 5 6 7 8\n");
    let bvh = read(two);
    assert_eq!(
        (codes(&bvh), bvh.motion.skeleton.joints().len()),
        (vec![], 6)
    );
}

#[test]
fn a_joint_may_be_called_end() {
    for name in ["End", "EndSite", "LegEnd", "End Site", "RightEndEffector"] {
        let bvh = read(small("JOINT Leg", &format!("JOINT {name}")));
        let joints = bvh.motion.skeleton.joints();
        assert_eq!((joints.len(), joints[1].name.as_str()), (3, name));
        assert!(!joints[1].end_site && joints[2].end_site);
    }
    let without = small("    End Site\n    {\n      OFFSET 0 -40.5 0\n    }\n", "");
    assert_eq!(read(&without).motion.skeleton.joints().len(), 2);
    check_values(without, &VALUES, &[]);
}

#[test]
fn rows_and_lines_may_differ_where_the_meaning_is_clear() {
    check(rows("1 2\n3 4.5\n5 6\n7 8.5\n"), &["BVH017"]);
    check(rows("1 2 3\n4.5\n5 6 7\n8.5\n"), &["BVH017"]);
    check(rows("1\n2\n3\n4.5\n5\n6\n7\n8.5\n"), &["BVH017"]);
    check(rows("1 2 3 4.5 5 6 7 8.5\n"), &["BVH017"]);
    // Lines of three, as many in all as the header says.
    check(rows("1 2 3\n4.5 5 6\n7 8.5\n"), &["BVH017"]);
    // One line break was lost.
    let three = "1 2 3 4.5 5 6 7 8.5\n1 2 3 4\n";
    let values = [&VALUES[..], &[1.0, 2.0, 3.0, 4.0]].concat();
    check_values(
        rows(three).replace("Frames: 2", "Frames: 3"),
        &values,
        &["BVH017"],
    );
    // The last frame goes on over lines that are not all there.
    check_values(
        rows("1 2\n3 4.5\n5\n"),
        &VALUES[..4],
        &["BVH012", "BVH017", "BVH013"],
    );
    check_values(
        rows("1 2 3 4.5\n5 6\n7\n"),
        &VALUES[..4],
        &["BVH012", "BVH013"],
    );
}

#[test]
fn a_value_too_many_or_too_few_in_the_middle_is_refused() {
    let third = "1 1 1 1\n";
    for (wrong, n) in [
        ("5 6 7\n", 3),
        ("5 6 7 8 9\n", 5),
        ("5\n", 1),
        ("5 6 7 8 9 10\n", 6),
    ] {
        for text in [
            format!("1 2 3 4\n{wrong}{third}"),
            format!("1 2 3 4\n{wrong}{third}{third}{third}"),
        ] {
            for frames in ["Frames: 2", "Frames: 3", "Frames: 5"] {
                check_refused(
                    rows(&text).replace("Frames: 2", frames),
                    &format!("20:1: expected 4 values for frame 2, found {n}"),
                );
            }
        }
    }
    // Every row is one short or one long: the skeleton is of another file.
    for row in ["1 2 3\n", "1 2 3 4 5\n"] {
        let n = row.split_whitespace().count();
        check_refused(
            rows(&row.repeat(4)).replace("Frames: 2", "Frames: 4"),
            &format!("19:1: expected 4 values for frame 1, found {n}"),
        );
    }
}

#[test]
fn what_is_no_number_is_refused_where_it_stands() {
    for word in [
        "0x10", "1.5f", "1e", "1d5", "--1", "1.2.3", "1;2", "O", "1,2.5", "*", "1_0",
    ] {
        check_refused(
            rows(&format!("1 {word} 3 4.5\n5 6 7 8.5\n")),
            &format!("19:3: expected a number, found {word:?}"),
        );
    }
    for word in [
        "NaN",
        "-nan(ind)",
        "inf",
        "-Infinity",
        "1e999",
        "-1.#IND00",
        "1.#QNAN",
    ] {
        check_refused(
            rows(&format!("1 {word} 3 4.5\n5 6 7 8.5\n")),
            &format!("19:3: expected a finite number, found {word:?}"),
        );
    }
}

#[test]
fn long_lines_and_many_blanks_take_linear_time() {
    let blanks = " ".repeat(1_000_000);
    check(
        rows(&format!("1 2{blanks}3 4.5{blanks}\n5 6 7 8.5{blanks}")),
        &[],
    );
    check(small("0.01", &format!("{blanks}0.01")), &[]);
    check(
        small("-40.5", &format!("-40.5{}", "0".repeat(1_000_000))),
        &[],
    );
    let comments = "# x\n".repeat(200_000);
    check(small("1 2 3", &format!("{comments}1 2 3")), &["BVH002"]);
    // Many channels, and many lines that are no rows of them.
    let joint = "JOINT a { OFFSET 0 0 0 CHANNELS 3 Zrotation Xrotation Yrotation } ";
    let wide = small("End Site", &format!("{}End Site", joint.repeat(16_000)));
    let row = "0 ".repeat(3 * 16_000 + 4);
    let rows = format!("{row}\n{comments}{row}\n");
    let bvh = read(wide.replace("1 2 3 4.5\n5 6 7 8.5\n", &rows));
    assert_eq!(codes(&bvh)[..2], ["BVH019", "BVH019"]);
    assert_eq!(bvh.motion.channels.dim(), (2, 3 * 16_000 + 4));
}
