use serde::Deserialize;

use crate::BodyPoint;

/// A direction to look along.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase", deny_unknown_fields)]
pub enum Direction {
    /// From the first point to the second.
    Axis([BodyPoint; 2]),
    /// The normal (p1 − p3) × (p2 − p3) of the oriented plane through three points, by the
    /// right-hand rule in the listed order (spec.md a.1).
    Normal([BodyPoint; 3]),
    /// Upwards, whichever way the body turns.
    Up,
}

/// The other side of an angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(untagged, expecting = "expected two body points or \"up\"")]
pub enum Segment {
    /// From the first point to the second.
    Points([BodyPoint; 2]),
    /// The vertical, upwards.
    World(WorldAxis),
}

/// A direction fixed in the world.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum WorldAxis {
    /// Y.
    Up,
}

/// What a feature measures in each frame, before any threshold.
///
/// `n` is a unit [`Direction`]. Lengths are in metres, angles in degrees, speeds in metres per second.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Quantity {
    /// n · (of − from): distance of a point from a plane with normal n through `from`
    /// (paper 2006, F_plane and F_nplane).
    Distance {
        /// The point tested.
        of: BodyPoint,
        /// A point of the plane.
        from: BodyPoint,
        /// The plane's normal.
        along: Direction,
        /// Take the distance without its sign.
        #[serde(default)]
        absolute: bool,
    },
    /// n · mean velocity of (of − relative_to), with the direction of the frame itself
    /// (paper 2006, F_move and F_nmove).
    Velocity {
        /// The moving point.
        of: BodyPoint,
        /// The point that its motion is relative to.
        relative_to: BodyPoint,
        /// The direction that is looked along.
        along: Direction,
        /// Length of the averaging window in milliseconds; 0 for none.
        window_ms: f64,
    },
    /// The norm of the mean velocity vector, the smallest over the points (paper 2006, F_fast).
    Speed {
        /// The points, all of which must be fast.
        of: Vec<BodyPoint>,
        /// Length of the averaging window in milliseconds; 0 for none.
        window_ms: f64,
    },
    /// Distance of the nearest of some points from a body segment (paper 2005, section 3), less the
    /// segment's radius: negative inside.
    SegmentDistance {
        /// The points, one of which must be near.
        of: Vec<BodyPoint>,
        /// The ends of the segment.
        to: [BodyPoint; 2],
        /// The segment's radius, in multiples of its length in the first frame.
        #[serde(default)]
        radius: f64,
        /// Cut the segment off flat at its first end: what lies before that end is not near it, and
        /// is as far away as from the second.
        #[serde(default)]
        flat_start: bool,
    },
    /// The angle between two directed segments, 0° to 180° (paper 2006, F_angle). While one of
    /// them has no length, the angle stays what it was.
    Angle {
        /// One segment.
        of: [BodyPoint; 2],
        /// The other.
        to: Segment,
    },
    /// Height above the lowest body point.
    Height {
        /// The point tested.
        of: BodyPoint,
        /// Points that do not count when looking for the lowest.
        above_lowest_except: Vec<BodyPoint>,
    },
    /// Height of the highest body point above the lowest.
    VerticalExtent {},
    /// The largest distance, in plan view, of any two of the points.
    HorizontalDiameter {
        /// The points.
        of: Vec<BodyPoint>,
    },
    /// The smallest of quantities of one dimension; unknown while one of them is.
    Smallest {
        /// The quantities.
        of: Vec<Quantity>,
    },
    /// The largest of quantities of one dimension; unknown while one of them is.
    Largest {
        /// The quantities.
        of: Vec<Quantity>,
    },
}

/// What a quantity is measured in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimension {
    /// Metres.
    Length,
    /// Metres per second.
    Speed,
    /// Degrees.
    Angle,
}

impl Quantity {
    /// The longest averaging window within, in milliseconds; 0 without one.
    pub(crate) fn window_ms(&self) -> f64 {
        match self {
            Quantity::Velocity { window_ms, .. } | Quantity::Speed { window_ms, .. } => *window_ms,
            Quantity::Smallest { of } | Quantity::Largest { of } => {
                of.iter().map(Quantity::window_ms).fold(0.0, f64::max)
            }
            _ => 0.0,
        }
    }

    /// What the quantity is measured in.
    #[must_use]
    pub fn dimension(&self) -> Dimension {
        match self {
            Quantity::Velocity { .. } | Quantity::Speed { .. } => Dimension::Speed,
            Quantity::Angle { .. } => Dimension::Angle,
            Quantity::Smallest { of } | Quantity::Largest { of } => {
                of.first().map_or(Dimension::Length, Quantity::dimension)
            }
            _ => Dimension::Length,
        }
    }

    /// The body points that must have a joint. Those that are merely looked at when they exist, as
    /// candidates for the lowest point, count as well: leaving one out would change the answer.
    #[must_use]
    pub fn body_points(&self) -> Vec<BodyPoint> {
        let direction = |d: &Direction| match d {
            Direction::Axis(points) => points.to_vec(),
            Direction::Normal(points) => points.to_vec(),
            Direction::Up => Vec::new(),
        };
        match self {
            Quantity::Distance {
                of, from, along, ..
            } => [vec![*of, *from], direction(along)].concat(),
            Quantity::Velocity {
                of,
                relative_to,
                along,
                ..
            } => [vec![*of, *relative_to], direction(along)].concat(),
            Quantity::Speed { of, .. } | Quantity::HorizontalDiameter { of } => of.clone(),
            Quantity::SegmentDistance { of, to, .. } => [of.as_slice(), to].concat(),
            Quantity::Smallest { of } | Quantity::Largest { of } => {
                of.iter().flat_map(Quantity::body_points).collect()
            }
            Quantity::Angle { of, to } => match to {
                Segment::Points(to) => [*of, *to].concat(),
                Segment::World(_) => of.to_vec(),
            },
            Quantity::Height {
                of,
                above_lowest_except,
            } => BodyPoint::ALL
                .into_iter()
                .filter(|p| p == of || !above_lowest_except.contains(p))
                .collect(),
            Quantity::VerticalExtent {} => BodyPoint::ALL.to_vec(),
        }
    }
}
