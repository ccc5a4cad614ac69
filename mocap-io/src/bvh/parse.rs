use ndarray::Array2;

use super::hierarchy::{Column, Hierarchy, parse_hierarchy};
use super::rate::{DEFAULT_HZ, PLAUSIBLE_SECONDS, rate_from_frame_time};
use super::repair::without_commas;
use super::rows::parse_rows;
use crate::cursor::{Cursor, Lexed, is_newline, quote};
use crate::warning::Oddities;
use crate::{
    FrameRate, LengthUnit, Motion, ParseError, RateSource, UpAxis, UpSource, Warning, WarningKind,
    guess_unit,
};

/// A BVH file.
#[derive(Clone, Debug, PartialEq)]
pub struct Bvh {
    /// Skeleton and motion. The unit is guessed with [`guess_unit`].
    pub motion: Motion,
    /// What was odd, in file order.
    pub warnings: Vec<Warning>,
}

impl Bvh {
    /// The same with the unit said by the caller.
    #[must_use]
    pub fn with_unit(mut self, unit: LengthUnit) -> Self {
        self.motion.unit = unit;
        self.motion.unit_source = crate::UnitSource::Given;
        self
    }
}

/// Reads a BVH file.
///
/// Lenient where the meaning is clear: white space, line ends, letter case of keywords, bytes that
/// are not UTF-8, several roots, several End Sites. Where it could be meant otherwise, too, but one
/// meaning is by far the likeliest, it is read with a [`Warning`]; the README of this crate lists them.
///
/// Where the file gives no frame time from 0.1 ms to 1 s, the rate is 30 Hz and its source is
/// [`RateSource::Default`].
///
/// O(bytes), in time and in memory.
///
/// # Errors
/// [`ParseError`] with line and column where the file cannot mean anything, or could mean several
/// things: NaN and infinities, rows with too many or too few values, unknown or repeated channels.
pub fn parse_bvh(bytes: &[u8]) -> Result<Bvh, ParseError> {
    Cursor::new(bytes).check_encoding()?;
    let error = match parse_text(bytes, Oddities::default()) {
        Ok(bvh) => return Ok(bvh),
        Err(error) => error,
    };
    // Commas and no-break spaces stand in names as well; only where a file makes no sense otherwise
    // are they taken for something else.
    let Some((repaired, oddities)) = without_commas(bytes) else {
        return Err(error);
    };
    // The one that comes further has understood more.
    parse_text(&repaired, oddities).map_err(|e| if e.at >= error.at { e } else { error })
}

fn parse_text(bytes: &[u8], mut oddities: Oddities) -> Result<Bvh, ParseError> {
    let mut cursor = Cursor::new(bytes);
    let tree = parse_hierarchy(&mut cursor, &mut oddities)?;
    let header = parse_motion_header(&mut cursor, &mut oddities)?;
    let n_columns = tree.columns().count();
    let header_frames = header.frames.map(|(_, n)| n);
    let mut values = parse_rows(&mut cursor, n_columns, header_frames, &mut oddities)?;
    // A skeleton without channels has nothing to count frames by.
    let found = values.len().checked_div(n_columns).unwrap_or(0);
    if let Some((at, header)) = header.frames.filter(|&(_, n)| n != found as u64) {
        oddities.push(at, WarningKind::FrameCount { header, found });
    }
    drop_scales(&tree, &mut values);
    let skeleton = tree.into_skeleton(&cursor)?;
    let n_channels = skeleton.n_channels();
    let n_frames = values.len().checked_div(n_channels).unwrap_or(0);
    let channels =
        Array2::from_shape_vec((n_frames, n_channels), values).expect("only whole rows were kept");
    let (unit, unit_source) = guess_unit(&skeleton);
    let motion = Motion {
        skeleton,
        channels,
        rate: header.rate,
        rate_source: header.rate_source,
        unit,
        unit_source,
        up: UpAxis::Y,
        up_source: UpSource::Default,
    };
    let warnings = oddities.into_warnings(bytes);
    Ok(Bvh { motion, warnings })
}

