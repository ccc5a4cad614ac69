//! What exporters, editors and people make of ASF and AMC.

use mocap_io::{Amc, Asf, Axis, Channel, LengthUnit, parse_amc, parse_asf};

const SKELETON: &str = ":version 1.10
:name sample
:units
  mass 1.0
  length 0.45
  angle deg
:root
  order TX TY TZ RX RY RZ
  axis XYZ
  position 0 0 0
  orientation 0 0 0
:bonedata
  begin
    id 1
    name lfemur
    direction 0 -1 0
    length 8
    axis 0 0 20 XYZ
    dof rx rz
    limits (-160.0 20.0)
           (-70.0 70.0)
  end
  begin
    id 2
    name ltibia
    direction 0 -2 0
    length 7
    axis 0 0 20 XYZ
  end
:hierarchy
  begin
    root lfemur
    lfemur ltibia
  end
";

const MOTION: &str = "#!OML:ASF sample.asf
:FULLY-SPECIFIED
:DEGREES
1
root 1 2 3 4 5 6
lfemur 7 8
2
root 11 12 13 14 15 16
lfemur 17 18.5
3
root 21 22 23 24 25 26
lfemur 27 28
";

fn with(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "{from:?} is not in the sample");
    text.replacen(from, to, 1)
}

#[track_caller]
fn read_asf(text: impl AsRef<[u8]>) -> Asf {
    parse_asf(text.as_ref()).unwrap_or_else(|e| panic!("{e}"))
}

#[track_caller]
fn read_amc(text: impl AsRef<[u8]>) -> Amc {
    parse_amc(text.as_ref(), &read_asf(SKELETON)).unwrap_or_else(|e| panic!("{e}"))
}

/// The same skeleton as the sample, with these warnings.
#[track_caller]
fn check_asf(text: impl AsRef<[u8]>, codes: &[&str]) {
    let (asf, sample) = (read_asf(text), read_asf(SKELETON));
    let found: Vec<&str> = asf.warnings.iter().map(mocap_io::Warning::code).collect();
    assert_eq!(found, codes);
    assert_eq!(
        (asf.skeleton, asf.angle_unit),
        (sample.skeleton, sample.angle_unit)
    );
}

/// The same motion as the sample, with these warnings.
#[track_caller]
fn check_amc(text: impl AsRef<[u8]>, codes: &[&str]) {
    let (amc, sample) = (read_amc(text), read_amc(MOTION));
    let found: Vec<&str> = amc.warnings.iter().map(mocap_io::Warning::code).collect();
    assert_eq!(found, codes);
    assert_eq!(amc.motion, sample.motion);
}

#[track_caller]
fn check_refused(motion: impl AsRef<[u8]>, expected: &str) {
    match parse_amc(motion.as_ref(), &read_asf(SKELETON)) {
        Err(error) => assert_eq!(error.to_string(), expected),
        Ok(_) => panic!("read, expected {expected}"),
    }
}

#[track_caller]
fn check_asf_refused(text: impl AsRef<[u8]>, expected: &str) {
    match parse_asf(text.as_ref()) {
        Err(error) => assert_eq!(error.to_string(), expected),
        Ok(_) => panic!("read, expected {expected}"),
    }
}

#[test]
fn the_samples_are_read_without_a_warning() {
    check_asf(SKELETON, &[]);
    check_amc(MOTION, &[]);
    assert_eq!(read_asf(SKELETON).unit, LengthUnit::ACCLAIM_CMU);
    let row: Vec<f64> = read_amc(MOTION).motion.channels.row(1).to_vec();
    assert_eq!(row, [11.0, 12.0, 13.0, 14.0, 15.0, 16.0, 17.0, 18.5]);
}

#[test]
fn skeletons_are_written_in_many_ways() {
    let limits = "limits (-160.0 20.0)\n           (-70.0 70.0)";
    for text in [
        SKELETON.replace("  ", "\t"),
        SKELETON.replace('\n', "\r\n"),
        SKELETON.replace('\n', "\n\n"),
        SKELETON.trim_end().to_owned(),
        with(SKELETON, ":version 1.10\n", ""),
        with(SKELETON, ":name sample", ":name"),
        with(SKELETON, "  mass 1.0\n", ""),
        with(SKELETON, "direction 0 -2 0", "direction 0 -1e-3 0"),
        with(SKELETON, "angle deg", "ANGLE Degrees"),
        with(SKELETON, ":units", ":UNITS"),
        with(
            SKELETON,
            "order TX TY TZ RX RY RZ",
            "ORDER tx ty tz rx ry rz",
        ),
        with(SKELETON, limits, "limits (-inf inf)\n(-INF INF)"),
        with(SKELETON, limits, "limits (-inf\n inf)\n   (\n-70.0 70.0\n)"),
        with(SKELETON, limits, ""),
        // `dof` behind `limits`, the name last.
        with(
            SKELETON,
            &format!("dof rx rz\n    {limits}"),
            &format!("{limits}\n    dof RX RZ"),
        ),
        with(SKELETON, "    name ltibia\n", "").replacen("length 7", "length 7\nname ltibia", 1),
        with(SKELETON, "    id 1\n", "id 1\nbodymass 2\ncofmass 1\n"),
        with(SKELETON, "axis 0 0 20 XYZ\n  end", "axis 0 0 20\n  end"),
    ] {
        check_asf(&text, &[]);
    }
}

