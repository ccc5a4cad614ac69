//! Body points that a rig lacks, made of those that it has.

use super::BodyMap;
use crate::BodyPoint;
use crate::BodyPoint as P;

/// A body point as a weighted sum of others.
struct Derivation {
    point: BodyPoint,
    from: &'static [(BodyPoint, f64)],
    text: &'static str,
}

const fn rule(
    point: BodyPoint,
    from: &'static [(BodyPoint, f64)],
    text: &'static str,
) -> Derivation {
    Derivation { point, from, text }
}

/// Tried in order; each may build on those before it. Only what lies between placed points, or in
/// the prolongation of the neck, is derived: where a knee, a hand or the tip of a foot is cannot be
/// told from the other joints.
///
/// The trunk is cut in equal parts, as in Acclaim skeletons. A head is about one and a half necks
/// long: the median of ten public BVH skeletons that have both.
const RULES: [Derivation; 11] = [
    rule(
        P::Root,
        &[(P::LHip, 0.5), (P::RHip, 0.5)],
        "midway between the hips",
    ),
    rule(
        P::Neck,
        &[(P::LClavicle, 0.5), (P::RClavicle, 0.5)],
        "midway between the clavicles",
    ),
    rule(
        P::Neck,
        &[(P::LShoulder, 0.5), (P::RShoulder, 0.5)],
        "midway between the shoulders",
    ),
    rule(P::LClavicle, &[(P::Neck, 1.0)], "at the neck"),
    rule(P::RClavicle, &[(P::Neck, 1.0)], "at the neck"),
    rule(
        P::Chest,
        &[(P::Belly, 0.5), (P::Neck, 0.5)],
        "midway between belly and neck",
    ),
    rule(
        P::Belly,
        &[(P::Root, 0.5), (P::Chest, 0.5)],
        "midway between root and chest",
    ),
    rule(
        P::Belly,
        &[(P::Root, 2.0 / 3.0), (P::Neck, 1.0 / 3.0)],
        "a third of the way from root to neck",
    ),
    rule(
        P::Chest,
        &[(P::Root, 1.0 / 3.0), (P::Neck, 2.0 / 3.0)],
        "two thirds of the way from root to neck",
    ),
    rule(
        P::Head,
        &[(P::Neck, 0.6), (P::HeadTop, 0.4)],
        "two fifths of the way from neck to headtop",
    ),
    rule(
        P::HeadTop,
        &[(P::Head, 2.5), (P::Neck, -1.5)],
        "beyond the head by one and a half necks",
    ),
];

impl BodyMap {
    /// The map with these points found, and derived what can be.
    pub(super) fn derive(rig: &str, sources: Vec<Vec<(usize, f64)>>) -> BodyMap {
        let mut map = BodyMap {
            rig: rig.to_owned(),
            sources,
            derived: vec![None; BodyPoint::COUNT],
        };
        for rule in &RULES {
            if !map.places(rule.point) && rule.from.iter().all(|&(p, _)| map.places(p)) {
                map.sources[rule.point.idx()] = map.mix(rule.from);
                map.derived[rule.point.idx()] = Some(rule.text);
            }
        }
        map
    }

    /// A weighted sum of body points as a weighted sum of joints, each named once.
    fn mix(&self, points: &[(BodyPoint, f64)]) -> Vec<(usize, f64)> {
        let mut sum: Vec<(usize, f64)> = Vec::new();
        for &(point, share) in points {
            for &(joint, weight) in self.sources(point) {
                match sum.iter_mut().find(|(j, _)| *j == joint) {
                    Some((_, total)) => *total += share * weight,
                    None => sum.push((joint, share * weight)),
                }
            }
        }
        sum
    }
}
