//! Which way is up, from motion alone.

use std::fs;

use mocap_io::ndarray::{Array3, s};
use mocap_io::{
    Axis, Motion, UpAxis, UpSource, forward_kinematics, guess_up, parse_amc, parse_asf, parse_bvh,
    parse_c3d,
};
use proptest::prelude::*;
use proptest::sample::select;

use crate::real::{data, files_below, skeleton_of};

/// A figure of sticks that walks along X, Y up, in metres: two feet on the floor by turns, hips, a head
/// and two hands.
fn walker(n_frames: usize) -> Array3<f32> {
    let mut positions = Array3::zeros((n_frames, 6, 3));
    for frame in 0..n_frames {
        let step = frame as f32 / 30.0;
        let foot = |phase: f32| {
            let t = step + phase;
            let swing = (t.fract() * 2.0 - 1.0).max(0.0);
            [
                (t.floor() + swing) * 1.2 - phase * 1.2,
                0.08 + 0.1 * swing * (1.0 - swing),
            ]
        };
        let x = step * 1.2;
        let bob = 0.02 * (step * 12.0).sin();
        let swing = 0.3 * (step * 6.0).sin();
        let points = [
            [foot(0.0)[0], foot(0.0)[1], 0.1],
            [foot(0.5)[0], foot(0.5)[1], -0.1],
            [x, 0.95 + bob, 0.0],
            [x, 1.7 + bob, 0.0],
            [x + swing, 0.9, 0.25],
            [x - swing, 0.9, -0.25],
        ];
        for (joint, at) in points.iter().enumerate() {
            for axis in 0..3 {
                positions[[frame, joint, axis]] = at[axis];
            }
        }
    }
    positions
}

/// `positions` with Y up, turned so that `up` is up.
fn turned(positions: &Array3<f32>, up: UpAxis) -> Array3<f32> {
    let mut turned = Array3::zeros(positions.dim());
    let sign = if up.is_reversed() { -1.0 } else { 1.0 };
    // The axes in their order, so that up comes where Y was.
    let to = match up.axis() {
        Axis::X => [2, 0, 1],
        Axis::Y => [0, 1, 2],
        Axis::Z => [1, 2, 0],
    };
    for (from, to) in to.into_iter().enumerate() {
        let sign = if from == 0 || from == 1 { sign } else { 1.0 };
        turned
            .slice_mut(s![.., .., to])
            .assign(&(&positions.slice(s![.., .., from]) * sign));
    }
    turned
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// No direction is preferred, and the unit does not matter.
    #[test]
    fn a_turned_walker_is_guessed_with_the_same_confidence(up in select(UpAxis::ALL.to_vec()), scale in 0.01f32..1000.0) {
        let walker = walker(120);
        let (as_made, confidence) = guess_up(walker.view()).unwrap();
        prop_assert_eq!(as_made, UpAxis::Y);
        prop_assert!(confidence > 0.8, "{}", confidence);
        let (found, again) = guess_up((turned(&walker, up) * scale).view()).unwrap();
        prop_assert_eq!(found, up);
        // Sums are rounded in another order.
        prop_assert!((again - confidence).abs() < 1e-3, "{} and {}", confidence, again);
    }

    #[test]
    fn missing_points_are_left_out(frames in proptest::collection::vec(0usize..120, 0..40), joint in 0usize..6) {
        let mut walker = walker(120);
        for frame in frames {
            walker.slice_mut(s![frame, joint, ..]).fill(f32::NAN);
        }
        let (up, confidence) = guess_up(walker.view()).unwrap();
        prop_assert_eq!(up, UpAxis::Y);
        prop_assert!(confidence <= 1.0);
    }
}

#[test]
fn little_evidence_gives_little_confidence() {
    for n_frames in [1, 2] {
        let (_, confidence) = guess_up(walker(n_frames).view()).unwrap();
        assert!(
            (1.0 / 6.0..0.6).contains(&confidence),
            "{n_frames} frames: {confidence}"
        );
    }
    assert_eq!(guess_up(Array3::zeros((0, 5, 3)).view()), None);
    assert_eq!(guess_up(Array3::zeros((5, 0, 3)).view()), None);
    assert_eq!(guess_up(Array3::zeros((5, 3, 3)).view()), None);
    assert_eq!(
        guess_up(Array3::from_elem((5, 3, 3), f32::NAN).view()),
        None
    );
}

