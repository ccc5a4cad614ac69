/// One of the people of the corpus: proportions and manner of moving.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Performer {
    /// First part of the names of this performer's clips.
    pub name: &'static str,
    /// Standing height in metres, to the top of the head.
    pub height: f64,
    /// Frames per second of this performer's recordings.
    pub rate_hz: f64,
    pub(crate) build: Build,
    pub(crate) style: Style,
}

/// Proportions, each relative to the average figure of [`Body`](super::body::Body).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Build {
    pub(crate) legs: f64,
    pub(crate) arms: f64,
    pub(crate) shoulders: f64,
    pub(crate) hips: f64,
}

/// Habits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Style {
    /// Speed relative to the average.
    pub(crate) tempo: f64,
    /// Size of movements relative to the average.
    pub(crate) amplitude: f64,
    /// How much more the right limbs move than the left ones: positive for right-handers.
    pub(crate) handedness: f64,
    /// Forward bend of the spine in neutral standing, degrees.
    pub(crate) stoop: f64,
    /// Outward turn of each foot, degrees.
    pub(crate) toe_out: f64,
    /// Distance of the ankles in neutral standing, relative to that of the hip joints.
    pub(crate) stance: f64,
    /// How far the arms hang from the body, degrees.
    pub(crate) arm_spread: f64,
    /// Bend of the hanging elbow, degrees.
    pub(crate) elbow: f64,
}

impl Performer {
    /// All performers. The first three were recorded at 120 Hz, the others at 60 Hz.
    pub const ALL: [Performer; 5] = [
        Performer {
            name: "anna",
            height: 1.67,
            rate_hz: 120.0,
            build: Build {
                legs: 1.0,
                arms: 0.98,
                shoulders: 0.95,
                hips: 1.03,
            },
            style: Style {
                tempo: 1.0,
                amplitude: 1.0,
                handedness: 0.04,
                stoop: 2.0,
                toe_out: 7.0,
                stance: 1.05,
                arm_spread: 9.0,
                elbow: 14.0,
            },
        },
        Performer {
            name: "ben",
            height: 1.83,
            rate_hz: 120.0,
            build: Build {
                legs: 1.02,
                arms: 1.03,
                shoulders: 1.08,
                hips: 0.98,
            },
            style: Style {
                tempo: 0.9,
                amplitude: 0.95,
                handedness: 0.08,
                stoop: 7.0,
                toe_out: 12.0,
                stance: 1.3,
                arm_spread: 13.0,
                elbow: 20.0,
            },
        },
        Performer {
            name: "chiyo",
            height: 1.55,
            rate_hz: 120.0,
            build: Build {
                legs: 0.97,
                arms: 0.97,
                shoulders: 0.94,
                hips: 1.0,
            },
            style: Style {
                tempo: 1.15,
                amplitude: 1.04,
                handedness: -0.06,
                stoop: 0.0,
                toe_out: 4.0,
                stance: 0.9,
                arm_spread: 7.0,
                elbow: 11.0,
            },
        },
        Performer {
            name: "dan",
            height: 1.95,
            rate_hz: 60.0,
            build: Build {
                legs: 1.03,
                arms: 1.04,
                shoulders: 1.03,
                hips: 0.95,
            },
            style: Style {
                tempo: 0.92,
                amplitude: 0.98,
                handedness: 0.05,
                stoop: 5.0,
                toe_out: 10.0,
                stance: 1.15,
                arm_spread: 10.0,
                elbow: 16.0,
            },
        },
        Performer {
            name: "eva",
            height: 1.74,
            rate_hz: 60.0,
            build: Build {
                legs: 1.01,
                arms: 1.0,
                shoulders: 0.98,
                hips: 1.06,
            },
            style: Style {
                tempo: 1.07,
                amplitude: 1.06,
                handedness: 0.02,
                stoop: 3.0,
                toe_out: 6.0,
                stance: 1.1,
                arm_spread: 8.0,
                elbow: 12.0,
            },
        },
    ];
}
