use nalgebra::Vector3;
use ndarray::{ArrayView1, ArrayView3, Axis};

use crate::velocity::{mean_velocity, window_frames};
use crate::{BodyMap, BodyPoint, Direction, Quantity, Segment};

/// A segment shorter than this, in metres, has no direction: positions are `f32`, and coordinates of
/// some metres are rounded by about half a micrometre.
const NO_LENGTH: f64 = 1e-6;

/// Three points whose triangle is flatter than this sine span no plane, for the same reason.
const NO_PLANE: f64 = 1e-6;

/// What a stretch of frames has to know of those before it: the directions and angles that were
/// kept last, in the order in which a measurement asks for them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Kept {
    directions: Vec<Vector3<f64>>,
    angles: Vec<f64>,
    n_directions: usize,
    n_angles: usize,
    /// Frame of the stretch after which they are taken down for the next one.
    at: Option<usize>,
}

impl Kept {
    /// Before every measurement of a stretch.
    pub(crate) fn rewind(&mut self, at: Option<usize>) {
        (self.n_directions, self.n_angles, self.at) = (0, 0, at);
    }

    fn direction(&mut self) -> &mut Vector3<f64> {
        self.n_directions += 1;
        let n = self.directions.len().max(self.n_directions);
        self.directions.resize(n, Vector3::repeat(f64::NAN));
        &mut self.directions[self.n_directions - 1]
    }

    fn angle(&mut self) -> &mut f64 {
        self.n_angles += 1;
        let n = self.angles.len().max(self.n_angles);
        self.angles.resize(n, f64::NAN);
        &mut self.angles[self.n_angles - 1]
    }
}

/// Where the body points were in a motion's first frame.
pub(crate) type FirstPose = Vec<Option<Vector3<f64>>>;

/// The paths of the body points, in metres.
#[derive(Debug)]
pub(crate) struct Paths {
    /// Per body point; empty where the body map does not place it.
    points: Vec<Vec<Vector3<f64>>>,
    /// The pose that lengths are taken from.
    first: FirstPose,
    n_frames: usize,
    rate: f64,
}

fn joint_path(positions: ArrayView3<'_, f32>, joint: usize) -> impl Iterator<Item = Vector3<f64>> {
    let at = |pose: ArrayView1<'_, f32>| Vector3::from_fn(|axis, _| f64::from(pose[axis]));
    positions
        .index_axis_move(Axis(1), joint)
        .into_outer_iter()
        .map(at)
}

impl Paths {
    pub(crate) fn gather(positions: ArrayView3<'_, f32>, map: &BodyMap, rate: f64) -> Paths {
        let n_frames = positions.dim().0;
        let path = |sources: &[(usize, f64)]| match *sources {
            [] => Vec::new(),
            [(joint, _)] => joint_path(positions, joint).collect(),
            [(first, weight), ref rest @ ..] => {
                let mut path: Vec<_> = joint_path(positions, first).map(|at| at * weight).collect();
                for &(joint, weight) in rest {
                    for (at, more) in path.iter_mut().zip(joint_path(positions, joint)) {
                        *at += more * weight;
                    }
                }
                path
            }
        };
        let points: Vec<Vec<Vector3<f64>>> = BodyPoint::ALL
            .iter()
            .map(|&p| path(map.sources(p)))
            .collect();
        Paths {
            first: points.iter().map(|path| path.first().copied()).collect(),
            points,
            n_frames,
            rate,
        }
    }

    /// The pose that lengths are taken from.
    pub(crate) fn first_pose(&self) -> &FirstPose {
        &self.first
    }

    /// The same frames, of a motion that began with this pose.
    pub(crate) fn of_motion(self, first: FirstPose) -> Paths {
        Paths { first, ..self }
    }

    fn path(&self, point: BodyPoint) -> &[Vector3<f64>] {
        &self.points[point.idx()]
    }

    /// The summed distances of the pairs in the first frame; `None` without a frame or a point.
    pub(crate) fn first_frame_length(&self, pairs: &[[BodyPoint; 2]]) -> Option<f64> {
        pairs
            .iter()
            .map(|&[a, b]| Some((self.first[a.idx()]? - self.first[b.idx()]?).norm()))
            .sum()
    }

