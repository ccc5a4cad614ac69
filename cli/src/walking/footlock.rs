//! Feet that stay where they touched down.

use std::ops::Range;

use mocap_io::{Channel, Motion, OffsetFrame, forward_kinematics};
use nalgebra::{DMatrix, DVector};
use ndarray::{Array2, Array3};
use relfeat::{BodyMap, BodyPoint};

use super::contact::{Contacts, foot_points};

/// Before and after a contact the foot finds its way to and from the place held, in seconds: half of
/// a walk's swing, so that two contacts in a row do not pull at once.
const EASE_SECONDS: f64 = 0.2;

/// Contacts so many seconds apart are one: from the heel's to the toes' the foot does not leave the
/// floor.
const BRIDGE_SECONDS: f64 = 0.1;

/// The feet may be held so many metres from where they are: further, a leg in a stride no longer
/// reaches, and its knee would snap.
const MAX_SHIFT: f64 = 0.1;

/// Steps of Gauss and Newton: with four a leg that reaches is there to a millimetre.
const N_STEPS: usize = 4;

/// Damping in metres per radian: a tenth of a leg's length, so that feet follow, and a leg that is
/// nearly straight, which cannot get much longer, does not shake.
const DAMPING: f64 = 0.1;

/// Degrees by which channels are changed to see what they do: single precision still shows
/// centimetres to a thousandth.
const PROBE_DEGREES: f64 = 0.5;

/// The two points of a foot, and the channels that move them.
struct Leg {
    /// Columns of the points in contacts: ankle, toes.
    points: [usize; 2],
    columns: Vec<usize>,
}

/// Holds feet in place while they are in contact.
///
/// Within a contact a foot is shifted over the floor against the travel of its toes, or of its ankle
/// where the toes are not in contact, such that its middle frame stays where it is; 0.2 s before and
/// after, or as long as the foot is in the air, the shift comes and goes smoothly. It is 0.1 m at most. Ankle and toes are
/// brought there by the leg's own channels below the hip, by damped least squares; root and hips stay.
///
/// O(frames · joints · channels of a leg).
#[must_use]
pub fn footlock(motion: &Motion, map: &BodyMap, contacts: &Contacts) -> Motion {
    let legs = [
        (BodyPoint::LHip, BodyPoint::LToes, BodyPoint::LAnkle),
        (BodyPoint::RHip, BodyPoint::RToes, BodyPoint::RAnkle),
    ];
    let legs = legs.iter().enumerate().map(|(side, &(hip, toes, ankle))| {
        let points = [2 * side, 2 * side + 1];
        let foot = if map.places(toes) { toes } else { ankle };
        let columns = leg_columns(motion, map, (hip, foot));
        Leg { points, columns }
    });
    let legs: Vec<Leg> = legs.collect();
    let places = foot_points(forward_kinematics(motion).view(), map);
    let mut targets = places.clone();
    for leg in &legs {
        let shifts = shifts(&places, contacts, leg, motion.rate.hz());
        for (k, shift) in shifts.iter().enumerate() {
            for point in leg.points {
                targets[[k, point, 0]] += shift[0] as f32;
                targets[[k, point, 2]] += shift[1] as f32;
            }
        }
    }
    let mut locked = motion.clone();
    for _ in 0..N_STEPS {
        approach(&mut locked, map, &legs, &targets);
    }
    locked
}

/// The rotation channels between hip and foot. A joint's own rotation moves it in Acclaim files, where
/// the hip is the end of a bone, and only what is below it elsewhere.
fn leg_columns(motion: &Motion, map: &BodyMap, (hip, foot): (BodyPoint, BodyPoint)) -> Vec<usize> {
    let skeleton = &motion.skeleton;
    let (&[(hip, _), ..], &[(foot, _), ..]) = (map.sources(hip), map.sources(foot)) else {
        return Vec::new();
    };
    let up = |joint: &usize| skeleton.joints()[*joint].parent;
    let mut chain: Vec<usize> = std::iter::successors(Some(foot), up).collect();
    let Some(at) = chain.iter().position(|&joint| joint == hip) else {
        return Vec::new();
    };
    chain.truncate(match skeleton.offset_frame() {
        OffsetFrame::Own => at,
        OffsetFrame::Parent => at + 1,
    });
    let columns = chain.iter().flat_map(|&joint| {
        let first = skeleton.first_channel(joint).unwrap_or(0);
        let channels = skeleton.joints()[joint].channels.iter().zip(first..);
        channels.filter_map(|(channel, column)| {
            matches!(channel, Channel::Rotation(_)).then_some(column)
        })
    });
    columns.collect()
}

