use ndarray::Array2;

use super::interpolate::{Between, frame_by_frame, row};
use super::mismatch::SkeletonMismatch;
use super::root::{Facing, Roots};
use crate::{Axis, Channel, FrameRate, Motion, OffsetFrame};

/// Why two motions cannot be blended or joined.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BlendError {
    /// The motions have different skeletons.
    #[error(transparent)]
    Skeleton(#[from] SkeletonMismatch),
    /// The motions have different rates; resample one of them.
    #[error("the first motion has {} Hz, the second {} Hz", first.hz(), second.hz())]
    Rate {
        /// Of the first motion.
        first: FrameRate,
        /// Of the second one.
        second: FrameRate,
    },
    /// Not one weight per frame.
    #[error("expected {expected} weights, one per frame, found {found}")]
    WeightCount {
        /// Frames of the path.
        expected: usize,
        /// Weights given.
        found: usize,
    },
    /// A weight that is not within 0..=1.
    #[error("expected a weight from 0 to 1 for frame {frame}, found {weight}")]
    Weight {
        /// 0-based frame of the result.
        frame: usize,
        /// The weight.
        weight: f64,
    },
    /// A position that a motion does not have.
    #[error("frame {frame} asks for position ({}, {}) of motions with {first} and {second} frames",
        position.0, position.1)]
    Position {
        /// 0-based frame of the result.
        frame: usize,
        /// Positions in the two motions, in frames.
        position: (f64, f64),
        /// Frames of the first motion.
        first: usize,
        /// Frames of the second one.
        second: usize,
    },
    /// More frames overlap than a motion has.
    #[error("expected an overlap of at most {longest} frames, found {overlap}")]
    Overlap {
        /// Frames of the shorter motion.
        longest: usize,
        /// Frames that should overlap.
        overlap: usize,
    },
    /// No frame tells how the motions lie to each other: where they should meet the root's +Z axis
    /// is vertical, or a channel is missing.
    #[error("the motions have no place and heading where they should meet")]
    NoHeading,
}

/// Weights from 0 to 1 that start and end gently, `3t² − 2t³` at even `t`. One weight is 0.
#[must_use]
pub fn smoothstep_weights(n_frames: usize) -> Vec<f64> {
    let last = n_frames.saturating_sub(1).max(1) as f64;
    (0..n_frames).map(|k| smoothstep(k as f64 / last)).collect()
}

pub(super) fn smoothstep(t: f64) -> f64 {
    t * t * (3.0 - 2.0 * t)
}

/// Blends two motions, each stretched evenly to the number of weights (spec.md i.25): 0 is `a`, 1 is
/// `b`. For a constant weight `w` the natural number of frames is `(1 − w) · frames of a + w · frames of
/// b`, and [`smoothstep_weights`] leads from one to the other. All else as in [`blend_along`].
///
/// # Errors
/// As [`blend_along`].
pub fn blend(a: &Motion, b: &Motion, weights: &[f64]) -> Result<Motion, BlendError> {
    let last = weights.len().saturating_sub(1).max(1) as f64;
    let stretched = |motion: &Motion, k: usize| {
        let end = motion.n_frames().saturating_sub(1) as f64;
        (k as f64 * end / last).min(end)
    };
    let path: Vec<(f64, f64)> = (0..weights.len())
        .map(|k| (stretched(a, k), stretched(b, k)))
        .collect();
    blend_along(a, b, &path, weights)
}

/// Blends two motions along given correspondences: frame `k` mixes position `path[k].0` of `a` with
/// position `path[k].1` of `b` (in frames, fractions as in [`Motion::sampled`]), `weights[k]` of the way from
/// `a` to `b`. The result has the rate, unit, up axis, offsets and axis frames of `a`.
///
/// Joints below the root: translations and lengths mix linearly, rotations along the shortest arc.
/// Roots: both are seen from their own facing frame, the place on the floor and the heading of the
/// first root, and mixed there like any joint. The facing frames are mixed step by step: each motion's
/// step from one frame to the next, turn and displacement in the facing frame before it, is weighted
/// (by the mean of the two frames' weights) and added up. So two walks in different directions give a
/// walk, wherever they stand. The result starts where `a` starts and faces where `a` faces.
///
/// Where a root's +Z axis is vertical the heading before counts. A frame in which a root's place or
/// heading is missing has missing roots, and the next step leads past it. Angles stay near those of the
/// frame before; roots get the channels they need ([`Motion::with_free_roots`]). O(joints · frames).
///
/// # Errors
/// [`BlendError`] if skeletons or rates differ, for weights outside 0..=1 or not as many as frames,
/// and for positions outside the motions.
pub fn blend_along(
    a: &Motion,
    b: &Motion,
    path: &[(f64, f64)],
    weights: &[f64],
) -> Result<Motion, BlendError> {
    let (a, b) = comparable(a, b)?;
    if weights.len() != path.len() {
        return Err(BlendError::WeightCount {
            expected: path.len(),
            found: weights.len(),
        });
    }
    let is_weight = |weight: &f64| (0.0..=1.0).contains(weight);
    if let Some((frame, &weight)) = weights.iter().enumerate().find(|(_, w)| !is_weight(w)) {
        return Err(BlendError::Weight { frame, weight });
    }
    let is_within = |&(i, j): &(f64, f64)| a.has_position(i) && b.has_position(j);
    if let Some(frame) = path.iter().position(|p| !is_within(p)) {
        return Err(BlendError::Position {
            frame,
            position: path[frame],
            first: a.n_frames(),
            second: b.n_frames(),
        });
    }
    let mut first = a.at_positions(path.iter().map(|p| p.0));
    let mut second = b.at_positions(path.iter().map(|p| p.1));
    let roots = Roots::new(&first);
    let walk = walk(&roots, &mut first.channels, &mut second.channels, weights);
    let mixed = mix_frames(&first, &first.channels, &second.channels, weights);
    let frames = walk.iter().enumerate();
    let channels = frame_by_frame(
        path.len(),
        mixed.ncols(),
        frames,
        |(k, facing), near, new| {
            let old = row(&mixed, k);
            new.copy_from_slice(old);
            match facing {
                Some(facing) => roots.shift(*facing, near.unwrap_or(old), new),
                None => roots.clear(new),
            }
        },
    );
    Ok(Motion { channels, ..first })
}

