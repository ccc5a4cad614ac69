use super::*;
use crate::{OffsetFrame, WarningKind};

/// Three bones: `a` on the root, `b` and `c` on `a`.
const SMALL: &str = ":version 1.10
:name small
:units
  mass 1.0
  length 0.45
  angle deg
:documentation
  what it is about
:root
  order TX TY TZ RX RY RZ
  axis XYZ
  position 1 2 3
  orientation 0 0 0
:bonedata
  begin
    id 1
    name a
    direction 0 2 0
    length 10
    axis 0 0 20 XYZ
    dof rx ry rz
    limits (-160.0 20.0)
           (-70.0 70.0)
           (-60.0 70.0)
  end
  begin
    name b
    direction 1 0 0
    length 5
    axis 0 0 0 ZYX
    dof rz
  end
  begin
    name c
    direction 0 0 -1
    length 5
    axis 0 0 0
  end
:hierarchy
  begin
    root a
    a b c
  end
";

fn small(from: &str, to: &str) -> String {
    assert!(SMALL.contains(from), "{from:?} is not in the sample");
    SMALL.replacen(from, to, 1)
}

#[track_caller]
fn parse(text: impl AsRef<[u8]>) -> Asf {
    parse_asf(text.as_ref()).unwrap_or_else(|e| panic!("{e}"))
}

#[track_caller]
fn check_same(text: impl AsRef<[u8]>) {
    assert_eq!(parse(text), parse(SMALL));
}

#[track_caller]
fn check_error(text: impl AsRef<[u8]>, expected: &str) {
    match parse_asf(text.as_ref()) {
        Err(error) => assert_eq!(error.to_string(), expected),
        Ok(_) => panic!("no error, expected {expected}"),
    }
}

#[test]
fn a_small_file_says_what_it_says() {
    let asf = parse(SMALL);
    assert_eq!(asf.name, "small");
    assert_eq!(asf.warnings, []);
    assert_eq!(asf.unit, LengthUnit::ACCLAIM_CMU);
    assert_eq!(asf.skeleton.offset_frame(), OffsetFrame::Own);
    let joints = asf.skeleton.joints();
    let names: Vec<(&str, Option<usize>)> =
        joints.iter().map(|j| (j.name.as_str(), j.parent)).collect();
    assert_eq!(
        names,
        [
            ("root", None),
            ("a", Some(0)),
            ("b", Some(1)),
            ("c", Some(1))
        ]
    );
    assert_eq!(joints[0].offset, [1.0, 2.0, 3.0]);
    // The direction had length 2.
    assert_eq!(joints[1].offset, [0.0, 10.0, 0.0]);
    assert_eq!(joints[3].offset, [0.0, 0.0, -5.0]);
    assert_eq!(joints[1].axis, Some(AxisFrame::xyz([0.0, 0.0, 20.0])));
    assert_eq!(joints[2].axis.unwrap().order, [Axis::Z, Axis::Y, Axis::X]);
    assert_eq!(joints[2].channels, [Channel::Rotation(Axis::Z)]);
    assert_eq!(joints[3].channels, []);
    assert_eq!(asf.skeleton.n_channels(), 10);
}

#[test]
fn white_space_and_line_ends_do_not_matter() {
    check_same(SMALL.replace('\n', "\r\n"));
    check_same(SMALL.replace('\n', "\r"));
    check_same(SMALL.replace("  ", "\t"));
    check_same(SMALL.replace('\n', " \t\n\n"));
    check_same(format!("\u{feff}{SMALL}"));
    check_same(SMALL.trim_end());
}

#[test]
fn comments_may_stand_on_any_line() {
    let mut text = String::from("## head :root\n");
    for line in SMALL.lines() {
        text += &format!("{line}\n  # begin :bonedata name x\n");
    }
    check_same(text);
}

#[test]
fn sections_and_bones_come_in_any_order() {
    let (head, bones) = SMALL.split_once(":bonedata").unwrap();
    let (bones, tree) = bones.split_once(":hierarchy").unwrap();
    check_same(format!("{head}:hierarchy{tree}:bonedata{bones}"));
    let (units, root) = head.split_once(":root").unwrap();
    check_same(format!(
        ":bonedata{bones}:root{root}:hierarchy{tree}{units}"
    ));
    // The hierarchy orders the joints, not the bone data.
    let c_first = SMALL
        .replace("name c", "name x")
        .replace("name b", "name c")
        .replace("name x", "name b");
    let names: Vec<String> = parse(c_first).skeleton.names().map(str::to_owned).collect();
    assert_eq!(names, ["root", "a", "b", "c"]);
    check_same(small("root a\n    a b c", "a b\n    root a\n    a c"));
}

