use std::ops::Range;

use ndarray::s;

use crate::Markers;

/// Frames in which a marker is missing, between frames in which it is there or the ends.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Gap {
    /// Which marker, counted from 0.
    pub marker: usize,
    /// Frames, 0-based, end exclusive; as long as can be.
    pub frames: Range<usize>,
}

/// A gap that was filled.
pub type Filled = Gap;

/// Room for the rounding of seconds times rate, so that a gap of exactly the given length counts.
const ROUNDING: f64 = 1e-9;

impl Markers {
    /// All gaps, by marker, then frame. A marker that is never there has one gap. O(frames · markers).
    #[must_use]
    pub fn gaps(&self) -> Vec<Gap> {
        let mut gaps = Vec::new();
        for marker in 0..self.names.len() {
            let mut start = None;
            for frame in 0..self.n_frames() {
                match (self.is_missing(frame, marker), start) {
                    (true, None) => start = Some(frame),
                    (false, Some(from)) => {
                        gaps.push(Gap {
                            marker,
                            frames: from..frame,
                        });
                        start = None;
                    }
                    _ => {}
                }
            }
            if let Some(from) = start {
                gaps.push(Gap {
                    marker,
                    frames: from..self.n_frames(),
                });
            }
        }
        gaps
    }

    /// The markers with every gap of at most `max_gap_s` seconds filled, and which these were.
    ///
    /// A gap of n frames lasts n frame times. It is filled by the cubic through the two nearest
    /// positions on each side, at their own times, so that a marker on a cubic is restored exactly; with
    /// a single position on one side by the parabola through three, on both by the line. Positions
    /// filled do not serve others. Gaps at either end and longer ones stay missing. Filled positions
    /// have residual 0, as the C3D format marks what was calculated.
    ///
    /// O(frames · markers).
    #[must_use]
    pub fn filled(&self, max_gap_s: f64) -> (Markers, Vec<Filled>) {
        let mut markers = self.clone();
        let mut filled = self.gaps();
        let longest = max_gap_s * self.rate.hz() * (1.0 + ROUNDING);
        filled.retain(|gap| {
            let is_inside = gap.frames.start > 0 && gap.frames.end < self.n_frames();
            is_inside && gap.frames.len() as f64 <= longest
        });
        for gap in &filled {
            let known = self.around(gap);
            for frame in gap.frames.clone() {
                let weights = lagrange_weights(&known, frame);
                for axis in 0..3 {
                    let terms = known.iter().zip(&weights);
                    let value: f64 = terms
                        .map(|(&at, w)| w * f64::from(self.positions[[at, gap.marker, axis]]))
                        .sum();
                    markers.positions[[frame, gap.marker, axis]] = value as f32;
                }
                markers.residuals[[frame, gap.marker]] = 0.0;
            }
        }
        (markers, filled)
    }

    fn is_missing(&self, frame: usize, marker: usize) -> bool {
        let at = self.positions.slice(s![frame, marker, ..]);
        at.iter().any(|v| v.is_nan())
    }

    /// The frames of the two nearest positions on each side of a gap, ascending.
    fn around(&self, gap: &Gap) -> Vec<usize> {
        let is_there = |&frame: &usize| !self.is_missing(frame, gap.marker);
        let mut known: Vec<usize> = (0..gap.frames.start)
            .rev()
            .filter(is_there)
            .take(2)
            .collect();
        known.reverse();
        known.extend((gap.frames.end..self.n_frames()).filter(is_there).take(2));
        known
    }
}

/// Of each of the frames `known`, its weight in the value at `frame` of the polynomial through all.
fn lagrange_weights(known: &[usize], frame: usize) -> Vec<f64> {
    let weight = |&own: &usize| {
        let others = known.iter().filter(|&&other| other != own);
        let factors =
            others.map(|&other| (frame as f64 - other as f64) / (own as f64 - other as f64));
        factors.product()
    };
    known.iter().map(weight).collect()
}
