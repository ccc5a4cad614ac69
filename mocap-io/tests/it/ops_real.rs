//! Operations on real clips.

use std::path::{Path, PathBuf};

use mocap_io::ndarray::{Array3, s};
use mocap_io::{
    Channel, FrameRate, Motion, UpAxis, blend, forward_kinematics, mirror_pairs, parse_bvh,
    smoothstep_weights, write_bvh,
};

use crate::ops::places;
use crate::ops_layout::through_asf_and_amc;
use crate::real::{data, files_below, read_amc, read_asf, read_bvh, skeleton_of};

/// Positions of some metres, rounded to `f32` on both sides.
const METRES: f32 = 1e-5;

/// A micrometre: nothing that any feature could tell.
const OWN_METRES: f64 = 1e-6;

/// Text keeps every bit but for bones' directions and lengths.
const WRITTEN_METRES: f32 = 1e-4;

/// Frames per clip, so that the whole run takes seconds.
const N_FRAMES: usize = 240;

/// A hand is accelerated by less than 60 g: between frames h apart an arc strays from the way by
/// less than a·h²/8.
fn stray(hz: f64) -> f32 {
    (600.0 / (8.0 * hz * hz)) as f32
}

fn clips(data: &Path) -> Vec<(PathBuf, Motion)> {
    let mut found = Vec::new();
    let mut acclaim = vec![data.join("cmu/02/02_01.amc")];
    for folder in [
        "jogLeftCircle4StepsRstart",
        "lieDownFloor",
        "sneak2StepsLStart",
    ] {
        let mut clips = Vec::new();
        files_below(&data.join("hdm05").join(folder), "amc", &mut clips);
        acclaim.push(clips.swap_remove(0));
    }
    for path in acclaim {
        let motion = read_amc(&path, &read_asf(&skeleton_of(&path))).motion;
        found.push((path, motion));
    }
    for clip in [
        "bvh/cgspeed/02/02_01.bvh",
        "tricky/bvh/bvh-toolbox_walk01.bvh",
        "tricky/bvh/AnimatedDrawings_jesse_dance.bvh",
        "tricky/bvh/XBMotionGraph_input1.bvh",
        "tricky/bvh/iclone_002_03.bvh",
    ] {
        let path = data.join(clip);
        let motion = read_bvh(&path).motion;
        found.push((path, motion));
    }
    for (_, motion) in &mut found {
        // The first frame of some is a T-pose, from which the second one jumps.
        *motion = motion.slice(1..motion.n_frames().min(N_FRAMES)).unwrap();
    }
    found
}

fn largest_difference(a: &Array3<f32>, b: &Array3<f32>) -> f32 {
    assert_eq!(a.dim(), b.dim());
    let mut worst = 0.0f32;
    for (a, b) in a.iter().zip(b) {
        assert!(a.is_finite() && b.is_finite());
        worst = worst.max((a - b).abs());
    }
    worst
}

#[track_caller]
fn check_same(path: &Path, a: &Motion, b: &Motion, tolerance: f32) {
    let worst = largest_difference(&forward_kinematics(a), &forward_kinematics(b));
    assert!(worst <= tolerance, "{}: {worst} m", path.display());
}

#[test]
fn real_acclaim_skeletons_have_both_sides() {
    let Some(data) = data() else { return };
    let mut skeletons = Vec::new();
    files_below(&data.join("cmu"), "asf", &mut skeletons);
    files_below(&data.join("hdm05"), "asf", &mut skeletons);
    assert!(skeletons.len() > 20);
    let sided = [
        "hipjoint", "femur", "tibia", "foot", "toes", "clavicle", "humerus", "radius", "wrist",
        "hand", "fingers", "thumb",
    ];
    for path in skeletons {
        let skeleton = read_asf(&path).skeleton;
        let names: Vec<&str> = skeleton.names().collect();
        let pairs = mirror_pairs(&skeleton);
        let mut n_sided = 0;
        for (name, partner) in names.iter().zip(pairs) {
            let expected = match name.split_at(1) {
                ("l", rest) if sided.contains(&rest) => format!("r{rest}"),
                ("r", rest) if sided.contains(&rest) => format!("l{rest}"),
                _ => (*name).to_owned(),
            };
            assert_eq!(names[partner], expected, "{}", path.display());
            n_sided += usize::from(expected != *name);
        }
        assert_eq!(n_sided, 24, "{}", path.display());
    }
}

