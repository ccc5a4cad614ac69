use std::fmt;

use nalgebra::Matrix3;

use crate::Axis;

mod guess;

pub use guess::guess_up;
pub(crate) use guess::{OVERRULES_DEFAULT, typical_extent};

/// Which way a file's axes point up. Positions are always turned to Y up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct UpAxis {
    axis: Axis,
    reversed: bool,
}

impl UpAxis {
    /// Y up: what BVH and Acclaim files mean unless said otherwise.
    pub const Y: UpAxis = UpAxis::new(Axis::Y, false);
    /// Z up: what most laboratories record in.
    pub const Z: UpAxis = UpAxis::new(Axis::Z, false);

    /// The axes up and down: X, Y, Z, then their opposites.
    pub const ALL: [UpAxis; 6] = [
        UpAxis::new(Axis::X, false),
        UpAxis::Y,
        UpAxis::Z,
        UpAxis::new(Axis::X, true),
        UpAxis::new(Axis::Y, true),
        UpAxis::new(Axis::Z, true),
    ];

    /// Along `axis`, or against it.
    #[must_use]
    pub const fn new(axis: Axis, reversed: bool) -> Self {
        UpAxis { axis, reversed }
    }

    /// Reads `y`, `+y` or `-y`, in any case, and likewise X and Z.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        let name = name.trim().to_ascii_lowercase();
        let (letter, reversed) = match name.strip_prefix('-') {
            Some(letter) => (letter, true),
            None => (name.strip_prefix('+').unwrap_or(&name), false),
        };
        let axis = match letter {
            "x" => Axis::X,
            "y" => Axis::Y,
            "z" => Axis::Z,
            _ => return None,
        };
        Some(UpAxis::new(axis, reversed))
    }

    /// The axis.
    #[must_use]
    pub fn axis(self) -> Axis {
        self.axis
    }

    /// Whether up is against the axis.
    #[must_use]
    pub fn is_reversed(self) -> bool {
        self.reversed
    }

    /// The rotation that turns up to Y, by the shortest way: Z up becomes Y up about the X axis,
    /// X up about the Z axis. Columns are where X, Y and Z go.
    pub(crate) fn to_y(self) -> Matrix3<f64> {
        let s = if self.reversed { -1.0 } else { 1.0 };
        match self.axis {
            Axis::X => Matrix3::new(0.0, -s, 0.0, s, 0.0, 0.0, 0.0, 0.0, 1.0),
            Axis::Y => Matrix3::new(1.0, 0.0, 0.0, 0.0, s, 0.0, 0.0, 0.0, s),
            Axis::Z => Matrix3::new(1.0, 0.0, 0.0, 0.0, 0.0, s, 0.0, -s, 0.0),
        }
    }
}

impl fmt::Display for UpAxis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sign = if self.reversed { "-" } else { "" };
        write!(f, "{sign}{}", self.axis.letter())
    }
}

/// Where a recording's up axis comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum UpSource {
    /// The file says it.
    File,
    /// What the format means where nothing speaks against it.
    Default,
    /// Guessed from the motion.
    Guessed {
        /// From 0, a toss-up, to 1, no doubt.
        confidence: f64,
    },
    /// Said by the caller.
    Given,
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    #[test]
    fn up_becomes_y_by_a_rotation() {
        for up in UpAxis::ALL {
            let mut direction = Vector3::zeros();
            direction[up.axis().idx()] = if up.is_reversed() { -1.0 } else { 1.0 };
            let turn = up.to_y();
            assert_eq!(turn * direction, Vector3::y(), "{up}");
            assert_eq!(turn * turn.transpose(), Matrix3::identity(), "{up}");
            assert_eq!(turn.determinant(), 1.0, "{up}");
        }
    }

    #[test]
    fn names_are_read_back() {
        for up in UpAxis::ALL {
            assert_eq!(UpAxis::from_name(&up.to_string()), Some(up));
        }
        assert_eq!(UpAxis::from_name(" +z "), Some(UpAxis::Z));
        for name in ["", "-", "w", "--y", "yz"] {
            assert_eq!(UpAxis::from_name(name), None);
        }
    }
}
