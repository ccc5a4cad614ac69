//! Clips as a page draws and plays them: few points, integer millimetres, at the library's rate.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use mocap_io::Motion as Recorded;
use ndarray::{Array3, ArrayView3};
use relfeat::{BodyMap, BodyPoint, source_frame};

use super::document::{Clip, Figure, MISSING, Motion, Strip};
use super::figure;
use crate::align::pose::Body;
use crate::failure::Failure;
use crate::picture::strip::three_quarter;
use crate::recording::{ReadOptions, Recording, body_map, load};
use crate::source::{ClipRef, Span};
use crate::take::Take;
use crate::wire::check_span;

/// Poses of a strip.
pub const STRIP_POSES: usize = 8;

/// Degrees from which strips show a figure, to the side of where it faces.
const STRIP_CAMERA: f32 = -50.0;

/// Millimetres per unit of a strip.
const STRIP_UNIT: f32 = 10.0;

/// Greatest number of a coordinate in a strip; one more twice is a missing point.
const STRIP_MAX: f32 = 254.0;

/// Further away than this, in millimetres, nothing is.
const FARTHEST: f32 = 1e9;

/// The largest number of millimetres from the origin of a motion.
const REACH: f32 = i16::MAX as f32;

/// A clip that can be drawn.
#[derive(Clone, Debug)]
pub struct Drawn {
    /// Its file with its span, or what it is called.
    pub name: String,
    /// Frames per second of its file.
    pub source_rate: f64,
    /// Its frames in the file.
    pub span: Span,
    /// The rig that placed the body points.
    pub rig: Option<String>,
    /// What is drawn.
    pub figure: Figure,
    /// Poses per second: the library's rate, or the file's if that is lower.
    pub rate: f64,
    /// Shape `(poses, points, 3)`, metres, Y up; NaN where missing.
    pub positions: Array3<f32>,
}

/// Positions as they are stored.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Millimetres {
    /// What is added to every position.
    pub origin: [i32; 3],
    /// Shape `(poses, points, 3)`; [`MISSING`] where there is none.
    pub values: Vec<i16>,
}

impl Drawn {
    /// Reads a clip. One whose skeleton no rig fits is drawn by its own joints or markers.
    ///
    /// # Errors
    /// [`Failure`]: a file that cannot be read, a span beyond the end.
    pub fn load(clip: &ClipRef, options: &ReadOptions, rate: f64) -> Result<Drawn, Failure> {
        let loaded = load(&clip.path, options)?;
        let recording = &loaded.recording;
        let span = check_span(clip, recording.n_frames())?;
        let map = body_map(&clip.path, recording, options).ok();
        let raw = Raw {
            positions: recording.positions(),
            map: map.as_ref(),
            rate: recording.rate().0.hz(),
        };
        Ok(raw.drawn(clip.display(), span, rate, || joints_of(recording)))
    }

    /// A clip that was read; `rate` is in poses per second.
    #[must_use]
    pub fn of_take(take: &Take, rate: f64) -> Drawn {
        let raw = Raw {
            positions: take.positions.clone(),
            map: Some(&take.map),
            rate: take.rate(),
        };
        let recording = &take.loaded.recording;
        raw.drawn(take.clip.display(), take.span, rate, || {
            joints_of(recording)
        })
    }

    /// A motion that is in no file; `rate` is in poses per second.
    #[must_use]
    pub fn of_motion(name: String, motion: &Recorded, rate: f64) -> Drawn {
        let names: Vec<&str> = motion.skeleton.names().collect();
        let map = BodyMap::recognise(&names);
        let raw = Raw {
            positions: mocap_io::forward_kinematics(motion),
            map: map.as_ref(),
            rate: motion.rate.hz(),
        };
        let span = Span {
            start: 0,
            end: motion.n_frames(),
        };
        let bones: Vec<(usize, usize)> = motion.skeleton.bones().collect();
        raw.drawn(name, span, rate, || figure::of_joints(&names, &bones))
    }

