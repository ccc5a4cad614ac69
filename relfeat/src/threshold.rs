use std::str::FromStr;

use serde::Deserialize;

use crate::Dimension;

/// A test of a number: `">= 0.2 chest"`, `"< 1.4 hl"`, `"> 1.8 hl/s"` or `"70..110 deg"` (both ends
/// included).
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(try_from = "String")]
pub struct Test {
    /// The comparison, in multiples of the unit.
    pub bound: Bound,
    /// What the numbers are multiples of.
    pub unit: Unit,
}

/// A comparison.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound {
    /// `> x`
    Above(f64),
    /// `>= x`
    AtLeast(f64),
    /// `< x`
    Below(f64),
    /// `<= x`
    AtMost(f64),
    /// `a..b`, both included.
    Within(f64, f64),
}

/// The unit of a test.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Degrees.
    Degrees,
    /// A length of the body, by its name in the set's `lengths`, or `m` for metres.
    Length(String),
    /// Such a length per second.
    LengthPerSecond(String),
}

impl Unit {
    /// What the unit measures.
    #[must_use]
    pub fn dimension(&self) -> Dimension {
        match self {
            Unit::Degrees => Dimension::Angle,
            Unit::Length(_) => Dimension::Length,
            Unit::LengthPerSecond(_) => Dimension::Speed,
        }
    }

    /// The name of the length, if there is one.
    #[must_use]
    pub fn length(&self) -> Option<&str> {
        match self {
            Unit::Degrees => None,
            Unit::Length(name) | Unit::LengthPerSecond(name) => Some(name),
        }
    }
}

impl Bound {
    /// Whether `value` passes. NaN never does.
    #[inline]
    #[must_use]
    pub fn holds(self, value: f64) -> bool {
        match self {
            Bound::Above(x) => value > x,
            Bound::AtLeast(x) => value >= x,
            Bound::Below(x) => value < x,
            Bound::AtMost(x) => value <= x,
            Bound::Within(a, b) => a <= value && value <= b,
        }
    }

    /// The numbers that the comparison turns on.
    pub fn thresholds(self) -> impl Iterator<Item = f64> {
        let (first, second) = match self {
            Bound::Above(x) | Bound::AtLeast(x) | Bound::Below(x) | Bound::AtMost(x) => (x, None),
            Bound::Within(a, b) => (a, Some(b)),
        };
        std::iter::once(first).chain(second)
    }

    /// The same with every number times `unit`, which must not be negative.
    #[must_use]
    pub fn scaled(self, unit: f64) -> Bound {
        match self {
            Bound::Above(x) => Bound::Above(x * unit),
            Bound::AtLeast(x) => Bound::AtLeast(x * unit),
            Bound::Below(x) => Bound::Below(x * unit),
            Bound::AtMost(x) => Bound::AtMost(x * unit),
            Bound::Within(a, b) => Bound::Within(a * unit, b * unit),
        }
    }

    /// Whether everything that passes `self` passes `loose`, too.
    pub(crate) fn implies(self, loose: Bound) -> bool {
        use Bound as B;
        match (self, loose) {
            (B::Above(a) | B::AtLeast(a), B::Above(b) | B::AtLeast(b)) => {
                b < a || (b == a && !matches!((self, loose), (B::AtLeast(_), B::Above(_))))
            }
            (B::Below(a) | B::AtMost(a), B::Below(b) | B::AtMost(b)) => {
                b > a || (b == a && !matches!((self, loose), (B::AtMost(_), B::Below(_))))
            }
            (B::Within(a, b), B::Within(c, d)) => c <= a && b <= d,
            _ => false,
        }
    }
}

const EXAMPLES: &str = "a test such as \">= 0.2 hl\", \"< 1.3 hl/s\" or \"0..110 deg\"";

impl FromStr for Test {
    type Err = String;

    fn from_str(text: &str) -> Result<Test, String> {
        let wrong = || format!("expected {EXAMPLES}, found {text:?}");
        let (bound, unit) = text.trim().rsplit_once(' ').ok_or_else(wrong)?;
        let number = |s: &str| s.trim().parse::<f64>().ok().filter(|v| v.is_finite());
        let bound = bound.trim();
        let bound = if let Some(rest) = bound.strip_prefix(">=") {
            number(rest).map(Bound::AtLeast)
        } else if let Some(rest) = bound.strip_prefix('>') {
            number(rest).map(Bound::Above)
        } else if let Some(rest) = bound.strip_prefix("<=") {
            number(rest).map(Bound::AtMost)
        } else if let Some(rest) = bound.strip_prefix('<') {
            number(rest).map(Bound::Below)
        } else {
            let ends = bound.split_once("..");
            ends.and_then(|(a, b)| Some((number(a)?, number(b)?)))
                .filter(|(a, b)| a <= b)
                .map(|(a, b)| Bound::Within(a, b))
        };
        let unit = match unit.strip_suffix("/s") {
            Some(length) => Unit::LengthPerSecond(length.to_owned()),
            None if unit == "deg" => Unit::Degrees,
            None => Unit::Length(unit.to_owned()),
        };
        let bound = bound.ok_or_else(wrong)?;
        Ok(Test { bound, unit })
    }
}

impl TryFrom<String> for Test {
    type Error = String;

    fn try_from(text: String) -> Result<Test, String> {
        text.parse()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(text: &str, bound: Bound, unit: Unit) {
        assert_eq!(text.parse(), Ok(Test { bound, unit }));
    }

    #[test]
    fn tests_are_read() {
        let hl = || Unit::Length("hl".to_owned());
        check(">= 0.2 hl", Bound::AtLeast(0.2), hl());
        check("  > -1 hl ", Bound::Above(-1.0), hl());
        check("<= -0.125 hl", Bound::AtMost(-0.125), hl());
        check("<1.4 hl", Bound::Below(1.4), hl());
        check("70..110 deg", Bound::Within(70.0, 110.0), Unit::Degrees);
        check(
            "> 2 m/s",
            Bound::Above(2.0),
            Unit::LengthPerSecond("m".to_owned()),
        );
    }

    #[test]
    fn nonsense_is_an_error() {
        for text in [
            "",
            "hl",
            "= 3 hl",
            "> x hl",
            "> inf hl",
            "1.. deg",
            "> 3",
            "110..70 deg",
        ] {
            assert!(text.parse::<Test>().is_err(), "{text}");
        }
    }

    #[test]
    fn equality_passes_only_inclusive_tests() {
        assert!(!Bound::Above(1.0).holds(1.0));
        assert!(Bound::AtLeast(1.0).holds(1.0));
        assert!(!Bound::Below(1.0).holds(1.0));
        assert!(Bound::AtMost(1.0).holds(1.0));
        assert!(Bound::Within(1.0, 2.0).holds(1.0) && Bound::Within(1.0, 2.0).holds(2.0));
        for bound in [
            Bound::Above(0.0),
            Bound::AtMost(0.0),
            Bound::Within(0.0, 1.0),
        ] {
            assert!(!bound.holds(f64::NAN));
        }
    }
}