    /// The quantity in every frame; all its body points must have a path.
    ///
    /// `kept` is fresh, or was left by the same quantity over the frames before.
    pub(crate) fn measure(&self, quantity: &Quantity, kept: &mut Kept) -> Vec<f64> {
        match quantity {
            Quantity::Distance {
                of,
                from,
                along,
                absolute,
            } => {
                let n = self.directions(along, kept);
                let pairs = self.path(*of).iter().zip(self.path(*from));
                let signed = pairs.zip(&n).map(|((q, p), n)| n.dot(&(q - p)));
                match absolute {
                    true => signed.map(f64::abs).collect(),
                    false => signed.collect(),
                }
            }
            Quantity::Velocity {
                of,
                relative_to,
                along,
                window_ms,
            } => {
                let pairs = self.path(*of).iter().zip(self.path(*relative_to));
                let relative: Vec<Vector3<f64>> = pairs.map(|(q, p)| q - p).collect();
                let velocity = self.velocity(&relative, *window_ms);
                let n = self.directions(along, kept);
                velocity.iter().zip(&n).map(|(v, n)| n.dot(v)).collect()
            }
            Quantity::Speed { of, window_ms } => {
                let speeds = of.iter().map(|&point| {
                    let velocity = self.velocity(self.path(point), *window_ms);
                    velocity.iter().map(Vector3::norm).collect()
                });
                extreme(speeds, f64::lt)
            }
            Quantity::SegmentDistance {
                of,
                to,
                radius,
                flat_start,
            } => {
                let length = self.first_frame_length(&[*to]).unwrap_or(f64::NAN);
                let outside = |d: f64| d - radius * length;
                let distances = of.iter().map(|&point| {
                    let distances = self.segment_distances(point, *to, *flat_start);
                    distances.into_iter().map(outside).collect()
                });
                extreme(distances, f64::lt)
            }
            Quantity::Smallest { of } => extreme(of.iter().map(|q| self.measure(q, kept)), f64::lt),
            Quantity::Largest { of } => extreme(of.iter().map(|q| self.measure(q, kept)), f64::gt),
            Quantity::Angle { of, to } => self.angles(*of, *to, kept),
            Quantity::Height {
                of,
                above_lowest_except,
            } => {
                let (low, _) = self.height_range(above_lowest_except);
                self.path(*of)
                    .iter()
                    .zip(&low)
                    .map(|(q, low)| q.y - low)
                    .collect()
            }
            Quantity::VerticalExtent {} => {
                let (low, high) = self.height_range(&[]);
                high.iter()
                    .zip(&low)
                    .map(|(high, low)| high - low)
                    .collect()
            }
            Quantity::HorizontalDiameter { of } => self.horizontal_diameter(of),
        }
    }

    fn velocity(&self, path: &[Vector3<f64>], window_ms: f64) -> Vec<Vector3<f64>> {
        mean_velocity(path, window_frames(window_ms, self.rate), self.rate)
    }

    /// Unit directions. Where a direction vanishes the one before it is kept; before the first that
    /// does not vanish it is NaN, which no test passes (spec.md j.4). A missing point makes the
    /// direction of its frame NaN and no other.
    fn directions(&self, direction: &Direction, kept: &mut Kept) -> Vec<Vector3<f64>> {
        let at = kept.at;
        let kept = kept.direction();
        let mut last = *kept;
        let mut frames = 0..self.n_frames;
        let mut unit = |v: Vector3<f64>, shortest: f64| {
            let norm = v.norm();
            if norm > shortest {
                last = v / norm;
            }
            if frames.next() == at {
                *kept = last;
            }
            if norm.is_nan() { v } else { last }
        };
        match *direction {
            Direction::Up => vec![Vector3::y(); self.n_frames],
            Direction::Axis([from, to]) => self
                .path(from)
                .iter()
                .zip(self.path(to))
                .map(|(from, to)| unit(to - from, NO_LENGTH))
                .collect(),
            Direction::Normal([a, b, c]) => self
                .path(a)
                .iter()
                .zip(self.path(b))
                .zip(self.path(c))
                .map(|((a, b), c)| {
                    let (u, v) = (a - c, b - c);
                    unit(u.cross(&v), NO_PLANE * u.norm() * v.norm())
                })
                .collect(),
        }
    }

