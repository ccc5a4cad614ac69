use std::borrow::Cow;

use nalgebra::UnitQuaternion;
use ndarray::Array2;

use crate::kinematics::rotations;
use crate::rotation::{Euler, nearest_angle, slerp};
use crate::{Channel, FrameRate, Motion, RateSource, Skeleton};

/// Frames nearer to a source frame than this are that frame: it is what rounding leaves of a time.
const SAME_FRAME: f64 = 1e-9;

/// Where the frames of another rate lie, counted in frames of the old one.
pub(super) fn times(n_frames: usize, from: FrameRate, to: FrameRate) -> Vec<f64> {
    let Some(last) = n_frames.checked_sub(1).map(|last| last as f64) else {
        return Vec::new();
    };
    let n_frames = ((last * to.hz() / from.hz() + SAME_FRAME).floor() as usize).saturating_add(1);
    let time = |k: usize| {
        let time = k as f64 * from.hz() / to.hz();
        let whole = time.round();
        let is_whole = (time - whole).abs() <= SAME_FRAME;
        if is_whole { whole } else { time }.min(last)
    };
    (0..n_frames).map(time).collect()
}

impl Motion {
    /// The same motion at another rate: frame `k` is the motion at `k / rate` seconds, as long as that
    /// is not after the last frame. Nothing is smoothed, so a lower rate may alias. The result takes eight
    /// bytes per channel and new frame: a rate that comes from a user wants a bound.
    ///
    /// Between frames as [`Motion::sampled`] says; times of source frames give these frames to the bit,
    /// and the same rate gives the same motion. O(joints · new frames), in time and in memory.
    #[must_use]
    pub fn resample(&self, rate: FrameRate) -> Motion {
        let resampled = |motion: Motion| Motion {
            rate,
            rate_source: RateSource::Given,
            ..motion
        };
        if rate == self.rate {
            return resampled(self.clone());
        }
        let times = times(self.n_frames(), self.rate, rate);
        resampled(self.at_positions(times.into_iter()))
    }

    /// The motion at any positions, counted in frames: 2.25 is a quarter of the way from frame 2 to
    /// frame 3. Positions may repeat and run backwards; the rate stays. `None` if a position is not
    /// within `0..=n_frames − 1`.
    ///
    /// Whole positions give their frame to the bit. Between two frames translations and lengths move on
    /// a straight line and the rotation of a joint on the shortest arc (slerp). It is written in the
    /// joint's own channels; of all angles that mean it those nearest to the previous frame of the
    /// result, so that no angle jumps that did not jump before.
    ///
    /// **Deviation**: joints whose rotation channels are not three different axes cannot hold every
    /// rotation between two; each of their angles turns evenly, the shorter way round. With one axis
    /// that is the arc itself.
    ///
    /// A value is missing (NaN) where it is in one of the two frames, a rotation of three axes as soon
    /// as one of its angles is. O(joints · positions).
    #[must_use]
    pub fn sampled(&self, positions: &[f64]) -> Option<Motion> {
        let is_within = |&position: &f64| self.has_position(position);
        let all_within = positions.iter().all(is_within);
        all_within.then(|| self.at_positions(positions.iter().copied()))
    }

    pub(super) fn has_position(&self, position: f64) -> bool {
        position >= 0.0
            && position < self.n_frames() as f64
            && position.ceil() < self.n_frames() as f64
    }

    pub(super) fn at_positions(&self, positions: impl ExactSizeIterator<Item = f64>) -> Motion {
        let source = self.dense();
        let between = Between::new(&self.skeleton);
        let (mut from, mut to) = (between.pose(), between.pose());
        let n_frames = positions.len();
        let frames = frame_by_frame(
            n_frames,
            source.ncols(),
            positions,
            |position, near, out| {
                let (frame, t) = (position.floor() as usize, position.fract());
                let a = row(&source, frame);
                if t == 0.0 {
                    out.copy_from_slice(a);
                    return;
                }
                let b = row(&source, frame + 1);
                // Neighbours in time share frames, and turning angles into rotations costs most.
                if to.frame == Some(frame) {
                    std::mem::swap(&mut from, &mut to);
                }
                between.turn(&mut from, frame, a);
                between.turn(&mut to, frame + 1, b);
                between.mix_turned([a, b], [&from, &to], t, near.unwrap_or(a), out);
            },
        );
        Motion {
            channels: frames,
            ..self.without_frames()
        }
    }

    /// The channels in standard layout, with as many columns as the skeleton asks for.
    pub(crate) fn dense(&self) -> Cow<'_, Array2<f64>> {
        let n_channels = self.skeleton.n_channels();
        if self.channels.ncols() == n_channels && self.channels.is_standard_layout() {
            return Cow::Borrowed(&self.channels);
        }
        let mut channels = Array2::zeros((self.n_frames(), n_channels));
        for (values, mut row) in self.rows().zip(channels.rows_mut()) {
            row.assign(&ndarray::ArrayView1::from(&values[..]));
        }
        Cow::Owned(channels)
    }
}