#[test]
fn comments_may_stand_at_the_end_of_any_line() {
    let noted: String = SKELETON
        .lines()
        .map(|line| format!("{line}\t# :root begin 7\n"))
        .collect();
    check_asf(noted, &[]);
    let noted: String = MOTION
        .lines()
        .map(|line| format!("{line} # 4 root\n # 5\n"))
        .collect();
    check_amc(noted, &[]);
    // Within a word it is a sign like others.
    let asf = read_asf(SKELETON.replace("ltibia", "l#tibia"));
    assert_eq!(asf.skeleton.joints()[2].name, "l#tibia");
}

#[test]
fn units_that_are_not_said_are_inches_and_degrees() {
    let (head, tail) = SKELETON.split_once(":units").unwrap();
    let tail = &tail[tail.find(":root").unwrap()..];
    let asf = read_asf(format!("{head}{tail}"));
    assert_eq!(asf.unit, LengthUnit::INCH);
    check_asf(format!("{head}{tail}"), &["ASF003", "ASF003"]);
    check_asf(with(SKELETON, "  length 0.45\n", ""), &["ASF003"]);
    check_asf(with(SKELETON, "  angle deg\n", ""), &["ASF003"]);
    let metres = read_asf(with(SKELETON, "0.45", "0.0254")).unit;
    assert_eq!(metres, LengthUnit::METRE);
}

#[test]
fn unknown_keywords_are_skipped() {
    check_asf(
        with(SKELETON, "    id 1\n", "id 1\ncolour 1 2 3\n"),
        &["ASF004"],
    );
    check_asf(with(SKELETON, "  mass 1.0\n", "time 1\n"), &["ASF004"]);
    check_asf(
        with(SKELETON, "  axis XYZ\n", "scale 2\naxis XYZ\n"),
        &["ASF004"],
    );
    check_asf(
        with(SKELETON, ":root", ":skin a.obj\n 1 2\n:root"),
        &["ASF002"],
    );
    check_amc(with(MOTION, ":DEGREES", ":DEGREES\n:ACTOR x"), &["AMC004"]);
}

#[test]
fn a_bone_has_a_length_that_is_not_negative() {
    let asf = read_asf(with(SKELETON, "    length 7\n", ""));
    assert_eq!(asf.warnings[0].code(), "ASF005");
    assert_eq!(asf.skeleton.joints()[2].offset, [0.0; 3]);
    check_asf_refused(
        with(SKELETON, "length 7", "length -7"),
        "27:12: a bone's length must be not negative, found -7",
    );
}

#[test]
fn the_root_has_any_order_and_axis() {
    let text = with(
        SKELETON,
        "order TX TY TZ RX RY RZ",
        "order RZ TX RY TY RX TZ",
    );
    let asf = read_asf(with(&text, "axis XYZ", "axis zxy"));
    let root = &asf.skeleton.joints()[0];
    assert_eq!(root.channels[0], Channel::Rotation(Axis::Z));
    assert_eq!(root.channels[5], Channel::Translation(Axis::Z));
    assert_eq!(root.axis.unwrap().order, [Axis::Z, Axis::X, Axis::Y]);
}

#[test]
fn letter_case_of_names_is_forgiven_where_only_one_bone_fits() {
    check_asf(with(SKELETON, "root lfemur", "ROOT LFemur"), &["AMC006"]);
    check_amc(MOTION.replace("lfemur", "LFEMUR"), &["AMC006"]);
    check_amc(MOTION.replace("root", "Root"), &["AMC006"]);
    check_amc(with(MOTION, "lfemur 17", "Lfemur 17"), &["AMC006"]);
    let twins = SKELETON
        .replace("name ltibia", "name LFemur")
        .replace("lfemur ltibia", "lfemur LFemur");
    check_asf_refused(
        with(&twins, "root lfemur", "root LFEMUR"),
        "32:10: unknown bone \"LFEMUR\"",
    );
}

