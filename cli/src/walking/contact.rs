//! Which feet are on the floor, and how far they slide there.

use std::collections::BTreeMap;

use bundles::Walk;
use mocap_io::{Motion, forward_kinematics};
use ndarray::{Array2, Array3, ArrayView3};
use relfeat::{BodyMap, BodyPoint};

use super::{PlayError, WalkClips, sides};

/// The points of the feet: ankle and toes of the left foot, then of the right one.
pub const FOOT_POINTS: [BodyPoint; 4] = [
    BodyPoint::LAnkle,
    BodyPoint::LToes,
    BodyPoint::RAnkle,
    BodyPoint::RToes,
];

/// A point is as low as on the floor up to so many metres above its own low level in the clip: toes
/// clear the floor by one or two centimetres as they swing, and bend by as much as they push off.
const MAX_HEIGHT: f32 = 0.04;

/// The share of a clip's frames in which a point is below its low level: few enough that one step
/// in a clip shows it, enough that a stray marker does not.
const LOW_SHARE: f64 = 0.05;

/// Points that travel faster over the floor, in metres per second, are swung: a walk's foot swings at
/// 3 m/s, and noise of a millimetre is 0.06 m/s at 120 frames per second over two frames.
const MAX_SPEED: f64 = 0.4;

/// Contacts shorter than this, in seconds, are noise: a step rests for half a second, a running one
/// for a tenth and more.
const MIN_SECONDS: f64 = 0.05;

/// Which points of the feet rest on the floor.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Contacts {
    /// Shape `(frames, 4)`, columns as [`FOOT_POINTS`].
    pub on_floor: Array2<bool>,
}

impl Contacts {
    /// The contacts of a clip: a point is in contact while it is no more than 4 cm above its own low
    /// level, which 5 % of the clip's frames are below, and travels over the floor at no more than
    /// 0.4 m/s from the frame before to the frame after, for 0.05 s at least. A missing point is not
    /// in contact.
    ///
    /// O(frames · (joints + log frames)).
    #[must_use]
    pub fn of_clip(motion: &Motion, map: &BodyMap) -> Contacts {
        let points = foot_points(forward_kinematics(motion).view(), map);
        let n_frames = motion.n_frames();
        let hz = motion.rate.hz();
        let min_frames = (MIN_SECONDS * hz).ceil() as usize;
        let mut on_floor = Array2::from_elem((n_frames, FOOT_POINTS.len()), false);
        for point in 0..FOOT_POINTS.len() {
            let Some(level) = low_level(&points, point) else {
                continue;
            };
            let speed = |k: usize| {
                let (before, after) = (k.saturating_sub(1), (k + 1).min(n_frames - 1));
                travel(&points, point, before, after) * hz / (after - before).max(1) as f64
            };
            let mut column = on_floor.column_mut(point);
            let mut run = 0;
            for k in 0..=n_frames {
                let rests = k < n_frames
                    && points[[k, point, 1]] <= level + MAX_HEIGHT
                    && speed(k) <= MAX_SPEED;
                if rests {
                    run += 1;
                    continue;
                }
                if run >= min_frames {
                    (k - run..k).for_each(|k| column[k] = true);
                }
                run = 0;
            }
        }
        Contacts { on_floor }
    }

