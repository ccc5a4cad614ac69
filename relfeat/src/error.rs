use crate::BodyPoint;

/// Why a rig or a feature set in TOML could not be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{line}:{column}: {message}")]
pub struct ConfigError {
    /// Line, 1-based.
    pub line: usize,
    /// Column in characters, 1-based.
    pub column: usize,
    /// What was expected and what was found.
    pub message: String,
}

impl ConfigError {
    pub(crate) fn from_toml(text: &str, error: &toml::de::Error) -> Self {
        let start = error.span().map_or(0, |s| s.start);
        Self::at(text, start, error.message().trim().replace('\n', "; "))
    }

    pub(crate) fn at(text: &str, byte: usize, message: String) -> Self {
        let before = text.get(..byte).unwrap_or(text);
        let line_start = before.rfind('\n').map_or(0, |i| i + 1);
        ConfigError {
            line: before.matches('\n').count() + 1,
            column: before[line_start..].chars().count() + 1,
            message,
        }
    }
}

/// Why features could not be computed at all.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ExtractError {
    /// The body map was made for another skeleton.
    #[error("the body map names joint {joint_idx}, the positions have {n_joints} joints")]
    BodyMap {
        /// The largest joint index of the map.
        joint_idx: usize,
        /// Joints in the positions.
        n_joints: usize,
    },
    /// The last axis does not hold x, y and z.
    #[error("expected positions of shape (frames, joints, 3), found ({0}, {1}, {2})")]
    Shape(usize, usize, usize),
    /// A rate that is not positive and finite.
    #[error("{what} must be positive and finite, found {found}")]
    Rate {
        /// Which rate.
        what: &'static str,
        /// The value.
        found: f64,
    },
    /// More words than could be meant, by a library rate far above the motion's.
    #[error("{n_frames} frames at {rate} Hz give too many at {library_rate} Hz")]
    TooManyFrames {
        /// Frames of the motion.
        n_frames: usize,
        /// Rate of the motion.
        rate: f64,
        /// Rate asked for.
        library_rate: f64,
    },
}

/// A feature that could not be computed, and the body points that it lacks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unavailable {
    /// 0-based index of the feature.
    pub feature_idx: usize,
    /// The body points that no joint was found for.
    pub missing: Vec<BodyPoint>,
}
