use super::*;

const SMALL: &str = "name = \"small\"

[lengths]
hl = [[\"rshoulder\", \"relbow\"]]
sw = [[\"rshoulder\", \"lshoulder\"]]

[[feature]]
name = \"rhand_up\"
set = \"upper\"
mirror = \"lhand_up\"
quantity = { kind = \"distance\", of = \"rwrist\", from = \"neck\", along = { axis = [\"chest\", \"neck\"] } }
enter = \">= 0.2 hl\"
stay = \">= 0 hl\"

[[feature]]
name = \"lhand_up\"
set = \"upper\"
mirror = \"rhand_up\"
quantity = { kind = \"distance\", of = \"lwrist\", from = \"neck\", along = { axis = [\"chest\", \"neck\"] } }
enter = \">= 0.2 hl\"
stay = \">= 0 hl\"

[[feature]]
name = \"fast\"
set = \"mix\"
mirror = \"fast\"
quantity = { kind = \"speed\", of = [\"root\"], window_ms = 0 }
enter = \"> 2 hl/s\"
stay = \"> 1 hl/s\"
";

fn small(from: &str, to: &str) -> String {
    assert!(SMALL.contains(from), "{from:?} is not in the sample");
    SMALL.replacen(from, to, 1)
}

#[track_caller]
fn check_error(text: impl AsRef<str>, expected: &str) {
    match FeatureSet::from_toml(text.as_ref()) {
        Err(error) => assert_eq!(error.to_string(), expected),
        Ok(_) => panic!("no error, expected {expected}"),
    }
}

/// For messages of the TOML parser, whose wording is its own.
#[track_caller]
fn check_place(text: impl AsRef<str>, line: usize, column: usize, part: &str) {
    let error = FeatureSet::from_toml(text.as_ref()).unwrap_err();
    assert_eq!((error.line, error.column), (line, column), "{error}");
    assert!(error.message.contains(part), "{error}");
    assert!(!error.message.contains('\n'), "{error:?}");
}

#[test]
fn every_builtin_set_reads() {
    for (name, n_features) in BUILTIN_SETS.into_iter().zip([39, 39, 31, 31]) {
        let text = FeatureSet::builtin_toml(name).unwrap();
        let set = FeatureSet::from_toml(text).unwrap_or_else(|e| panic!("{name}:{e}"));
        assert_eq!(set.name(), name);
        assert_eq!(set.features().len(), n_features);
        assert_eq!(set.all(), (1 << n_features) - 1);
    }
    assert_eq!(FeatureSet::builtin("mueller1906"), None);
}

#[test]
fn a_small_set_says_what_it_says() {
    let set = FeatureSet::from_toml(SMALL).unwrap();
    assert_eq!(
        (set.name(), set.features().len(), set.all()),
        ("small", 3, 0b111)
    );
    let mirrors: Vec<usize> = set.features().iter().map(|f| f.mirror).collect();
    assert_eq!(mirrors, [1, 0, 2]);
    assert_eq!(
        set.length("hl"),
        Some(&[[BodyPoint::RShoulder, BodyPoint::RElbow]][..])
    );
    assert_eq!(set.length("m"), None);
    let empty = FeatureSet::from_toml("name = 'none'").unwrap();
    assert_eq!((empty.all(), empty.select("F1")), (0, None));
}

#[test]
fn features_are_selected_by_name_number_and_part() {
    let set = FeatureSet::from_toml(SMALL).unwrap();
    assert_eq!(set.select("lhand_up"), Some(0b010));
    assert_eq!(set.select("F1"), Some(0b001));
    assert_eq!(set.select("f3"), Some(0b100));
    assert_eq!(set.select("upper"), Some(0b011));
    assert_eq!(set.select("*hand*"), Some(0b011));
    assert_eq!(set.select("l*_up"), Some(0b010));
    assert_eq!(set.select("f*t"), Some(0b100));
    assert_eq!(set.select("*"), Some(0b111));
    for nothing in ["F0", "F4", "3", "lower", "", "hand_up", "F"] {
        assert_eq!(set.select(nothing), None, "{nothing}");
    }
    let set = FeatureSet::builtin("mueller2006").unwrap();
    let parts = ["upper", "lower", "mix"].map(|part| set.select(part).unwrap());
    assert_eq!(parts.map(u64::count_ones), [14, 12, 13]);
    assert_eq!(parts.iter().fold(0, |all, part| all | part), set.all());
    assert_eq!(set.select("F39"), set.select("root_fast"));
}

/// A set of `n` features.
fn set_of(n: usize) -> String {
    let feature = |i: usize| {
        format!(
            "[[feature]]\nname = 'x{i}'\nset = 's'\nmirror = 'x{i}'\nquantity = {{ kind = 'vertical_extent' }}\nenter = '> 2 m'\nstay = '> 1 m'\n"
        )
    };
    "name = 'n'\n".to_owned() + &(0..n).map(feature).collect::<String>()
}

#[test]
fn a_word_has_64_bits() {
    let set = FeatureSet::from_toml(&set_of(64)).unwrap();
    assert_eq!(set.all(), u64::MAX);
    assert_eq!(set.select("F64"), Some(1 << 63));
    check_error(set_of(65), "450:1: expected at most 64 features, found 65");
}

#[test]
fn broken_toml_is_an_error() {
    check_place("", 1, 1, "name");
    check_place("name = ", 1, 8, "");
    check_place(small("set = \"upper\"\n", ""), 7, 1, "set");
    check_place(small("mirror", "mirrored"), 10, 1, "mirrored");
    check_place(small("[[feature]]", "[[features]]"), 7, 3, "features");
}

#[test]
fn unknown_words_are_errors_with_their_place() {
    check_place(small("\"rwrist\"", "\"rwirst\""), 11, 12, "rwirst");
    check_place(small("\"relbow\"]]", "\"ellbow\"]]"), 4, 21, "ellbow");
    check_place(small("\"distance\"", "\"distanze\""), 11, 21, "distanze");
    check_place(small("axis", "axes"), 11, 12, "axes");
    check_place(small("of = \"rwrist\"", "off = \"rwrist\""), 11, 12, "off");
    check_place(small("window_ms = 0", "window = 0"), 27, 12, "window");
    check_place(
        small("\">= 0.2 hl\"", "\"0.2 hl\""),
        12,
        9,
        "expected a test such as",
    );
    check_place(
        small("\">= 0.2 hl\"", "\"0.5..0.2 hl\""),
        12,
        9,
        "0.5..0.2 hl",
    );
}

#[test]
fn lengths_have_points_and_names_of_their_own() {
    check_error(
        small("[[\"rshoulder\", \"relbow\"]]", "[]"),
        "4:1: expected pairs of body points, found none",
    );
    check_error(
        small("sw =", "m ="),
        "5:1: the name of this length is taken by a unit",
    );
    check_error(
        small("sw =", "deg ="),
        "5:1: the name of this length is taken by a unit",
    );
}

#[test]
fn tests_fit_their_quantity() {
    let measures = "7:1: feature \"rhand_up\" measures a length, its test a unit of";
    check_error(small("0.2 hl", "0.2 hl/s"), &format!("{measures} a speed"));
    check_error(small("0 hl", "0 deg"), &format!("{measures} an angle"));
    let fast = small("> 2 hl/s", "> 2 hl");
    check_error(
        fast,
        "23:1: feature \"fast\" measures a speed, its test a unit of a length",
    );
    check_error(
        small("0.2 hl", "0.2 hw"),
        "7:1: unknown unit \"hw\"; known are m, hl, sw",
    );
    assert!(FeatureSet::from_toml(&SMALL.replace(" hl\"", " m\"")).is_ok());
}

#[test]
fn what_enters_may_stay() {
    let implied =
        "7:1: feature \"rhand_up\": whatever passes `enter` must pass `stay`, in the same unit";
    for (enter, stay) in [
        (">= 0.2 hl", ">= 0.3 hl"),
        (">= 0.2 hl", "> 0.2 hl"),
        (">= 0.2 hl", "<= 0.2 hl"),
        (">= 0.2 hl", ">= 0 sw"),
        ("<= 0.2 hl", "<= 0.1 hl"),
        ("<= 0.2 hl", "< 0.2 hl"),
        ("0.2..0.4 hl", "0.3..0.5 hl"),
        ("0.2..0.4 hl", ">= 0 hl"),
    ] {
        check_error(
            SMALL
                .replacen(">= 0.2 hl", enter, 1)
                .replacen(">= 0 hl", stay, 1),
            implied,
        );
    }
    for (enter, stay) in [
        ("> 0.2 hl", ">= 0.2 hl"),
        (">= 0.2 hl", ">= 0.2 hl"),
        ("< 0.2 hl", "<= 0.2 hl"),
        ("<= 0.2 hl", "< 0.3 hl"),
        ("0.2..0.4 hl", "0.2..0.5 hl"),
    ] {
        let text = SMALL
            .replacen(">= 0.2 hl", enter, 1)
            .replacen(">= 0 hl", stay, 1);
        assert!(FeatureSet::from_toml(&text).is_ok(), "{enter}, {stay}");
    }
}

#[test]
fn names_are_single_and_no_numbers() {
    check_error(
        small("name = \"fast\"", "name = \"rhand_up\""),
        "23:1: feature \"rhand_up\" appears twice",
    );
    for name in ["", "F7", "f12"] {
        let expected = format!("23:1: expected a name that is not a number, found {name:?}");
        check_error(
            small("name = \"fast\"", &format!("name = {name:?}")),
            &expected,
        );
    }
}

#[test]
fn mirrors_come_in_pairs() {
    check_error(
        small("mirror = \"lhand_up\"", "mirror = \"x\""),
        "7:1: mirror names no feature of this set, found \"x\"",
    );
    check_error(
        small("mirror = \"lhand_up\"", "mirror = \"fast\""),
        "7:1: \"fast\" is not mirrored back to \"rhand_up\"",
    );
}

#[test]
fn points_and_windows_are_within_their_limits() {
    check_error(
        small("[\"root\"]", "[]"),
        "23:1: feature \"fast\" measures no point",
    );
    for ms in ["-1", "60001", "nan", "inf"] {
        let found: f64 = ms.parse().unwrap();
        let expected = format!("23:1: expected window_ms from 0 to 60000, found {found}");
        check_error(
            small("window_ms = 0", &format!("window_ms = {ms}")),
            &expected,
        );
    }
}

#[test]
fn the_smallest_is_of_some_like_quantities() {
    let speed = "{ kind = \"speed\", of = [\"root\"], window_ms = 0 }";
    let of = |parts: &[&str]| {
        small(
            speed,
            &format!("{{ kind = \"smallest\", of = [{}] }}", parts.join(", ")),
        )
    };
    let angle = "{ kind = \"angle\", of = [\"root\", \"neck\"], to = \"up\" }";
    let nothing = "{ kind = \"largest\", of = [] }";
    let still = "{ kind = \"speed\", of = [], window_ms = 0 }";
    assert!(FeatureSet::from_toml(&of(&[speed, speed])).is_ok());
    check_error(of(&[]), "23:1: feature \"fast\" measures nothing");
    check_error(
        of(&[speed, angle]),
        "23:1: feature \"fast\" compares a speed with an angle",
    );
    let nested = format!("{{ kind = \"largest\", of = [{nothing}] }}");
    check_error(of(&[&nested]), "23:1: feature \"fast\" measures nothing");
    check_error(
        of(&[speed, still]),
        "23:1: feature \"fast\" measures no point",
    );
    check_error(
        of(&[angle]),
        "23:1: feature \"fast\" measures an angle, its test a unit of a speed",
    );
}

#[test]
fn segments_have_points_and_a_finite_radius() {
    let distance = "kind = \"distance\", of = \"rwrist\", from = \"neck\", along = { axis = [\"chest\", \"neck\"] }";
    let segment = |of: &str, radius: &str| {
        small(
            distance,
            &format!(
                "kind = \"segment_distance\", of = [{of}], to = [\"neck\", \"head\"], radius = {radius}"
            ),
        )
    };
    assert!(FeatureSet::from_toml(&segment("\"rwrist\"", "0.5")).is_ok());
    check_error(
        segment("", "0.5"),
        "7:1: feature \"rhand_up\" measures no point",
    );
    for radius in ["-1", "1001", "nan", "inf"] {
        let found: f64 = radius.parse().unwrap();
        check_error(
            segment("\"rwrist\"", radius),
            &format!("7:1: expected a radius from 0 to 1000, found {found}"),
        );
    }
}

/// Deep nesting is refused by the TOML parser, before it could exhaust the stack.
#[test]
fn nesting_has_an_end() {
    let speed = "{ kind = \"speed\", of = [\"root\"], window_ms = 0 }";
    let (open, close) = ("{ kind = \"smallest\", of = [", "] }");
    let nested = |depth: usize| {
        small(
            speed,
            &format!("{}{speed}{}", open.repeat(depth), close.repeat(depth)),
        )
    };
    assert!(FeatureSet::from_toml(&nested(10)).is_ok());
    assert!(FeatureSet::from_toml(&nested(10_000)).is_err());
}

#[test]
fn stars_stand_for_anything() {
    for (pattern, name, expected) in [
        ("a*a", "a", false),
        ("a*a", "aa", true),
        ("*ab*ab*", "abab", true),
        ("*ab*ab*", "abb", false),
        ("*b", "abab", true),
        ("**", "", true),
        ("", "", true),
        ("a", "ab", false),
    ] {
        assert_eq!(fits(pattern, name), expected, "{pattern} {name}");
    }
}

#[test]
fn mirrored_bits_change_sides_and_come_back() {
    let set = FeatureSet::builtin("mueller2006").unwrap();
    let bit = |name| set.select(name).unwrap();
    assert_eq!(set.mirrored(bit("rknee_bent")), bit("lknee_bent"));
    assert_eq!(set.mirrored(bit("root_fast")), bit("root_fast"));
    for i in 0..64 {
        assert_eq!(set.mirrored(set.mirrored(1 << i)), set.all() & 1 << i);
    }
}
