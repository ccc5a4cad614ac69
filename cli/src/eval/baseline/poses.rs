use mocap_io::{Channel, Motion, local_rotations};
use nalgebra::{Matrix3, Vector3};
use ndarray::{Array2, Axis, concatenate, s};
use relfeat::BodyPoint;

use crate::align::pose::Body;
use crate::take::Take;

/// The poses of a clip at some of its frames, in two forms.
#[derive(Clone, Debug)]
pub struct Poses {
    /// A unit quaternion w, x, y, z for each joint that turns, the root left out; `None` for markers.
    pub rotations: Option<Named>,
    /// x, y, z of each body point in the frame of the root, in total lengths of the limbs; `None` where
    /// root, hips or limbs are not placed.
    pub coordinates: Option<Named>,
}

/// Numbers per frame that belong to names.
#[derive(Clone, Debug, PartialEq)]
pub struct Named {
    /// Joints or body points.
    pub names: Vec<String>,
    /// Shape `(frames, names · numbers each)`.
    pub values: Array2<f64>,
}

impl Poses {
    /// The poses of a clip at `frames` of its file.
    #[must_use]
    pub fn of(take: &Take, frames: &[usize]) -> Poses {
        let motion = take.loaded.recording.motion();
        Poses {
            rotations: motion.and_then(|motion| rotations(motion, frames)),
            coordinates: coordinates(take, frames),
        }
    }
}

impl Named {
    /// The values of the names that both have, in the order of this one's; `None` if there are none.
    #[must_use]
    pub fn common(&self, other: &Named) -> Option<(Array2<f64>, Array2<f64>)> {
        let width = self.values.ncols().checked_div(self.names.len())?;
        let mut columns = [Vec::new(), Vec::new()];
        for (i, name) in self.names.iter().enumerate() {
            if let Some(j) = other.names.iter().position(|n| n == name) {
                columns[0].extend(i * width..(i + 1) * width);
                columns[1].extend(j * width..(j + 1) * width);
            }
        }
        let [own, others] = columns;
        (!own.is_empty()).then(|| {
            let own = self.values.select(Axis(1), &own);
            (own, other.values.select(Axis(1), &others))
        })
    }
}

fn rotations(motion: &Motion, frames: &[usize]) -> Option<Named> {
    let all = local_rotations(motion).mapv(f64::from);
    let joints = motion.skeleton.joints().iter().enumerate();
    let turn = |channel: &Channel| matches!(channel, Channel::Rotation(_));
    let turning: Vec<_> = joints
        .filter(|(_, joint)| joint.parent.is_some() && joint.channels.iter().any(turn))
        .collect();
    let of_joint = |&(joint, _): &(usize, _)| {
        let of_joint = all.slice(s![.., joint, ..]);
        of_joint.select(Axis(0), frames)
    };
    let blocks: Vec<Array2<f64>> = turning.iter().map(of_joint).collect();
    let views: Vec<_> = blocks.iter().map(|block| block.view()).collect();
    Some(Named {
        names: turning
            .iter()
            .map(|(_, joint)| joint.name.clone())
            .collect(),
        values: concatenate(Axis(1), &views).ok()?,
    })
}

fn coordinates(take: &Take, frames: &[usize]) -> Option<Named> {
    let body = Body {
        positions: take.positions.view(),
        map: &take.map,
    };
    let points: Vec<BodyPoint> = BodyPoint::ALL
        .into_iter()
        .filter(|&point| take.map.places(point) && point != BodyPoint::Root)
        .collect();
    let scale = 1.0 / f64::from(body.size(&points, frames)?);
    let mut values = Array2::from_elem((frames.len(), 3 * points.len()), f64::NAN);
    for (&frame, mut row) in frames.iter().zip(values.rows_mut()) {
        let at = |point| Vector3::from(body.point(frame, point).map(f64::from));
        let Some(turn) = pelvis(at) else { continue };
        let root = at(BodyPoint::Root);
        for (k, &point) in points.iter().enumerate() {
            let seen = turn * (at(point) - root) * scale;
            row.slice_mut(s![3 * k..3 * k + 3])
                .assign(&ndarray::aview1(seen.as_slice()));
        }
    }
    // A point that is missing in one frame would close the frame for all.
    let n_points = points.len();
    let is_missing = |k: usize| {
        values
            .slice(s![.., 3 * k..3 * k + 3])
            .iter()
            .any(|v| v.is_nan())
    };
    let kept: Vec<usize> = (0..n_points).filter(|&k| !is_missing(k)).collect();
    let columns: Vec<usize> = kept.iter().flat_map(|k| 3 * k..3 * k + 3).collect();
    (!kept.is_empty()).then(|| Named {
        names: kept.iter().map(|&k| points[k].name().to_owned()).collect(),
        values: values.select(Axis(1), &columns),
    })
}

/// Sides this close to each other, in metres, do not tell a direction.
const MIN_LENGTH: f64 = 0.01;

/// Turns directions into those of the pelvis, where left is +X and up about +Y: the triangle of root
/// and hips, which turns with the root in any rig. Where the root lies between the hips, the spine
/// says where up is.
fn pelvis(at: impl Fn(BodyPoint) -> Vector3<f64>) -> Option<Matrix3<f64>> {
    let [left, right] = [at(BodyPoint::LHip), at(BodyPoint::RHip)];
    let across = (left - right).try_normalize(MIN_LENGTH)?;
    let root = at(BodyPoint::Root);
    let ups = [
        root - (left + right) / 2.0,
        at(BodyPoint::Belly) - root,
        at(BodyPoint::Chest) - root,
        at(BodyPoint::Neck) - root,
    ];
    let up = ups.into_iter().find_map(|up| {
        let upright = up - across * up.dot(&across);
        upright.try_normalize(MIN_LENGTH)
    })?;
    let front = across.cross(&up);
    Some(Matrix3::from_rows(&[
        across.transpose(),
        up.transpose(),
        front.transpose(),
    ]))
}
