//! Poses that can be compared whoever strikes them, wherever, and whichever way they face.

use std::ops::Range;

use ndarray::{Array2, ArrayView3};
use relfeat::{BodyMap, BodyPoint};

/// Normalised poses, one per row.
///
/// A pose is the positions of the body points that both clips have, seen from the body itself: the
/// root is the origin (and not a point of the pose), Y is up, and the horizontal part of the line from
/// the right to the left side, hips and shoulders together, is +X; so the body faces +Z. All
/// lengths are scaled so that both bodies' limbs are as long as the mean of the two. So neither place nor
/// heading nor height matters, and distances are metres on a body of mean size.
#[derive(Clone, Debug, PartialEq)]
pub struct Poses {
    /// Shape `(frames, 3 · points)`: x, y, z per point; NaN where missing.
    coords: Array2<f32>,
}

/// Points left and right of the body's middle, whose difference tells where it faces.
const SIDES: [[BodyPoint; 2]; 2] = [
    [BodyPoint::LHip, BodyPoint::RHip],
    [BodyPoint::LShoulder, BodyPoint::RShoulder],
];

/// The limbs, whose lengths are the size of a body. Conversions between rigs leave these alone; the
/// spine they do not.
const LIMBS: [[BodyPoint; 2]; 8] = [
    [BodyPoint::LHip, BodyPoint::LKnee],
    [BodyPoint::RHip, BodyPoint::RKnee],
    [BodyPoint::LKnee, BodyPoint::LAnkle],
    [BodyPoint::RKnee, BodyPoint::RAnkle],
    [BodyPoint::LShoulder, BodyPoint::LElbow],
    [BodyPoint::RShoulder, BodyPoint::RElbow],
    [BodyPoint::LElbow, BodyPoint::LWrist],
    [BodyPoint::RElbow, BodyPoint::RWrist],
];

/// A body's sides nearer to each other than this on the floor, in metres, do not tell where it faces.
const MIN_WIDTH: f32 = 0.01;

/// The body of one clip.
#[derive(Clone, Copy, Debug)]
pub struct Body<'a> {
    /// Shape `(frames, joints, 3)`, metres, Y up.
    pub positions: ArrayView3<'a, f32>,
    /// Which joint is which body point.
    pub map: &'a BodyMap,
}

/// Two clips have too few body points in common to be compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "the clips have {n_shared} body points in common; poses take the root, both hips or both shoulders, \
    and {} points in all",
    MIN_POINTS
)]
pub struct TooFewPoints {
    /// How many both have.
    pub n_shared: usize,
}

/// Fewer body points than this are no pose.
pub const MIN_POINTS: usize = 6;

/// The body points that poses of both clips are made of, in order.
///
/// # Errors
/// [`TooFewPoints`].
pub fn shared_points(a: &BodyMap, b: &BodyMap) -> Result<Vec<BodyPoint>, TooFewPoints> {
    let both = |point: &BodyPoint| a.places(*point) && b.places(*point);
    let mut points: Vec<BodyPoint> = BodyPoint::ALL.into_iter().filter(both).collect();
    let has_sides = SIDES.iter().any(|pair| pair.iter().all(both));
    if !both(&BodyPoint::Root) || !has_sides || points.len() < MIN_POINTS {
        let n_shared = points.len();
        return Err(TooFewPoints { n_shared });
    }
    points.retain(|&point| point != BodyPoint::Root);
    Ok(points)
}

type Point = [f32; 3];

