use std::collections::BTreeSet;

use nalgebra::{Matrix3, Vector3};
use ndarray::Array2;

use crate::kinematics::{rotate_columns, rotations};
use crate::rotation::euler_degrees;
use crate::{Axis, AxisFrame, Channel, Joint, Motion, OffsetFrame, Skeleton};

/// An Acclaim skeleton has one root.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("expected one root, found a second one at joint {joint_idx} ({name:?})")]
pub struct SeveralRoots {
    /// Index of the second root.
    pub joint_idx: usize,
    /// Its name.
    pub name: String,
}

/// The factors of a rotation in an Acclaim file, leftmost first: what every reader of AMC assumes.
const ORDER: [Axis; 3] = [Axis::Z, Axis::Y, Axis::X];

impl Motion {
    /// The same motion with the offsets of Acclaim: one bone for each joint, in the same order and tree,
    /// that *ends* where the joint is. A motion that has these offsets already is returned as it is.
    ///
    /// The bone from joint `p` to joint `c` has the name of `c` and the rotation of `p`, since an Acclaim
    /// bone turns with its own rotation; if several bones leave `p`, each one repeats it. The root's
    /// rotation stays with the root. So the rotation of a joint without children, which moves nothing, is
    /// lost. All axis frames are zero with the order XYZ; rotations that this order cannot hold
    /// get other angles, near those of the frame before. A joint with translation channels becomes a bone
    /// that shifts (`tx ty tz`) by what the translation differs from the offset; few
    /// other programs read such bones.
    ///
    /// Names are made such as Acclaim files can hold: the root is called `root`, blanks and
    /// control characters become `_`, and a name that is empty, reserved or taken gets a `_` and a number.
    ///
    /// O(frames · joints).
    ///
    /// # Errors
    /// [`SeveralRoots`] if there is more than one root.
    pub fn to_own_offsets(&self) -> Result<Motion, SeveralRoots> {
        if self.skeleton.offset_frame() == OffsetFrame::Own {
            return Ok(self.clone());
        }
        let joints = self.skeleton.joints();
        let is_second = |&(j, joint): &(usize, &Joint)| j > 0 && joint.parent.is_none();
        if let Some((joint_idx, joint)) = joints.iter().enumerate().find(is_second) {
            return Err(SeveralRoots {
                joint_idx,
                name: joint.name.clone(),
            });
        }
        let sources = Source::all(joints);
        let mut names = Names::default();
        let bone = |(joint, source): (&Joint, &Source)| Joint {
            name: names.acclaim(joint),
            parent: joint.parent,
            offset: match joint.parent {
                Some(_) => joint.offset,
                None => [0.0; 3],
            },
            channels: source.bone_channels(&sources),
            axis: Some(AxisFrame::xyz([0.0; 3])),
            end_site: false,
        };
        let bones = joints.iter().zip(&sources).map(bone).collect();
        let skeleton =
            Skeleton::new(bones, OffsetFrame::Own).expect("the tree and its offsets stay");
        let channels = self.bone_values(&sources, &skeleton);
        Ok(Motion {
            skeleton,
            channels,
            ..self.without_frames()
        })
    }

    fn bone_values(&self, sources: &[Source], skeleton: &Skeleton) -> Array2<f64> {
        let n_channels = skeleton.n_channels();
        let mut values: Vec<f64> = Vec::with_capacity(self.n_frames() * n_channels);
        // Of each joint the rotation, and its angles: the next frame's are to be near them.
        let mut turned = vec![(Matrix3::identity(), [0.0; 3]); sources.len()];
        for row in self.rows() {
            for (source, (rotation, degrees)) in sources.iter().zip(&mut turned) {
                *rotation = source.rotation(&row);
                *degrees = source.degrees(&row, rotation, *degrees);
            }
            for (source, bone) in sources.iter().zip(skeleton.joints()) {
                let mut shift = source.shift(&row);
                let carried = source.carried.map(|j| turned[j]);
                if let (Some((rotation, _)), false) = (carried, source.is_root) {
                    // A bone shifts before it turns, a joint after its parent did.
                    shift = rotation * shift;
                }
                values.extend(bone.channels.iter().map(|channel| match *channel {
                    Channel::Translation(axis) => shift[axis.idx()],
                    Channel::Rotation(axis) => {
                        carried.map_or(0.0, |(_, degrees)| degrees[axis.idx()])
                    }
                    Channel::Length => 0.0,
                }));
            }
        }
        Array2::from_shape_vec((self.n_frames(), n_channels), values)
            .expect("the loop pushed one value per frame and channel")
    }
}

