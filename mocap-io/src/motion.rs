use std::borrow::Cow;
use std::ops::Range;

use ndarray::{Array2, s};

use crate::{Channel, LengthUnit, RateSource, Skeleton, UnitSource, UpAxis, UpSource};

/// Frames per second: positive and finite.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct FrameRate(f64);

impl FrameRate {
    /// `None` unless `hz` is positive and finite and its reciprocal is finite, too.
    #[must_use]
    pub fn from_hz(hz: f64) -> Option<Self> {
        (hz > 0.0 && hz.is_finite() && hz.recip().is_finite()).then_some(FrameRate(hz))
    }

    /// `None` unless `seconds`, the time from one frame to the next, is positive and finite.
    #[must_use]
    pub fn from_frame_time(seconds: f64) -> Option<Self> {
        Self::from_hz(seconds.recip()).filter(|_| seconds.is_finite())
    }

    /// Frames per second.
    #[must_use]
    pub fn hz(self) -> f64 {
        self.0
    }

    /// Seconds from one frame to the next.
    #[must_use]
    pub fn frame_time(self) -> f64 {
        self.0.recip()
    }
}

/// A skeleton and how it moves.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// The joints.
    pub skeleton: Skeleton,
    /// Shape `(frames, channels)`, in skeleton order: degrees and file units. Columns that the skeleton
    /// asks for and that are not there count as NaN.
    pub channels: Array2<f64>,
    /// Frames per second.
    pub rate: FrameRate,
    /// Where the rate comes from.
    pub rate_source: RateSource,
    /// Metres per file unit.
    pub unit: LengthUnit,
    /// Where the unit comes from.
    pub unit_source: UnitSource,
    /// Which way is up in the file; positions are turned to Y up.
    pub up: UpAxis,
    /// Where the up axis comes from.
    pub up_source: UpSource,
}

/// Why a skeleton and numbers do not make a motion.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("expected {expected} channels per frame, found {found}")]
pub struct ChannelCountError {
    /// Channels that the skeleton has.
    pub expected: usize,
    /// Columns of the array.
    pub found: usize,
}

impl Motion {
    /// A motion made by a program, Y up: rate, unit and up axis count as given.
    ///
    /// # Errors
    /// [`ChannelCountError`] if `channels` has another number of columns than the skeleton asks for.
    pub fn new(
        skeleton: Skeleton,
        channels: Array2<f64>,
        rate: FrameRate,
        unit: LengthUnit,
    ) -> Result<Self, ChannelCountError> {
        if channels.ncols() != skeleton.n_channels() {
            return Err(ChannelCountError {
                expected: skeleton.n_channels(),
                found: channels.ncols(),
            });
        }
        Ok(Motion {
            skeleton,
            channels,
            rate,
            rate_source: RateSource::Given,
            unit,
            unit_source: UnitSource::Given,
            up: UpAxis::Y,
            up_source: UpSource::Given,
        })
    }

    /// Number of frames.
    #[must_use]
    pub fn n_frames(&self) -> usize {
        self.channels.nrows()
    }

    /// Seconds from the first frame to the end of the last one.
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.n_frames() as f64 * self.rate.frame_time()
    }

    /// The frames of `span` (0-based, end exclusive), with the same skeleton; `None` if the span
    /// reaches past the end or is reversed.
    #[must_use]
    pub fn slice(&self, span: Range<usize>) -> Option<Motion> {
        if span.start > span.end || span.end > self.n_frames() {
            return None;
        }
        Some(Motion {
            channels: self.channels.slice(s![span, ..]).to_owned(),
            ..self.without_frames()
        })
    }

    /// The same motion with its lengths in another unit: offsets and translations are multiplied,
    /// positions in metres stay. O(frames · channels).
    #[must_use]
    pub fn in_unit(&self, unit: LengthUnit) -> Motion {
        let factor = self.unit.metres() / unit.metres();
        let mut motion = self.clone();
        motion.skeleton = self.skeleton.scaled(factor);
        let kinds = self.skeleton.joints().iter().flat_map(|j| &j.channels);
        for (kind, mut column) in kinds.zip(motion.channels.columns_mut()) {
            if !matches!(kind, Channel::Rotation(_)) {
                column *= factor;
            }
        }
        motion.unit = unit;
        motion.unit_source = UnitSource::Given;
        motion
    }

    /// The values of each frame, one per channel of the skeleton. Both are public fields and may have
    /// been made to disagree: a value that is not there is missing, that is NaN; one too many is left out.
    pub(crate) fn rows(&self) -> impl Iterator<Item = Cow<'_, [f64]>> {
        let n_channels = self.skeleton.n_channels();
        let channels = self.channels.rows().into_iter();
        channels.map(move |row| match row.to_slice() {
            Some(values) if values.len() == n_channels => Cow::Borrowed(values),
            _ => {
                let value = |column| row.get(column).copied().unwrap_or(f64::NAN);
                Cow::Owned((0..n_channels).map(value).collect())
            }
        })
    }

    pub(crate) fn without_frames(&self) -> Motion {
        Motion {
            skeleton: self.skeleton.clone(),
            channels: Array2::zeros((0, self.skeleton.n_channels())),
            ..*self
        }
    }
}
