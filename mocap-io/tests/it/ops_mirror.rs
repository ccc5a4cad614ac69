//! Motions in the mirror, and the same motions in other axes.

use mocap_io::{Channel, Joint, MirrorError, Motion, OffsetFrame, Skeleton, UpAxis, mirror_pairs};
use proptest::prelude::*;
use proptest::sample::{Index, select};

use crate::ops::{any_motion, any_value, bits, check_places, places};
use crate::strategies::{Freedom, skeleton};

fn reflected([x, y, z]: [f64; 3]) -> [f64; 3] {
    [-x, y, z]
}

/// Some joints with partners, whatever tree they are in; the root is its own.
fn any_pairs(n_joints: usize, picks: &[(Index, Index)]) -> Vec<usize> {
    let mut pairs: Vec<usize> = (0..n_joints).collect();
    for (a, b) in picks {
        let (a, b) = (1 + a.index(n_joints - 1), 1 + b.index(n_joints - 1));
        if pairs[a] == a && pairs[b] == b {
            pairs.swap(a, b);
        }
    }
    pairs
}

/// Of each joint of `from` the index of the one with its name in `to`.
fn by_name(from: &Motion, to: &Motion) -> Vec<usize> {
    from.skeleton
        .names()
        .map(|name| to.skeleton.find(name).unwrap())
        .collect()
}

fn reordered(frames: &[Vec<[f64; 3]>], order: &[usize]) -> Vec<Vec<[f64; 3]>> {
    let frame = |frame: &Vec<[f64; 3]>| order.iter().map(|&j| frame[j]).collect();
    frames.iter().map(frame).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_joint_is_where_the_mirror_shows_its_partner(
        motion in any_motion(any_value(), 3),
        picks in proptest::collection::vec(any::<(Index, Index)>(), 0..4),
    ) {
        let pairs = any_pairs(motion.skeleton.joints().len(), &picks);
        let mirrored = motion.mirror(&pairs).unwrap();
        prop_assert_eq!((mirrored.rate, mirrored.unit, mirrored.up), (motion.rate, motion.unit, motion.up));
        let now_at = by_name(&motion, &mirrored);
        let expected: Vec<Vec<[f64; 3]>> = places(&motion)
            .iter()
            .map(|frame| pairs.iter().map(|&j| reflected(frame[j])).collect())
            .collect();
        check_places(&reordered(&places(&mirrored), &now_at), &expected)?;

        // Twice is once more the same.
        let mut pairs_now = pairs.clone();
        for (j, &partner) in pairs.iter().enumerate() {
            pairs_now[now_at[j]] = now_at[partner];
        }
        let again = mirrored.mirror(&pairs_now).unwrap();
        let order = by_name(&motion, &again);
        check_places(&reordered(&places(&again), &order), &places(&motion))?;
        if order.is_sorted() {
            prop_assert_eq!(&again.skeleton, &motion.skeleton);
            prop_assert_eq!(bits(&again), bits(&motion));
        }
    }

    #[test]
    fn found_pairs_are_mutual_and_respect_the_tree(
        skeleton in skeleton(OffsetFrame::Parent, Freedom::of_bvh()),
        names in proptest::collection::vec(
            select(vec!["Hips", "LeftArm", "RightArm", "lhand", "rhand", "toe.L", "toe.R", "Llama", "rroot"]), 10),
    ) {
        let named = |(joint, name): (&Joint, &&str)| Joint { name: (*name).to_owned(), ..joint.clone() };
        let joints: Vec<Joint> = skeleton.joints().iter().zip(&names).map(named).collect();
        let skeleton = Skeleton::new(joints, OffsetFrame::Parent).unwrap();
        let joints = skeleton.joints();
        let pairs = mirror_pairs(&skeleton);
        let other = |name: &str| match name {
            "LeftArm" => "RightArm",
            "RightArm" => "LeftArm",
            "lhand" => "rhand",
            "rhand" => "lhand",
            "toe.L" => "toe.R",
            "toe.R" => "toe.L",
            _ => "",
        }.to_owned();
        for (j, &partner) in pairs.iter().enumerate() {
            prop_assert_eq!(pairs[partner], j);
            if partner != j {
                prop_assert_eq!(&joints[partner].name, &other(&joints[j].name));
                prop_assert_eq!(joints[partner].parent, joints[j].parent.map(|p| pairs[p]));
            } else {
                // Nobody who would do is left over.
                let would_do = |k: &usize| pairs[*k] == *k && joints[*k].name == other(&joints[j].name)
                    && joints[*k].parent == joints[j].parent.map(|p| pairs[p]);
                prop_assert_eq!((0..joints.len()).find(would_do), None);
            }
        }
    }

    #[test]
    fn other_axes_keep_positions_and_lead_back(
        motion in any_motion(any_value(), 3),
        up in select(UpAxis::ALL.to_vec()),
        picks in proptest::collection::vec(any::<(Index, Index)>(), 0..4),
    ) {
        let turned = motion.to_up(up);
        prop_assert_eq!(turned.up, up);
        check_places(&places(&turned), &places(&motion))?;
        let back = turned.to_up(motion.up);
        prop_assert_eq!(&back.skeleton, &motion.skeleton);
        prop_assert_eq!(bits(&back), bits(&motion));
        // The mirror does not care in which axes a file is written.
        let pairs = any_pairs(motion.skeleton.joints().len(), &picks);
        let (a, b) = (turned.mirror(&pairs).unwrap(), motion.mirror(&pairs).unwrap());
        check_places(&places(&a), &places(&b))?;
        for frame in 0..motion.n_frames() {
            match (turned.heading(frame), motion.heading(frame)) {
                (Some(a), Some(b)) => prop_assert!((a - b).sin().abs() <= 1e-6 && (a - b).cos() > 0.0),
                (a, b) => prop_assert_eq!(a, b),
            }
        }
    }
}