    /// As a page has it, with the number of the figure there, without its motion.
    #[must_use]
    pub fn to_clip(&self, id: u32, figure: usize, label: Option<String>) -> Clip {
        Clip {
            id,
            name: self.name.clone(),
            label,
            rate: self.source_rate,
            start: self.span.start,
            end: self.span.end,
            rig: self.rig.clone(),
            figure,
            strip: self.strip(),
            motion: None,
        }
    }

    /// What is played.
    #[must_use]
    pub fn motion(&self) -> Motion {
        let Millimetres { origin, values } = self.millimetres();
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        Motion {
            rate: self.rate,
            frames: self.positions.dim().0,
            origin,
            bytes: STANDARD.encode(bytes),
        }
    }

    /// Bytes of [`Motion::bytes`].
    #[must_use]
    pub fn motion_bytes(&self) -> usize {
        (self.positions.len() * size_of::<i16>()).div_ceil(3) * 4
    }

    /// Whole millimetres from the middle of the motion, or, where it reaches further than 32 m from there, from
    /// where most of it is; what lies beyond 32 m is missing.
    #[must_use]
    pub fn millimetres(&self) -> Millimetres {
        let origin = [0, 1, 2].map(|axis| origin(self.positions.view(), axis));
        let points = self.positions.rows();
        let points = points.into_iter().flat_map(|_| [0, 1, 2]);
        let mut values: Vec<i16> = Vec::with_capacity(self.positions.len());
        for (&metres, axis) in self.positions.iter().zip(points) {
            // In 64 bits, so that half millimetres stay right far from the file's origin.
            let value = f64::from(metres) * 1000.0 - f64::from(origin[axis]);
            let fits = value.is_finite() && value.abs() <= f64::from(REACH);
            values.push(if fits { value.round() as i16 } else { MISSING });
        }
        // A point is missing as a whole.
        for point in values.chunks_exact_mut(3) {
            if point.contains(&MISSING) {
                point.fill(MISSING);
            }
        }
        Millimetres { origin, values }
    }

    /// A few poses side by side; `None` without frames or points.
    #[must_use]
    pub fn strip(&self) -> Option<Strip> {
        let (n_frames, n_points, _) = self.positions.dim();
        if n_frames == 0 || n_points == 0 {
            return None;
        }
        let poses = STRIP_POSES.min(n_frames);
        let floor = floor(self.positions.view());
        let (sin, cos) = self.camera().to_radians().sin_cos();
        let mut bytes = Vec::with_capacity(poses * n_points * 2);
        for k in 0..poses {
            let frame = k * (n_frames - 1) / (poses - 1).max(1);
            let seen = (0..n_points).map(|point| {
                let [x, y, z] = [0, 1, 2].map(|axis| self.positions[[frame, point, axis]] * 1000.0);
                let is_there = [x, y, z].iter().all(|c| c.abs() < FARTHEST);
                is_there.then_some([x * cos - z * sin, y - floor])
            });
            let seen: Vec<Option<[f32; 2]>> = seen.collect();
            let across = seen.iter().flatten().map(|p| p[0]);
            let (low, high) = across.fold((f32::MAX, f32::MIN), |(low, high), x| {
                (low.min(x), high.max(x))
            });
            let middle = f32::midpoint(low, high);
            let byte = |value: f32| value.round().clamp(0.0, STRIP_MAX) as u8;
            bytes.extend(seen.iter().flat_map(|point| match point {
                None => [u8::MAX; 2],
                Some([x, y]) => [
                    byte((x - middle) / STRIP_UNIT + 128.0),
                    byte(y / STRIP_UNIT),
                ],
            }));
        }
        Some(Strip {
            poses,
            bytes: STANDARD.encode(bytes),
        })
    }

