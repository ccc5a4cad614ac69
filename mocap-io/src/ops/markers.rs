use ndarray::{Array2, Array3};

use super::interpolate::times;
use crate::{FrameRate, Markers, RateSource};

impl Markers {
    /// The same markers at another rate: frame `k` is where they were at `k / rate` seconds, as long as
    /// that is not after the last frame; on a straight line between two frames, missing where either is.
    /// Frames of the file stay as they are, to the bit. O(markers · new frames).
    #[must_use]
    pub fn resample(&self, rate: FrameRate) -> Markers {
        let times = times(self.n_frames(), self.rate, rate);
        let n_markers = self.names.len();
        let mix = |time: f64, value: &dyn Fn(usize) -> f32| {
            let (before, share) = (time.floor() as usize, time.fract());
            if share == 0.0 {
                return value(before);
            }
            let (a, b) = (f64::from(value(before)), f64::from(value(before + 1)));
            (a + (b - a) * share) as f32
        };
        let positions = Array3::from_shape_fn((times.len(), n_markers, 3), |(k, marker, axis)| {
            mix(times[k], &|frame| self.positions[[frame, marker, axis]])
        });
        let residuals = Array2::from_shape_fn((times.len(), n_markers), |(k, marker)| {
            mix(times[k], &|frame| self.residuals[[frame, marker]])
        });
        Markers {
            names: self.names.clone(),
            positions,
            residuals,
            rate,
            rate_source: RateSource::Given,
            ..*self
        }
    }
}