    /// The contacts of [`play`](super::play)'s frames: at each frame those of the clip that has the
    /// larger weight (the exit at one half), at its nearest frame; none where the body map is unknown. What the blend does to the feet
    /// does not count, so a foot that slides is still in contact.
    ///
    /// O(frames), and [`of_clip`](Self::of_clip) for each clip on the way.
    ///
    /// # Errors
    /// [`PlayError::Frames`] if the clips are not those of the graph.
    pub fn of_walk(walk: &Walk, clips: &WalkClips) -> Result<Contacts, PlayError> {
        let of_clips = clips.iter().filter_map(|(&index, clip)| {
            let map = clip.map.as_ref()?;
            Some((index, Contacts::of_clip(&clip.motion, map)))
        });
        let of_clips: BTreeMap<usize, Contacts> = of_clips.collect();
        let mut rows: Vec<bool> = Vec::new();
        for (index, piece) in walk.pieces.iter().enumerate() {
            let (entry, exit) = sides(piece);
            // The last pose is the next piece's first.
            let is_last = index + 1 == walk.pieces.len();
            for frame in (0..piece.n_frames() + usize::from(is_last)).filter_map(|k| piece.frame(k))
            {
                let (side, at) = if frame.weight < 0.5 {
                    (entry, frame.entry)
                } else {
                    (exit, frame.exit)
                };
                let missing = || PlayError::Frames {
                    clip: side.clip,
                    span: side.span.clone(),
                };
                let clip = clips.get(&side.clip).ok_or_else(missing)?;
                let k = (at.round() as usize).checked_sub(clip.first);
                let k = k.filter(|&k| k < clip.motion.n_frames());
                let k = k.ok_or_else(missing)?;
                match of_clips.get(&side.clip) {
                    Some(contacts) => rows.extend(contacts.on_floor.row(k)),
                    None => rows.extend([false; FOOT_POINTS.len()]),
                }
            }
        }
        let shape = (rows.len() / FOOT_POINTS.len(), FOOT_POINTS.len());
        // The shape fits: whole rows were pushed.
        let on_floor = Array2::from_shape_vec(shape, rows).unwrap_or_default();
        Ok(Contacts { on_floor })
    }

    /// Whether a point rests from frame `k` to the next.
    pub(super) fn stays(&self, k: usize, point: usize) -> bool {
        self.on_floor[[k, point]] && self.on_floor[[k + 1, point]]
    }
}

/// The mean speed over the floor, in metres per second, of ankles and toes while they are in contact,
/// from each frame in contact to a next one that is, too; `None` if there is none such.
///
/// O(frames · joints).
#[must_use]
pub fn skate(motion: &Motion, map: &BodyMap, contacts: &Contacts) -> Option<f64> {
    let points = foot_points(forward_kinematics(motion).view(), map);
    let n_frames = motion.n_frames().min(contacts.on_floor.nrows());
    let (mut sum, mut n) = (0.0, 0_usize);
    for k in 1..n_frames {
        for point in (0..FOOT_POINTS.len()).filter(|&point| contacts.stays(k - 1, point)) {
            let travel = travel(&points, point, k - 1, k);
            if travel.is_finite() {
                sum += travel;
                n += 1;
            }
        }
    }
    (n > 0).then(|| sum / n as f64 * motion.rate.hz())
}

/// Shape `(frames, 4, 3)`, metres, Y up, columns as [`FOOT_POINTS`]; NaN where not placed.
pub(super) fn foot_points(positions: ArrayView3<'_, f32>, map: &BodyMap) -> Array3<f32> {
    let shape = (positions.shape()[0], FOOT_POINTS.len(), 3);
    Array3::from_shape_fn(shape, |(k, point, axis)| {
        let sources = map.sources(FOOT_POINTS[point]);
        if sources.is_empty() {
            return f32::NAN;
        }
        let parts = sources.iter();
        parts
            .map(|&(joint, weight)| weight as f32 * positions[[k, joint, axis]])
            .sum()
    })
}

/// Metres over the floor.
fn travel(points: &Array3<f32>, point: usize, from: usize, to: usize) -> f64 {
    let along = |axis: usize| f64::from(points[[to, point, axis]] - points[[from, point, axis]]);
    along(0).hypot(along(2))
}

fn low_level(points: &Array3<f32>, point: usize) -> Option<f32> {
    let heights = (0..points.shape()[0]).map(|k| points[[k, point, 1]]);
    let mut heights: Vec<f32> = heights.filter(|h| h.is_finite()).collect();
    let at = (heights.len() as f64 * LOW_SHARE) as usize;
    if at >= heights.len() {
        return None;
    }
    Some(*heights.select_nth_unstable_by(at, f32::total_cmp).1)
}
