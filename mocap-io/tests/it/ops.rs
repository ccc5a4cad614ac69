//! What the tests of motion operations share: random motions of both kinds, and positions by the book.

use mocap_io::{Channel, Motion, OffsetFrame};
use proptest::prelude::*;
use proptest::sample::select;

use crate::naive;
use crate::strategies::{Freedom, any_way_up, motion, skeleton};

/// Positions of up to some kilometres, summed and turned a few dozen times in `f64`.
pub(crate) const METRES: f64 = 1e-8;

/// Right angles, which meet gimbal locks and half turns, and any others.
pub(crate) fn any_value() -> impl Strategy<Value = f64> + Clone {
    prop_oneof![3 => -400.0..400.0, 1 => -1.0..1.0, 1 => select(vec![0.0, 90.0, -90.0, 180.0])]
        .boxed()
}

/// Angles that leave no doubt about the shorter way.
pub(crate) fn small_value() -> impl Strategy<Value = f64> + Clone {
    (-80.0..80.0).boxed()
}

/// A motion of either kind, with any way up.
pub(crate) fn any_motion(
    value: impl Strategy<Value = f64> + Clone + 'static,
    max_frames: usize,
) -> impl Strategy<Value = Motion> {
    let bvh = skeleton(OffsetFrame::Parent, Freedom::of_bvh());
    let acclaim = skeleton(OffsetFrame::Own, Freedom::of_acclaim());
    let either = prop_oneof![
        motion(bvh, value.clone(), max_frames),
        motion(acclaim, value, max_frames)
    ];
    any_way_up(either)
}

/// Of each frame, where every joint is: metres, Y up.
pub(crate) fn places(motion: &Motion) -> Vec<Vec<[f64; 3]>> {
    naive::positions(motion)
}

pub(crate) fn check_places(
    found: &[Vec<[f64; 3]>],
    expected: &[Vec<[f64; 3]>],
) -> Result<(), TestCaseError> {
    prop_assert_eq!(found.len(), expected.len());
    for (frame, (found, expected)) in found.iter().zip(expected).enumerate() {
        prop_assert_eq!(found.len(), expected.len());
        for (joint_idx, (a, b)) in found.iter().zip(expected).enumerate() {
            for axis in 0..3 {
                prop_assert!(
                    (a[axis] - b[axis]).abs() <= METRES,
                    "frame {}, joint {}: {:?} instead of {:?}",
                    frame,
                    joint_idx,
                    a,
                    b
                );
            }
        }
    }
    Ok(())
}

/// `[x, y, z]` turned about Y and moved on the floor.
pub(crate) fn moved([x, y, z]: [f64; 3], yaw: f64, [to_x, to_z]: [f64; 2]) -> [f64; 3] {
    let (s, c) = yaw.sin_cos();
    [c * x + s * z + to_x, y, -s * x + c * z + to_z]
}

pub(crate) fn all_moved(places: &[Vec<[f64; 3]>], yaw: f64, to: [f64; 2]) -> Vec<Vec<[f64; 3]>> {
    let frame = |frame: &Vec<[f64; 3]>| frame.iter().map(|&p| moved(p, yaw, to)).collect();
    places.iter().map(frame).collect()
}

pub(crate) fn bits(motion: &Motion) -> Vec<u64> {
    motion.channels.iter().map(|v| v.to_bits()).collect()
}

/// The channels of every joint: joint, channel, column.
pub(crate) fn columns(motion: &Motion) -> Vec<(usize, Channel, usize)> {
    let joints = motion.skeleton.joints().iter().enumerate();
    let all = joints.flat_map(|(j, joint)| joint.channels.iter().map(move |&c| (j, c)));
    all.enumerate()
        .map(|(column, (j, c))| (j, c, column))
        .collect()
}
