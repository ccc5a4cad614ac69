use std::ops::Range;

use ndarray::Array2;

use super::asf::{AngleUnit, Asf};
use super::names::Names;
use crate::cursor::{Cursor, text};
use crate::warning::Oddities;
use crate::{
    Channel, FrameRate, Motion, ParseError, ParseErrorKind, RateSource, UnitSource, UpAxis,
    UpSource, Warning, WarningKind,
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

mod frames;

#[cfg(test)]
mod tests;