#[test]
fn unknown_sections_are_skipped_with_a_warning() {
    let asf = parse(small(
        ":units",
        ":namespace mo_walk\n  begin\n  length 3\n:skin a.skin\n:units",
    ));
    let warnings: Vec<String> = asf.warnings.iter().map(Warning::to_string).collect();
    assert_eq!(
        warnings,
        [
            "3:1: ASF002: unknown section \"namespace\" was skipped",
            "6:1: ASF002: unknown section \"skin\" was skipped"
        ]
    );
    assert_eq!(asf.skeleton, parse(SMALL).skeleton);
    assert_eq!(
        asf.warnings[0].kind,
        WarningKind::UnknownSection {
            name: "namespace".to_owned()
        }
    );
}

#[test]
fn a_name_may_have_blanks_and_any_bytes() {
    assert_eq!(
        parse(small("small", "Walk Skeleton Mini ")).name,
        "Walk Skeleton Mini"
    );
    let (before, after) = SMALL.split_once("small").unwrap();
    let text = [before.as_bytes(), b"M\xfcller", after.as_bytes()].concat();
    assert_eq!(parse(text).name, "Müller");
}

#[test]
fn radians_become_degrees() {
    let text = small("angle deg", "angle rad").replace("0 0 20 XYZ", "0 0 3.141592653589793 XYZ");
    let asf = parse(text.replace("orientation 0 0 0", "orientation 0 1.5707963267948966 0"));
    assert_eq!(asf.angle_unit, AngleUnit::Radians);
    assert_eq!(
        asf.skeleton.joints()[0].axis.unwrap().degrees,
        [0.0, 90.0, 0.0]
    );
    assert_eq!(
        asf.skeleton.joints()[1].axis.unwrap().degrees,
        [0.0, 0.0, 180.0]
    );
}

#[test]
fn a_unit_without_length_is_an_inch() {
    assert_eq!(parse(small("  length 0.45\n", "")).unit, LengthUnit::INCH);
    assert_eq!(
        parse(small("length 0.45", "length .045")).unit.metres(),
        0.0254 / 0.045
    );
}

#[test]
fn bones_may_shift_and_stretch() {
    let dofs = parse(small("dof rx ry rz", "dof TX ty tz rx l"))
        .skeleton
        .joints()[1]
        .channels
        .clone();
    let spelt: Vec<String> = dofs.iter().map(Channel::to_string).collect();
    assert_eq!(
        spelt,
        ["Xposition", "Yposition", "Zposition", "Xrotation", "length"]
    );
}

#[test]
fn a_bone_without_length_needs_no_direction() {
    let asf = parse(small(
        "direction 0 2 0\n    length 10",
        "direction 0 0 0\n    length 0",
    ));
    assert_eq!(asf.skeleton.joints()[1].offset, [0.0; 3]);
    let what = "15:3: the direction's length must be positive and finite, found";
    check_error(
        small("direction 0 2 0", "direction 0 0 0"),
        &format!("{what} 0"),
    );
    check_error(
        small("direction 0 2 0", "direction 0 1e200 0"),
        &format!("{what} inf"),
    );
    check_error(
        small("length 10", "length 1e308").replace("direction 0 2 0", "direction 0 1e-200 1e-100"),
        "15:3: the direction's length must be positive and finite, found 0.0000000000000000000000\
         000000000000000000000000000000000000000000000000000000000000000000000000000001",
    );
}

#[test]
fn numbers_too_large_in_degrees_are_refused() {
    let text = small("angle deg", "angle rad").replace("0 0 20 XYZ", "0 0 1e308 XYZ");
    check_error(text, "15:3: an axis angle must be finite, found inf");
    check_error(
        small("0 0 20 XYZ", "0 0 inf XYZ"),
        "20:14: expected a finite number, found \"inf\"",
    );
}

#[test]
fn missing_parts_are_named() {
    check_error("", "1:1: the file has no :root section");
    check_error("hello\nworld", "2:6: the file has no :root section");
    let (head, _) = SMALL.split_once(":bonedata").unwrap();
    check_error(head, "14:1: the file has no :bonedata section");
    let (head, _) = SMALL.split_once(":hierarchy").unwrap();
    check_error(head, "39:1: the file has no :hierarchy section");
}

#[test]
fn a_bone_outside_the_hierarchy_is_left_out_with_a_warning() {
    let asf = parse(small("a b c", "a b"));
    let names: Vec<&str> = asf.skeleton.names().collect();
    assert_eq!(names, ["root", "a", "b"]);
    let warnings: Vec<String> = asf.warnings.iter().map(Warning::to_string).collect();
    assert_eq!(
        warnings,
        ["33:3: ASF001: bone \"c\" is not in the hierarchy; it was left out"]
    );
}