/// Where on the floor, in x and z, a foot is to be shifted in each frame.
fn shifts(places: &Array3<f32>, contacts: &Contacts, leg: &Leg, hz: f64) -> Vec<[f64; 2]> {
    let n_frames = places.shape()[0].min(contacts.on_floor.nrows());
    let resting = |k: usize| {
        let mut points = leg.points.iter().rev();
        points.find(|&&point| contacts.stays(k, point)).copied()
    };
    // Of each step from one frame to the next: the point that rests in it.
    let rests: Vec<Option<usize>> = (1..n_frames).map(|k| resting(k - 1)).collect();
    let mut shifts = vec![[0.0; 2]; places.shape()[0]];
    let held = held_spans(&rests, (BRIDGE_SECONDS * hz).ceil() as usize);
    for span in &held {
        let (start, end) = (span.start, span.end - 1);
        for k in start..end {
            let along = |point: usize, axis: usize| {
                f64::from(places[[k + 1, point, axis]] - places[[k, point, axis]])
            };
            let step = rests[k].map(|point| [along(point, 0), along(point, 2)]);
            let step = step.filter(|step| step.iter().all(|v| v.is_finite()));
            let step = step.unwrap_or_default();
            shifts[k + 1] = [0, 1].map(|i| shifts[k][i] - step[i]);
        }
        let middle = shifts[start + (end - start) / 2];
        for shift in &mut shifts[start..=end] {
            *shift = limited([0, 1].map(|i| shift[i] - middle[i]));
        }
    }
    ease(&mut shifts, &held, (EASE_SECONDS * hz).ceil() as usize);
    shifts
}

/// The frames in which a foot is held: those of steps in which it rests, and of up to `bridge` steps
/// between.
fn held_spans(rests: &[Option<usize>], bridge: usize) -> Vec<Range<usize>> {
    let mut held: Vec<Range<usize>> = Vec::new();
    for k in (0..rests.len()).filter(|&k| rests[k].is_some()) {
        match held.last_mut() {
            Some(span) if k < span.end + bridge => span.end = k + 2,
            _ => held.push(k..k + 2),
        }
    }
    held
}

fn limited(shift: [f64; 2]) -> [f64; 2] {
    let far = shift[0].hypot(shift[1]);
    shift.map(|v| {
        if far > MAX_SHIFT {
            v * MAX_SHIFT / far
        } else {
            v
        }
    })
}

/// Lets the shifts come and go outside of the frames held.
fn ease(shifts: &mut [[f64; 2]], held: &[Range<usize>], n_frames: usize) {
    let n = shifts.len();
    for (i, span) in held.iter().enumerate() {
        let before = if i == 0 { 0 } else { held[i - 1].end };
        let after = held.get(i + 1).map_or(n, |next| next.start);
        // A contact at the start or end of the walk has a gap there that none else ends.
        let reach = |gap: usize| n_frames.min(gap + 1);
        let fade = |j: usize, reach: usize| {
            let t = 1.0 - j as f64 / reach as f64;
            t * t * (3.0 - 2.0 * t)
        };
        let (first, last) = (shifts[span.start], shifts[span.end - 1]);
        let reach_before = reach(span.start - before);
        for j in 1..reach_before {
            let shift = &mut shifts[span.start - j];
            *shift = [0, 1].map(|i| shift[i] + fade(j, reach_before) * first[i]);
        }
        let reach_after = reach(after - span.end);
        for j in 1..reach_after {
            let shift = &mut shifts[span.end - 1 + j];
            *shift = [0, 1].map(|i| shift[i] + fade(j, reach_after) * last[i]);
        }
    }
}

/// One step of all frames towards the targets. Both legs' channels are probed at once: neither moves
/// the other's points.
fn approach(motion: &mut Motion, map: &BodyMap, legs: &[Leg], targets: &Array3<f32>) {
    let places = |motion: &Motion| foot_points(forward_kinematics(motion).view(), map);
    let now = places(motion);
    let n_probes = legs.iter().map(|leg| leg.columns.len()).max().unwrap_or(0);
    let probes: Vec<Array3<f32>> = (0..n_probes)
        .map(|i| {
            let mut probe = motion.clone();
            for column in legs.iter().filter_map(|leg| leg.columns.get(i)) {
                probe
                    .channels
                    .column_mut(*column)
                    .mapv_inplace(|v| v + PROBE_DEGREES);
            }
            places(&probe)
        })
        .collect();
    for leg in legs {
        for k in 0..motion.n_frames() {
            turn(&mut motion.channels, k, leg, (&now, &probes, targets));
        }
    }
}

type Probed<'a> = (&'a Array3<f32>, &'a [Array3<f32>], &'a Array3<f32>);

fn turn(channels: &mut Array2<f64>, k: usize, leg: &Leg, (now, probes, targets): Probed<'_>) {
    let rows = leg
        .points
        .iter()
        .flat_map(|&point| [0, 1, 2].map(|axis| [k, point, axis]));
    let rows: Vec<[usize; 3]> = rows.filter(|&at| now[at].is_finite()).collect();
    let missing = DVector::from_iterator(
        rows.len(),
        rows.iter().map(|&at| f64::from(targets[at] - now[at])),
    );
    if missing.iter().all(|&v| v == 0.0) {
        return;
    }
    let per_radian = 1.0 / PROBE_DEGREES.to_radians();
    let effect = DMatrix::from_fn(rows.len(), leg.columns.len(), |row, i| {
        f64::from(probes[i][rows[row]] - now[rows[row]]) * per_radian
    });
    let mut normal = &effect * effect.transpose();
    for i in 0..rows.len() {
        normal[(i, i)] += DAMPING * DAMPING;
    }
    let Some(solved) = normal.cholesky().map(|c| c.solve(&missing)) else {
        return;
    };
    let turns = effect.transpose() * solved;
    for (&column, turn) in leg.columns.iter().zip(turns.iter()) {
        channels[[k, column]] += turn.to_degrees();
    }
}
