//! Which joints of a skeleton are which points of the body.

mod derive;
mod joint_name;
mod nearest;
mod rig;
#[cfg(test)]
mod tests;

use joint_name::Names;
use rig::{BUILTIN, Compiled};
pub use rig::{PointRule, Rig};

use crate::BodyPoint;

/// Where the body points are, for the joints of one skeleton.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyMap {
    rig: String,
    /// Per body point the joints that it is made of, with weights that sum to 1; none if unplaced.
    sources: Vec<Vec<(usize, f64)>>,
    /// Per body point how it was made of other body points, if it was.
    derived: Vec<Option<&'static str>>,
}

impl BodyMap {
    /// The least [`BodyMap::score`] that [`BodyMap::recognise`] is content with: six body points. A
    /// gait laboratory's legs and pelvis are nine; a prop that has a `root` and a `head` is two.
    pub const MIN_SCORE: f64 = 0.25;

    /// Places the body points by the rig of [`Rig::builtin`] that finds the most of them; on a tie
    /// the earlier rig. A rig whose required joints are not all there is passed over. `None` if no
    /// rig reaches [`BodyMap::MIN_SCORE`].
    ///
    /// Names are split into words at case changes, at borders of letters and digits, and at anything
    /// else, and compared whole: `Spine1` is `spine_01` and `SPINE.1`, but not `Spine12` nor
    /// `Spine1_split`. What comes before a colon does not count (`Alice:Hips`), nor do first words
    /// that many names share (`mixamorig1_`, `Bip01 `, `m_avg_`, `DEF-`). Where there are several
    /// such families of names, body points are sought in one of the largest at a time.
    ///
    /// O(rigs + joints).
    #[must_use]
    pub fn recognise(joint_names: &[&str]) -> Option<BodyMap> {
        let names = Names::new(joint_names);
        let mut best: Option<(usize, BodyMap)> = None;
        for rig in BUILTIN.iter() {
            if let Some((n_found, sources)) = rig.place(&names)
                && n_found > best.as_ref().map_or(0, |(most, _)| *most)
            {
                best = Some((n_found, BodyMap::derive(rig.name(), sources)));
            }
        }
        best.map(|(_, map)| map)
            .filter(|map| map.score() >= BodyMap::MIN_SCORE)
    }

    /// The rigs that find some body point, with their scores, the best first; rigs with equal scores
    /// are in the order of [`Rig::builtin`]. The first is what [`BodyMap::recognise`] takes if its
    /// score is high enough.
    ///
    /// O(rigs + joints).
    #[must_use]
    pub fn candidates(joint_names: &[&str]) -> Vec<(&'static str, f64)> {
        let names = Names::new(joint_names);
        let found = BUILTIN.iter().filter_map(|rig| {
            let (n_found, _) = rig.place(&names)?;
            (n_found > 0).then(|| (rig.name(), score(n_found)))
        });
        let mut candidates: Vec<(&'static str, f64)> = found.collect();
        candidates.sort_by(|a, b| b.1.total_cmp(&a.1));
        candidates
    }

    /// Places the body points by a given rig, however few it finds, and derives what it can. Required
    /// joints are not asked for. Names are compared as in [`BodyMap::recognise`].
    #[must_use]
    pub fn with_rig(joint_names: &[&str], rig: &Rig) -> BodyMap {
        let compiled = Compiled::new(rig);
        let (_, sources) = compiled.place_any(&Names::new(joint_names));
        BodyMap::derive(&rig.name, sources)
    }

    /// The name of the rig.
    #[must_use]
    pub fn rig(&self) -> &str {
        &self.rig
    }

    /// The share of the body points that the rig found among the joint names, 0 to 1. Derived points
    /// do not count.
    #[must_use]
    pub fn score(&self) -> f64 {
        score(self.n_placed() - self.derived.iter().flatten().count())
    }

    /// How a body point that the rig did not find was made of others, such as `midway between belly
    /// and neck`; `None` if it was found or is not placed.
    #[must_use]
    pub fn derived(&self, point: BodyPoint) -> Option<&str> {
        self.derived[point.idx()]
    }

    /// The joints that a body point is made of, with weights that sum to 1; empty if it is not placed.
    #[must_use]
    pub fn sources(&self, point: BodyPoint) -> &[(usize, f64)] {
        &self.sources[point.idx()]
    }

    /// Whether a body point is placed, found or derived.
    #[must_use]
    pub fn places(&self, point: BodyPoint) -> bool {
        !self.sources(point).is_empty()
    }

    /// Number of body points that are placed, at most [`BodyPoint::COUNT`].
    #[must_use]
    pub fn n_placed(&self) -> usize {
        BodyPoint::ALL.iter().filter(|&&p| self.places(p)).count()
    }

    /// The body points that are not placed.
    pub fn missing(&self) -> impl Iterator<Item = BodyPoint> {
        BodyPoint::ALL.into_iter().filter(|&p| !self.places(p))
    }

    /// The joints whose names are nearest to any that a built-in rig knows for a body point, the
    /// nearest first, at most `n`: what a user may have meant. Joints of the other side of the body
    /// are left out, and so are names that are not alike.
    ///
    /// O(joints · rigs).
    #[must_use]
    pub fn nearest<'a>(point: BodyPoint, joint_names: &[&'a str], n: usize) -> Vec<&'a str> {
        nearest::nearest(point, joint_names, n)
    }

    /// The map as a rig of its own, to be saved and changed by hand: derived points are written as
    /// what they are made of. `joint_names` are those that the map was made for.
    #[must_use]
    pub fn to_rig(&self, joint_names: &[&str]) -> Rig {
        let name = |joint: usize| {
            joint_names
                .get(joint)
                .copied()
                .unwrap_or_default()
                .to_owned()
        };
        let rule = |sources: &[(usize, f64)]| match sources {
            [(joint, _)] => PointRule::Joint(name(*joint)),
            mix => PointRule::Mix(mix.iter().map(|&(j, weight)| (name(j), weight)).collect()),
        };
        let placed = BodyPoint::ALL.into_iter().filter(|&p| self.places(p));
        Rig {
            name: self.rig.clone(),
            requires: Vec::new(),
            points: placed.map(|p| (p, vec![rule(self.sources(p))])).collect(),
        }
    }

    /// The map with the sides of the body exchanged: for positions whose x is negated, it places the body points of
    /// the left/right mirrored body.
    #[must_use]
    pub fn mirrored(&self) -> BodyMap {
        let other = |point: BodyPoint| point.mirrored().idx();
        let all = BodyPoint::ALL.into_iter();
        BodyMap {
            rig: self.rig.clone(),
            sources: all
                .clone()
                .map(|p| self.sources[other(p)].clone())
                .collect(),
            derived: all.map(|p| self.derived[other(p)]).collect(),
        }
    }

    /// The largest joint index in the map.
    pub(crate) fn last_joint(&self) -> Option<usize> {
        self.sources.iter().flatten().map(|&(joint, _)| joint).max()
    }
}

fn score(n_found: usize) -> f64 {
    n_found as f64 / BodyPoint::COUNT as f64
}
