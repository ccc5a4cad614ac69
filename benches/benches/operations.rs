//! Resampling, against nalgebra's quaternions joint by joint.
#![allow(missing_docs)]

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use mocap_io::{Channel, FrameRate, Motion, forward_kinematics};
use nalgebra::{Rotation3, UnitQuaternion, Vector3};
use ndarray::Array2;

/// The rate that the takes of 120 Hz are read at: no frame but each sixth is one of theirs.
const HZ: f64 = 100.0;

/// Of a joint with rotations about X, Y and Z in this order of columns, applied in this order.
fn rotation(degrees: [f64; 3]) -> UnitQuaternion<f64> {
    let [x, y, z] = degrees.map(f64::to_radians);
    let axes = [
        (Vector3::x_axis(), x),
        (Vector3::y_axis(), y),
        (Vector3::z_axis(), z),
    ];
    let about = axes.map(|(axis, angle)| Rotation3::from_axis_angle(&axis, angle));
    UnitQuaternion::from_rotation_matrix(&(about[2] * about[1] * about[0]))
}

/// The channels at another rate, for the built-in corpus: `rx ry rz` in axis order XYZ, or fewer.
fn textbook(motion: &Motion, hz: f64) -> Array2<f64> {
    let channels = &motion.channels;
    let step = motion.rate.hz() / hz;
    let n_frames = ((motion.n_frames() - 1) as f64 / step) as usize + 1;
    let mut found = Array2::zeros((n_frames, channels.ncols()));
    for k in 0..n_frames {
        let (frame, t) = ((k as f64 * step) as usize, (k as f64 * step).fract());
        let next = (frame + 1).min(motion.n_frames() - 1);
        let mut column = 0;
        for joint in motion.skeleton.joints() {
            let turns = |c: &Channel| matches!(c, Channel::Rotation(_));
            let n_turns = joint.channels.iter().filter(|c| turns(c)).count();
            let first_turn = column + joint.channels.len() - n_turns;
            for i in column..column + joint.channels.len() {
                found[[k, i]] = channels[[frame, i]] * (1.0 - t) + channels[[next, i]] * t;
            }
            if n_turns == 3 {
                let at = |frame| rotation([0, 1, 2].map(|i| channels[[frame, first_turn + i]]));
                let (x, y, z) = at(frame).slerp(&at(next), t).euler_angles();
                for (i, angle) in [x, y, z].into_iter().enumerate() {
                    found[[k, first_turn + i]] = angle.to_degrees();
                }
            }
            column += joint.channels.len();
        }
    }
    found
}

fn operations(c: &mut Criterion) {
    /// Metres: an arc cosine in one of them, and positions are rounded to `f32`.
    const TOLERANCE: f32 = 1e-4;
    let motion = benches::take().motion;
    let rate = FrameRate::from_hz(HZ).expect("a rate");
    let (fast, slow) = (motion.resample(rate), textbook(&motion, HZ));
    // Angles may differ where they mean the same rotation.
    let slow = Motion {
        channels: slow,
        ..motion.clone()
    };
    let (a, b) = (forward_kinematics(&fast), forward_kinematics(&slow));
    assert_eq!(a.dim(), b.dim());
    assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() <= TOLERANCE));
    let mut group = c.benchmark_group("operations");
    group.throughput(Throughput::Elements(fast.n_frames() as u64));
    group.bench_function("resample", |b| {
        b.iter(|| black_box(&motion).resample(rate));
    });
    group.bench_function("naive resample", |b| {
        b.iter(|| textbook(black_box(&motion), HZ));
    });
    group.finish();
}

criterion_group!(benches, operations);
criterion_main!(benches);
