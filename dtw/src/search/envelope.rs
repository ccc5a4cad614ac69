//! Least and greatest samples within a radius.

/// Envelope of a sequence of points, dimension after dimension.
#[derive(Debug, Default, Clone)]
pub(super) struct Envelope {
    pub(super) len: usize,
    pub(super) lower: Vec<f64>,
    pub(super) upper: Vec<f64>,
    padded: Vec<f64>,
    doubled: Vec<f64>,
}

impl Envelope {
    /// Sets entry j of each dimension, for j in 0..len, to the extremes of the points at most
    /// `radius` from j. `points` holds whole dimensions of `n` points.
    #[inline(always)]
    pub(super) fn set(&mut self, points: &[f64], n: usize, len: usize, radius: usize) {
        self.len = len;
        self.lower.clear();
        self.upper.clear();
        if n == 0 {
            return;
        }
        for dimension in points.chunks_exact(n) {
            self.extremes(
                dimension,
                radius,
                f64::INFINITY,
                |a, b| if a < b { a } else { b },
            );
            self.lower.extend_from_slice(&self.padded[..len]);
            self.extremes(dimension, radius, f64::NEG_INFINITY, |a, b| {
                if a > b { a } else { b }
            });
            self.upper.extend_from_slice(&self.padded[..len]);
        }
    }

    /// Of each `2 radius + 1` neighbours, from those of 1, 2, 4, …: O((n + radius) log radius).
    #[inline(always)]
    fn extremes(
        &mut self,
        points: &[f64],
        radius: usize,
        neutral: f64,
        of: impl Fn(f64, f64) -> f64,
    ) {
        // A wider radius sees the same points.
        let radius = radius.min(points.len().max(self.len));
        let needed = self.len + 2 * radius;
        let padded = &mut self.padded;
        padded.clear();
        padded.resize(radius, neutral);
        padded.extend_from_slice(points);
        padded.resize(needed, neutral);
        let width = 2 * radius + 1;
        let mut reach = 1;
        while reach < width {
            // Windows may overlap, so the last doubling need not be a whole one.
            let step = reach.min(width - reach);
            self.doubled.clear();
            let pairs = padded.iter().zip(&padded[step..]);
            self.doubled.extend(pairs.map(|(&a, &b)| of(a, b)));
            std::mem::swap(padded, &mut self.doubled);
            reach += step;
        }
    }
}
