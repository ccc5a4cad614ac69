use ndarray::{ArrayView2, ArrayView3, Axis as Dimension};


use super::UpAxis;

/// How many frames are looked at.
const MAX_SAMPLES: usize = 200;

/// Frames between the two positions that a displacement is taken from: long enough for a step to show
/// against noise, short enough for a foot to stay.
const LAG: usize = 4;

/// How thick the slice of the figure at its lower and upper end is, as a share of its extent.
const END_SLICE: f64 = 0.1;

/// What speaks for each direction of [`UpAxis::ALL`] being up.
#[doc(hidden)]
pub fn signs_of_up(positions: ArrayView3<'_, f32>) -> Option<[[f64; N_SIGNS]; 6]> {
    let frames = sampled(positions.len_of(Dimension(0)));
    let samples: Vec<Sample> = frames
        .filter_map(|frame| Sample::new(&positions, frame))
        .collect();
    if samples.is_empty() {
        return None;
    }
    let size = median(samples.iter().map(|s| s.size()).collect());
    if size.is_nan() || size <= 0.0 {
        return None;
    }
    let typical_step = mean(samples.iter().map(|s| s.step)) / size;
    Some(UpAxis::ALL.map(|up| {
        let axis = up.axis().idx();
        let (bottom, top) = if up.is_reversed() { (1, 0) } else { (0, 1) };
        let spread_of = |end: usize| {
            let mut heights: Vec<f64> = samples.iter().map(|s| s.ends[axis][end].height).collect();
            heights.sort_by(f64::total_cmp);
            let at = |share: f64| heights[((heights.len() - 1) as f64 * share) as usize];
            (at(0.9) - at(0.1)) / size
        };
        let step_of = |end: usize| mean(samples.iter().map(|s| s.ends[axis][end].step)) / size;
        let width_of = |end: usize| mean(samples.iter().map(|s| s.ends[axis][end].width)) / size;
        let extent = median(samples.iter().map(|s| s.extent[axis]).collect()) / size;
        let floor = median(samples.iter().map(|s| s.ends[axis][bottom].height).collect()) / size;
        [
            (extent + 0.01).ln(),
            (spread_of(bottom) + 0.01).ln(),
            (spread_of(top) + 0.01).ln(),
            ((step_of(bottom) + 0.001) / (typical_step + 0.001)).ln(),
            ((step_of(top) + 0.001) / (typical_step + 0.001)).ln(),
            (width_of(bottom) + 0.05).ln(),
            (width_of(top) + 0.05).ln(),
            (floor.abs() + 0.02).ln(),
        ]
    }))
}

/// Number of signs.
pub const N_SIGNS: usize = 8;

/// Guesses which way is up from positions of shape `(frames, joints or markers, 3)`.
pub fn guess_up(positions: ArrayView3<'_, f32>) -> Option<(UpAxis, f64)> {
    let signs = signs_of_up(positions)?;
    let scores = signs.map(|signs| signs.iter().zip(WEIGHTS).map(|(s, w)| s * w).sum::<f64>());
    let best = (0..6).max_by(|&a, &b| scores[a].total_cmp(&scores[b]))?;
    let share: f64 = scores.iter().map(|s| (s - scores[best]).exp()).sum();
    Some((UpAxis::ALL[best], 1.0 / share))
}

const WEIGHTS: [f64; N_SIGNS] = [1.0, -1.0, 0.0, -1.0, 1.0, 0.0, 0.0, -0.5];

/// Evenly spread frames, at most [`MAX_SAMPLES`].
fn sampled(n_frames: usize) -> impl Iterator<Item = usize> {
    let n = n_frames.min(MAX_SAMPLES);
    (0..n).map(move |i| i * n_frames / n)
}

/// The figure in one frame.
struct Sample {
    /// Along each axis.
    extent: [f64; 3],
    /// Of each axis, the end where it begins and the end where it ends.
    ends: [[End; 2]; 3],
    /// How far points moved on average.
    step: f64,
}

#[derive(Clone, Copy, Default)]
struct End {
    /// Coordinate of the outermost point.
    height: f64,
    /// How far the points in the end slice moved on average.
    step: f64,
    /// Largest distance between points of the end slice along the other axes.
    width: f64,
}

impl Sample {
    fn new(positions: &ArrayView3<'_, f32>, frame: usize) -> Option<Sample> {
        let n_frames = positions.len_of(Dimension(0));
        let now = positions.index_axis(Dimension(0), frame);
        let lag = LAG.min(n_frames - 1);
        let then = if frame + lag < n_frames { frame + lag } else { frame - lag };
        let then = positions.index_axis(Dimension(0), then);
        let there = points(&now);
        let moved: Vec<([f64; 3], f64)> = there
            .map(|(idx, at)| {
                let later = [0, 1, 2].map(|i| f64::from(then[[idx, i]]));
                let step = (0..3).map(|i| (later[i] - at[i]).powi(2)).sum::<f64>().sqrt();
                (at, step)
            })
            .collect();
        if moved.len() < 2 {
            return None;
        }
        let (low, high) = bounds(moved.iter().map(|m| m.0));
        let extent = [0, 1, 2].map(|i| high[i] - low[i]);
        let ends = [0, 1, 2].map(|axis| {
            [low[axis], high[axis]].map(|height| {
                let slice = moved
                    .iter()
                    .filter(|(at, _)| (at[axis] - height).abs() <= END_SLICE * extent[axis]);
                let (from, to) = bounds(slice.clone().map(|m| m.0));
                let others = (0..3).filter(|&i| i != axis);
                End {
                    height,
                    step: mean(slice.map(|m| m.1).filter(|s| !s.is_nan())),
                    width: others.map(|i| to[i] - from[i]).fold(0.0, f64::max),
                }
            })
        });
        Some(Sample {
            extent,
            ends,
            step: mean(moved.iter().map(|m| m.1).filter(|s| !s.is_nan())),
        })
    }

    fn size(&self) -> f64 {
        self.extent.iter().map(|e| e * e).sum::<f64>().sqrt()
    }
}

/// Points that are there, with their numbers.
fn points<'a>(frame: &'a ArrayView2<'_, f32>) -> impl Iterator<Item = (usize, [f64; 3])> + 'a {
    let all = frame.rows().into_iter().enumerate();
    let all = all.map(|(idx, at)| (idx, [0, 1, 2].map(|i| f64::from(at[i]))));
    all.filter(|(_, at)| at.iter().all(|v| v.is_finite()))
}

fn bounds(points: impl Iterator<Item = [f64; 3]>) -> ([f64; 3], [f64; 3]) {
    points.fold(([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]), |(low, high), at| {
        let pick = |f: fn(f64, f64) -> f64, so_far: [f64; 3]| [0, 1, 2].map(|i| f(so_far[i], at[i]));
        (pick(f64::min, low), pick(f64::max, high))
    })
}

/// Zero of nothing.
fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, n) = values.fold((0.0, 0usize), |(sum, n), v| (sum + v, n + 1));
    if n == 0 { 0.0 } else { sum / n as f64 }
}

/// Zero of nothing.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

/// The largest extent along an axis of a typical frame; 0 if there is none.
pub(crate) fn typical_extent(positions: ArrayView3<'_, f32>) -> f64 {
    let largest = sampled(positions.len_of(Dimension(0))).filter_map(|frame| {
        let frame = positions.index_axis(Dimension(0), frame);
        let (low, high) = bounds(points(&frame).map(|(_, at)| at));
        let extent = (0..3).map(|i| high[i] - low[i]).fold(0.0, f64::max);
        (low[0] <= high[0]).then_some(extent)
    });
    median(largest.collect())
}
