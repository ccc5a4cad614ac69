use ndarray::Array2;

use crate::cursor::{Cursor, Lexed, quote, text};
use crate::error::Oddities;
use crate::{
    Axis, Channel, FrameRate, Joint, LengthUnit, Motion, OffsetFrame, ParseError, ParseErrorKind,
    RateSource, Skeleton, UpAxis, UpSource, Warning, WarningKind, guess_unit,
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

const CHANNELS: &str = "Xposition, Yposition, Zposition, Xrotation, Yrotation and Zrotation";

/// Rates that software writes. A frame time that is one of them to its last printed digit is taken
/// as that rate: 0.008333 means 120 Hz, not 120.0048.
const COMMON_HZ: [f64; 24] = [
    10.0, 12.0, 15.0, 20.0, 24.0, 25.0, 30.0, 48.0, 50.0, 60.0, 72.0, 75.0, 90.0, 100.0, 120.0,
    125.0, 144.0, 150.0, 180.0, 200.0, 240.0, 250.0, 300.0, 480.0,
];

/// Reads a BVH file.
///
/// Lenient where the meaning is clear: white space, line ends, letter case of keywords, bytes that
/// are not UTF-8, several roots, several End Sites, a wrong frame count, numbers without a blank
/// between them, a file cut off within its last row.
///
/// O(bytes).
///
/// # Errors
/// [`ParseError`] with line and column where the file cannot mean anything.
pub fn parse_bvh(bytes: &[u8]) -> Result<Bvh, ParseError> {
    let mut cursor = Cursor::new(bytes);
    let mut oddities = Oddities::default();
    let skeleton = parse_hierarchy(&mut cursor)?;
    if !cursor.take_keyword("MOTION") {
        cursor.skip_space();
        return Err(cursor.expected("ROOT or MOTION"));
    }
    let (count_at, header_frames) = parse_frame_count(&mut cursor)?;
    let rate = parse_frame_time(&mut cursor)?;
    let n_channels = skeleton.n_channels();
    let values = parse_rows(&mut cursor, n_channels, &mut oddities)?;
    // A skeleton without channels has nothing to count frames by.
    let n_frames = values.len().checked_div(n_channels).unwrap_or(0);
    if n_frames as u64 != header_frames {
        let (header, found) = (header_frames, n_frames);
        oddities.push(count_at, WarningKind::FrameCount { header, found });
    }
    let channels =
        Array2::from_shape_vec((n_frames, n_channels), values).expect("only whole rows were kept");
    let (unit, unit_source) = guess_unit(&skeleton);
    let motion = Motion {
        skeleton,
        channels,
        rate,
        rate_source: RateSource::File,
        unit,
        unit_source,
        up: UpAxis::Y,
        up_source: UpSource::Default,
    };
    let warnings = oddities.into_warnings(bytes);
    Ok(Bvh { motion, warnings })
}

/// The joints read so far.
#[derive(Default)]
struct Hierarchy {
    joints: Vec<Joint>,
    /// Per joint.
    n_end_sites: Vec<usize>,
}

impl Hierarchy {
    fn push(&mut self, joint: Joint) -> usize {
        self.joints.push(joint);
        self.n_end_sites.push(0);
        self.joints.len() - 1
    }
}

fn parse_hierarchy(cursor: &mut Cursor<'_>) -> Result<Skeleton, ParseError> {
    if !cursor.take_keyword("HIERARCHY") {
        cursor.skip_space();
        return Err(cursor.expected("HIERARCHY"));
    }
    let start = cursor.byte();
    let mut tree = Hierarchy::default();
    while cursor.take_keyword("ROOT") {
        parse_tree(cursor, &mut tree)?;
    }
    if tree.joints.is_empty() {
        cursor.skip_space();
        return Err(cursor.expected("ROOT"));
    }
    Skeleton::new(tree.joints, OffsetFrame::Parent).map_err(|_| {
        // Every number was checked and every parent was open when its child was read.
        cursor.error_at(start, ParseErrorKind::Missing { what: "hierarchy" })
    })
}

/// Reads one tree from behind its ROOT keyword. An explicit stack keeps deep files from exhausting
/// the call stack.
fn parse_tree(cursor: &mut Cursor<'_>, tree: &mut Hierarchy) -> Result<(), ParseError> {
    let mut open = vec![open_joint(cursor, tree, None)?];
    while let Some(&current) = open.last() {
        if cursor.take_byte(b'}') {
            open.pop();
        } else if cursor.take_keyword("JOINT") {
            open.push(open_joint(cursor, tree, Some(current))?);
        } else if cursor.take_keyword("End") {
            if !cursor.take_keyword("Site") {
                cursor.skip_space();
                return Err(cursor.expected("Site"));
            }
            open_end_site(cursor, tree, current)?;
        } else if cursor.take_keyword("OFFSET") {
            tree.joints[current].offset = parse_offset(cursor)?;
        } else if cursor.take_keyword("CHANNELS") {
            tree.joints[current].channels = parse_channels(cursor)?;
        } else {
            cursor.skip_space();
            return Err(cursor.expected("OFFSET, CHANNELS, JOINT, End Site or }"));
        }
    }
    Ok(())
}

fn open_joint(
    cursor: &mut Cursor<'_>,
    tree: &mut Hierarchy,
    parent: Option<usize>,
) -> Result<usize, ParseError> {
    let name = text(cursor.line_text(Some(b'{')));
    if name.is_empty() {
        return Err(cursor.expected("a joint name"));
    }
    take_brace(cursor)?;
    Ok(tree.push(Joint {
        name,
        parent,
        offset: [0.0; 3],
        channels: Vec::new(),
        axis: None,
        end_site: false,
    }))
}

fn open_end_site(
    cursor: &mut Cursor<'_>,
    tree: &mut Hierarchy,
    parent: usize,
) -> Result<(), ParseError> {
    // Some exporters write a name behind the keyword.
    cursor.line_text(Some(b'{'));
    take_brace(cursor)?;
    let mut offset = [0.0; 3];
    while !cursor.take_byte(b'}') {
        if cursor.take_keyword("OFFSET") {
            offset = parse_offset(cursor)?;
        } else if cursor.take_keyword("CHANNELS") {
            cursor.skip_space();
            let at = cursor.byte();
            if !parse_channels(cursor)?.is_empty() {
                return Err(cursor.error_at(
                    at,
                    ParseErrorKind::OutOfRange {
                        what: "the number of channels of an End Site",
                        limit: "0",
                        found: "more".to_owned(),
                    },
                ));
            }
        } else {
            cursor.skip_space();
            return Err(cursor.expected("OFFSET or }"));
        }
    }
    tree.n_end_sites[parent] += 1;
    let number = match tree.n_end_sites[parent] {
        1 => String::new(),
        n => n.to_string(),
    };
    let name = format!("{}_End{number}", tree.joints[parent].name);
    tree.push(Joint {
        name,
        parent: Some(parent),
        offset,
        channels: Vec::new(),
        axis: None,
        end_site: true,
    });
    Ok(())
}

fn take_brace(cursor: &mut Cursor<'_>) -> Result<(), ParseError> {
    cursor.skip_space();
    if cursor.peek() != Some(b'{') {
        return Err(cursor.expected("{"));
    }
    cursor.advance(1);
    Ok(())
}

fn parse_offset(cursor: &mut Cursor<'_>) -> Result<[f64; 3], ParseError> {
    let mut offset = [0.0; 3];
    for value in &mut offset {
        *value = cursor.required_number()?;
    }
    Ok(offset)
}

fn parse_channels(cursor: &mut Cursor<'_>) -> Result<Vec<Channel>, ParseError> {
    cursor.skip_space();
    let at = cursor.byte();
    let count = cursor.required_number()?;
    if count.fract() != 0.0 || !(0.0..=6.0).contains(&count) {
        return Err(cursor.error_at(
            at,
            ParseErrorKind::OutOfRange {
                what: "the number of channels",
                limit: "a whole number from 0 to 6",
                found: count.to_string(),
            },
        ));
    }
    let mut channels = Vec::new();
    while channels.len() < count as usize {
        cursor.skip_space();
        let at = cursor.byte();
        if cursor.at_end() {
            return Err(cursor.expected("a channel"));
        }
        let word = cursor.word();
        let channel = channel_from_word(word).ok_or_else(|| {
            let kind = ParseErrorKind::UnknownKeyword {
                what: "channel",
                found: text(word),
                known: CHANNELS,
            };
            cursor.error_at(at, kind)
        })?;
        if channels.contains(&channel) {
            let kind = ParseErrorKind::Twice {
                what: "channel",
                name: channel.to_string(),
            };
            return Err(cursor.error_at(at, kind));
        }
        channels.push(channel);
    }
    Ok(channels)
}

fn channel_from_word(word: &[u8]) -> Option<Channel> {
    let axis = match word.first()?.to_ascii_uppercase() {
        b'X' => Axis::X,
        b'Y' => Axis::Y,
        b'Z' => Axis::Z,
        _ => return None,
    };
    let kind = &word[1..];
    if kind.eq_ignore_ascii_case(b"position") {
        Some(Channel::Translation(axis))
    } else if kind.eq_ignore_ascii_case(b"rotation") {
        Some(Channel::Rotation(axis))
    } else {
        None
    }
}

/// `Frames: 343`, with any white space or none around the colon. Gives the place and the number.
fn parse_frame_count(cursor: &mut Cursor<'_>) -> Result<(usize, u64), ParseError> {
    take_label(cursor, &["Frames"], "Frames:")?;
    cursor.skip_space();
    let at = cursor.byte();
    let count = cursor.required_number()?;
    if count.fract() != 0.0 || !(0.0..=9e15).contains(&count) {
        return Err(cursor.error_at(
            at,
            ParseErrorKind::OutOfRange {
                what: "the number of frames",
                limit: "a whole number, not negative",
                found: count.to_string(),
            },
        ));
    }
    Ok((at, count as u64))
}

fn parse_frame_time(cursor: &mut Cursor<'_>) -> Result<FrameRate, ParseError> {
    take_label(cursor, &["Frame", "Time"], "Frame Time:")?;
    cursor.skip_blanks();
    let at = cursor.byte();
    let seconds = cursor.required_number()?;
    let written = cursor.text_between(at, cursor.byte());
    rate_from_frame_time(seconds, written).ok_or_else(|| {
        let found = quote(written);
        cursor.error_at(at, ParseErrorKind::FrameTime { found })
    })
}

/// The rate of a frame time as `written`: a whole number if its frame time is exactly this, one of
/// [`COMMON_HZ`] if its frame time rounds to what is written, else the reciprocal.
pub(super) fn rate_from_frame_time(seconds: f64, written: &[u8]) -> Option<FrameRate> {
    let rate = FrameRate::from_frame_time(seconds)?;
    let whole = rate.hz().round();
    if whole.recip() == seconds {
        // Nothing was lost: 0.002 is 500 Hz, not 480 Hz cut off after three decimals.
        return FrameRate::from_hz(whole);
    }
    let mut n_decimals = 0;
    let mut in_fraction = false;
    for &b in written {
        match b {
            b'.' => in_fraction = true,
            b'0'..=b'9' if in_fraction => n_decimals += 1,
            b'e' | b'E' => return Some(rate),
            _ => {}
        }
    }
    // Exporters round, or cut the digits off.
    let last_digit = 10f64.powi(-n_decimals);
    let lost = |hz: f64| hz.recip() - seconds;
    COMMON_HZ
        .into_iter()
        .filter(|&hz| (-0.5 * last_digit..last_digit).contains(&lost(hz)))
        .filter(|&hz| lost(hz).abs() < 0.1 * seconds)
        .min_by(|&a, &b| lost(a).abs().total_cmp(&lost(b).abs()))
        .and_then(FrameRate::from_hz)
        .or(Some(rate))
}

/// Takes words and a colon, with or without white space before the colon.
fn take_label(
    cursor: &mut Cursor<'_>,
    words: &[&str],
    expected: &'static str,
) -> Result<(), ParseError> {
    cursor.skip_space();
    let start = cursor.clone();
    for word in words {
        cursor.skip_blanks();
        let matches = cursor
            .rest()
            .get(..word.len())
            .is_some_and(|w| w.eq_ignore_ascii_case(word.as_bytes()));
        if !matches {
            return Err(start.expected(expected));
        }
        cursor.advance(word.len());
    }
    cursor.skip_blanks();
    if cursor.peek() == Some(b':') {
        cursor.advance(1);
        return Ok(());
    }
    Err(start.expected(expected))
}

/// Reads all rows: one frame a line. Only whole rows are kept.
fn parse_rows(
    cursor: &mut Cursor<'_>,
    n_channels: usize,
    oddities: &mut Oddities,
) -> Result<Vec<f64>, ParseError> {
    // Six bytes are about the shortest a real value takes; a guess that only saves copying.
    let mut values = Vec::with_capacity(cursor.rest().len() / 6);
    let mut n_frames = 0;
    let mut glued = false;
    loop {
        cursor.skip_space();
        if cursor.at_end() {
            return Ok(values);
        }
        let row_at = cursor.byte();
        let row_start = values.len();
        let mut cut = false;
        loop {
            let before = cursor.byte();
            let touches = values.len() > row_start && !cursor.at_white_space();
            match cursor.lex_number() {
                Lexed::Number(value) => values.push(value),
                Lexed::LineEnd => break,
                Lexed::Wrong => {
                    cut = values.len() - row_start < n_channels && cursor.at_cut_number();
                    if cut {
                        break;
                    }
                    return Err(cursor.number_error());
                }
            }
            if touches && !glued {
                glued = true;
                oddities.push(before, WarningKind::GluedNumbers);
            }
        }
        let found = values.len() - row_start;
        n_frames += 1;
        if found == n_channels {
            continue;
        }
        let mut ahead = cursor.clone();
        ahead.skip_space();
        if found < n_channels && (cut || ahead.at_end()) {
            values.truncate(row_start);
            let expected = n_channels;
            oddities.push(row_at, WarningKind::TruncatedRow { expected, found });
            return Ok(values);
        }
        return Err(cursor.error_at(
            row_at,
            ParseErrorKind::ValueCount {
                what: format!("frame {n_frames}"),
                expected: n_channels,
                found,
            },
        ));
    }
}

#[cfg(test)]
mod tests;
