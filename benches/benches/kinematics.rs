//! Forward kinematics, against 4×4 matrices multiplied one by one.
#![allow(missing_docs)]

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use mocap_io::{Axis, Channel, Motion, forward_kinematics};
use nalgebra::{Matrix4, Rotation3, Vector3};

fn rotation(axis: Axis, degrees: f64) -> Matrix4<f64> {
    let axis = [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()][axis.idx()];
    Rotation3::from_axis_angle(&axis, degrees.to_radians()).to_homogeneous()
}

/// Positions of all bone ends of an Acclaim motion.
fn textbook(motion: &Motion) -> Vec<[f32; 3]> {
    let metres = motion.unit.metres();
    let mut positions = Vec::new();
    for values in motion.channels.rows() {
        let mut column = 0;
        let mut world: Vec<Matrix4<f64>> = Vec::new();
        for joint in motion.skeleton.joints() {
            let frame = joint.axis.map_or([0.0; 3], |a| a.degrees);
            let c = rotation(Axis::Z, frame[2])
                * rotation(Axis::Y, frame[1])
                * rotation(Axis::X, frame[0]);
            let mut turn = Matrix4::identity();
            let mut offset = Vector3::from(joint.offset);
            for channel in &joint.channels {
                match *channel {
                    Channel::Rotation(axis) => turn = rotation(axis, values[column]) * turn,
                    Channel::Translation(axis) => offset[axis.idx()] += values[column],
                    Channel::Length => {}
                }
                column += 1;
            }
            let local = c * turn * c.transpose();
            let shift = Matrix4::new_translation(&(offset * metres));
            let place = match joint.parent {
                None => shift * local,
                Some(parent) => world[parent] * local * shift,
            };
            positions.push([0, 1, 2].map(|i| place[(i, 3)] as f32));
            world.push(place);
        }
    }
    positions
}

fn kinematics(c: &mut Criterion) {
    /// Both sum in `f64`; rounding to `f32` of coordinates of some metres is all that may differ.
    const TOLERANCE: f32 = 1e-5;
    let motion = benches::take().motion;
    let (fast, slow) = (forward_kinematics(&motion), textbook(&motion));
    let differs = |(a, b): (&f32, &f32)| (a - b).abs() > TOLERANCE;
    assert!(!fast.iter().zip(slow.iter().flatten()).any(differs));
    let mut group = c.benchmark_group("kinematics");
    group.throughput(Throughput::Elements(motion.n_frames() as u64));
    group.bench_function("forward_kinematics", |b| {
        b.iter(|| forward_kinematics(black_box(&motion)));
    });
    group.bench_function("naive 4x4 matrices", |b| {
        b.iter(|| textbook(black_box(&motion)))
    });
    group.finish();
}

criterion_group!(benches, kinematics);
criterion_main!(benches);
