use crate::WarningKind;
use crate::cursor::{is_newline, is_space};
use crate::warning::Oddities;

/// A copy of the same length with commas in and between numbers, and no-break spaces, replaced by what
/// they most likely mean; `None` if there are none. Lines with names stay as they are.
///
/// Programs that print numbers the way their user's country writes them put commas where points
/// belong (`1,5 2,5`); spreadsheets put them between numbers (`1.5,2.5` or `1, 2`). A file that has
/// points in numbers as well uses its commas the second way.
pub(super) fn without_commas(bytes: &[u8]) -> Option<(Vec<u8>, Oddities)> {
    if !bytes.contains(&b',') && !bytes.contains(&NO_BREAK) {
        return None;
    }
    let is_digit = |at: usize| bytes.get(at).is_some_and(u8::is_ascii_digit);
    let follows_digit = |at: usize| at > 0 && is_digit(at - 1);
    let is_point = |at| bytes[at] == b'.' && (is_digit(at + 1) || follows_digit(at));
    let is_tight = |at| bytes[at] == b',' && is_digit(at + 1) && follows_digit(at);
    let has_points = number_places(bytes).any(is_point);
    let is_decimal = !has_points && number_places(bytes).any(is_tight);
    let meaning = if is_decimal {
        "decimal points"
    } else {
        "blanks between numbers"
    };
    let mut oddities = Oddities::default();
    let mut text = bytes.to_vec();
    for at in number_places(bytes) {
        match bytes[at] {
            b',' => {
                oddities.push_once(at, WarningKind::Commas { meaning });
                text[at] = if is_decimal && is_tight(at) {
                    b'.'
                } else {
                    b' '
                };
            }
            NO_BREAK => {
                oddities.push_once(at, WarningKind::NoBreakSpaces);
                text[at] = b' ';
                if at > 0 && bytes[at - 1] == UTF8_LEAD {
                    text[at - 1] = b' ';
                }
            }
            _ => {}
        }
    }
    Some((text, oddities))
}

/// The places of all bytes on lines without names.
fn number_places(bytes: &[u8]) -> impl Iterator<Item = usize> {
    let lines = bytes.split_inclusive(|&b| is_newline(b));
    let ends = lines.scan(0, |at, line| {
        *at += line.len();
        Some((line, *at))
    });
    let of_numbers = ends.filter(|(line, _)| !has_name(line));
    of_numbers.flat_map(|(line, end)| end - line.len()..end)
}

/// A no-break space in Latin-1, and the second of its two bytes in UTF-8.
const NO_BREAK: u8 = 0xa0;
/// The first of its two bytes in UTF-8.
const UTF8_LEAD: u8 = 0xc2;

/// Whether the line begins with ROOT, JOINT or End.
fn has_name(line: &[u8]) -> bool {
    let start = line.iter().position(|&b| !is_space(b)).unwrap_or(0);
    let word = line[start..].split(|&b| is_space(b)).next();
    let word = word.unwrap_or_default();
    ["ROOT", "JOINT", "End"]
        .iter()
        .any(|keyword| word.eq_ignore_ascii_case(keyword.as_bytes()))
}
