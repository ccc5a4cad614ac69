use std::fmt;

use serde::{Deserialize, Serialize};

/// A point of the body that the papers' features speak of (spec.md f).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[allow(missing_docs, reason = "the names are the documentation")]
pub enum BodyPoint {
    Root,
    LHip,
    RHip,
    LKnee,
    RKnee,
    LAnkle,
    RAnkle,
    LToes,
    RToes,
    Belly,
    Chest,
    Neck,
    Head,
    HeadTop,
    LClavicle,
    RClavicle,
    LShoulder,
    RShoulder,
    LElbow,
    RElbow,
    LWrist,
    RWrist,
    LFingers,
    RFingers,
}

impl BodyPoint {
    /// Number of body points.
    pub const COUNT: usize = 24;

    /// All body points in order.
    pub const ALL: [BodyPoint; Self::COUNT] = {
        use BodyPoint as P;
        [
            P::Root,
            P::LHip,
            P::RHip,
            P::LKnee,
            P::RKnee,
            P::LAnkle,
            P::RAnkle,
            P::LToes,
            P::RToes,
            P::Belly,
            P::Chest,
            P::Neck,
            P::Head,
            P::HeadTop,
            P::LClavicle,
            P::RClavicle,
            P::LShoulder,
            P::RShoulder,
            P::LElbow,
            P::RElbow,
            P::LWrist,
            P::RWrist,
            P::LFingers,
            P::RFingers,
        ]
    };

    /// Place in [`BodyPoint::ALL`].
    #[must_use]
    pub fn idx(self) -> usize {
        self as usize
    }

    /// The same point on the other side of the body; points of the middle are their own.
    #[must_use]
    pub fn mirrored(self) -> BodyPoint {
        let name = self.name();
        let other = match name.split_at(1) {
            ("l", rest) => format!("r{rest}"),
            ("r", rest) => format!("l{rest}"),
            _ => return self,
        };
        // `root` is no right side of anything.
        let mut all = BodyPoint::ALL.into_iter();
        all.find(|point| point.name() == other).unwrap_or(self)
    }

    /// The papers' name, such as `lhip` or `headtop`.
    #[must_use]
    pub fn name(self) -> &'static str {
        [
            "root",
            "lhip",
            "rhip",
            "lknee",
            "rknee",
            "lankle",
            "rankle",
            "ltoes",
            "rtoes",
            "belly",
            "chest",
            "neck",
            "head",
            "headtop",
            "lclavicle",
            "rclavicle",
            "lshoulder",
            "rshoulder",
            "lelbow",
            "relbow",
            "lwrist",
            "rwrist",
            "lfingers",
            "rfingers",
        ][self.idx()]
    }
}

impl fmt::Display for BodyPoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
