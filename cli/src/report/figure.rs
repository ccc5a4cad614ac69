//! Skeletons as they are drawn.

use relfeat::{BodyMap, BodyPoint};

use super::document::{Bone, Figure, Side};
use crate::picture::strip::{side_of, strokes};

/// Each body point that hangs on others: the nearest of them that the rig places, and millimetres.
const HANGS_ON: [(BodyPoint, &[BodyPoint], u16); 23] = {
    use BodyPoint as P;
    [
        (P::LHip, &[P::Root], 110),
        (P::LKnee, &[P::LHip, P::Root], 115),
        (P::LAnkle, &[P::LKnee, P::LHip], 85),
        (P::LToes, &[P::LAnkle], 65),
        (P::RHip, &[P::Root], 110),
        (P::RKnee, &[P::RHip, P::Root], 115),
        (P::RAnkle, &[P::RKnee, P::RHip], 85),
        (P::RToes, &[P::RAnkle], 65),
        (P::Belly, &[P::Root], 130),
        (P::Chest, &[P::Belly, P::Root], 140),
        (P::Neck, &[P::Chest, P::Belly, P::Root], 100),
        (P::Head, &[P::Neck, P::Chest, P::Root], 75),
        (P::HeadTop, &[P::Head, P::Neck], 150),
        (P::LClavicle, &[P::Chest, P::Neck], 90),
        (
            P::LShoulder,
            &[P::LClavicle, P::Neck, P::Chest, P::Root],
            85,
        ),
        (P::LElbow, &[P::LShoulder, P::LClavicle], 75),
        (P::LWrist, &[P::LElbow, P::LShoulder], 60),
        (P::LFingers, &[P::LWrist], 50),
        (P::RClavicle, &[P::Chest, P::Neck], 90),
        (
            P::RShoulder,
            &[P::RClavicle, P::Neck, P::Chest, P::Root],
            85,
        ),
        (P::RElbow, &[P::RShoulder, P::RClavicle], 75),
        (P::RWrist, &[P::RElbow, P::RShoulder], 60),
        (P::RFingers, &[P::RWrist], 50),
    ]
};

/// Thickness of a marker in millimetres.
const MARKER: u16 = 30;

/// The 24 body points, and a bone to each that the rig places.
#[must_use]
pub fn of_body(map: &BodyMap) -> Figure {
    let placed = HANGS_ON.iter().filter(|(point, ..)| map.places(*point));
    let bones = placed.filter_map(|&(to, from, width)| {
        let from = from.iter().find(|&&from| map.places(from))?;
        Some(Bone {
            from: from.idx(),
            to: to.idx(),
            side: side(to),
            width,
        })
    });
    Figure {
        bones: bones.collect(),
        points: BodyPoint::ALL.map(|p| p.name().to_owned()).to_vec(),
    }
}

fn side(point: BodyPoint) -> Side {
    match (point.mirrored() == point, point.name().as_bytes()[0]) {
        (false, b'l') => Side::Left,
        (false, _) => Side::Right,
        (true, _) => Side::Middle,
    }
}

/// Joints and their bones; of markers, which have none, each is a bone from itself to itself.
#[must_use]
pub fn of_joints(names: &[&str], bones: &[(usize, usize)]) -> Figure {
    let sided = |from: usize, to: usize, width: u16| Bone {
        from,
        to,
        side: side_of(&names[to].to_ascii_lowercase()),
        width,
    };
    let points = names.iter().map(|&name| name.to_owned()).collect();
    let bones = match bones {
        [] => (0..names.len()).map(|i| sided(i, i, MARKER)).collect(),
        bones => strokes(names, bones)
            .iter()
            .map(|stroke| {
                let millimetres = (stroke.width * 1000.0).round() as u16;
                sided(stroke.from, stroke.to, millimetres)
            })
            .collect(),
    };
    Figure { points, bones }
}