#[test]
fn real_bvh_rigs_have_both_sides() {
    let Some(data) = data() else { return };
    for (path, joint, partner) in [
        ("bvh/cgspeed/02/02_01.bvh", "LHipJoint", "RHipJoint"),
        (
            "bvh/cgspeed/02/02_01.bvh",
            "LeftToeBase_End",
            "RightToeBase_End",
        ),
        ("bvh/cgspeed/02/02_01.bvh", "Spine1", "Spine1"),
    ] {
        let skeleton = read_bvh(&data.join(path)).motion.skeleton;
        let found = mirror_pairs(&skeleton)[skeleton.find(joint).unwrap()];
        assert_eq!(skeleton.joints()[found].name, partner, "{path}");
    }
    let mut clips = Vec::new();
    files_below(&data, "bvh", &mut clips);
    for path in clips {
        let skeleton = read_bvh(&path).motion.skeleton;
        let pairs = mirror_pairs(&skeleton);
        let n_sided = (0..pairs.len()).filter(|&j| pairs[j] != j).count();
        println!(
            "{:3} of {:3} joints have a partner: {}",
            n_sided,
            pairs.len(),
            path.display()
        );
        assert_eq!(n_sided % 2, 0);
    }
}

#[test]
fn real_clips_are_mirrored_and_back() {
    let Some(data) = data() else { return };
    for (path, motion) in clips(&data) {
        let pairs = mirror_pairs(&motion.skeleton);
        let mirrored = motion.mirror(&pairs).unwrap();
        let names = |m: &Motion| -> Vec<String> { m.skeleton.names().map(str::to_owned).collect() };
        assert_eq!(names(&mirrored), names(&motion), "{}", path.display());
        let (before, after) = (forward_kinematics(&motion), forward_kinematics(&mirrored));
        for (j, &partner) in pairs.iter().enumerate() {
            for frame in 0..motion.n_frames() {
                let (a, b) = (
                    after.slice(s![frame, j, ..]),
                    before.slice(s![frame, partner, ..]),
                );
                let off = [a[0] + b[0], a[1] - b[1], a[2] - b[2]];
                assert!(
                    off.iter().all(|v| v.abs() <= METRES),
                    "{}: {off:?}",
                    path.display()
                );
            }
        }
        assert!(
            mirrored.mirror(&pairs).unwrap() == motion,
            "{}",
            path.display()
        );
    }
}

#[test]
fn real_clips_survive_resampling() {
    let Some(data) = data() else { return };
    for (path, motion) in clips(&data) {
        let hz = motion.rate.hz();
        let rate = |factor: f64| FrameRate::from_hz(hz * factor).unwrap();
        assert!(motion.resample(rate(3.0)).resample(rate(1.0)).channels == motion.channels);
        // Half the frames tell nearly as much.
        let half = motion.resample(rate(0.5));
        let n = half.n_frames() * 2 - 1;
        let back = half.resample(rate(1.0));
        assert_eq!(back.n_frames(), n);
        let worst = largest_difference(
            &forward_kinematics(&back),
            &forward_kinematics(&motion.slice(0..n).unwrap()),
        );
        println!(
            "{worst:.4} m of {:.4} m: {}",
            stray(hz * 0.5),
            path.display()
        );
        assert!(worst <= stray(hz * 0.5), "{}: {worst} m", path.display());
    }
}

/// From one frame to the next no angle goes more than half round, where the file's own do not.
#[test]
fn real_resampled_angles_do_not_jump() {
    let Some(data) = data() else { return };
    let largest_step = |motion: &Motion, column: usize| {
        let values = motion.channels.column(column);
        let steps = values
            .iter()
            .zip(values.iter().skip(1))
            .map(|(a, b)| (a - b).abs());
        steps.fold(0.0, f64::max)
    };
    let mut n_columns = 0;
    for (path, motion) in clips(&data) {
        let finer = motion.resample(FrameRate::from_hz(motion.rate.hz() * 1.37).unwrap());
        let kinds = motion.skeleton.joints().iter().flat_map(|j| &j.channels);
        for (column, kind) in kinds.enumerate() {
            if matches!(kind, Channel::Rotation(_)) && largest_step(&motion, column) < 90.0 {
                let step = largest_step(&finer, column);
                assert!(step < 120.0, "{} column {column}: {step}", path.display());
                n_columns += 1;
            }
        }
    }
    assert!(n_columns > 400, "only {n_columns} angles");
}

