//! Random skeletons and motions of both kinds.

use mocap_io::ndarray::Array2;
use mocap_io::{
    AngleUnit, Asf, Axis, AxisFrame, Channel, FrameRate, Joint, LengthUnit, Motion, OffsetFrame,
    Skeleton, UpAxis,
};
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::{select, subsequence};

pub(crate) fn rotations() -> Vec<Channel> {
    Axis::ALL.map(Channel::Rotation).to_vec()
}

fn everything() -> Vec<Channel> {
    [
        Axis::ALL.map(Channel::Translation),
        Axis::ALL.map(Channel::Rotation),
    ]
    .concat()
}

/// What the joints of a random skeleton may have.
pub(crate) struct Freedom {
    pub(crate) root: Vec<Channel>,
    pub(crate) joint: Vec<Channel>,
}

impl Freedom {
    pub(crate) fn of_bvh() -> Freedom {
        Freedom {
            root: everything(),
            joint: everything(),
        }
    }

    pub(crate) fn of_acclaim() -> Freedom {
        Freedom {
            root: everything(),
            joint: [everything(), vec![Channel::Length]].concat(),
        }
    }

    /// What survives the conversion to a BVH skeleton: bones that only turn.
    pub(crate) fn of_turning_bones() -> Freedom {
        Freedom {
            root: everything(),
            joint: rotations(),
        }
    }
}

/// Some of `all`, in any order.
fn some(all: Vec<Channel>) -> impl Strategy<Value = Vec<Channel>> {
    let n = all.len();
    subsequence(all, 0..=n).prop_shuffle()
}

/// Right angles, where Euler angles lock, and any others.
pub(crate) fn angle() -> impl Strategy<Value = f64> {
    prop_oneof![
        select(vec![-180.0, -90.0, 0.0, 90.0, 180.0, 270.0]),
        -400.0..400.0
    ]
}

fn vector() -> impl Strategy<Value = [f64; 3]> {
    prop_oneof![
        1 => Just([0.0; 3]),
        9 => [-1.0..1.0, -1.0..1.0, -1.0..1.0],
    ]
}

fn axis_frame() -> impl Strategy<Value = AxisFrame> {
    let order = Just(Axis::ALL.to_vec()).prop_shuffle();
    ([angle(), angle(), angle()], order).prop_map(|(degrees, order)| AxisFrame {
        degrees,
        order: order.try_into().unwrap(),
    })
}

/// Up to nine joints in depth-first order; in BVH with several roots and End Sites, in Acclaim with
/// one root, whose name is `root`.
pub(crate) fn skeleton(frame: OffsetFrame, freedom: Freedom) -> impl Strategy<Value = Skeleton> {
    let one = (
        vector(),
        some(freedom.joint),
        axis_frame(),
        0usize..4,
        any::<bool>(),
    );
    (some(freedom.root), vec(one, 1..9)).prop_map(move |(root_channels, joints)| {
        let mut made = vec![Joint {
            name: "root".to_owned(),
            parent: None,
            offset: [0.5, 0.25, -0.125],
            channels: root_channels,
            axis: (frame == OffsetFrame::Own).then_some(AxisFrame::xyz([0.0; 3])),
            end_site: false,
        }];
        for (offset, channels, axis, n_up, tip) in joints {
            // The joint before or one of its ancestors: that keeps the order depth first.
            let mut parent = made.len() - 1;
            for _ in 0..n_up + usize::from(made[parent].end_site) {
                parent = made[parent].parent.unwrap_or(parent);
            }
            let tip = tip && frame == OffsetFrame::Parent;
            let n_tips = made
                .iter()
                .filter(|j| j.end_site && j.parent == Some(parent))
                .count();
            let name = match (tip, n_tips) {
                (false, _) => format!("j{} a", made.len()),
                (true, 0) => format!("{}_End", made[parent].name),
                (true, n) => format!("{}_End{}", made[parent].name, n + 1),
            };
            let own = frame == OffsetFrame::Own;
            made.push(Joint {
                name: if own { name.replace(' ', ":") } else { name },
                parent: Some(parent),
                offset,
                channels: if tip { Vec::new() } else { channels },
                axis: own.then_some(axis),
                end_site: tip,
            });
        }
        Skeleton::new(made, frame).unwrap()
    })
}

pub(crate) fn unit() -> impl Strategy<Value = LengthUnit> {
    select(vec![
        LengthUnit::METRE,
        LengthUnit::CENTIMETRE,
        LengthUnit::ACCLAIM_CMU,
    ])
}

/// A motion of `skeleton` with up to `max_frames` frames and values from `value`.
pub(crate) fn motion(
    skeleton: impl Strategy<Value = Skeleton>,
    value: impl Strategy<Value = f64> + Clone,
    max_frames: usize,
) -> impl Strategy<Value = Motion> {
    (skeleton, 0..=max_frames, 1e-4..1.0, unit()).prop_flat_map(
        move |(skeleton, n_frames, frame_time, unit)| {
            let n_channels = skeleton.n_channels();
            vec(value.clone(), n_frames * n_channels).prop_map(move |values| {
                let channels = Array2::from_shape_vec((n_frames, n_channels), values).unwrap();
                let rate = FrameRate::from_frame_time(frame_time).unwrap();
                Motion::new(skeleton.clone(), channels, rate, unit).unwrap()
            })
        },
    )
}

/// `motions` with any axis up.
pub(crate) fn any_way_up(motions: impl Strategy<Value = Motion>) -> impl Strategy<Value = Motion> {
    (motions, select(UpAxis::ALL.to_vec())).prop_map(|(motion, up)| Motion { up, ..motion })
}

pub(crate) fn asf_of(skeleton: &Skeleton, unit: LengthUnit) -> Asf {
    Asf {
        name: "random skeleton".to_owned(),
        skeleton: skeleton.clone(),
        unit,
        angle_unit: AngleUnit::Degrees,
        warnings: Vec::new(),
    }
}
