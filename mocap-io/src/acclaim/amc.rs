use std::ops::Range;

use ndarray::Array2;

use super::asf::{AngleUnit, Asf, nearest};
use super::names::Names;
use crate::cursor::{Cursor, Lexed, is_newline, is_space, quote, skip_blanks, text};
use crate::error::Oddities;
use crate::{
    Channel, FrameRate, Motion, ParseError, ParseErrorKind, RateSource, UnitSource, UpAxis,
    UpSource, Warning, WarningKind, number,
};

/// The rate of Acclaim motions, which the format cannot name: both public libraries, CMU and
/// HDM05, were recorded or distributed at 120 Hz (spec.md f).
pub(super) const DEFAULT_HZ: f64 = 120.0;

/// An AMC file.
#[derive(Clone, Debug, PartialEq)]
pub struct Amc {
    /// Motion of the given skeleton, at 120 Hz unless the caller knows better.
    pub motion: Motion,
    /// The number of the first frame in the file, usually 1. Frame `i` of the motion is the `i`-th
    /// whole frame of the file, whatever the numbers say.
    pub first_frame_number: Option<u64>,
    /// What was odd, in file order.
    pub warnings: Vec<Warning>,
}

/// Reads an AMC file that belongs to the skeleton `asf`.
///
/// The rate is 120 Hz unless a line `:SAMPLES-PER-SECOND` says otherwise. Bones may come in any
/// order within a frame. A bone that no frame moves keeps its rest pose, with a warning. If the file
/// ends within a frame, that frame is dropped, with a warning.
///
/// O(bytes) in time. Rows are dense: a motion takes eight bytes per frame and channel of its skeleton,
/// even if the file moves a single bone. Where that comes to more than 8 MiB and six times the
/// file, the file is refused.
///
/// # Errors
/// [`ParseError`] with line and column: an unknown bone, a wrong number of values, a frame in the
/// middle of the file that leaves a bone out.
pub fn parse_amc(bytes: &[u8], asf: &Asf) -> Result<Amc, ParseError> {
    Cursor::new(bytes).check_encoding()?;
    let mut reader = Reader::new(bytes, asf);
    reader.parse_header()?;
    reader.parse_frames()?;
    Ok(reader.finish())
}

/// Values that a file of `n_bytes` may become: as many as fit into what [`parse_amc`] promises.
fn max_values(n_bytes: usize) -> usize {
    const SPARE_BYTES: usize = 8 << 20;
    const BYTES_PER_BYTE: usize = 6;
    (SPARE_BYTES + BYTES_PER_BYTE * n_bytes) / size_of::<f64>()
}

/// Where the values of one bone go.
struct BoneSlot {
    first_channel: usize,
    is_rotation: Vec<bool>,
    last_frame: Option<usize>,
}

struct Reader<'a> {
    cursor: Cursor<'a>,
    asf: &'a Asf,
    angle_unit: AngleUnit,
    /// Per joint.
    slots: Vec<BoneSlot>,
    names: Names,
    /// The bones in the order of the first frame, which the next frames almost always repeat, with
    /// their names as written there.
    usual_order: Vec<(usize, &'a [u8])>,
    /// Where the frames begin.
    start: usize,
    values: Vec<f64>,
    n_frames: usize,
    rate: (FrameRate, RateSource),
    first_frame_number: Option<u64>,
    oddities: Oddities,
}

/// Why a frame could not be read to its end.
enum FrameEnd {
    Whole,
    /// The file ends within the frame.
    Cut,
}

impl<'a> Reader<'a> {
    fn new(bytes: &'a [u8], asf: &'a Asf) -> Self {
        let skeleton = &asf.skeleton;
        let slots: Vec<BoneSlot> = skeleton
            .joints()
            .iter()
            .scan(0, |first_channel, joint| {
                let slot = BoneSlot {
                    first_channel: *first_channel,
                    is_rotation: joint
                        .channels
                        .iter()
                        .map(|c| matches!(c, Channel::Rotation(_)))
                        .collect(),
                    last_frame: None,
                };
                *first_channel += joint.channels.len();
                Some(slot)
            })
            .collect();
        Reader {
            cursor: Cursor::new(bytes),
            asf,
            angle_unit: asf.angle_unit,
            slots,
            names: Names::new(skeleton.names()),
            usual_order: Vec::new(),
            start: 0,
            values: Vec::new(),
            n_frames: 0,
            rate: (
                FrameRate::from_hz(DEFAULT_HZ).expect("120 is a rate"),
                RateSource::Default,
            ),
            first_frame_number: None,
            oddities: Oddities::default(),
        }
    }

