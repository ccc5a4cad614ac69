use crate::{Channel, OffsetFrame, Skeleton, UpAxis};

/// What keeps two skeletons from sharing channels. `first` and `second` are in the order of the
/// call, joints count from 0.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SkeletonMismatch {
    /// One has the offsets of BVH, the other one those of Acclaim.
    #[error("offsets are in frame {first:?} in the first skeleton, {second:?} in the second")]
    Layout {
        /// Of the first skeleton.
        first: OffsetFrame,
        /// Of the second one.
        second: OffsetFrame,
    },
    /// Another number of joints, where all joints that both have agree.
    #[error("the first skeleton has {first} joints, the second {second}")]
    Count {
        /// Of the first skeleton.
        first: usize,
        /// Of the second one.
        second: usize,
    },
    /// Another name.
    #[error("joint {joint_idx} is {first:?} in the first skeleton, {second:?} in the second")]
    Name {
        /// Index of the joint.
        joint_idx: usize,
        /// Its name in the first skeleton.
        first: String,
        /// Its name in the second one.
        second: String,
    },
    /// Another parent.
    #[error(
        "joint {joint_idx} ({name:?}) hangs from {} in the first skeleton, {} in the second",
        parent_text(*.first),
        parent_text(*.second)
    )]
    Parent {
        /// Index of the joint.
        joint_idx: usize,
        /// Its name.
        name: String,
        /// Its parent in the first skeleton.
        first: Option<usize>,
        /// Its parent in the second one.
        second: Option<usize>,
    },
    /// Other channels, or the same ones in another order: the order of rotations is part of it.
    #[error(
        "joint {joint_idx} ({name:?}) has channels [{}] in the first skeleton, [{}] in the second",
        channels_text(.first),
        channels_text(.second)
    )]
    Channels {
        /// Index of the joint.
        joint_idx: usize,
        /// Its name.
        name: String,
        /// Its channels in the first skeleton, rotations leftmost factor first.
        first: Vec<Channel>,
        /// Its channels in the second one.
        second: Vec<Channel>,
    },
    /// Another way up.
    #[error("{first} is up in the first motion, {second} in the second")]
    Up {
        /// Of the first motion.
        first: UpAxis,
        /// Of the second one.
        second: UpAxis,
    },
}

fn parent_text(parent: Option<usize>) -> String {
    parent.map_or("nothing".to_owned(), |p| format!("joint {p}"))
}

fn channels_text(channels: &[Channel]) -> String {
    let texts: Vec<String> = channels.iter().map(Channel::to_string).collect();
    texts.join(" ")
}

impl Skeleton {
    /// Whether the channels of `other` mean the same joints: the same names, tree and channel lists.
    /// Offsets and the angles of axis frames may differ, as they do from one performer to the next.
    ///
    /// # Errors
    /// [`SkeletonMismatch`] with the first difference.
    pub fn match_joints(&self, other: &Skeleton) -> Result<(), SkeletonMismatch> {
        let (first, second) = (self.offset_frame(), other.offset_frame());
        if first != second {
            return Err(SkeletonMismatch::Layout { first, second });
        }
        for (joint_idx, (a, b)) in self.joints().iter().zip(other.joints()).enumerate() {
            let name = a.name.clone();
            if a.name != b.name {
                return Err(SkeletonMismatch::Name {
                    joint_idx,
                    first: name,
                    second: b.name.clone(),
                });
            }
            if a.parent != b.parent {
                return Err(SkeletonMismatch::Parent {
                    joint_idx,
                    name,
                    first: a.parent,
                    second: b.parent,
                });
            }
            let order = |joint: &crate::Joint| joint.axis.map(|frame| frame.order);
            if a.channels != b.channels || order(a) != order(b) {
                return Err(SkeletonMismatch::Channels {
                    joint_idx,
                    name,
                    first: a.channels.clone(),
                    second: b.channels.clone(),
                });
            }
        }
        let (first, second) = (self.joints().len(), other.joints().len());
        if first != second {
            return Err(SkeletonMismatch::Count { first, second });
        }
        Ok(())
    }
}
