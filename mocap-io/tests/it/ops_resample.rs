//! Motions between frames, against matrices turned about an axis by the book.

use mocap_io::ndarray::Array2;
use mocap_io::{Axis, Channel, FrameRate, Joint, LengthUnit, Motion, OffsetFrame, Skeleton};
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::Index;

use crate::ops::{any_motion, any_value, bits, columns};

type Matrix = [[f64; 3]; 3];

/// Entries of rotations, after an arc cosine of a trace: half the digits of `f64` remain where two
/// rotations are nearly the same or nearly opposite.
const ROTATION: f64 = 1e-6;

/// Two rotations this near to half a turn apart (radians) have no shorter way between them.
const HALF_TURN: f64 = 1e-3;

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let entry = |i: usize, j: usize| (0..3).map(|k| a[i][k] * b[k][j]).sum();
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| entry(i, j)))
}

fn transposed(a: &Matrix) -> Matrix {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| a[j][i]))
}

/// Rodrigues' formula.
fn about([x, y, z]: [f64; 3], radians: f64) -> Matrix {
    let (s, c) = radians.sin_cos();
    let k = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
    let kk = product(&k, &k);
    let one = |i, j| if i == j { 1.0 } else { 0.0 };
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| one(i, j) + s * k[i][j] + (1.0 - c) * kk[i][j]))
}

fn angle_of(r: &Matrix) -> f64 {
    ((r[0][0] + r[1][1] + r[2][2] - 1.0) / 2.0)
        .clamp(-1.0, 1.0)
        .acos()
}

/// `A · exp(t · log(A⁻¹ · B))`; `None` where the shorter way is in doubt.
fn arc(a: &Matrix, b: &Matrix, t: f64) -> Option<Matrix> {
    let step = product(&transposed(a), b);
    let angle = angle_of(&step);
    if angle > std::f64::consts::PI - HALF_TURN {
        return None;
    }
    let axis = [
        step[2][1] - step[1][2],
        step[0][2] - step[2][0],
        step[1][0] - step[0][1],
    ];
    let length = axis.iter().map(|v| v * v).sum::<f64>().sqrt();
    if length < 1e-9 {
        return Some(*a);
    }
    Some(product(a, &about(axis.map(|v| v / length), t * angle)))
}

/// The rotation channels of a joint, leftmost factor first.
fn factors(joint: &Joint, columns: &[(Channel, usize)]) -> Vec<(Axis, usize)> {
    let listed = columns
        .iter()
        .filter_map(|&(channel, column)| match channel {
            Channel::Rotation(axis) => Some((axis, column)),
            _ => None,
        });
    let listed: Vec<_> = listed.collect();
    match joint.axis {
        None => listed,
        Some(frame) => {
            let last_first = frame.order.into_iter().rev();
            last_first
                .flat_map(|axis| listed.iter().copied().filter(move |f| f.0 == axis))
                .collect()
        }
    }
}

fn rotation(factors: &[(Axis, usize)], row: &[f64]) -> Matrix {
    let unit = |axis: Axis| [0, 1, 2].map(|i| if i == axis.idx() { 1.0 } else { 0.0 });
    let identity = about([1.0, 0.0, 0.0], 0.0);
    factors.iter().fold(identity, |so_far, &(axis, column)| {
        product(&so_far, &about(unit(axis), row[column].to_radians()))
    })
}

/// Where the frame at `t` between two others is not what the textbook says.
fn check_between(
    motion: &Motion,
    a: &[f64],
    b: &[f64],
    t: f64,
    found: &[f64],
) -> Result<(), TestCaseError> {
    let all = columns(motion);
    for (j, joint) in motion.skeleton.joints().iter().enumerate() {
        let own: Vec<_> = all
            .iter()
            .filter(|c| c.0 == j)
            .map(|c| (c.1, c.2))
            .collect();
        let factors = factors(joint, &own);
        for &(channel, i) in &own {
            if !matches!(channel, Channel::Rotation(_)) {
                let expected = (1.0 - t) * a[i] + t * b[i];
                prop_assert!(
                    (found[i] - expected).abs() <= 1e-9,
                    "{} {}",
                    found[i],
                    expected
                );
            } else if factors.len() < 3 {
                // Alone every angle goes the shorter way round.
                let alone = |row: &[f64]| about([0.0, 0.0, 1.0], row[i].to_radians());
                if let Some(expected) = arc(&alone(a), &alone(b), t) {
                    check_matrix(&alone(found), &expected)?;
                }
            }
        }
        if factors.len() == 3
            && let Some(expected) = arc(&rotation(&factors, a), &rotation(&factors, b), t)
        {
            check_matrix(&rotation(&factors, found), &expected)?;
        }
    }
    Ok(())
}