/// A BVH joint, as far as its bone needs it.
struct Source {
    is_root: bool,
    /// The joint whose rotation the bone carries.
    carried: Option<usize>,
    offset: Vector3<f64>,
    /// Translation channels: axis and column.
    translations: Vec<(Axis, usize)>,
    /// Rotation channels, leftmost factor first.
    factors: Vec<(Axis, usize)>,
    /// Whether these stand in the order of [`ORDER`], so that their angles can stay.
    in_order: bool,
}

impl Source {
    fn all(joints: &[Joint]) -> Vec<Source> {
        let mut first = 0;
        let source = |(j, joint): (usize, &Joint)| {
            let factors = rotations(joint, first);
            let rank = |axis: Axis| ORDER.iter().position(|&a| a == axis);
            let translations = joint.channels.iter().zip(first..);
            let source = Source {
                is_root: joint.parent.is_none(),
                carried: match joint.parent {
                    None => Some(j),
                    Some(p) => joints[p].parent.map(|_| p),
                },
                offset: Vector3::from(joint.offset),
                translations: translations
                    .filter_map(|(channel, column)| match *channel {
                        Channel::Translation(axis) => Some((axis, column)),
                        _ => None,
                    })
                    .collect(),
                in_order: factors.windows(2).all(|w| rank(w[0].0) < rank(w[1].0)),
                factors,
            };
            first += joint.channels.len();
            source
        };
        joints.iter().enumerate().map(source).collect()
    }

    fn bone_channels(&self, sources: &[Source]) -> Vec<Channel> {
        let mut channels = Vec::new();
        if self.is_root || !self.translations.is_empty() {
            channels.extend(Axis::ALL.map(Channel::Translation));
        }
        if let Some(carried) = self.carried.map(|j| &sources[j]) {
            let needs_all = self.is_root || !carried.in_order;
            let turns = |axis| needs_all || carried.factors.iter().any(|&(a, _)| a == axis);
            let axes = Axis::ALL.into_iter().filter(|&axis| turns(axis));
            channels.extend(axes.map(Channel::Rotation));
        }
        channels
    }

    fn rotation(&self, row: &[f64]) -> Matrix3<f64> {
        let mut rotation = Matrix3::identity();
        for &(axis, column) in &self.factors {
            rotate_columns(&mut rotation, axis, row[column].to_radians());
        }
        rotation
    }

    /// The angles about X, Y and Z of `rotation = Rz · Ry · Rx`.
    fn degrees(&self, row: &[f64], rotation: &Matrix3<f64>, near: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = near;
        if !self.in_order {
            let [z, y, x] = euler_degrees(rotation, ORDER, [z, y, x]);
            return [x, y, z];
        }
        let mut degrees = [0.0; 3];
        for &(axis, column) in &self.factors {
            degrees[axis.idx()] = row[column];
        }
        degrees
    }

    /// How far the joint is from where its bone ends at rest; of the root, where it is.
    fn shift(&self, row: &[f64]) -> Vector3<f64> {
        let rest = if self.is_root {
            Vector3::zeros()
        } else {
            self.offset
        };
        let mut place = self.offset;
        for &(axis, column) in &self.translations {
            place[axis.idx()] = row[column];
        }
        place - rest
    }
}

/// Names that were given out.
#[derive(Default)]
struct Names(BTreeSet<String>);

impl Names {
    fn acclaim(&mut self, joint: &Joint) -> String {
        let is_blank = |c: char| c.is_whitespace() || c.is_control();
        let mut name = match joint.parent {
            None => "root".to_owned(),
            Some(_) => joint.name.replace(is_blank, "_"),
        };
        // A line that starts with a number is a frame, with # a comment, with : a section.
        let is_misread = name.starts_with(['#', ':']) || name.parse::<f64>().is_ok();
        if is_misread || matches!(name.to_ascii_lowercase().as_str(), "" | "begin" | "end") {
            name.insert(0, '_');
        }
        let mut unique = name.clone();
        let mut n = 2;
        while !self.0.insert(unique.clone()) {
            unique = format!("{name}_{n}");
            n += 1;
        }
        unique
    }
}