    /// Comments and keywords up to the first frame.
    fn parse_header(&mut self) -> Result<(), ParseError> {
        loop {
            self.skip_to_content();
            if self.cursor.peek() != Some(b':') {
                return Ok(());
            }
            let at = self.cursor.byte();
            let word = self.cursor.word().to_ascii_lowercase();
            match word.as_slice() {
                b":degrees" => self.set_angle_unit(at, AngleUnit::Degrees),
                b":radians" => self.set_angle_unit(at, AngleUnit::Radians),
                b":fully-specified" => {}
                b":samples-per-second" => self.parse_rate()?,
                _ => {
                    let name = text(&word);
                    self.oddities
                        .push(at, WarningKind::UnknownAmcKeyword { name });
                }
            }
            self.cursor.next_line();
        }
    }

    fn parse_rate(&mut self) -> Result<(), ParseError> {
        self.cursor.skip_blanks();
        let at = self.cursor.byte();
        let hz = self.cursor.required_number()?;
        let Some(rate) = FrameRate::from_hz(hz) else {
            let kind = ParseErrorKind::OutOfRange {
                what: "the rate",
                limit: "positive and finite",
                found: hz.to_string(),
            };
            return Err(self.cursor.error_at(at, kind));
        };
        self.rate = (rate, RateSource::File);
        Ok(())
    }

    fn set_angle_unit(&mut self, at: usize, unit: AngleUnit) {
        if unit != self.asf.angle_unit {
            let kind = WarningKind::AngleUnit {
                skeleton: self.asf.angle_unit.name(),
                motion: unit.name(),
            };
            self.oddities.push(at, kind);
        }
        self.angle_unit = unit;
    }

    fn skip_to_content(&mut self) {
        loop {
            self.cursor.skip_space();
            if self.cursor.peek() != Some(b'#') {
                return;
            }
            self.cursor.next_line();
        }
    }

    fn parse_frames(&mut self) -> Result<(), ParseError> {
        let n_channels = self.asf.skeleton.n_channels();
        let max_values = max_values(self.cursor.whole().len());
        self.start = self.cursor.byte();
        let mut last_number = None;
        loop {
            self.skip_to_content();
            if self.cursor.at_end() {
                return Ok(());
            }
            let at = self.cursor.byte();
            let number = self.frame_number()?;
            let expected = last_number.map(|n: u64| n.saturating_add(1));
            if let Some(expected) = expected.filter(|&e| e != number) {
                let found = number;
                self.oddities
                    .push_once(at, WarningKind::FrameNumber { expected, found });
            }
            self.first_frame_number = self.first_frame_number.or(Some(number));
            last_number = Some(number);
            let frame_start = self.values.len();
            if frame_start + n_channels > max_values {
                let kind = ParseErrorKind::TooSparse {
                    n_frames: self.n_frames + 1,
                    n_channels,
                    n_bytes: self.cursor.whole().len(),
                };
                return Err(self.cursor.error_at(at, kind));
            }
            let (n_read, n_rest) = (at - self.start, self.cursor.rest().len());
            number::reserve(&mut self.values, n_channels, n_read, n_rest, max_values);
            self.values.resize(frame_start + n_channels, 0.0);
            if self.read_usual_frame(frame_start) {
                self.n_frames += 1;
                continue;
            }
            self.values[frame_start..].fill(0.0);
            match self.parse_frame(number, frame_start)? {
                FrameEnd::Whole => self.n_frames += 1,
                FrameEnd::Cut => {
                    self.values.truncate(frame_start);
                    let (frame, kept) = (number, self.n_frames);
                    self.oddities
                        .push(at, WarningKind::TruncatedFrame { frame, kept });
                    return Ok(());
                }
            }
        }
    }

    /// Reads a frame that has the bones of the first frame in the same order, one a line, and nothing
    /// else. Otherwise stays where it was and says `false`.
    fn read_usual_frame(&mut self, frame_start: usize) -> bool {
        if self.n_frames == 0 {
            return false;
        }
        let text = self.cursor.whole();
        let in_radians = self.angle_unit == AngleUnit::Radians;
        let row = &mut self.values[frame_start..];
        let mut pos = self.cursor.byte();
        for &(slot_idx, name) in &self.usual_order {
            let slot = &self.slots[slot_idx];
            let next = read_usual_line(text, pos, name, &mut row[slot.channels()]);
            let Some(end) = next else { return false };
            pos = end;
            if in_radians && !turn_to_degrees(&mut row[slot.channels()], &slot.is_rotation) {
                return false;
            }
        }
        let start = self.cursor.clone();
        self.cursor.seek(pos);
        self.skip_to_content();
        if self.cursor.at_end() || self.at_frame_number() {
            return true;
        }
        self.cursor = start;
        false
    }