impl Body<'_> {
    /// NaN where a joint is missing, or where the map does not place the point.
    pub(crate) fn point(&self, frame: usize, point: BodyPoint) -> Point {
        let sources = self.map.sources(point);
        if sources.is_empty() {
            return [f32::NAN; 3];
        }
        let mut sum = [0.0; 3];
        for &(joint, weight) in sources {
            for (axis, sum) in sum.iter_mut().enumerate() {
                *sum += weight as f32 * self.positions[[frame, joint, axis]];
            }
        }
        sum
    }

    /// The total length of the limbs among `points`, in metres, each its mean over `frames`. `None` if
    /// none has a length.
    #[must_use]
    pub fn size(&self, points: &[BodyPoint], frames: &[usize]) -> Option<f32> {
        let limbs = LIMBS
            .iter()
            .filter(|limb| limb.iter().all(|end| points.contains(end)));
        let lengths = limbs.filter_map(|&[from, to]| {
            let lengths = frames
                .iter()
                .map(|&t| norm(minus(self.point(t, from), self.point(t, to))));
            let known: Vec<f32> = lengths.filter(|length| length.is_finite()).collect();
            (!known.is_empty()).then(|| known.iter().sum::<f32>() / known.len() as f32)
        });
        Some(lengths.sum()).filter(|&size| size > 0.0)
    }

    /// Cosine and sine of the turn that puts the line from right to left on +X; `None` if the sides are
    /// missing or above each other.
    fn turn(&self, frame: usize) -> Option<[f32; 2]> {
        let (mut x, mut z) = (0.0, 0.0);
        for [left, right] in SIDES {
            let across = minus(self.point(frame, left), self.point(frame, right));
            if across.iter().all(|c| c.is_finite()) {
                x += across[0];
                z += across[2];
            }
        }
        let width = x.hypot(z);
        (width > MIN_WIDTH).then(|| [x / width, z / width])
    }

    /// The poses of some frames, `scale` times as large, and which frames they are: those without a
    /// root, or with half the points missing, have no pose. Where the sides do not tell a heading, that
    /// of the nearest frame before counts, at the start that of the first frame that has one.
    #[must_use]
    pub fn poses(&self, points: &[BodyPoint], frames: &[usize], scale: f32) -> (Poses, Vec<usize>) {
        let mut turn = frames
            .iter()
            .find_map(|&t| self.turn(t))
            .unwrap_or([1.0, 0.0]);
        let mut kept = Vec::new();
        let mut coords = Vec::new();
        for &t in frames {
            turn = self.turn(t).unwrap_or(turn);
            let [cos, sin] = turn;
            let root = self.point(t, BodyPoint::Root);
            let seen = points.iter().map(|&point| {
                let [x, y, z] = minus(self.point(t, point), root);
                [x * cos + z * sin, y, z * cos - x * sin].map(|c| c * scale)
            });
            let seen: Vec<Point> = seen.collect();
            let n_known = seen
                .iter()
                .filter(|p| p.iter().all(|c| c.is_finite()))
                .count();
            // More than half, so that any two poses have a point in common.
            if 2 * n_known > points.len() {
                kept.push(t);
                coords.extend(seen.into_iter().flatten());
            }
        }
        let shape = (kept.len(), 3 * points.len());
        let coords = Array2::from_shape_vec(shape, coords);
        // The shape fits: so many were pushed.
        (
            Poses {
                coords: coords.unwrap_or_default(),
            },
            kept,
        )
    }
}

fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn norm([x, y, z]: Point) -> f32 {
    (x * x + y * y + z * z).sqrt()
}

impl Poses {
    /// Poses as they are given, `(frames, 3 · points)`.
    #[must_use]
    pub fn from_coords(coords: Array2<f32>) -> Poses {
        let coords = coords.as_standard_layout().into_owned();
        Poses { coords }
    }

    /// Number of poses.
    #[must_use]
    pub fn n_frames(&self) -> usize {
        self.coords.nrows()
    }

    fn row(&self, frame: usize) -> &[f32] {
        let width = self.coords.ncols();
        let all = self.coords.as_slice().unwrap_or_default();
        &all[frame * width..(frame + 1) * width]
    }

    /// The mean distance, in metres, of the points that both poses have. 0-based.
    #[must_use]
    pub fn distance(&self, frame: usize, other: &Poses, other_frame: usize) -> f64 {
        let (a, b) = (self.row(frame), other.row(other_frame));
        let sum: f64 = point_distances(a, b).map(f64::from).sum();
        let (sum, n) = if sum.is_nan() {
            let known = point_distances(a, b).filter(|d| !d.is_nan());
            known.fold((0.0, 0), |(sum, n), d| (sum + f64::from(d), n + 1))
        } else {
            (sum, a.len() / 3)
        };
        sum / n as f64
    }

    /// The distance of each point, in metres; `None` where one of the poses lacks it. Their mean is
    /// [`Poses::distance`].
    #[must_use]
    pub fn distances(&self, frame: usize, other: &Poses, other_frame: usize) -> Vec<Option<f64>> {
        let distances = point_distances(self.row(frame), other.row(other_frame));
        distances
            .map(|d| (!d.is_nan()).then_some(f64::from(d)))
            .collect()
    }

    /// The mean pose of each span, of the frames that have the point.
    pub(crate) fn means(&self, spans: &[Range<usize>]) -> Poses {
        let mut means = Array2::from_elem((spans.len(), self.coords.ncols()), f32::NAN);
        for (span, mut mean) in spans.iter().zip(means.rows_mut()) {
            for (column, mean) in mean.iter_mut().enumerate() {
                let values = span.clone().map(|t| self.coords[[t, column]]);
                let known = values.filter(|v| !v.is_nan());
                let (sum, n) = known.fold((0.0, 0), |(sum, n), v| (sum + v, n + 1));
                if n > 0 {
                    *mean = sum / n as f32;
                }
            }
        }
        Poses { coords: means }
    }
}

fn point_distances<'a>(a: &'a [f32], b: &'a [f32]) -> impl Iterator<Item = f32> + 'a {
    let pairs = a.chunks_exact(3).zip(b.chunks_exact(3));
    pairs.map(|(p, q)| norm([p[0] - q[0], p[1] - q[1], p[2] - q[2]]))
}
