//! Parts of an answer (RFC 9110, section 14).

use std::ops::Range;

/// What of an answer is wanted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Wanted {
    /// All of it.
    Whole,
    /// These bytes.
    Part(Range<usize>),
    /// Bytes that are not there.
    Nothing,
}

/// Reads a `Range` header for an answer of `n_bytes`. What is no range of bytes is ignored, as the RFC has it; so are
/// several ranges at once, which a server need not give.
pub(super) fn wanted(header: &str, n_bytes: usize) -> Wanted {
    let range = match parse(header) {
        None => return Wanted::Whole,
        Some((Some(first), Some(last))) if last < first => return Wanted::Whole,
        Some((Some(first), last)) => {
            first..last.map_or(n_bytes, |last| last.saturating_add(1).min(n_bytes))
        }
        Some((None, last)) => n_bytes.saturating_sub(last.unwrap_or(0))..n_bytes,
    };
    match range.is_empty() {
        true => Wanted::Nothing,
        false => Wanted::Part(range),
    }
}

/// `bytes=A-B`, `bytes=A-` or `bytes=-B`.
fn parse(header: &str) -> Option<(Option<usize>, Option<usize>)> {
    let (unit, range) = header.split_once('=')?;
    let (start, last) = range.trim().split_once('-')?;
    let is_number = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    if !unit.trim().eq_ignore_ascii_case("bytes") || !is_number(start) || !is_number(last) {
        return None;
    }
    // More than can be counted is as good as the most that can.
    let number = |text: &str| (!text.is_empty()).then(|| text.parse().unwrap_or(usize::MAX));
    let (start, last) = (number(start), number(last));
    (start.is_some() || last.is_some()).then_some((start, last))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(header: &str, n_bytes: usize, expected: Wanted) {
        assert_eq!(wanted(header, n_bytes), expected, "{header} of {n_bytes}");
    }

    #[test]
    fn ranges_are_read_as_the_rfc_has_it() {
        // The examples of RFC 9110, section 14.1.2, for 10000 bytes.
        check("bytes=0-499", 10_000, Wanted::Part(0..500));
        check("bytes=500-999", 10_000, Wanted::Part(500..1000));
        check("bytes=-500", 10_000, Wanted::Part(9500..10_000));
        check("bytes=9500-", 10_000, Wanted::Part(9500..10_000));
    }

    #[test]
    fn ends_are_cut() {
        check("bytes=5-99", 10, Wanted::Part(5..10));
        check("bytes=-99", 10, Wanted::Part(0..10));
        check("bytes=9-9", 10, Wanted::Part(9..10));
        check("bytes=0-18446744073709551615", 10, Wanted::Part(0..10));
        check("bytes=0-99999999999999999999999", 10, Wanted::Part(0..10));
    }

    #[test]
    fn what_is_not_there_is_refused() {
        check("bytes=10-", 10, Wanted::Nothing);
        check("bytes=10-12", 10, Wanted::Nothing);
        check("bytes=99999999999999999999999-", 10, Wanted::Nothing);
        check("bytes=-0", 10, Wanted::Nothing);
        check("bytes=0-", 0, Wanted::Nothing);
    }

    #[test]
    fn what_is_no_range_is_ignored() {
        for header in [
            "",
            "bytes",
            "bytes=",
            "bytes=-",
            "bytes=a-b",
            "bytes=1",
            "bytes=+1-2",
            "items=0-1",
            "bytes=2-1",
            "bytes=0-1,3-4",
            "bytes=0--1",
        ] {
            check(header, 10, Wanted::Whole);
        }
    }
}
