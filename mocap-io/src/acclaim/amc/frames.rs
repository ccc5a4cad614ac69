//! Frames, and the bones in them.

use super::Reader;
use crate::acclaim::asf::{AngleUnit, nearest};
use crate::cursor::{Cursor, Lexed, is_newline, is_space, quote, skip_blanks, text};
use crate::{ParseError, ParseErrorKind, WarningKind, number};

/// Values that a file of `n_bytes` may become: as many as fit into what [`crate::parse_amc`] promises.
fn max_values(n_bytes: usize) -> usize {
    const SPARE_BYTES: usize = 8 << 20;
    const BYTES_PER_BYTE: usize = 6;
    (SPARE_BYTES + BYTES_PER_BYTE * n_bytes) / size_of::<f64>()
}

/// Why a frame could not be read to its end.
enum FrameEnd {
    Whole,
    /// The file ends within the frame.
    Cut,
}

impl Reader<'_> {
    pub(super) fn parse_frames(&mut self) -> Result<(), ParseError> {
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

    pub(super) fn name(&self, slot_idx: usize) -> &str {
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