/// Leaves the frames of `a` and `b` in their own facing frames, and gives the facing frames of the
/// blend; `None` where one is missing.
fn walk(
    roots: &Roots,
    a: &mut Array2<f64>,
    b: &mut Array2<f64>,
    weights: &[f64],
) -> Vec<Option<Facing>> {
    let (from_a, from_b) = (into_facing_frames(roots, a), into_facing_frames(roots, b));
    let mut known: Option<(usize, Facing)> = None;
    let facing = |k: usize| {
        let (now_a, now_b) = (from_a[k]?, from_b[k]?);
        let facing = match known {
            None => now_a,
            Some((i, facing)) => {
                let step_a = now_a.step_from(from_a[i]?);
                let step_b = now_b.step_from(from_b[i]?);
                facing.then(step_a.mix(step_b, (weights[i] + weights[k]) / 2.0))
            }
        };
        known = Some((k, facing));
        Some(facing)
    };
    (0..weights.len()).map(facing).collect()
}

fn into_facing_frames(roots: &Roots, channels: &mut Array2<f64>) -> Vec<Option<Facing>> {
    let mut yaw = 0.0;
    let into_own = |mut row: ndarray::ArrayViewMut1<'_, f64>| {
        let row = row.as_slice_mut()?;
        yaw = roots
            .yaw(row)
            .or_else(|| roots.is_turned(row).then_some(yaw))?;
        let facing = roots.facing(row, yaw)?;
        let near = row.to_vec();
        roots.shift(facing.inverse(), &near, row);
        Some(facing)
    };
    channels.rows_mut().into_iter().map(into_own).collect()
}

/// Each frame of `a` mixed with the one of `b` in the same place.
pub(super) fn mix_frames(
    motion: &Motion,
    a: &Array2<f64>,
    b: &Array2<f64>,
    weights: &[f64],
) -> Array2<f64> {
    let between = Between::new(&motion.skeleton);
    let frames = weights.iter().enumerate();
    frame_by_frame(
        weights.len(),
        a.ncols(),
        frames,
        |(k, &weight), near, out| {
            let (a, b) = (row(a, k), row(b, k));
            between.mix(a, b, weight, near.unwrap_or(a), out);
        },
    )
}

/// Whether the channels of two motions mean the same, frame by frame.
pub(super) fn check(a: &Motion, b: &Motion) -> Result<(), BlendError> {
    a.skeleton.match_joints(&b.skeleton)?;
    if a.up != b.up {
        let (first, second) = (a.up, b.up);
        return Err(SkeletonMismatch::Up { first, second }.into());
    }
    if a.rate != b.rate {
        return Err(BlendError::Rate {
            first: a.rate,
            second: b.rate,
        });
    }
    Ok(())
}

/// Both motions on the skeleton of the first, in its unit, and with free roots.
pub(super) fn comparable(a: &Motion, b: &Motion) -> Result<(Motion, Motion), BlendError> {
    check(a, b)?;
    let (a, b) = (a.with_free_roots(), b.in_unit(a.unit).with_free_roots());
    let b = with_skeleton_of(&a, b);
    Ok((a, b))
}

/// `motion` on the skeleton of `like`. An Acclaim root's offset is a place, which stays.
fn with_skeleton_of(like: &Motion, mut motion: Motion) -> Motion {
    let mut channels = motion.dense().into_owned();
    let mut first = 0;
    let joints = like.skeleton.joints().iter().zip(motion.skeleton.joints());
    for (to, from) in joints {
        let is_moved = to.parent.is_none() && like.skeleton.offset_frame() == OffsetFrame::Own;
        for (channel, column) in to.channels.iter().zip(first..).filter(|_| is_moved) {
            if let Channel::Translation(axis) = channel {
                let axis = Axis::idx(*axis);
                let missing = from.offset[axis] - to.offset[axis];
                channels.column_mut(column).mapv_inplace(|v| v + missing);
            }
        }
        first += to.channels.len();
    }
    motion.channels = channels;
    motion.skeleton = like.skeleton.clone();
    motion
}