fn check_matrix(found: &Matrix, expected: &Matrix) -> Result<(), TestCaseError> {
    for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
        prop_assert!(
            (found - expected).abs() <= ROTATION,
            "{} instead of {}",
            found,
            expected
        );
    }
    Ok(())
}

fn row(motion: &Motion, frame: usize) -> Vec<f64> {
    motion.channels.row(frame).to_vec()
}

fn squared(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum()
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn frames_between_frames_match_the_textbook(
        motion in any_motion(any_value(), 4),
        at in vec((any::<Index>(), 0.0..1.0), 0..6),
    ) {
        if motion.n_frames() < 2 {
            return Ok(());
        }
        let position = |(frame, t): &(Index, f64)| frame.index(motion.n_frames() - 1) as f64 + t;
        let positions: Vec<f64> = at.iter().map(position).collect();
        let found = motion.sampled(&positions).unwrap();
        prop_assert_eq!((&found.skeleton, found.rate, found.up), (&motion.skeleton, motion.rate, motion.up));
        prop_assert_eq!(found.n_frames(), positions.len());
        for (k, position) in positions.iter().enumerate() {
            let (frame, t) = (position.floor() as usize, position.fract());
            let (a, b) = (row(&motion, frame), row(&motion, frame + 1));
            check_between(&motion, &a, &b, t, &row(&found, k))?;
        }
    }

    #[test]
    fn no_other_angles_are_nearer_to_the_frame_before(
        motion in any_motion(any_value(), 4),
        t in 0.01..0.99,
        u in 0.01..0.99,
    ) {
        if motion.n_frames() < 2 {
            return Ok(());
        }
        let found = motion.sampled(&[t, u]).unwrap();
        let (before, now) = (row(&found, 0), row(&found, 1));
        let all = columns(&motion);
        for (j, joint) in motion.skeleton.joints().iter().enumerate() {
            let own: Vec<_> = all.iter().filter(|c| c.0 == j).map(|c| (c.1, c.2)).collect();
            let at: Vec<usize> = factors(joint, &own).iter().map(|f| f.1).collect();
            let (before, now): (Vec<f64>, Vec<f64>) = at.iter().map(|&i| (before[i], now[i])).unzip();
            let mut others = vec![now.clone()];
            if let [a, b, c] = now[..] {
                others.push(vec![a + 180.0, 180.0 - b, c + 180.0]);
            }
            for other in others {
                for turns in 0..5usize.pow(at.len() as u32) {
                    let turn = |(i, v): (usize, &f64)| v + 360.0 * ((turns / 5usize.pow(i as u32) % 5) as f64 - 2.0);
                    let other: Vec<f64> = other.iter().enumerate().map(turn).collect();
                    prop_assert!(squared(&now, &before) <= squared(&other, &before) + 1e-6,
                        "{:?} after {:?}, where {:?} is nearer", now, before, other);
                }
            }
        }
    }

    #[test]
    fn whole_positions_give_their_frames_to_the_bit(
        motion in any_motion(any_value(), 5),
        frames in vec(any::<Index>(), 0..8),
    ) {
        if motion.n_frames() == 0 {
            return Ok(());
        }
        let frames: Vec<usize> = frames.iter().map(|i| i.index(motion.n_frames())).collect();
        let positions: Vec<f64> = frames.iter().map(|&f| f as f64).collect();
        let found = motion.sampled(&positions).unwrap();
        for (k, &frame) in frames.iter().enumerate() {
            prop_assert_eq!(row(&found, k), row(&motion, frame));
        }
    }

    #[test]
    fn positions_outside_give_nothing(motion in any_motion(any_value(), 3), past in 1e-9f64..10.0) {
        let last = motion.n_frames() as f64 - 1.0;
        for outside in [last + past, -past, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            prop_assert_eq!(motion.sampled(&[outside]), None);
        }
        prop_assert_eq!(motion.sampled(&[]).map(|m| m.n_frames()), Some(0));
    }

    #[test]
    fn times_of_source_frames_keep_them_to_the_bit(
        motion in any_motion(any_value(), 6),
        hz in 1u32..500,
        times in 1u32..9,
    ) {
        let rate = |hz: u32| FrameRate::from_hz(f64::from(hz)).unwrap();
        let motion = Motion { rate: rate(hz), ..motion };
        let same = motion.resample(rate(hz));
        prop_assert_eq!(bits(&same), bits(&motion));
        let finer = motion.resample(rate(hz * times));
        prop_assert_eq!(finer.rate, rate(hz * times));
        let again = finer.resample(rate(hz));
        prop_assert_eq!(again.n_frames(), motion.n_frames());
        prop_assert_eq!(bits(&again), bits(&motion));
    }

    #[test]
    fn new_frames_fill_the_time_and_stand_at_theirs(
        motion in any_motion(any_value(), 6),
        hz in 1u32..300,
        new_hz in 1u32..300,
    ) {
        if motion.n_frames() == 0 {
            return Ok(());
        }
        let rate = |hz: u32| FrameRate::from_hz(f64::from(hz)).unwrap();
        let motion = Motion { rate: rate(hz), ..motion };
        let found = motion.resample(rate(new_hz));
        let last = motion.n_frames() - 1;
        prop_assert_eq!(found.n_frames(), last * new_hz as usize / hz as usize + 1);
        for k in 0..found.n_frames() {
            let position = k as f64 * f64::from(hz) / f64::from(new_hz);
            let frame = (position.floor() as usize).min(last);
            let next = (frame + 1).min(last);
            check_between(&motion, &row(&motion, frame), &row(&motion, next), position - frame as f64, &row(&found, k))?;
        }
    }

    #[test]
    fn what_is_missing_stays_missing_and_nothing_else(
        motion in any_motion(any_value(), 2),
        frame in 0usize..2,
        column in any::<Index>(),
        t in 0.01..0.99,
    ) {
        if motion.n_frames() < 2 || motion.skeleton.n_channels() == 0 {
            return Ok(());
        }
        let column = column.index(motion.skeleton.n_channels());
        let mut holed = motion.clone();
        holed.channels[[frame, column]] = f64::NAN;
        let all = columns(&motion);
        let (joint, channel, _) = all[column];
        let turns = |c: &Channel| matches!(c, Channel::Rotation(_));
        let n_turns = motion.skeleton.joints()[joint].channels.iter().filter(|c| turns(c)).count();
        let found = row(&holed.sampled(&[t]).unwrap(), 0);
        let whole = row(&motion.sampled(&[t]).unwrap(), 0);
        for (j, c, i) in all {
            let is_missing = i == column || (j == joint && turns(&c) && turns(&channel) && n_turns == 3);
            if is_missing {
                prop_assert!(found[i].is_nan(), "column {}", i);
            } else if frame == 1 {
                prop_assert_eq!(found[i].to_bits(), whole[i].to_bits());
            } else {
                prop_assert!(!found[i].is_nan(), "column {}", i);
            }
        }
    }
}

/// Over the half turn, with angles wrapped as capture software writes them.
#[test]
fn a_wrapped_angle_goes_on_the_shorter_way() {
    let joint = Joint {
        name: "a".to_owned(),
        parent: None,
        offset: [0.0; 3],
        channels: vec![Channel::Rotation(Axis::Y)],
        axis: None,
        end_site: false,
    };
    let skeleton = Skeleton::new(vec![joint], OffsetFrame::Parent).unwrap();
    let channels = Array2::from_shape_vec((3, 1), vec![170.0, -170.0, -150.0]).unwrap();
    let rate = FrameRate::from_hz(1.0).unwrap();
    let motion = Motion::new(skeleton, channels, rate, LengthUnit::METRE).unwrap();
    let found = motion.sampled(&[0.0, 0.25, 0.75, 1.5]).unwrap();
    assert_eq!(
        found.channels.into_raw_vec_and_offset().0,
        [170.0, 175.0, 185.0, 200.0]
    );
}
