//! Each class looks like what its name says.

use super::*;

/// Handedness differs by up to ±8 %, and three repetitions are drawn for each side.
const SIDE_RATIO: f64 = 0.2;

/// Angle at `b` in degrees.
fn angle(a: [f32; 3], b: [f32; 3], c: [f32; 3]) -> f32 {
    let (u, v) = (
        [0, 1, 2].map(|i| a[i] - b[i]),
        [0, 1, 2].map(|i| c[i] - b[i]),
    );
    let dot: f32 = (0..3).map(|i| u[i] * v[i]).sum();
    (dot / (distance(a, b) * distance(b, c)))
        .acos()
        .to_degrees()
}

#[test]
fn walking_goes_where_it_says() {
    for (class, sign) in [
        (Class::Walk, 1.0),
        (Class::Jog, 1.0),
        (Class::WalkBackwards, -1.0),
    ] {
        for shot in of_class(class) {
            let last = shot.clip.motion.n_frames() - 1;
            let (from, to) = (shot.at(0, "root"), shot.at(last, "root"));
            let (left, right) = (shot.at(0, "lhipjoint"), shot.at(0, "rhipjoint"));
            // Forward is left × up, horizontally.
            let front = [-(left[2] - right[2]), left[0] - right[0]];
            let along = (to[0] - from[0]) * front[0] + (to[2] - from[2]) * front[1];
            let way = sign * along / front[0].hypot(front[1]);
            assert!(way > 0.8, "{} {way}", shot.clip.name);
        }
    }
}

#[test]
fn a_kick_raises_its_own_foot() {
    for (class, own, other) in [
        (Class::KickLeft, "ltoes", "rtoes"),
        (Class::KickRight, "rtoes", "ltoes"),
    ] {
        for shot in of_class(class) {
            let upper_arm = distance(shot.at(0, "lclavicle"), shot.at(0, "lhumerus"));
            // Feature 17/18 asks for 1.2 upper arms.
            assert!(shot.highest(own) > 1.4 * upper_arm, "{}", shot.clip.name);
            assert!(shot.highest(other) < 0.08, "{}", shot.clip.name);
        }
    }
}

#[test]
fn a_squat_lowers_the_hips_and_bends_the_knees() {
    for shot in of_class(Class::Squat) {
        let heights = (0..shot.clip.motion.n_frames()).map(|frame| shot.height(frame, "lhipjoint"));
        let (frame, low) = heights
            .enumerate()
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .unwrap();
        assert!(
            low < 0.7 * shot.height(0, "lhipjoint"),
            "{}",
            shot.clip.name
        );
        for side in ["l", "r"] {
            let [hip, knee, ankle] =
                ["hipjoint", "femur", "tibia"].map(|part| shot.at(frame, &format!("{side}{part}")));
            // Features 20 and 21 ask for 110°.
            assert!(angle(hip, knee, ankle) < 105.0, "{}", shot.clip.name);
        }
    }
}

#[test]
fn lying_down_ends_flat_on_the_floor() {
    for shot in of_class(Class::LieDown) {
        let last = shot.clip.motion.n_frames() - 1;
        let (root, neck) = (shot.at(last, "root"), shot.at(last, "thorax"));
        let steep = (neck[1] - root[1]) / distance(root, neck);
        assert!(shot.height(last, "head") < 0.5, "{}", shot.clip.name);
        // Feature 32 asks for 70° to 110° from the vertical.
        assert!(steep.abs() < 0.2, "{} {steep}", shot.clip.name);
        let heights = shot.positions.index_axis(ndarray::Axis(0), last);
        let high = heights.column(1).iter().copied().fold(f32::MIN, f32::max);
        assert!(high < 0.4, "{} {high}", shot.clip.name);
    }
}

#[test]
fn sitting_down_ends_with_level_thighs() {
    for shot in of_class(Class::SitDown) {
        let last = shot.clip.motion.n_frames() - 1;
        let [hip, knee] = ["lhipjoint", "lfemur"].map(|name| shot.at(last, name));
        let steep = (hip[1] - knee[1]) / distance(hip, knee);
        assert!(steep.abs() < 0.25, "{} {steep}", shot.clip.name);
    }
}

#[test]
fn arms_go_overhead_in_jumping_jacks_and_circles() {
    for class in [
        Class::JumpingJack,
        Class::RotateArmsForward,
        Class::RotateArmsBackward,
    ] {
        for shot in of_class(class) {
            let head = shot.height(0, "head");
            for hand in ["lfingers", "rfingers"] {
                assert!(shot.highest(hand) > head + 0.1, "{} {hand}", shot.clip.name);
            }
        }
    }
}

/// Channels come back after a full circle of the arm instead of being wound up by a turn.
#[test]
fn arm_circles_do_not_wind_up() {
    for class in [Class::RotateArmsForward, Class::RotateArmsBackward] {
        for Shot { clip, .. } in of_class(class) {
            let first = clip.motion.skeleton.find("lhumerus").unwrap();
            let column = clip.motion.skeleton.first_channel(first).unwrap();
            let channels = &clip.motion.channels;
            for k in column..column + 3 {
                let moved = channels[[clip.motion.n_frames() - 1, k]] - channels[[0, k]];
                // Neutral standing drifts by some degrees.
                assert!(moved.abs() < 30.0, "{} {moved}", clip.name);
            }
        }
    }
}

#[test]
fn mirrored_classes_have_mirrored_statistics() {
    for (left, right, joints) in [
        (Class::KickLeft, Class::KickRight, ["ltoes", "rtoes"]),
        (Class::PunchLeft, Class::PunchRight, ["lwrist", "rwrist"]),
    ] {
        for performer in Performer::ALL {
            let mean = |class: Class, joint: &str| {
                let own = of_class(class).filter(|shot| shot.clip.performer == performer);
                let heights: Vec<f64> = own.map(|shot| f64::from(shot.highest(joint))).collect();
                heights.iter().sum::<f64>() / heights.len() as f64
            };
            let ratio = mean(left, joints[0]) / mean(right, joints[1]);
            assert!(
                (ratio - 1.0).abs() < SIDE_RATIO,
                "{} {left} {ratio}",
                performer.name
            );
        }
    }
}