    /// Degrees of the strip's camera, by the first pose that has hips.
    fn camera(&self) -> f32 {
        let point = |name: &str| self.figure.points.iter().position(|p| p == name);
        let hips = [BodyPoint::LHip, BodyPoint::RHip].map(|hip| point(hip.name()));
        let [Some(left), Some(right)] = hips else {
            return STRIP_CAMERA;
        };
        let turns = self.positions.outer_iter().map(|pose| {
            let pose = pose.insert_axis(ndarray::Axis(0));
            three_quarter(pose, left, right, STRIP_CAMERA)
        });
        let mut turns = turns.filter(|turn| turn.is_finite());
        turns.next().unwrap_or(STRIP_CAMERA)
    }
}

/// A recording before it is thinned out.
struct Raw<'a> {
    positions: Array3<f32>,
    map: Option<&'a BodyMap>,
    rate: f64,
}

impl Raw<'_> {
    fn drawn(&self, name: String, span: Span, rate: f64, joints: impl FnOnce() -> Figure) -> Drawn {
        let rate = rate.min(self.rate);
        let frames = (0..).map(|k| span.start.saturating_add(source_frame(k, self.rate, rate)));
        let frames: Vec<usize> = frames.take_while(|&frame| frame < span.end).collect();
        let (figure, positions) = match self.map {
            Some(map) => (figure::of_body(map), self.body_points(map, &frames)),
            None => {
                let thinned = self.positions.select(ndarray::Axis(0), &frames);
                (joints(), thinned)
            }
        };
        Drawn {
            name,
            source_rate: self.rate,
            span,
            rig: self.map.map(|map| map.rig().to_owned()),
            figure,
            rate,
            positions,
        }
    }

    /// Shape `(frames, 24, 3)`.
    fn body_points(&self, map: &BodyMap, frames: &[usize]) -> Array3<f32> {
        let body = Body {
            positions: self.positions.view(),
            map,
        };
        let mut points = Array3::from_elem((frames.len(), BodyPoint::COUNT, 3), f32::NAN);
        for (k, &frame) in frames.iter().enumerate() {
            for (p, &point) in BodyPoint::ALL.iter().enumerate() {
                for (axis, metres) in body.point(frame, point).into_iter().enumerate() {
                    points[[k, p, axis]] = metres;
                }
            }
        }
        points
    }
}

fn joints_of(recording: &Recording) -> Figure {
    figure::of_joints(&recording.names(), &recording.bones())
}

/// In millimetres: the middle between the least and the greatest coordinate if both are within reach of it,
/// else the median.
fn origin(positions: ArrayView3<'_, f32>, axis: usize) -> i32 {
    let coordinates = positions.index_axis_move(ndarray::Axis(2), axis);
    let millimetres = coordinates.iter().map(|metres| metres * 1000.0);
    let mut known: Vec<f32> = millimetres.filter(|mm| mm.abs() < FARTHEST).collect();
    let bounds = known.iter().fold((f32::MAX, f32::MIN), |(low, high), &mm| {
        (low.min(mm), high.max(mm))
    });
    if known.is_empty() {
        return 0;
    }
    if bounds.1 - bounds.0 < 2.0 * (REACH - 1.0) {
        return f32::midpoint(bounds.0, bounds.1).round() as i32;
    }
    let middle = known.len() / 2;
    let (_, median, _) = known.select_nth_unstable_by(middle, f32::total_cmp);
    median.round() as i32
}

/// The height in millimetres that the lowest points of one pose in ten are below: a stray marker is no floor.
fn floor(positions: ArrayView3<'_, f32>) -> f32 {
    let lowest = positions.outer_iter().map(|pose| {
        let heights = pose.column(1).into_iter().map(|metres| metres * 1000.0);
        let known = heights.filter(|mm| mm.abs() < FARTHEST);
        known.fold(f32::MAX, f32::min)
    });
    let mut lowest: Vec<f32> = lowest.filter(|&mm| mm < FARTHEST).collect();
    if lowest.is_empty() {
        return 0.0;
    }
    let tenth = lowest.len() / 10;
    *lowest.select_nth_unstable_by(tenth, f32::total_cmp).1
}

#[cfg(test)]
mod tests;
