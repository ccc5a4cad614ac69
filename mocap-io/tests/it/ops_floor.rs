//! Motions moved on the floor.

use std::f64::consts::{FRAC_PI_2, PI};

use mocap_io::ndarray::Array2;
use mocap_io::{
    Axis, AxisFrame, Channel, FrameRate, Joint, LengthUnit, Motion, OffsetFrame, Skeleton, UpAxis,
};
use proptest::prelude::*;
use proptest::sample::select;

use crate::ops::{all_moved, any_motion, any_value, bits, check_places, columns, places};
use crate::strategies::angle;

/// A heading is an arc tangent of entries that were rounded some ten times.
const RADIANS: f64 = 1e-9;

/// Where the +Z axis has so little left on the floor, its direction is rounding.
const STEEP: f64 = 1e-3;

fn angle_between(a: f64, b: f64) -> f64 {
    (a - b + PI).rem_euclid(2.0 * PI) - PI
}

/// A root and a rigid bone from it along +Z of the positions.
fn pointer(frame: OffsetFrame, up: UpAxis, axis: AxisFrame, degrees: [f64; 3]) -> Motion {
    // What to_up makes of Z where Y is up.
    let offset = match (up.axis(), up.is_reversed()) {
        (Axis::X, _) => [0.0, 0.0, 1.0],
        (Axis::Y, reversed) => [0.0, 0.0, if reversed { -1.0 } else { 1.0 }],
        (Axis::Z, reversed) => [0.0, if reversed { 1.0 } else { -1.0 }, 0.0],
    };
    let own = frame == OffsetFrame::Own;
    let joint = |name: &str, parent, channels, offset| Joint {
        name: name.to_owned(),
        parent,
        offset,
        channels,
        axis: own.then_some(if parent.is_none() {
            axis
        } else {
            AxisFrame::xyz([0.0; 3])
        }),
        end_site: false,
    };
    let turns = [Axis::Z, Axis::Y, Axis::X].map(Channel::Rotation).to_vec();
    let joints = vec![
        joint("root", None, turns, [0.3, 0.2, 0.1]),
        joint("tip", Some(0), Vec::new(), offset),
    ];
    let skeleton = Skeleton::new(joints, frame).unwrap();
    let channels = Array2::from_shape_vec((1, 3), degrees.to_vec()).unwrap();
    let motion = Motion::new(
        skeleton,
        channels,
        FrameRate::from_hz(1.0).unwrap(),
        LengthUnit::METRE,
    );
    Motion {
        up,
        ..motion.unwrap()
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_heading_is_where_a_bone_along_z_points(
        own in any::<bool>(),
        up in select(UpAxis::ALL.to_vec()),
        degrees in [angle(), angle(), angle()],
        axis in [angle(), angle(), angle()],
        order in Just(Axis::ALL.to_vec()).prop_shuffle(),
    ) {
        let frame = if own { OffsetFrame::Own } else { OffsetFrame::Parent };
        let axis = AxisFrame { degrees: axis, order: order.try_into().unwrap() };
        let motion = pointer(frame, up, axis, degrees);
        let places = places(&motion);
        let (from, to) = (places[0][0], places[0][1]);
        let (x, z) = (to[0] - from[0], to[2] - from[2]);
        let found = motion.heading(0);
        if x.hypot(z) > STEEP {
            let found = found.unwrap();
            prop_assert!(angle_between(found, x.atan2(z)).abs() <= RADIANS / STEEP, "{found}");
            prop_assert!((-PI..=PI).contains(&found));
        }
        prop_assert_eq!(motion.heading(1), None);
    }

    #[test]
    fn free_roots_change_nothing_but_the_channels_of_roots(motion in any_motion(any_value(), 3)) {
        let free = motion.with_free_roots();
        check_places(&places(&free), &places(&motion))?;
        prop_assert_eq!(&free.with_free_roots().skeleton, &free.skeleton);
        prop_assert_eq!(bits(&free.with_free_roots()), bits(&free));
        let root = &free.skeleton.joints()[0];
        for axis in Axis::ALL {
            prop_assert!(root.channels.contains(&Channel::Translation(axis)));
            prop_assert!(root.channels.contains(&Channel::Rotation(axis)));
        }
        let below = |m: &Motion| -> Vec<Vec<u64>> {
            let column = |c: &(usize, Channel, usize)| m.channels.column(c.2).iter().map(|v| v.to_bits()).collect();
            columns(m).iter().filter(|c| c.0 > 0).map(column).collect()
        };
        prop_assert_eq!(below(&free), below(&motion));
        if motion.skeleton.joints()[0].channels.len() == 6 {
            prop_assert_eq!(&free.skeleton, &motion.skeleton);
            prop_assert_eq!(bits(&free), bits(&motion));
        }
    }

    #[test]
    fn a_moved_motion_is_moved_everywhere(
        motion in any_motion(any_value(), 3),
        yaw in prop_oneof![Just(0.0), -7.0..7.0],
        to in [-5.0..5.0, -5.0..5.0],
    ) {
        let found = motion.moved(yaw, to);
        check_places(&places(&found), &all_moved(&places(&motion), yaw, to))?;
        for frame in 0..motion.n_frames() {
            if let (Some(before), Some(after)) = (motion.heading(frame), found.heading(frame)) {
                prop_assert!(angle_between(after, before + yaw).abs() <= 1e-6, "{before} {after}");
            }
        }
        if yaw == 0.0 {
            let free = motion.with_free_roots();
            for (_, channel, column) in columns(&free) {
                if let Channel::Rotation(_) = channel {
                    prop_assert_eq!(found.channels.column(column), free.channels.column(column));
                }
            }
        }
    }

    #[test]
    fn in_the_facing_frame_the_root_stands_over_the_origin_and_faces_z(
        motion in any_motion(any_value(), 3),
        frame in 0usize..4,
    ) {
        let Some(found) = motion.in_facing_frame(frame) else {
            prop_assert_eq!(motion.heading(frame), None);
            return Ok(());
        };
        let heading = motion.heading(frame).unwrap();
        prop_assert!(found.heading(frame).unwrap().abs() <= 1e-6);
        let before = places(&motion);
        let [x, _, z] = before[frame][0];
        let back = all_moved(&[vec![[-x, 0.0, -z]]], -heading, [0.0; 2])[0][0];
        check_places(&places(&found), &all_moved(&before, -heading, [back[0], back[2]]))?;
        check_places(&places(&found.in_facing_frame(frame).unwrap()), &places(&found))?;
    }
}

#[test]
fn a_heading_that_is_vertical_or_missing_is_none() {
    let straight = AxisFrame::xyz([0.0; 3]);
    for frame in [OffsetFrame::Parent, OffsetFrame::Own] {
        let heading = |degrees| pointer(frame, UpAxis::Y, straight, degrees).heading(0);
        assert_eq!(heading([0.0, 0.0, 90.0]), None);
        assert_eq!(heading([0.0, f64::NAN, 0.0]), None);
        assert!((heading([0.0, 90.0, 0.0]).unwrap() - FRAC_PI_2).abs() <= RADIANS);
    }
}

#[test]
fn all_roots_move_together_and_the_first_decides() {
    let joint = |name: &str| Joint {
        name: name.to_owned(),
        parent: None,
        offset: [0.0; 3],
        channels: [
            Axis::ALL.map(Channel::Translation),
            Axis::ALL.map(Channel::Rotation),
        ]
        .concat(),
        axis: None,
        end_site: false,
    };
    let skeleton = Skeleton::new(vec![joint("a"), joint("b")], OffsetFrame::Parent).unwrap();
    // a stands at x = 1 and faces +X; b stands two metres before it and faces it.
    let row = vec![
        1.0, 1.0, 0.0, 0.0, 90.0, 0.0, 3.0, 1.0, 0.0, 0.0, -90.0, 0.0,
    ];
    let channels = Array2::from_shape_vec((1, 12), row).unwrap();
    let rate = FrameRate::from_hz(1.0).unwrap();
    let motion = Motion::new(skeleton, channels, rate, LengthUnit::METRE).unwrap();
    let found = motion.in_facing_frame(0).unwrap();
    check_places(&places(&found), &[vec![[0.0, 1.0, 0.0], [0.0, 1.0, 2.0]]]).unwrap();
    assert!((found.channels[[0, 10]].abs() - 180.0).abs() <= 1e-9);
}