/// A frame of an array in standard layout.
pub(super) fn row(channels: &Array2<f64>, frame: usize) -> &[f64] {
    let n_channels = channels.ncols();
    let values = channels.as_slice().expect("in standard layout");
    &values[frame * n_channels..][..n_channels]
}

/// Frames that are written one after the other from `sources`. Each knows the one before, which
/// its angles are to be near.
pub(super) fn frame_by_frame<T>(
    n_frames: usize,
    n_channels: usize,
    sources: impl Iterator<Item = T>,
    mut write: impl FnMut(T, Option<&[f64]>, &mut [f64]),
) -> Array2<f64> {
    let mut values = vec![0.0; n_frames.saturating_mul(n_channels)];
    for (k, source) in sources.take(n_frames).enumerate() {
        let (before, rest) = values.split_at_mut(k * n_channels);
        let near = k.checked_sub(1).map(|i| &before[i * n_channels..]);
        write(source, near, &mut rest[..n_channels]);
    }
    Array2::from_shape_vec((n_frames, n_channels), values)
        .expect("as many values as the shape says")
}

/// Mixes frames of one skeleton.
pub(super) struct Between {
    /// Translations and lengths.
    lines: Vec<usize>,
    /// Angles of joints that cannot hold every rotation.
    angles: Vec<usize>,
    eulers: Vec<Euler>,
}

impl Between {
    pub(super) fn new(skeleton: &Skeleton) -> Between {
        let (mut lines, mut angles, mut eulers) = (Vec::new(), Vec::new(), Vec::new());
        let mut first = 0;
        for joint in skeleton.joints() {
            let factors = rotations(joint, first);
            match Euler::new(&factors) {
                Some(euler) => eulers.push(euler),
                None => angles.extend(factors.iter().map(|&(_, column)| column)),
            }
            let columns = joint.channels.iter().zip(first..);
            lines.extend(columns.filter_map(|(channel, column)| {
                (!matches!(channel, Channel::Rotation(_))).then_some(column)
            }));
            first += joint.channels.len();
        }
        Between {
            lines,
            angles,
            eulers,
        }
    }

    fn pose(&self) -> Pose {
        Pose {
            frame: None,
            rotations: vec![UnitQuaternion::identity(); self.eulers.len()],
        }
    }

    /// Makes `pose` the one of `frame`, unless it is.
    fn turn(&self, pose: &mut Pose, frame: usize, row: &[f64]) {
        if pose.frame != Some(frame) {
            pose.frame = Some(frame);
            for (rotation, euler) in pose.rotations.iter_mut().zip(&self.eulers) {
                *rotation = euler.quaternion(row);
            }
        }
    }

    /// Writes the frame at `t` of the way from `a` to `b`, with angles near those of `near`.
    pub(super) fn mix(&self, a: &[f64], b: &[f64], t: f64, near: &[f64], out: &mut [f64]) {
        let (mut from, mut to) = (self.pose(), self.pose());
        if t > 0.0 && t < 1.0 {
            self.turn(&mut from, 0, a);
            self.turn(&mut to, 1, b);
        }
        self.mix_turned([a, b], [&from, &to], t, near, out);
    }

    fn mix_turned(
        &self,
        [a, b]: [&[f64]; 2],
        [from, to]: [&Pose; 2],
        t: f64,
        near: &[f64],
        out: &mut [f64],
    ) {
        for &column in &self.lines {
            out[column] = line(a[column], b[column], t);
        }
        for &column in &self.angles {
            let to = nearest_angle(b[column], a[column]);
            out[column] = nearest_angle(line(a[column], to, t), near[column]);
        }
        let rotations = from.rotations.iter().zip(&to.rotations);
        for (euler, (&from, &to)) in self.eulers.iter().zip(rotations) {
            match t {
                0.0 => euler.write_degrees(euler.degrees(a), near, out),
                1.0 => euler.write_degrees(euler.degrees(b), near, out),
                _ => {
                    let rotation = slerp(from, to, t).to_rotation_matrix();
                    euler.write(rotation.matrix(), near, out);
                }
            }
        }
    }
}

/// The rotations of a frame.
struct Pose {
    frame: Option<usize>,
    /// One for each joint that can hold every rotation.
    rotations: Vec<UnitQuaternion<f64>>,
}

/// `a` at 0, `b` at 1, both to the bit.
fn line(a: f64, b: f64, t: f64) -> f64 {
    if t == 1.0 { b } else { a + t * (b - a) }
}