    fn angles(&self, of: [BodyPoint; 2], to: Segment, kept: &mut Kept) -> Vec<f64> {
        let at = kept.at;
        let kept = kept.angle();
        let mut last = *kept;
        let mut frames = 0..self.n_frames;
        let mut angle = |u: Vector3<f64>, v: Vector3<f64>| {
            let (norm_u, norm_v) = (u.norm(), v.norm());
            if norm_u > NO_LENGTH && norm_v > NO_LENGTH {
                let cosine = u.dot(&v) / (norm_u * norm_v);
                last = cosine.clamp(-1.0, 1.0).acos().to_degrees();
            }
            if frames.next() == at {
                *kept = last;
            }
            // A missing point makes the angle of its frame unknown and no other.
            if (norm_u + norm_v).is_nan() {
                f64::NAN
            } else {
                last
            }
        };
        let pairs = self.path(of[0]).iter().zip(self.path(of[1]));
        let segments = pairs.map(|(a, b)| b - a);
        match to {
            Segment::World(_) => segments.map(|u| angle(u, Vector3::y())).collect(),
            Segment::Points([c, d]) => segments
                .zip(self.path(c).iter().zip(self.path(d)))
                .map(|(u, (c, d))| angle(u, d - c))
                .collect(),
        }
    }

    /// Distances of a point from a segment; with a flat start, those of points before the first end
    /// are taken from the second.
    fn segment_distances(
        &self,
        of: BodyPoint,
        [start, end]: [BodyPoint; 2],
        flat_start: bool,
    ) -> Vec<f64> {
        let ends = self.path(start).iter().zip(self.path(end));
        let distance = |(q, (a, b)): (&Vector3<f64>, (&Vector3<f64>, &Vector3<f64>))| {
            let axis = b - a;
            // A segment without length is a point, and nothing lies before it.
            let along = if axis.norm() > NO_LENGTH {
                axis.dot(&(q - a)) / axis.norm_squared()
            } else {
                0.0
            };
            let nearest = if flat_start && along < 0.0 {
                1.0
            } else {
                along.clamp(0.0, 1.0)
            };
            (q - (a + axis * nearest)).norm()
        };
        self.path(of).iter().zip(ends).map(distance).collect()
    }

    /// Lowest and highest body point per frame, all but the excepted ones.
    fn height_range(&self, except: &[BodyPoint]) -> (Vec<f64>, Vec<f64>) {
        let mut low = vec![f64::INFINITY; self.n_frames];
        let mut high = vec![f64::NEG_INFINITY; self.n_frames];
        for point in BodyPoint::ALL.iter().filter(|p| !except.contains(p)) {
            for ((q, low), high) in self.path(*point).iter().zip(&mut low).zip(&mut high) {
                // Missing points make the extreme unknown: `min` and `max` would skip them.
                if q.y < *low || q.y.is_nan() {
                    *low = q.y;
                }
                if q.y > *high || q.y.is_nan() {
                    *high = q.y;
                }
            }
        }
        (low, high)
    }

    fn horizontal_diameter(&self, points: &[BodyPoint]) -> Vec<f64> {
        let mut largest = vec![0.0f64; self.n_frames];
        for (i, &a) in points.iter().enumerate() {
            for &b in &points[i + 1..] {
                let pairs = self.path(a).iter().zip(self.path(b));
                for ((a, b), largest) in pairs.zip(&mut largest) {
                    let (x, z) = (a.x - b.x, a.z - b.z);
                    let square = x * x + z * z;
                    if square > *largest || square.is_nan() {
                        *largest = square;
                    }
                }
            }
        }
        largest.into_iter().map(f64::sqrt).collect()
    }
}

/// In each frame the value that wins over all others. A missing one makes it unknown.
fn extreme(columns: impl Iterator<Item = Vec<f64>>, wins: impl Fn(&f64, &f64) -> bool) -> Vec<f64> {
    let merged = columns.reduce(|mut best, column| {
        for (best, value) in best.iter_mut().zip(column) {
            if wins(&value, best) || value.is_nan() {
                *best = value;
            }
        }
        best
    });
    merged.unwrap_or_default()
}
