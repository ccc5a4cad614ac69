use std::fmt;

/// Joints that a file may define: far more than any figure has, and few enough that a small file
/// cannot fill the memory with them.
pub(crate) const MAX_JOINTS: usize = 1 << 14;

/// An axis of space. Y is up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Axis {
    /// To the figure's left when it faces Z.
    X,
    /// Up.
    Y,
    /// To the front, in the rest pose of most rigs.
    Z,
}

impl Axis {
    /// X, Y, Z.
    pub const ALL: [Axis; 3] = [Axis::X, Axis::Y, Axis::Z];

    /// 0 for X, 1 for Y, 2 for Z.
    #[must_use]
    pub fn idx(self) -> usize {
        self as usize
    }

    pub(crate) fn letter(self) -> char {
        ['X', 'Y', 'Z'][self.idx()]
    }
}

/// What one number of a frame moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Channel {
    /// A translation along an axis, in the file's length unit.
    Translation(Axis),
    /// A rotation about an axis, in degrees.
    Rotation(Axis),
    /// A change of the bone's length, in the file's length unit (the Acclaim degree of freedom `l`).
    Length,
}

/// In which frame a joint's offset is given, and so what the joint's position is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum OffsetFrame {
    /// BVH: the offset leads from the parent to the joint and turns with the parent.
    /// The joint is where its bone *starts*.
    Parent,
    /// Acclaim: the offset is the bone itself and turns with it. The joint is where its bone *ends*.
    Own,
}

/// The frame in which an Acclaim bone's rotations are meant (the keyword `axis`): three angles, the
/// first one applied first, so that the matrix is `C = R(order[2]) · R(order[1]) · R(order[0])`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisFrame {
    /// Angles in degrees, `degrees[i]` about `order[i]`.
    pub degrees: [f64; 3],
    /// The order in which the rotations are applied; the bone's own angles use it as well.
    pub order: [Axis; 3],
}

impl AxisFrame {
    /// Angles about X, Y and Z, applied in this order.
    #[must_use]
    pub fn xyz(degrees: [f64; 3]) -> Self {
        AxisFrame {
            degrees,
            order: Axis::ALL,
        }
    }
}

/// A joint of a [`Skeleton`].
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Name as written in the file. End sites of BVH files, which have none, are named after their
    /// parent: `Head_End`, and `Head_End2` if there are several.
    pub name: String,
    /// Index of the parent joint; `None` for a root.
    pub parent: Option<usize>,
    /// In file units, in the frame that [`Skeleton::offset_frame`] says. For the root of an Acclaim
    /// skeleton this is the keyword `position`.
    pub offset: [f64; 3],
    /// The numbers that move this joint, in file order. Empty for a rigid joint.
    pub channels: Vec<Channel>,
    /// The Acclaim axis frame; `None` in BVH, where the channels are applied as they are listed
    /// (the last one first).
    pub axis: Option<AxisFrame>,
    /// Whether this is an End Site of a BVH file: the tip of its parent's bone.
    pub end_site: bool,
}

/// Joints in depth-first order: a tree, or several where a file has several roots.
#[derive(Clone, Debug, PartialEq)]
pub struct Skeleton {
    joints: Vec<Joint>,
    offset_frame: OffsetFrame,
    first_channel: Vec<usize>,
    n_channels: usize,
}

/// Why joints do not make a skeleton.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SkeletonError {
    /// A parent that does not come before its child.
    #[error(
        "joint {joint_idx} names joint {parent_idx} as its parent, which does not come before it"
    )]
    ParentOrder {
        /// Index of the child.
        joint_idx: usize,
        /// The parent it names.
        parent_idx: usize,
    },
    /// An offset or axis angle that is not a finite number.
    #[error("joint {joint_idx} has an offset or axis that is not finite")]
    NotFinite {
        /// Index of the joint.
        joint_idx: usize,
    },
}

impl Skeleton {
    /// Checks that every parent comes before its children.
    ///
    /// # Errors
    /// [`SkeletonError`] where it does not, or where a number is not finite.
    pub fn new(joints: Vec<Joint>, offset_frame: OffsetFrame) -> Result<Self, SkeletonError> {
        let mut first_channel = Vec::with_capacity(joints.len());
        let mut n_channels = 0;
        for (joint_idx, joint) in joints.iter().enumerate() {
            if let Some(parent_idx) = joint.parent.filter(|&p| p >= joint_idx) {
                return Err(SkeletonError::ParentOrder {
                    joint_idx,
                    parent_idx,
                });
            }
            let axis = joint.axis.map_or([0.0; 3], |a| a.degrees);
            if !joint.offset.iter().chain(&axis).all(|v| v.is_finite()) {
                return Err(SkeletonError::NotFinite { joint_idx });
            }
            first_channel.push(n_channels);
            n_channels += joint.channels.len();
        }
        Ok(Skeleton {
            joints,
            offset_frame,
            first_channel,
            n_channels,
        })
    }

    /// The joints; a parent always comes before its children.
    #[must_use]
    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }

    pub(crate) fn scaled(&self, factor: f64) -> Skeleton {
        let mut scaled = self.clone();
        for joint in &mut scaled.joints {
            joint.offset = joint.offset.map(|v| v * factor);
        }
        scaled
    }

    /// In which frame the offsets are given.
    #[must_use]
    pub fn offset_frame(&self) -> OffsetFrame {
        self.offset_frame
    }

    /// Numbers per frame.
    #[must_use]
    pub fn n_channels(&self) -> usize {
        self.n_channels
    }

    /// Column of the first channel of joint `joint_idx` in a motion's channels; `None` if there is
    /// no such joint.
    #[must_use]
    pub fn first_channel(&self, joint_idx: usize) -> Option<usize> {
        self.first_channel.get(joint_idx).copied()
    }

    /// The joint that a column of a motion's channels moves.
    pub(crate) fn joint_of_channel(&self, column: usize) -> Option<&Joint> {
        // Joints without channels share their first column with the next joint: the last one has it.
        let n_up_to = self.first_channel.partition_point(|&first| first <= column);
        self.joints.get(n_up_to.checked_sub(1)?)
    }

    /// Joint names in order.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.joints.iter().map(|j| j.name.as_str())
    }

    /// The index of the first joint with this name.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<usize> {
        self.joints.iter().position(|j| j.name == name)
    }

    /// Bones as pairs (parent, child).
    pub fn bones(&self) -> impl Iterator<Item = (usize, usize)> {
        self.joints
            .iter()
            .enumerate()
            .filter_map(|(child, joint)| Some((joint.parent?, child)))
    }
}

impl fmt::Display for Channel {
    /// The BVH spelling.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Channel::Translation(axis) => write!(f, "{}position", axis.letter()),
            Channel::Rotation(axis) => write!(f, "{}rotation", axis.letter()),
            Channel::Length => write!(f, "length"),
        }
    }
}
