//! What a doctor looks at: size, floor, feet, jumps.

use ndarray::{ArrayView3, s};
use relfeat::{BodyMap, BodyPoint};
use serde::Serialize;

/// Share of the frames that may lie below what counts as the lowest point: a few frames of noise
/// must not move the floor.
const NOISE_SHARE: f64 = 0.01;
/// How far from zero the floor may be, in metres: ankle and toe joints stand a few centimetres above
/// it, markers on shoes a little more.
const FLOOR_OFF: f32 = 0.15;
/// A foot this near its lowest height is down, in metres.
const DOWN: f32 = 0.03;
/// A frame in which the joints move this far on average, in metres, is a jump, if it is also this
/// many times the usual way.
const JUMP: f32 = 0.1;
const JUMP_RATIO: f32 = 10.0;
/// Jumps that are listed one by one.
const JUMPS_LISTED: usize = 10;

/// What the motion itself says about unit, axes and quality.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Checkup {
    /// Height from the lowest to the highest point when most upright, in metres.
    pub stature_m: Option<f32>,
    /// The feet and the floor, if the rig has feet.
    pub floor: Option<Floor>,
    /// Frames that do not follow from the frame before, as after a T-pose put in front.
    pub jumps: Jumps,
}

/// Where the floor is and how the feet treat it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Floor {
    /// Lowest height of the left foot, in metres.
    pub left_m: f32,
    /// Lowest height of the right foot, in metres.
    pub right_m: f32,
    /// Median speed of a foot over the floor while it is down, in metres per second; none if no foot
    /// ever is. The median, because a foot that swings low over the floor counts as down, too.
    pub skate_m_s: Option<f32>,
    /// Whether the floor is about where zero is, for both feet.
    pub plausible: bool,
}

/// Frames that do not follow from the frame before.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Jumps {
    /// How many.
    pub count: usize,
    /// The first of them, 0-based.
    pub frames: Vec<usize>,
}

/// Looks at `positions`, shape `(frames, joints, 3)`, metres, Y up. O(frames · joints), and sorting
/// the frames.
pub(super) fn check_up(
    positions: ArrayView3<'_, f32>,
    map: Option<&BodyMap>,
    rate_hz: f64,
) -> Checkup {
    // Joints that are no body points, such as the helpers of a mesh, may be anywhere.
    let body: Option<Vec<Vec<[f32; 3]>>> = map.map(|map| {
        let points = BodyPoint::ALL.into_iter();
        points.filter_map(|p| path(positions, map, p)).collect()
    });
    let heights = |frame: usize| -> Vec<f32> {
        match &body {
            Some(body) => body.iter().map(|path| path[frame][1]).collect(),
            None => positions.slice(s![frame, .., 1]).to_vec(),
        }
    };
    Checkup {
        stature_m: stature((0..positions.dim().0).map(heights)),
        floor: map.and_then(|map| floor(positions, map, rate_hz)),
        jumps: jumps(positions),
    }
}

/// Value below which `share` of the sorted finite values lie.
fn quantile(mut values: Vec<f32>, share: f64) -> Option<f32> {
    values.retain(|v| v.is_finite());
    values.sort_unstable_by(f32::total_cmp);
    let last = values.len().checked_sub(1)?;
    values.get((last as f64 * share) as usize).copied()
}

/// From the heights of a body in each frame.
fn stature(heights: impl Iterator<Item = Vec<f32>>) -> Option<f32> {
    let extents = heights.filter_map(|heights| {
        let known = || heights.iter().copied().filter(|y| y.is_finite());
        Some(known().reduce(f32::max)? - known().reduce(f32::min)?)
    });
    quantile(extents.collect(), 1.0 - NOISE_SHARE)
}

/// A body point's path; `None` if the rig does not place it.
fn path(positions: ArrayView3<'_, f32>, map: &BodyMap, point: BodyPoint) -> Option<Vec<[f32; 3]>> {
    let sources = map.sources(point);
    let place = |frame: usize| {
        std::array::from_fn(|axis| {
            let part =
                |&(joint, weight): &(usize, f64)| weight as f32 * positions[[frame, joint, axis]];
            sources.iter().map(part).sum()
        })
    };
    (!sources.is_empty()).then(|| (0..positions.dim().0).map(place).collect())
}