fn read_motion(path: &std::path::Path) -> Option<Motion> {
    let bytes = fs::read(path).unwrap();
    if path.extension()?.eq_ignore_ascii_case("bvh") {
        return Some(parse_bvh(&bytes).ok()?.motion);
    }
    let asf = parse_asf(&fs::read(skeleton_of(path)).ok()?).ok()?;
    Some(parse_amc(&bytes, &asf).ok()?.motion)
}

/// The fair1 files of Animated Drawings are Z up, as its own configuration of them says; all other text
/// files here are Y up, all C3D files Z up but one, which was anonymised and names no axis.
#[test]
fn real_up_axes_are_guessed() {
    let Some(data) = data() else { return };
    let (mut n_right, mut n_sure) = (0, 0);
    let mut wrong = Vec::new();
    let mut paths = Vec::new();
    for extension in ["bvh", "amc", "c3d"] {
        files_below(&data, extension, &mut paths);
    }
    for path in &paths {
        let name = path.strip_prefix(&data).unwrap().display().to_string();
        let is_c3d = name.to_ascii_lowercase().ends_with("c3d");
        let (positions, expected) = if is_c3d {
            (
                parse_c3d(&fs::read(path).unwrap())
                    .unwrap()
                    .markers
                    .positions,
                UpAxis::Z,
            )
        } else {
            let Some(motion) = read_motion(path) else {
                continue;
            };
            let is_z = name.contains("fair1") || name.contains("AnimatedDrawings_dab");
            (
                forward_kinematics(&motion),
                if is_z { UpAxis::Z } else { UpAxis::Y },
            )
        };
        let Some((up, confidence)) = guess_up(positions.view()) else {
            continue;
        };
        let n_frames = positions.dim().0;
        if name.contains("561xxa01") {
            continue;
        }
        if up == expected {
            n_right += 1;
            n_sure += usize::from(confidence >= 0.8);
        } else {
            wrong.push((
                confidence,
                format!("{name}: {n_frames} frames: {up} instead of {expected}, {confidence:.2}"),
            ));
        }
    }
    for (_, line) in &wrong {
        println!("wrong: {line}");
    }
    println!(
        "right {n_right}, of these sure {n_sure}, wrong {}",
        wrong.len()
    );
    assert!(wrong.iter().all(|&(confidence, _)| confidence < 0.8));
    assert!(
        n_right > 550 && wrong.len() <= 12 && n_sure > 480,
        "{n_right}, {n_sure}, {}",
        wrong.len()
    );
}

#[test]
fn real_motions_are_turned_only_when_sure() {
    let Some(data) = data() else { return };
    let guessed = |path: &str| read_motion(&data.join(path)).unwrap().with_guessed_up();
    let zombie = guessed("bvh/animated-drawings/fair1/zombie.bvh");
    assert_eq!(zombie.up, UpAxis::Z);
    assert!(matches!(zombie.up_source, UpSource::Guessed { confidence } if confidence >= 0.8));
    // The head is above the feet now.
    let positions = forward_kinematics(&zombie);
    let height = |name: &str| positions[[100, zombie.skeleton.find(name).unwrap(), 1]];
    assert!(height("Head") > height("Hips") && height("Hips") > height("LeftFoot"));
    let walk = guessed("bvh/mass/walk.bvh");
    assert_eq!(walk.up, UpAxis::Y);
    assert!(matches!(walk.up_source, UpSource::Guessed { .. }));
    // A single frame says too little.
    let rest = guessed("tricky/bvh/dme_rest.bvh");
    assert_eq!((rest.up, rest.up_source), (UpAxis::Y, UpSource::Default));
    // What the caller says stays.
    let mut given = read_motion(&data.join("bvh/animated-drawings/fair1/zombie.bvh")).unwrap();
    given.up_source = UpSource::Given;
    assert_eq!(given.clone().with_guessed_up(), given);
}