#[test]
fn broken_bones_say_where() {
    check_error(
        small("  begin\n", "  bgin\n"),
        "15:3: expected begin or a section, found \"bgin\"",
    );
    check_error(
        small("  end\n  begin", "  begin"),
        "25:3: expected end, found \"begin\"",
    );
    let (head, _) = SMALL.split_once("  end\n:hierarchy").unwrap();
    check_error(head, "38:1: expected end, found the end of the file");
    check_error(
        head.to_owned() + ":hierarchy",
        "38:1: expected end, found \":hierarchy\"",
    );
    check_error(
        small("length 10", "length"),
        "19:11: expected a number, found the end of the line",
    );
    check_error(
        small("direction 0 2 0", "direction 0 2"),
        "18:18: expected a number, found the end of the line",
    );
    let known = "known are XYZ and its permutations";
    check_error(
        small("20 XYZ", "20 XYX"),
        &format!("20:17: unknown axis order \"XYX\"; {known}"),
    );
    check_error(
        small("20 XYZ", "20 XYZZ"),
        &format!("20:17: unknown axis order \"XYZZ\"; {known}"),
    );
    let known = "known are tx, ty, tz, rx, ry, rz and l";
    check_error(
        small("rx ry rz", "rx rw"),
        &format!("21:12: unknown degree of freedom \"rw\"; {known}"),
    );
    check_error(
        small("rx ry rz", "rx RX"),
        "21:12: degree of freedom \"RX\" appears twice",
    );
    check_error(small("name b", "name a"), "26:3: bone \"a\" appears twice");
}

#[test]
fn broken_units_say_where() {
    for word in ["0", "-1"] {
        let expected = format!("5:10: the length unit must be positive, found {word}");
        check_error(small("0.45", word), &expected);
    }
    check_error(
        small("angle deg", "angle grad"),
        "6:9: unknown angle unit \"grad\"; known are deg and rad",
    );
}

#[test]
fn broken_hierarchies_say_where() {
    let tree = |lines: &str| small("root a\n    a b c", lines);
    check_error(tree("root a\n    a b c d"), "42:11: unknown bone \"d\"");
    let text = SMALL
        .replace("name b", "name rradius")
        .replace("a b c", "a rradus c");
    check_error(
        text,
        "42:7: unknown bone \"rradus\"; the nearest name is \"rradius\"",
    );
    check_error(tree("root a\n    x b c"), "42:5: unknown bone \"x\"");
    check_error(
        tree("root a b\n    a b c"),
        "42:7: child \"b\" appears twice",
    );
    check_error(
        tree("root a\n    a b c a"),
        "42:11: child \"a\" appears twice",
    );
    check_error(
        tree("root a\n    a b c root"),
        "42:11: child \"root\" appears twice",
    );
    check_error(
        tree("root a\n    b c\n    c b"),
        "26:3: bone \"b\" is not connected to the root",
    );
    check_error(
        tree("root a\n    a b\n    c c"),
        "33:3: bone \"c\" is not connected to the root",
    );
}

/// A file of `n` bones in a chain, followed by `extra`.
fn chain(n: usize) -> String {
    let bone = |i: usize| format!("begin\nname n{i}\ndirection 0 1 0\nlength 1\nend\n");
    let bones: String = (1..=n).map(bone).collect();
    let edges: String = (1..n).map(|i| format!("n{i} n{}\n", i + 1)).collect();
    format!(":root\n:bonedata\n{bones}:hierarchy\nroot n1\n{edges}")
}

#[test]
fn long_chains_and_names_take_linear_time() {
    let n = MAX_JOINTS - 1;
    let asf = parse(chain(n));
    assert_eq!(asf.skeleton.joints().len(), n + 1);
    let mut again = Vec::new();
    crate::write_asf(&asf, &mut again).unwrap();
    assert_eq!(parse(again).skeleton.joints().len(), n + 1);
    let long = "x".repeat(400_000);
    let siblings = format!(
        ":root\n:bonedata\nbegin\nname a\nend\n:hierarchy\nroot a\n{long} {}",
        "b ".repeat(MAX_JOINTS - 1)
    );
    check_error(siblings, &format!("8:1: unknown bone {long:?}"));
}

#[test]
fn many_oddities_take_linear_time() {
    let text = SMALL.to_owned() + &":odd\n".repeat(100_000);
    let warnings = parse(text).warnings;
    let n = 100_000 - (warnings.len() - 1);
    assert_eq!(
        warnings[warnings.len() - 2].at.line(),
        Some(44 - 1 + warnings.len() - 1)
    );
    assert_eq!(warnings.last().unwrap().kind, WarningKind::More { n });
}

#[test]
fn no_more_bones_than_a_figure_could_have() {
    let bones = chain(MAX_JOINTS);
    let error = parse_asf(bones.as_bytes()).unwrap_err();
    let (what, limit) = ("bones", MAX_JOINTS);
    assert_eq!(error.kind, ParseErrorKind::TooMany { what, limit });
    let children = SMALL.to_owned() + "a " + &"b ".repeat(MAX_JOINTS);
    let error = parse_asf(children.as_bytes()).unwrap_err();
    let what = "children in the hierarchy";
    assert_eq!(error.kind, ParseErrorKind::TooMany { what, limit });
}
