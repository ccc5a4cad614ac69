use proptest::prelude::*;

use super::*;

/// What `str::parse` makes of the word that `text` begins with.
fn expected(text: &str) -> Option<u64> {
    let word = text.split(' ').next()?;
    let is_number = |b: u8| b.is_ascii_digit() || matches!(b, b'.' | b'e' | b'E' | b'+' | b'-');
    let value: f64 = word.parse().ok()?;
    (word.bytes().all(is_number) && value.is_finite()).then_some(value.to_bits())
}

/// At the end of the text, and with as much behind it as any way of reading looks at.
#[track_caller]
fn check(word: &str) {
    for rest in [
        "",
        " ",
        " 1",
        " 1.5 2.5 3.5 4.5 5.5",
        "\n-12345678.123456789",
    ] {
        let text = format!("{word}{rest}");
        let found = spaced(text.as_bytes(), 0);
        assert_eq!(found.map(|(v, _)| v.to_bits()), expected(word), "{text:?}");
        assert!(found.is_none_or(|(_, end)| end == word.len()), "{text:?}");
    }
}

#[test]
fn numbers_of_every_shape_are_read_as_the_library_reads_them() {
    for word in [
        "0",
        "-0",
        "0.0",
        "-0.0",
        "1.",
        ".5",
        "-.5",
        "+1.5",
        "1e5",
        "1E-5",
        "-6.55989e-014",
        "1234567",
        "12345678",
        "-1234567.1234567",
        "-1234567.12345678",
        "1234567.123456789",
        "9007199254740991",
        "9007199254740993",
        "0.9007199254740993",
        "90071992.54740993",
        ".12345678",
        ".1234567812345678",
        ".12345678123456789",
        "0.1234567812345678",
        "179769313486231570000e289",
        "1e308",
        "4.9e-324",
        "2.4703282292062327e-324",
        "1e-400",
        "2.2250738585072014e-308",
        "2.2250738585072011e-308",
        "0.1",
        "0.3",
        "1.7976931348623157e308",
        "00000000000000000001.5",
        "0.00000000000000000000000001",
        "123456789012345678901234567890",
    ] {
        check(word);
    }
}

#[test]
fn what_is_no_finite_number_is_not_read() {
    for word in [
        "",
        "-",
        "+",
        ".",
        "-.",
        "e5",
        "1e",
        "1.5.",
        "1.2.3",
        "--1",
        "1-",
        "1.5-2",
        "nan",
        "inf",
        "-inf",
        "1e999",
        "0x10",
        "1_000",
        "1,5",
        "12345678a",
        "1.1234567a",
        "1.12345678a",
        "1/",
        "1:",
    ] {
        assert_eq!(expected(word), None, "{word}");
        check(word);
    }
}

fn digits(max: usize) -> impl Strategy<Value = String> {
    proptest::string::string_regex(&format!("[0-9]{{0,{max}}}")).unwrap()
}

fn exponent() -> impl Strategy<Value = String> {
    prop_oneof![
        3 => Just(String::new()),
        1 => "[eE][+-]?[0-9]{1,3}",
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4096, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn decimals_match_the_library(
        sign in "[+-]?", whole in digits(20), point in "\\.?", decimals in digits(20), exponent in exponent()
    ) {
        check(&format!("{sign}{whole}{point}{decimals}{exponent}"));
    }

    #[test]
    fn short_decimals_match_the_library(sign in "-?", whole in digits(8), decimals in digits(9)) {
        check(&format!("{sign}{whole}.{decimals}"));
    }

    #[test]
    fn any_double_reads_back(bits in any::<u64>()) {
        let value = f64::from_bits(bits);
        prop_assume!(value.is_finite());
        check(&value.to_string());
        check(&format!("{value:e}"));
        check(&format!("{value:.17e}"));
    }

    #[test]
    fn near_ties_round_to_even(whole in (1u64 << 53)..(1 << 54), n_decimals in 1usize..17) {
        // Halfway between two doubles, or next to it.
        let text = whole.to_string();
        let at = text.len().saturating_sub(n_decimals);
        check(&format!("{}.{}", &text[..at], &text[at..]));
    }

    #[test]
    fn any_bytes_are_read_as_the_library_reads_them(word in "[-+.0-9eE:/]{0,24}") {
        check(&word);
    }
}