fn floor(positions: ArrayView3<'_, f32>, map: &BodyMap, rate_hz: f64) -> Option<Floor> {
    use BodyPoint::{LAnkle, LToes, RAnkle, RToes};
    let foot = |toes, ankle| path(positions, map, toes).or_else(|| path(positions, map, ankle));
    let (left, right) = (foot(LToes, LAnkle)?, foot(RToes, RAnkle)?);
    let lowest = |path: &[[f32; 3]]| quantile(path.iter().map(|p| p[1]).collect(), NOISE_SHARE);
    let (left_m, right_m) = (lowest(&left)?, lowest(&right)?);
    let mut steps: Vec<f32> = Vec::new();
    for (path, low) in [(&left, left_m), (&right, right_m)] {
        let is_down = |p: &[f32; 3]| p[1] <= low + DOWN;
        let pairs = path.windows(2).filter(|pair| pair.iter().all(is_down));
        steps.extend(pairs.map(|pair| (pair[1][0] - pair[0][0]).hypot(pair[1][2] - pair[0][2])));
    }
    Some(Floor {
        left_m,
        right_m,
        skate_m_s: quantile(steps, 0.5).map(|step| step * rate_hz as f32),
        plausible: left_m.abs() <= FLOOR_OFF && right_m.abs() <= FLOOR_OFF,
    })
}

fn jumps(positions: ArrayView3<'_, f32>) -> Jumps {
    let n_frames = positions.dim().0;
    let way = |frame: usize| {
        let (before, after) = (
            positions.slice(s![frame - 1, .., ..]),
            positions.slice(s![frame, .., ..]),
        );
        let joints = before.outer_iter().zip(after.outer_iter());
        let ways = joints
            .map(|(a, b)| (0..3).map(|i| (b[i] - a[i]).powi(2)).sum::<f32>().sqrt())
            .filter(|way| way.is_finite());
        let (sum, n) = ways.fold((0.0, 0u32), |(sum, n), way| (sum + way, n + 1));
        if n > 0 { sum / n as f32 } else { 0.0 }
    };
    let ways: Vec<f32> = (1..n_frames).map(way).collect();
    let usual = quantile(ways.clone(), 0.5).unwrap_or(0.0);
    let is_jump = |way: f32| way > JUMP && way > JUMP_RATIO * usual;
    let mut frames: Vec<usize> = (1..n_frames).filter(|&f| is_jump(ways[f - 1])).collect();
    let count = frames.len();
    frames.truncate(JUMPS_LISTED);
    Jumps { count, frames }
}

#[cfg(test)]
mod tests {
    use ndarray::Array3;
    use relfeat::Rig;

    use super::*;

    /// Two feet and a head, `height` above the feet.
    fn walker(n_frames: usize, floor: f32, height: f32) -> Array3<f32> {
        Array3::from_shape_fn((n_frames, 3, 3), |(frame, joint, axis)| {
            match (joint, axis) {
                (0 | 1, 1) => floor,
                (2, 1) => floor + height,
                (_, 2) => frame as f32 * 0.01,
                _ => 0.0,
            }
        })
    }

    fn map() -> BodyMap {
        let toml = "name = 'r'\n[points]\nltoes = ['l']\nrtoes = ['r']\nhead = ['h']";
        BodyMap::with_rig(&["l", "r", "h"], &Rig::from_toml(toml).unwrap())
    }

    #[test]
    fn a_figure_that_slides_over_the_floor_is_measured() {
        let found = check_up(walker(50, 0.02, 1.5).view(), Some(&map()), 100.0);
        assert!((found.stature_m.unwrap() - 1.5).abs() < 1e-6);
        let floor = found.floor.unwrap();
        assert_eq!((floor.left_m, floor.right_m), (0.02, 0.02));
        assert!((floor.skate_m_s.unwrap() - 1.0).abs() < 1e-4);
        assert!(floor.plausible);
        assert_eq!(found.jumps.count, 0);
    }

    #[test]
    fn a_floor_far_from_zero_is_not_plausible() {
        let found = check_up(walker(50, -0.9, 1.5).view(), Some(&map()), 100.0);
        assert!(!found.floor.unwrap().plausible);
    }

    #[test]
    fn a_pose_put_in_front_is_a_jump() {
        let mut positions = walker(50, 0.0, 1.5);
        positions.slice_mut(s![0, .., 0]).fill(2.0);
        let found = check_up(positions.view(), None, 100.0);
        assert_eq!(found.jumps.frames, [1]);
        assert_eq!(found.floor, None);
    }

    #[test]
    fn nothing_and_gaps_are_no_trouble() {
        assert_eq!(
            check_up(walker(0, 0.0, 1.5).view(), Some(&map()), 100.0),
            Checkup::default()
        );
        let missing = Array3::from_elem((5, 3, 3), f32::NAN);
        assert_eq!(
            check_up(missing.view(), Some(&map()), 100.0),
            Checkup::default()
        );
    }
}
