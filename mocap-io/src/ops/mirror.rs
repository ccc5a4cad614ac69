use ndarray::Array2;

use crate::{Axis, Channel, Joint, Motion, Skeleton};

/// Why joints do not mirror each other.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MirrorError {
    /// Not one partner per joint.
    #[error("expected a partner for each of the {expected} joints, found {found}")]
    Count {
        /// Joints of the skeleton.
        expected: usize,
        /// Partners given.
        found: usize,
    },
    /// A partner that does not exist, or whose own partner is another joint.
    #[error(
        "joint {joint_idx} ({name:?}) has joint {partner_idx} as its partner, which does not have \
         joint {joint_idx} as its own"
    )]
    NotMutual {
        /// Index of the joint.
        joint_idx: usize,
        /// Its name.
        name: String,
        /// The partner it names.
        partner_idx: usize,
    },
}

impl Motion {
    /// The motion as a mirror shows it: left and right are exchanged, by a reflection of positions
    /// across the plane x = 0. (In a file with Y or Z up that is the file's X, with X up its Y.)
    ///
    /// `pairs` gives each joint's partner on the other side, as [`mirror_pairs`](crate::mirror_pairs)
    /// finds them. Joint `j` gets the reflected offset, axis frame, channels and parent of its partner and
    /// keeps its name, so its positions are the reflected ones of its partner. A performer whose left leg
    /// is the longer one gets a longer right leg. Mirrored twice every number is the same again.
    ///
    /// A joint that is its own partner moves over with its parent: a sword in the left hand is then
    /// in the right one. Where joints hang differently afterwards and a parent would come after its child,
    /// the joints are put in depth-first order; where the tree is symmetric the order stays.
    ///
    /// O(frames · channels).
    ///
    /// # Errors
    /// [`MirrorError`] if `pairs` is not one partner per joint, mutual.
    pub fn mirror(&self, pairs: &[usize]) -> Result<Motion, MirrorError> {
        let joints = self.skeleton.joints();
        check(joints, pairs)?;
        let parent = |j: usize| joints[pairs[j]].parent.map(|p| pairs[p]);
        let parents: Vec<Option<usize>> = (0..joints.len()).map(parent).collect();
        let order = order(&parents);
        let mut new_idx = vec![0; joints.len()];
        for (new, &old) in order.iter().enumerate() {
            new_idx[old] = new;
        }
        let across = self.up.axes()[0].0;
        let mirrored = |&j: &usize| {
            let partner = &joints[pairs[j]];
            Joint {
                name: joints[j].name.clone(),
                parent: parents[j].map(|p| new_idx[p]),
                ..reflected(partner, across)
            }
        };
        let skeleton = Skeleton::new(
            order.iter().map(mirrored).collect(),
            self.skeleton.offset_frame(),
        )
        .expect("parents come first, and signs keep numbers finite");
        let mut columns = Vec::with_capacity(skeleton.n_channels());
        for &j in &order {
            let first = self.skeleton.first_channel(pairs[j]).unwrap_or(0);
            for (&channel, column) in joints[pairs[j]].channels.iter().zip(first..) {
                columns.push((column, sign(channel, across)));
            }
        }
        let mut channels = Array2::zeros((self.n_frames(), columns.len()));
        for (values, mut row) in self.rows().zip(channels.rows_mut()) {
            for (value, &(column, sign)) in row.iter_mut().zip(&columns) {
                *value = values[column] * sign;
            }
        }
        Ok(Motion {
            skeleton,
            channels,
            ..self.without_frames()
        })
    }
}

fn check(joints: &[Joint], pairs: &[usize]) -> Result<(), MirrorError> {
    if pairs.len() != joints.len() {
        return Err(MirrorError::Count {
            expected: joints.len(),
            found: pairs.len(),
        });
    }
    match (0..pairs.len()).find(|&j| pairs.get(pairs[j]) != Some(&j)) {
        None => Ok(()),
        Some(joint_idx) => Err(MirrorError::NotMutual {
            joint_idx,
            name: joints[joint_idx].name.clone(),
            partner_idx: pairs[joint_idx],
        }),
    }
}

/// The joints in their old order if parents come first in it, else depth first.
fn order(parents: &[Option<usize>]) -> Vec<usize> {
    let comes_first = |(j, parent): (usize, &Option<usize>)| parent.is_none_or(|p| p < j);
    if parents.iter().enumerate().all(comes_first) {
        return (0..parents.len()).collect();
    }
    let mut children = vec![Vec::new(); parents.len()];
    let mut open = Vec::new();
    for (j, parent) in parents.iter().enumerate().rev() {
        match parent {
            Some(parent) => children[*parent].push(j),
            None => open.push(j),
        }
    }
    let mut order = Vec::with_capacity(parents.len());
    while let Some(j) = open.pop() {
        order.push(j);
        open.append(&mut children[j]);
    }
    order
}

/// A reflection turns a rotation round unless it is about the axis that is reflected.
fn sign(channel: Channel, across: Axis) -> f64 {
    let is_turned = match channel {
        Channel::Translation(axis) => axis == across,
        Channel::Rotation(axis) => axis != across,
        Channel::Length => false,
    };
    if is_turned { -1.0 } else { 1.0 }
}

fn reflected(joint: &Joint, across: Axis) -> Joint {
    let mut joint = joint.clone();
    joint.offset[across.idx()] *= -1.0;
    if let Some(frame) = &mut joint.axis {
        for (degrees, &axis) in frame.degrees.iter_mut().zip(&frame.order) {
            *degrees *= sign(Channel::Rotation(axis), across);
        }
    }
    joint
}