#[test]
fn real_clips_move_on_the_floor_and_into_other_axes() {
    let Some(data) = data() else { return };
    for (path, motion) in clips(&data) {
        let Some(found) = motion.in_facing_frame(10) else {
            panic!("{}", path.display())
        };
        check_same(&path, &found.in_facing_frame(10).unwrap(), &found, METRES);
        for up in UpAxis::ALL {
            check_same(&path, &motion.to_up(up), &motion, METRES);
            check_same(
                &path,
                &motion.to_up(up).in_facing_frame(10).unwrap(),
                &found,
                METRES,
            );
        }
        let n = motion.n_frames();
        assert!(blend(&motion, &motion, &[]).unwrap().n_frames() == 0);
        check_same(
            &path,
            &blend(&motion, &motion, &smoothstep_weights(n)).unwrap(),
            &motion,
            METRES,
        );
        let (a, b) = (
            motion.slice(0..n / 2 + 9).unwrap(),
            motion.slice(n / 2..n).unwrap(),
        );
        check_same(
            &path,
            &a.concatenate(&b.moved(2.0, [3.0, 4.0]), 9).unwrap(),
            &motion,
            METRES,
        );
    }
}

/// Two walks of one performer: the blend goes as far as both, weighted, and no further.
#[test]
fn real_walks_blend_to_a_walk() {
    let Some(data) = data() else { return };
    let asf = read_asf(&data.join("cmu/02/02.asf"));
    let [a, b] = ["02_01", "02_02"].map(|clip| {
        let path = data.join("cmu/02").join(clip).with_extension("amc");
        read_amc(&path, &asf).motion
    });
    let way = |motion: &Motion| {
        let positions = forward_kinematics(motion);
        let step = |k: usize, axis: usize| positions[[k, 0, axis]] - positions[[k - 1, 0, axis]];
        let steps = (1..positions.dim().0).map(|k| step(k, 0).hypot(step(k, 2)));
        steps.sum::<f32>()
    };
    let n_frames = (a.n_frames() + b.n_frames()) / 2;
    let turned = b.moved(2.5, [4.0, -1.0]);
    let blended = blend(&a, &turned, &vec![0.5; n_frames]).unwrap();
    let (shortest, longest) = (way(&a).min(way(&b)), way(&a).max(way(&b)));
    println!("{} m of {} m and {} m", way(&blended), way(&a), way(&b));
    assert!(way(&blended) <= longest);
    // Sway to the sides cancels where the two are out of step; going forward does not.
    assert!(way(&blended) >= 0.8 * shortest);
}

#[test]
fn real_bvh_files_of_one_figure_become_acclaim_and_keep_every_joint() {
    let Some(data) = data() else { return };
    let mut clips = Vec::new();
    files_below(&data, "bvh", &mut clips);
    let (mut n_converted, mut worst) = (0, 0.0f64);
    for path in clips {
        let motion = read_bvh(&path).motion;
        let motion = motion.slice(0..motion.n_frames().min(N_FRAMES)).unwrap();
        let n_roots = motion
            .skeleton
            .joints()
            .iter()
            .filter(|j| j.parent.is_none())
            .count();
        let own = match motion.to_own_offsets() {
            Ok(own) => own,
            Err(error) => {
                assert!(n_roots > 1, "{}: {error}", path.display());
                println!("{}: {error}", path.display());
                continue;
            }
        };
        for (before, after) in places(&motion)
            .iter()
            .flatten()
            .zip(places(&own).iter().flatten())
        {
            for (before, after) in before.iter().zip(after) {
                worst = worst.max((before - after).abs());
                assert!((before - after).abs() <= OWN_METRES, "{}", path.display());
            }
        }
        let before = forward_kinematics(&motion);
        let again = forward_kinematics(&through_asf_and_amc(&own));
        let off = largest_difference(&before, &again);
        assert!(off <= WRITTEN_METRES, "{}: {off}", path.display());
        n_converted += 1;
    }
    println!("{n_converted} files, largest difference {worst:e} m");
    assert!(n_converted > 40);
}

#[test]
fn real_operations_can_be_written() {
    let Some(data) = data() else { return };
    for (path, motion) in clips(&data) {
        let bvh = motion.to_parent_offsets();
        let mirrored = bvh.mirror(&mirror_pairs(&bvh.skeleton)).unwrap();
        let moved = mirrored
            .resample(FrameRate::from_hz(25.0).unwrap())
            .in_facing_frame(0)
            .unwrap();
        let mut text = Vec::new();
        write_bvh(&moved, &mut text).unwrap();
        let again = parse_bvh(&text).unwrap().with_unit(moved.unit).motion;
        assert!(again.channels == moved.channels, "{}", path.display());
        check_same(&path, &again, &moved, 0.0);
    }
}