    fn frame_number(&mut self) -> Result<u64, ParseError> {
        let start = self.cursor.clone();
        let word = self.cursor.word();
        let number = std::str::from_utf8(word).ok().and_then(|w| w.parse().ok());
        number
            .filter(|_| at_content_end(&self.cursor))
            .ok_or_else(|| start.expected("a frame number"))
    }

    /// Whether the line is a whole number alone, and not a bone whose name begins with a digit.
    fn at_frame_number(&self) -> bool {
        let mut ahead = self.cursor.clone();
        ahead.word().iter().all(u8::is_ascii_digit) && at_content_end(&ahead)
    }

    /// Reads bone lines up to the next frame number or the end of the file.
    fn parse_frame(&mut self, number: u64, frame_start: usize) -> Result<FrameEnd, ParseError> {
        let mut n_read = 0;
        loop {
            self.skip_to_content();
            match self.cursor.peek() {
                None => break,
                Some(b) if b.is_ascii_digit() && self.at_frame_number() => break,
                Some(_) => {}
            }
            let at = self.cursor.byte();
            let name = self.cursor.word();
            let Some(slot_idx) = self.slot(name, n_read, at) else {
                if self.cursor.at_end() {
                    return Ok(FrameEnd::Cut);
                }
                let kind = ParseErrorKind::UnknownBone {
                    name: text(name),
                    nearest: nearest(&text(name), self.asf.skeleton.names()),
                };
                return Err(self.cursor.error_at(at, kind));
            };
            let last_frame = self.slots[slot_idx].last_frame;
            let is_newcomer = last_frame.is_none() && self.n_frames > 0;
            if (is_newcomer || last_frame == Some(self.n_frames)) && self.cursor.at_end() {
                // What is left of another name may be a name as well.
                return Ok(FrameEnd::Cut);
            }
            if is_newcomer {
                let kind = ParseErrorKind::Expected {
                    expected: "a bone that the first frame has",
                    found: quote(name),
                };
                return Err(self.cursor.error_at(at, kind));
            }
            if last_frame == Some(self.n_frames) {
                let (what, name) = ("bone", text(name));
                return Err(self
                    .cursor
                    .error_at(at, ParseErrorKind::Twice { what, name }));
            }
            if let FrameEnd::Cut = self.parse_values(slot_idx, frame_start, at)? {
                return Ok(FrameEnd::Cut);
            }
            self.slots[slot_idx].last_frame = Some(self.n_frames);
            if self.n_frames == 0 {
                self.usual_order.push((slot_idx, name));
            }
            n_read += 1;
        }
        if n_read == self.usual_order.len() && n_read > 0 {
            return Ok(FrameEnd::Whole);
        }
        if self.cursor.at_end() {
            return Ok(FrameEnd::Cut);
        }
        if n_read == 0 && self.n_frames == 0 {
            // Were frames without bones let in, two bytes of file would become a row of numbers.
            return Err(self.cursor.expected("a bone"));
        }
        Err(self.missing_bone(number))
    }

    /// The bone called `name` at `at`; the `n_read`-th bone of the first frame is tried first.
    fn slot(&mut self, name: &[u8], n_read: usize, at: usize) -> Option<usize> {
        match self.usual_order.get(n_read) {
            Some(&(usual, written)) if written == name => return Some(usual),
            _ => {}
        }
        let found = text(name);
        if let Some(slot_idx) = self.names.find_exact(&found) {
            return Some(slot_idx);
        }
        let slot_idx = self.names.find_folded(&found)?;
        let name = self.name(slot_idx).to_owned();
        self.oddities
            .push_once(at, WarningKind::NameCase { found, name });
        Some(slot_idx)
    }

    fn name(&self, slot_idx: usize) -> &str {
        &self.asf.skeleton.joints()[slot_idx].name
    }

