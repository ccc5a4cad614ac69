//! How far a motion goes from one frame to the next, beside the motions it is made of.

use std::collections::BTreeMap;

use mocap_io::{Motion, UpAxis, forward_kinematics, local_rotations};

/// A walk may go so many times as far from one frame to the next as its sources ever do: a submotion is
/// played at up to twice its own speed, as its length by the mean of two lengths.
pub(crate) const MAX_RATIO: f64 = 2.0;

/// Joints that hardly move in the sources still differ between them: a blend over 20 frames may turn
/// a joint by so many degrees per frame, which makes 10 degrees on the whole and is no jump.
const FREE_DEGREES: f64 = 0.75;

/// Likewise, for the root's place: two millimetres.
const FREE_METRES: f64 = 0.002;

/// The largest step from a frame to the next.
pub(crate) struct Steps {
    /// Of the root, in metres.
    pub(crate) root: f64,
    /// Of its +Z axis on the floor, in degrees.
    pub(crate) heading: f64,
    /// Of each joint within its parent, in degrees.
    pub(crate) joints: BTreeMap<String, f64>,
}

impl Steps {
    pub(crate) fn of(motion: &Motion) -> Steps {
        let motion = motion.to_up(UpAxis::Y);
        let places = forward_kinematics(&motion);
        let turns = local_rotations(&motion).mapv(f64::from);
        let pairs = || (1..motion.n_frames()).map(|k| (k - 1, k));
        let largest = |steps: &mut dyn Iterator<Item = f64>| steps.fold(0.0, f64::max);
        let root = |(i, k): (usize, usize)| {
            let along = |axis: usize| f64::from(places[[k, 0, axis]] - places[[i, 0, axis]]);
            (0..3).map(along).map(|d| d * d).sum::<f64>().sqrt()
        };
        let heading = |k: usize| {
            let [w, x, y, z] = [0, 1, 2, 3].map(|i| turns[[k, 0, i]]);
            (2.0 * (x * z + w * y)).atan2(1.0 - 2.0 * (x * x + y * y))
        };
        let turned = |(i, k): (usize, usize)| {
            let step = (heading(k) - heading(i)).to_degrees();
            (step - 360.0 * (step / 360.0).round()).abs()
        };
        let joint = |joint: usize, (i, k): (usize, usize)| {
            let apart = |sign: f64| {
                let parts =
                    (0..4).map(|part| turns[[i, joint, part]] - sign * turns[[k, joint, part]]);
                parts.map(|d| d * d).sum::<f64>().sqrt()
            };
            // By the chord between them: exact for small angles, where a cosine is not.
            let chord = apart(1.0).min(apart(-1.0));
            4.0 * (chord / 2.0).min(1.0).asin().to_degrees()
        };
        Steps {
            root: largest(&mut pairs().map(root)),
            heading: largest(&mut pairs().map(turned)),
            joints: motion
                .skeleton
                .names()
                .enumerate()
                .map(|(j, name)| {
                    (
                        name.to_owned(),
                        largest(&mut pairs().map(|pair| joint(j, pair))),
                    )
                })
                .collect(),
        }
    }

    /// Asserts that this walk does not jump beside the motions it is made of, and gives the largest
    /// ratio of a step to the largest one there.
    #[track_caller]
    pub(crate) fn assert_no_jump(&self, sources: &[Steps]) -> f64 {
        let largest = |of: &dyn Fn(&Steps) -> f64| sources.iter().map(of).fold(0.0, f64::max);
        let mut checks = vec![
            (
                "root".to_owned(),
                self.root,
                largest(&|s| s.root),
                FREE_METRES,
            ),
            (
                "heading".to_owned(),
                self.heading,
                largest(&|s| s.heading),
                FREE_DEGREES,
            ),
        ];
        for (name, &step) in &self.joints {
            let source = largest(&|s| s.joints[name]);
            checks.push((name.clone(), step, source, FREE_DEGREES));
        }
        let mut worst: f64 = 0.0;
        for (what, step, source, free) in checks {
            assert!(step.is_finite(), "{what}: {step}");
            assert!(
                step <= MAX_RATIO * source.max(free),
                "{what}: {step} after {source}"
            );
            worst = worst.max(step / source.max(free));
        }
        worst
    }
}
