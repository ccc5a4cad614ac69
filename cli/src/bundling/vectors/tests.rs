use mocap_io::ndarray::array;
use mocap_io::{Bvh, FrameRate, LengthUnit, Motion, UpAxis, forward_kinematics, parse_bvh};
use ndarray::{Array2, s};

use super::*;

/// Rounding of positions to `f32`, and of a few matrix products.
const ROUNDING: f64 = 1e-5;

/// A root with Euler angles in the order Y, X, Z, and a child that turns about two axes.
fn figure(rows: &str, n_frames: usize) -> Motion {
    let text = format!(
        "HIERARCHY\nROOT hips\n{{\nOFFSET 0 0 0\n\
        CHANNELS 6 Xposition Yposition Zposition Yrotation Xrotation Zrotation\n\
        JOINT chest\n{{\nOFFSET 0 20 0\nCHANNELS 2 Zrotation Xrotation\n\
        End Site\n{{\nOFFSET 0 20 0\n}}\n}}\n}}\n\
        MOTION\nFrames: {n_frames}\nFrame Time: 0.01\n{rows}"
    );
    let Bvh { mut motion, .. } = parse_bvh(text.as_bytes()).unwrap();
    motion.unit = LengthUnit::from_name("cm").unwrap();
    motion.rate = FrameRate::from_hz(100.0).unwrap();
    motion
}

fn wandering() -> Motion {
    let mut rows = String::new();
    for k in 0..40 {
        let t = f64::from(k) / 40.0;
        let (yaw, pitch, roll) = (170.0 + 60.0 * t, 50.0 * (7.0 * t).sin(), 30.0 * t - 10.0);
        let (x, y, z) = (90.0 * t, 90.0 + 5.0 * (9.0 * t).cos(), -40.0 * t * t);
        let bend = 20.0 * (5.0 * t).sin();
        rows += &format!("{x} {y} {z} {yaw} {pitch} {roll} {bend} {t}\n");
    }
    figure(&rows, 40)
}

#[track_caller]
fn assert_close(a: &Array2<f64>, b: &Array2<f64>) {
    assert_eq!(a.dim(), b.dim());
    for (at, (x, y)) in a.indexed_iter().map(|(at, x)| (at, (x, b[[at.0, at.1]]))) {
        assert!(
            (x - y).abs() < ROUNDING * (1.0 + x.abs()),
            "{at:?}: {x} {y}"
        );
    }
}

#[test]
fn dimensions_are_those_of_the_definition() {
    let motion = wandering();
    let names = layout(&motion);
    let expected = [
        "chest rz",
        "chest rx",
        "height",
        "pitch",
        "roll",
        "yaw rate",
        "velocity left",
        "velocity front",
    ];
    assert_eq!(names, expected);
    let vectors = pose_vectors(&motion).unwrap();
    assert_eq!(vectors.dim(), (40, 8));
    let own = &motion.channels;
    assert_close(
        &vectors.slice(s![.., ..2]).to_owned(),
        &own.slice(s![.., 6..]).to_owned(),
    );
    // With channels in the order yaw, pitch, roll the file says what they are.
    assert_close(
        &vectors.slice(s![.., 3..5]).to_owned(),
        &own.slice(s![.., 4..6]).to_owned(),
    );
    let rates = vectors.column(5);
    assert!(rates.iter().all(|rate| (rate - 150.0).abs() < 1e-9));
}

#[test]
fn place_and_heading_are_those_of_the_motion() {
    for up in ["y", "z", "-y", "x", "-z", "-x"] {
        let mut motion = wandering();
        motion.up = UpAxis::from_name(up).unwrap();
        let root = Root::new(&motion).unwrap();
        let positions = forward_kinematics(&motion);
        for frame in 0..motion.n_frames() {
            let place = root.place(frame);
            for axis in 0..3 {
                let expected = f64::from(positions[[frame, 0, axis]]);
                assert!((place[axis] - expected).abs() < ROUNDING, "{up}");
            }
            let front = root.rotation(frame).column(2).into_owned();
            let expected = motion.heading(frame).unwrap();
            let apart = front.x.atan2(front.z) - expected;
            // Half a turn to the left is half a turn to the right.
            assert!((1.0 - apart.cos()).abs() < ROUNDING, "{up}");
        }
    }
}

#[test]
fn standing_and_facing_elsewhere_changes_nothing() {
    let motion = wandering();
    let vectors = pose_vectors(&motion).unwrap();
    for yaw in [0.3, -2.0, 3.1] {
        assert_close(
            &vectors,
            &pose_vectors(&motion.moved(yaw, [3.0, -7.0])).unwrap(),
        );
    }
}

#[test]
fn velocity_is_seen_from_the_root() {
    // 1 cm a frame along +X at 100 frames per second: ahead, to the left, to the right.
    for (yaw, left, front) in [(90.0, 0.0, 1.0), (0.0, 1.0, 0.0), (180.0, -1.0, 0.0)] {
        let rows: String = (0..4)
            .map(|x| format!("{x} 80 0 {yaw} 0 0 1 2\n"))
            .collect();
        let vectors = pose_vectors(&figure(&rows, 4)).unwrap();
        for row in vectors.rows() {
            assert!((row[2] - 0.8).abs() < 1e-12);
            assert!((row[6] - left).abs() < 1e-12 && (row[7] - front).abs() < 1e-12);
        }
    }
}

#[test]
fn angles_go_on_over_half_turns() {
    let mut angles = array![350.0, -5.0, 10.0, 170.0, -170.0];
    unwrap(&mut angles.view_mut());
    assert_eq!(angles, array![-10.0, -5.0, 10.0, 170.0, 190.0]);
}

#[test]
fn what_makes_no_vectors_is_refused() {
    let mut motion = wandering();
    motion.channels[[3, 7]] = f64::NAN;
    let name = "chest rx".to_owned();
    let expected = VectorError::Missing { frame: 3, name };
    assert_eq!(pose_vectors(&motion), Err(expected));
    let rigid = "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 3 Xposition Yposition Zposition\n\
        End Site\n{\nOFFSET 0 1 0\n}\n}\nMOTION\nFrames: 1\nFrame Time: 0.01\n0 0 0\n";
    let motion = parse_bvh(rigid.as_bytes()).unwrap().motion;
    assert_eq!(pose_vectors(&motion), Err(VectorError::Rigid));
    let empty = pose_vectors(&wandering().slice(0..0).unwrap()).unwrap();
    assert_eq!(empty.dim(), (0, 8));
}