#[test]
fn motions_are_written_in_many_ways() {
    for text in [
        MOTION.replace(' ', "\t"),
        MOTION.replace('\n', "\r\n"),
        MOTION.replace('\n', " \n\n"),
        MOTION
            .replace("\nroot", "\n  root")
            .replace("\nlfemur", "\n\tlfemur"),
        MOTION.trim_end().to_owned(),
        with(MOTION, "#!OML:ASF sample.asf\n", ""),
        with(MOTION, "#!OML:ASF sample.asf", "# made by hand \u{fc}"),
        with(MOTION, ":FULLY-SPECIFIED\n:DEGREES\n", ""),
        with(MOTION, "\n1\n", "\n0001\n"),
        with(
            MOTION,
            "lfemur 17 18.5",
            "lfemur 1.7e+001 +18.500000000000000000000",
        ),
        MOTION.replace("6\nlfemur", "6\nltibia\nlfemur"),
        // Other bones first, from some frame on.
        with(
            MOTION,
            "root 11 12 13 14 15 16\nlfemur 17 18.5",
            "lfemur 17 18.5\nroot 11 12 13 14 15 16",
        ),
    ] {
        check_amc(&text, &[]);
    }
    let (head, frames) = MOTION.split_once("\n1\n").unwrap();
    let (one, frames) = frames.split_once("\n2\n").unwrap();
    let (two, three) = frames.split_once("\n3\n").unwrap();
    for first in [0, 2, 700, u64::MAX - 2] {
        let (second, third) = (first + 1, first + 2);
        let text = format!("{head}\n{first}\n{one}\n{second}\n{two}\n{third}\n{three}");
        check_amc(&text, &[]);
        assert_eq!(read_amc(text).first_frame_number, Some(first));
    }
    check_amc(MOTION.replace("\n3\n", "\n5\n"), &["AMC003"]);
}

#[test]
fn values_that_do_not_fit_the_degrees_of_freedom_are_refused() {
    // In the first frame, and in later ones, which are read another way.
    for (line, row) in [
        ("lfemur 7 8", 6),
        ("lfemur 17 18.5", 9),
        ("lfemur 27 28", 12),
    ] {
        for (wrong, n) in [("lfemur 7", 1), ("lfemur 7 8 9", 3), ("lfemur", 0)] {
            let text = with(MOTION, line, wrong) + "4\nroot 1 2 3 4 5 6\nlfemur 7 8\n";
            let expected = format!("{row}:1: expected 2 values for bone \"lfemur\", found {n}");
            check_refused(text, &expected);
        }
        let text = with(MOTION, line, "lfemur 1 nan");
        check_refused(
            text,
            &format!("{row}:10: expected a finite number, found \"nan\""),
        );
        let text = with(MOTION, line, "lfemur 1 2,5");
        check_refused(text, &format!("{row}:10: expected a number, found \"2,5\""));
        let text = with(MOTION, line, "lfmur 1 2");
        let expected = format!("{row}:1: unknown bone \"lfmur\"; the nearest name is \"lfemur\"");
        check_refused(text, &expected);
        let text = with(MOTION, line, &format!("{line}\n{line}"));
        let expected = format!("{}:1: bone \"lfemur\" appears twice", row + 1);
        check_refused(text + "4\nroot 1 2 3 4 5 6\nlfemur 7 8\n", &expected);
    }
}

#[test]
fn text_of_two_bytes_a_character_is_named() {
    let wide = |text: &str| -> Vec<u8> { text.encode_utf16().flat_map(u16::to_le_bytes).collect() };
    let expected =
        "1:1: expected UTF-8 or Latin-1 text, found UTF-16; save the file in one of them";
    check_refused(wide(MOTION), expected);
    check_asf_refused(wide(SKELETON), expected);
}

/// Every way to lose the end of a file keeps all whole frames.
#[test]
fn a_file_cut_anywhere_keeps_its_whole_frames() {
    let whole = read_amc(MOTION).motion;
    // Which bones a frame has, only a whole one says.
    let first_frame = MOTION.find("\n2\n").unwrap() + 1;
    for end in first_frame..MOTION.len() {
        let amc = read_amc(&MOTION[..end]);
        let n_frames = amc.motion.n_frames();
        let n_begun = MOTION[..end].matches("root 1").count().max(1);
        assert!(n_frames + 1 >= n_begun, "{end}");
        for frame in 0..n_frames {
            // A last number that was cut cannot be told from a shorter one.
            let n_sure = if frame + 1 == n_frames { 7 } else { 8 };
            for column in 0..n_sure {
                let found = amc.motion.channels[[frame, column]];
                assert_eq!(found, whole.channels[[frame, column]], "{end}");
            }
        }
    }
}