/// Leaves only the columns that a skeleton can hold.
fn drop_scales(tree: &Hierarchy, values: &mut Vec<f64>) {
    let is_kept: Vec<bool> = tree
        .columns()
        .map(|column| column != Column::Scale)
        .collect();
    if is_kept.iter().all(|&kept| kept) {
        return;
    }
    let mut is_kept = is_kept.into_iter().cycle();
    values.retain(|_| is_kept.next() == Some(true));
}

/// What stands between MOTION and the rows.
struct MotionHeader {
    /// Place and number.
    frames: Option<(usize, u64)>,
    rate: FrameRate,
    rate_source: RateSource,
}

/// Reads lines until one is no header line.
fn parse_motion_header(
    cursor: &mut Cursor<'_>,
    oddities: &mut Oddities,
) -> Result<MotionHeader, ParseError> {
    let mut header = MotionHeader {
        frames: None,
        rate: FrameRate::from_hz(DEFAULT_HZ).expect("30 is a rate"),
        rate_source: RateSource::Default,
    };
    let (mut n_counts, mut n_times) = (0, 0);
    skip_comments(cursor, oddities);
    if cursor.at_end() {
        oddities.push(cursor.byte(), WarningKind::NoMotion);
        return Ok(header);
    }
    let at = cursor.byte();
    if cursor
        .peek_keyword()
        .eq_ignore_ascii_case(MOTION.as_bytes())
    {
        cursor.advance(MOTION.len());
    } else if at_label(cursor, &["Frames"]) || at_label(cursor, &["Frame", "Time"]) {
        let keyword = MOTION;
        oddities.push(at, WarningKind::MissingKeyword { keyword });
    } else {
        return Err(cursor.expected("ROOT or MOTION"));
    }
    loop {
        skip_comments(cursor, oddities);
        let at = cursor.byte();
        let repeated = |keyword| WarningKind::Repeated {
            keyword,
            resolution: "the last one counts",
        };
        if take_label(cursor, &["Frames"]) {
            n_counts += 1;
            if n_counts > 1 {
                oddities.push_once(at, repeated("Frames"));
            }
            header.frames = parse_frame_count(cursor, oddities);
        } else if take_label(cursor, &["Frame", "Time"]) {
            n_times += 1;
            if n_times > 1 {
                oddities.push_once(at, repeated("Frame Time"));
            }
            let rate = parse_frame_time(cursor, at, oddities)?;
            header.rate_source = rate.map_or(RateSource::Default, |_| RateSource::File);
            header.rate = rate.unwrap_or(header.rate);
        } else if at_other_label(cursor) {
            skip_line(cursor, oddities);
        } else {
            break;
        }
    }
    if n_counts == 0 {
        oddities.push(cursor.byte(), WarningKind::NoFrameCount);
    }
    if n_times == 0 {
        let hz = DEFAULT_HZ;
        oddities.push(cursor.byte(), WarningKind::NoFrameTime { hz });
    }
    Ok(header)
}

const MOTION: &str = "MOTION";

/// Skips white space and comments.
pub(super) fn skip_comments(cursor: &mut Cursor<'_>, oddities: &mut Oddities) {
    loop {
        cursor.skip_space();
        if !at_comment(cursor) {
            return;
        }
        oddities.push_once(cursor.byte(), WarningKind::Comment);
        cursor.next_line();
    }
}

pub(super) fn at_comment(cursor: &Cursor<'_>) -> bool {
    cursor.rest().starts_with(b"#") || cursor.rest().starts_with(b"//")
}

/// Skips the rest of the line, which is not blank.
pub(super) fn skip_line(cursor: &mut Cursor<'_>, oddities: &mut Oddities) {
    let at = cursor.byte();
    let found = quote(cursor.line_text(None));
    oddities.push_once(at, WarningKind::SkippedText { found });
}