fn tree(names: &[(&str, Option<usize>)]) -> Skeleton {
    let joint = |(name, parent): &(&str, Option<usize>)| Joint {
        name: (*name).to_owned(),
        parent: *parent,
        offset: [1.0, 2.0, 3.0],
        channels: Vec::<Channel>::new(),
        axis: None,
        end_site: false,
    };
    Skeleton::new(names.iter().map(joint).collect(), OffsetFrame::Parent).unwrap()
}

#[test]
fn a_partner_has_the_partner_of_the_parent() {
    // Two characters with the same names, and a left thumb on the wrong hand.
    let skeleton = tree(&[
        ("Hips", None),
        ("LeftHand", Some(0)),
        ("LeftThumb", Some(1)),
        ("RightHand", Some(0)),
        ("RightThumb", Some(0)),
        ("Hips", None),
        ("RightHand", Some(5)),
        ("LeftHand", Some(5)),
    ]);
    assert_eq!(mirror_pairs(&skeleton), [0, 3, 2, 1, 4, 5, 7, 6]);
    let skeleton = tree(&[
        ("root", None),
        ("lowerback", Some(0)),
        ("rotor", Some(0)),
        ("Llama", Some(0)),
    ]);
    assert_eq!(mirror_pairs(&skeleton), [0, 1, 2, 3]);
}

#[test]
fn pairs_that_are_none_are_refused() {
    let rate = mocap_io::FrameRate::from_hz(30.0).unwrap();
    let none = mocap_io::ndarray::Array2::zeros((1, 0));
    let skeleton = tree(&[("a", None), ("b", Some(0)), ("c", Some(0))]);
    let motion = Motion::new(skeleton, none, rate, mocap_io::LengthUnit::METRE).unwrap();
    let count = MirrorError::Count {
        expected: 3,
        found: 2,
    };
    assert_eq!(motion.mirror(&[0, 1]), Err(count));
    for partner_idx in [2, 7] {
        let error = motion
            .mirror(&[0, partner_idx, 1 + usize::from(partner_idx == 2)])
            .unwrap_err();
        let is_expected = matches!(&error, MirrorError::NotMutual { joint_idx: 1, name, partner_idx: p } if name == "b" && *p == partner_idx);
        assert!(is_expected, "{error}");
    }
}
