//! Textbook forward kinematics: one homogeneous 4×4 matrix per step, multiplied out one by one.

use mocap_io::{Axis, Channel, Motion, OffsetFrame, UpAxis};

type Matrix = [[f64; 4]; 4];

const IDENTITY: Matrix = [
    [1.0, 0.0, 0.0, 0.0],
    [0.0, 1.0, 0.0, 0.0],
    [0.0, 0.0, 1.0, 0.0],
    [0.0, 0.0, 0.0, 1.0],
];

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let mut c = [[0.0; 4]; 4];
    for i in 0..4 {
        for j in 0..4 {
            for k in 0..4 {
                c[i][j] += a[i][k] * b[k][j];
            }
        }
    }
    c
}

fn product_of(factors: &[Matrix]) -> Matrix {
    factors
        .iter()
        .fold(IDENTITY, |so_far, factor| product(&so_far, factor))
}

fn shift([x, y, z]: [f64; 3]) -> Matrix {
    [
        [1.0, 0.0, 0.0, x],
        [0.0, 1.0, 0.0, y],
        [0.0, 0.0, 1.0, z],
        [0.0, 0.0, 0.0, 1.0],
    ]
}

fn turn(axis: Axis, degrees: f64) -> Matrix {
    let (s, c) = (degrees * std::f64::consts::PI / 180.0).sin_cos();
    match axis {
        Axis::X => [
            [1.0, 0.0, 0.0, 0.0],
            [0.0, c, -s, 0.0],
            [0.0, s, c, 0.0],
            [0.0, 0.0, 0.0, 1.0],
        ],
        Axis::Y => [
            [c, 0.0, s, 0.0],
            [0.0, 1.0, 0.0, 0.0],
            [-s, 0.0, c, 0.0],
            [0.0, 0.0, 0.0, 1.0],
        ],
        Axis::Z => [
            [c, -s, 0.0, 0.0],
            [s, c, 0.0, 0.0],
            [0.0, 0.0, 1.0, 0.0],
            [0.0, 0.0, 0.0, 1.0],
        ],
    }
}

/// Of each frame, the position of every joint in metres.
pub(crate) fn positions(motion: &Motion) -> Vec<Vec<[f64; 3]>> {
    (0..motion.n_frames())
        .map(|frame| pose(motion, frame))
        .collect()
}

fn pose(motion: &Motion, frame: usize) -> Vec<[f64; 3]> {
    let joints = motion.skeleton.joints();
    let mut column = 0;
    let mut frames: Vec<Matrix> = Vec::new();
    for joint in joints {
        let mut values = Vec::new();
        for &channel in &joint.channels {
            values.push((channel, motion.channels[[frame, column]]));
            column += 1;
        }
        let outer = joint.parent.map_or(IDENTITY, |p| frames[p]);
        frames.push(match motion.skeleton.offset_frame() {
            OffsetFrame::Parent => {
                let mut offset = joint.offset;
                let mut turns = Vec::new();
                for (channel, value) in values {
                    match channel {
                        Channel::Translation(axis) => offset[axis.idx()] = value,
                        Channel::Rotation(axis) => turns.push(turn(axis, value)),
                        Channel::Length => panic!("BVH has no such channel"),
                    }
                }
                product_of(&[outer, shift(offset), product_of(&turns)])
            }
            OffsetFrame::Own => {
                let axis = joint.axis.unwrap();
                let (mut moved, mut longer) = ([0.0; 3], 0.0);
                // M = R(third axis) · R(second axis) · R(first axis).
                let mut m = IDENTITY;
                for order in axis.order {
                    for &(channel, value) in &values {
                        if channel == Channel::Rotation(order) {
                            m = product(&turn(order, value), &m);
                        }
                    }
                }
                for &(channel, value) in &values {
                    match channel {
                        Channel::Translation(axis) => moved[axis.idx()] = value,
                        Channel::Length => longer = value,
                        Channel::Rotation(_) => {}
                    }
                }
                let c = product_of(&[
                    turn(axis.order[2], axis.degrees[2]),
                    turn(axis.order[1], axis.degrees[1]),
                    turn(axis.order[0], axis.degrees[0]),
                ]);
                // The inverse rotation is the transposed one.
                let mut c_inverse = c;
                for i in 0..4 {
                    for j in 0..4 {
                        c_inverse[i][j] = c[j][i];
                    }
                }
                if joint.parent.is_none() {
                    product_of(&[shift(joint.offset), shift(moved), c, m, c_inverse])
                } else {
                    let length = joint.offset.iter().map(|v| v * v).sum::<f64>().sqrt();
                    let bone = joint.offset.map(|v| {
                        if length == 0.0 {
                            0.0
                        } else {
                            v * (length + longer) / length
                        }
                    });
                    product_of(&[outer, c, shift(moved), m, c_inverse, shift(bone)])
                }
            }
        });
    }
    let metres = motion.unit.metres();
    frames
        .iter()
        .map(|m| y_up([0, 1, 2].map(|i| m[i][3] * metres), motion.up))
        .collect()
}

/// The shortest turn of up to Y, written out: about Z for X up, about X for Z up.
fn y_up([x, y, z]: [f64; 3], up: UpAxis) -> [f64; 3] {
    match (up.axis(), up.is_reversed()) {
        (Axis::X, false) => [-y, x, z],
        (Axis::X, true) => [y, -x, z],
        (Axis::Y, false) => [x, y, z],
        (Axis::Y, true) => [x, -y, -z],
        (Axis::Z, false) => [x, z, -y],
        (Axis::Z, true) => [x, -z, y],
    }
}