/// `343` of `Frames: 343`, with its place, if it is a number of frames.
fn parse_frame_count(cursor: &mut Cursor<'_>, oddities: &mut Oddities) -> Option<(usize, u64)> {
    /// Above, not every whole number is a double.
    const MAX: f64 = 9e15;
    cursor.skip_blanks();
    let at = cursor.byte();
    let frames = match cursor.lex_number() {
        Lexed::Number(n) if n.fract() == 0.0 && (0.0..=MAX).contains(&n) => Some((at, n as u64)),
        Lexed::Number(_) | Lexed::LineEnd => None,
        Lexed::Wrong => {
            cursor.line_text(None);
            None
        }
    };
    if frames.is_none() {
        oddities.push_once(at, WarningKind::NoFrameCount);
    }
    skip_remark(cursor, oddities);
    frames
}

/// The rate, if there is a frame time that can be meant; `at` is where the line begins.
fn parse_frame_time(
    cursor: &mut Cursor<'_>,
    label_at: usize,
    oddities: &mut Oddities,
) -> Result<Option<FrameRate>, ParseError> {
    cursor.skip_blanks();
    let hz = DEFAULT_HZ;
    let at = cursor.byte();
    let seconds = match cursor.lex_number() {
        Lexed::Number(seconds) => seconds,
        Lexed::LineEnd => {
            oddities.push(label_at, WarningKind::NoFrameTime { hz });
            return Ok(None);
        }
        Lexed::Wrong => return Err(cursor.number_error()),
    };
    let written = cursor.text_between(at, cursor.byte());
    let rate = rate_from_frame_time(seconds, written).filter(|_| {
        // Compared with what is written: 10 kHz and 1 Hz are still meant.
        PLAUSIBLE_SECONDS.contains(&seconds)
    });
    if rate.is_none() {
        let found = quote(written);
        oddities.push(at, WarningKind::FrameTime { found, hz });
    }
    skip_remark(cursor, oddities);
    Ok(rate)
}

/// Skips a unit or a remark behind a number, such as `s` or `(30 fps)`.
fn skip_remark(cursor: &mut Cursor<'_>, oddities: &mut Oddities) {
    cursor.skip_blanks();
    let is_remark = |b: u8| b.is_ascii_alphabetic() || matches!(b, b'(' | b'[');
    let is_label = at_label(cursor, &["Frame", "Time"]) || at_label(cursor, &["Frames"]);
    if cursor.peek().is_some_and(is_remark) && !is_label && !cursor.at_not_finite() {
        skip_line(cursor, oddities);
    }
}

/// Whether the line is `Some label: …`.
fn at_other_label(cursor: &Cursor<'_>) -> bool {
    let mut line = cursor.rest().iter().take_while(|&&b| !is_newline(b));
    cursor.peek().is_some_and(|b| b.is_ascii_alphabetic()) && line.any(|&b| b == b':')
}

/// Whether the words with a colon come next.
fn at_label(cursor: &Cursor<'_>, words: &[&str]) -> bool {
    let mut ahead = cursor.clone();
    let end = take_label(&mut ahead, words).then(|| ahead.byte());
    end.is_some_and(|end| cursor.text_between(end - 1, end) == b":")
}

/// Takes words, with any blanks or none between them, and a colon or a blank.
fn take_label(cursor: &mut Cursor<'_>, words: &[&str]) -> bool {
    let mut ahead = cursor.clone();
    for word in words {
        ahead.skip_blanks();
        let next = ahead.rest().get(..word.len());
        if !next.is_some_and(|w| w.eq_ignore_ascii_case(word.as_bytes())) {
            return false;
        }
        ahead.advance(word.len());
    }
    let is_end = ahead.at_white_space();
    ahead.skip_blanks();
    let has_colon = ahead.peek() == Some(b':');
    if has_colon {
        ahead.advance(1);
    }
    if has_colon || is_end {
        *cursor = ahead;
    }
    has_colon || is_end
}

#[cfg(test)]
mod tests;