    fn parse_values(
        &mut self,
        slot_idx: usize,
        frame_start: usize,
        at: usize,
    ) -> Result<FrameEnd, ParseError> {
        let slot = &self.slots[slot_idx];
        let expected = slot.is_rotation.len();
        let first = frame_start + slot.first_channel;
        let mut found = 0;
        let mut cut = false;
        loop {
            let before = self.cursor.byte();
            self.cursor.skip_blanks();
            if self.cursor.peek() == Some(b'#') {
                self.cursor.line_text(None);
                break;
            }
            let mut value = match self.cursor.lex_number() {
                Lexed::Number(value) => value,
                Lexed::LineEnd => break,
                Lexed::Wrong => {
                    cut = found < expected && self.cursor.at_cut_number();
                    if cut {
                        break;
                    }
                    return Err(self.cursor.number_error());
                }
            };
            if found < expected {
                if self.angle_unit == AngleUnit::Radians && slot.is_rotation[found] {
                    value = value.to_degrees();
                    if !value.is_finite() {
                        return Err(self.too_large(before));
                    }
                }
                self.values[first + found] = value;
            }
            found += 1;
        }
        if found == expected {
            return Ok(FrameEnd::Whole);
        }
        let mut ahead = self.cursor.clone();
        ahead.skip_space();
        if found < expected && (cut || ahead.at_end()) {
            return Ok(FrameEnd::Cut);
        }
        let what = format!("bone {:?}", self.name(slot_idx));
        let kind = ParseErrorKind::ValueCount {
            what,
            expected,
            found,
        };
        Err(self.cursor.error_at(at, kind))
    }

    /// The error for the number between `before` and here, whose degrees are beyond a double.
    fn too_large(&self, before: usize) -> ParseError {
        let end = self.cursor.byte();
        let written = self.cursor.text_between(before, end).trim_ascii_start();
        let found = quote(written);
        let kind = ParseErrorKind::NotFinite { found };
        self.cursor.error_at(end - written.len(), kind)
    }

    fn missing_bone(&self, frame: u64) -> ParseError {
        // Every bone of this frame is one of the first frame's, once, so the missing one is, too.
        let mut usual = self.usual_order.iter().map(|&(slot_idx, _)| slot_idx);
        let missing = usual.find(|&i| self.slots[i].last_frame != Some(self.n_frames));
        let name = missing.map_or_else(String::new, |i| self.name(i).to_owned());
        let kind = ParseErrorKind::MissingBone { frame, name };
        self.cursor.error_at(self.cursor.byte(), kind)
    }

    fn finish(mut self) -> Amc {
        for slot_idx in 0..self.slots.len() {
            let slot = &self.slots[slot_idx];
            if self.n_frames > 0 && !slot.is_rotation.is_empty() && slot.last_frame.is_none() {
                let name = self.name(slot_idx).to_owned();
                let end = self.cursor.byte();
                self.oddities.push(end, WarningKind::UnmovedBone { name });
            }
        }
        let n_channels = self.asf.skeleton.n_channels();
        let channels = Array2::from_shape_vec((self.n_frames, n_channels), self.values)
            .expect("each frame pushed one value per channel");
        let motion = Motion {
            skeleton: self.asf.skeleton.clone(),
            channels,
            rate: self.rate.0,
            rate_source: self.rate.1,
            unit: self.asf.unit,
            unit_source: UnitSource::File,
            up: UpAxis::Y,
            up_source: UpSource::Default,
        };
        Amc {
            motion,
            first_frame_number: self.first_frame_number,
            warnings: self.oddities.into_warnings(self.cursor.whole()),
        }
    }
}

impl BoneSlot {
    /// Its columns.
    fn channels(&self) -> Range<usize> {
        self.first_channel..self.first_channel + self.is_rotation.len()
    }
}

/// Whether the line ends here or goes on with a comment.
fn at_content_end(cursor: &Cursor<'_>) -> bool {
    let mut ahead = cursor.clone();
    ahead.skip_blanks();
    ahead.at_line_end() || (ahead.peek() == Some(b'#') && cursor.at_white_space())
}

/// Fills `values` from the line `name value value …` at `pos` and gives the start of the next line, if
/// the line is just that.
#[inline(always)]
fn read_usual_line(text: &[u8], mut pos: usize, name: &[u8], values: &mut [f64]) -> Option<usize> {
    while text.get(pos).is_some_and(|&b| is_space(b)) {
        pos += 1;
    }
    if !text.get(pos..)?.starts_with(name) {
        return None;
    }
    pos += name.len();
    for value in values {
        let blank = pos;
        pos = skip_blanks(text, pos);
        if pos == blank {
            return None;
        }
        (*value, pos) = number::spaced(text, pos)?;
    }
    pos = skip_blanks(text, pos);
    text.get(pos).is_none_or(|&b| is_newline(b)).then_some(pos)
}

/// Turns the rotations into degrees; `false` if one is beyond a double then.
fn turn_to_degrees(values: &mut [f64], is_rotation: &[bool]) -> bool {
    for (value, _) in values.iter_mut().zip(is_rotation).filter(|(_, is)| **is) {
        *value = value.to_degrees();
    }
    values.iter().all(|value| value.is_finite())
}

#[cfg(test)]
mod tests;
