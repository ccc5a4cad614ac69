use std::ops::Range;

use ndarray::{Array2, Array3, Axis, s};

use crate::{FrameRate, LengthUnit, RateSource, UnitSource, UpAxis, UpSource};

/// Where labelled points were, frame by frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Markers {
    /// One per marker, distinct; prefixes such as `dg:` are kept.
    pub names: Vec<String>,
    /// Shape `(frames, markers, 3)`, in the file's unit and axes; all three NaN where missing.
    pub positions: Array3<f32>,
    /// How well the cameras agreed: shape `(frames, markers)`, file units. 0 where a position was
    /// calculated, not measured; NaN where it is missing, or where the file does not say.
    pub residuals: Array2<f32>,
    /// Frames per second.
    pub rate: FrameRate,
    /// Where the rate comes from.
    pub rate_source: RateSource,
    /// Metres per file unit.
    pub unit: LengthUnit,
    /// Where the unit comes from.
    pub unit_source: UnitSource,
    /// Which way is up in the file.
    pub up: UpAxis,
    /// Where the up axis comes from.
    pub up_source: UpSource,
    /// What the file calls frame 0 of `positions`; usually 1.
    pub first_frame_number: u64,
}

impl Markers {
    /// Number of frames.
    #[must_use]
    pub fn n_frames(&self) -> usize {
        self.positions.len_of(Axis(0))
    }

    /// Seconds from the first frame to the end of the last one.
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.n_frames() as f64 * self.rate.frame_time()
    }

    /// The frames of `span` (0-based, end exclusive); `None` if the span reaches past the end or is
    /// reversed.
    #[must_use]
    pub fn slice(&self, span: Range<usize>) -> Option<Markers> {
        if span.start > span.end || span.end > self.n_frames() {
            return None;
        }
        Some(Markers {
            names: self.names.clone(),
            positions: self.positions.slice(s![span.clone(), .., ..]).to_owned(),
            residuals: self.residuals.slice(s![span.clone(), ..]).to_owned(),
            first_frame_number: self.first_frame_number.saturating_add(span.start as u64),
            ..*self
        })
    }

    /// Positions in metres, Y up, right-handed; shape `(frames, markers, 3)`, NaN where missing.
    /// O(frames · markers).
    #[must_use]
    pub fn positions_y_up(&self) -> Array3<f32> {
        let turn = self.up.to_y() * self.unit.metres();
        let mut turned = self.positions.clone();
        for mut at in turned.lanes_mut(Axis(2)) {
            let [x, y, z] = [0, 1, 2].map(|i| f64::from(at[i]));
            for i in 0..3 {
                at[i] = (turn[(i, 0)] * x + turn[(i, 1)] * y + turn[(i, 2)] * z) as f32;
            }
        }
        turned
    }
}
