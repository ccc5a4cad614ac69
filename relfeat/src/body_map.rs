use std::collections::BTreeMap;

use ndarray::ArrayView3;
use serde::Deserialize;

use crate::{BodyPoint, ConfigError};

/// Which joint is which body point, for the joints of one skeleton.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BodyMap {
    rig: String,
    joints: [Option<usize>; BodyPoint::COUNT],
}

/// A naming convention: for each body point the joint names that mean it, the best first.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rig {
    /// What to call the convention.
    pub name: String,
    /// Joint names per body point.
    pub points: BTreeMap<BodyPoint, Vec<String>>,
}

/// The rigs that [`BodyMap::recognise`] knows, in order of preference when two fit equally well.
const RIGS: [&str; 5] = [
    include_str!("rigs/acclaim-bvh.toml"),
    include_str!("rigs/acclaim.toml"),
    include_str!("rigs/cmu-bvh.toml"),
    include_str!("rigs/cmu-bvh-max.toml"),
    include_str!("rigs/cmu-bvh-daz.toml"),
];

impl Rig {
    /// Reads a rig from TOML: `name`, and a table `points` of lists of joint names.
    ///
    /// # Errors
    /// [`ConfigError`] with line and column.
    pub fn from_toml(text: &str) -> Result<Rig, ConfigError> {
        toml::from_str(text).map_err(|e| ConfigError::from_toml(text, &e))
    }

    /// The rigs that come with the crate.
    #[must_use]
    pub fn builtin() -> Vec<Rig> {
        RIGS.iter()
            .map(|text| Rig::from_toml(text).expect("the rigs are read by a test"))
            .collect()
    }
}

impl BodyMap {
    /// Places the body points by the rig of [`Rig::builtin`] that places the most; on a tie the
    /// earlier rig. `None` if no rig places a single point.
    ///
    /// Names are compared whole, without regard to case and without what comes before a colon
    /// (`mixamorig:Hips`). O(joints · names).
    #[must_use]
    pub fn recognise(joint_names: &[&str]) -> Option<BodyMap> {
        let mut best: Option<BodyMap> = None;
        for rig in Rig::builtin() {
            let map = BodyMap::with_rig(joint_names, &rig);
            if map.n_placed() > best.as_ref().map_or(0, BodyMap::n_placed) {
                best = Some(map);
            }
        }
        best
    }

    /// Places the body points by a given rig; what it cannot place stays unplaced.
    #[must_use]
    pub fn with_rig(joint_names: &[&str], rig: &Rig) -> BodyMap {
        let bare: Vec<String> = joint_names.iter().map(|n| bare(n)).collect();
        let find = |name: &String| bare.iter().position(|b| *b == self::bare(name));
        let joints = BodyPoint::ALL.map(|point| rig.points.get(&point)?.iter().find_map(find));
        BodyMap {
            rig: rig.name.clone(),
            joints,
        }
    }

    /// The name of the rig.
    #[must_use]
    pub fn rig(&self) -> &str {
        &self.rig
    }

    /// The joint at a body point.
    #[must_use]
    pub fn joint(&self, point: BodyPoint) -> Option<usize> {
        self.joints[point.idx()]
    }

    /// Number of body points that have a joint, at most [`BodyPoint::COUNT`].
    #[must_use]
    pub fn n_placed(&self) -> usize {
        self.joints.iter().flatten().count()
    }

    /// The body points without a joint.
    pub fn missing(&self) -> impl Iterator<Item = BodyPoint> {
        BodyPoint::ALL.into_iter().filter(|&p| self.joint(p).is_none())
    }

    /// Whether every joint of the map exists in positions of this shape.
    pub(crate) fn fits(&self, positions: ArrayView3<'_, f32>) -> bool {
        self.joints.iter().flatten().all(|&j| j < positions.dim().1)
    }
}

fn bare(name: &str) -> String {
    let name = name.rsplit(':').next().unwrap_or(name);
    name.trim().to_lowercase()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_builtin_rig_reads_and_names_every_body_point() {
        for text in RIGS {
            let rig = Rig::from_toml(text).unwrap();
            assert_eq!(rig.points.len(), BodyPoint::COUNT, "{}", rig.name);
        }
    }

    fn names_of(rig_idx: usize) -> Vec<String> {
        let rig = Rig::from_toml(RIGS[rig_idx]).unwrap();
        rig.points.into_values().map(|mut n| n.swap_remove(0)).collect()
    }

    #[test]
    fn each_rig_recognises_its_own_names() {
        for (rig_idx, rig) in Rig::builtin().into_iter().enumerate() {
            let names = names_of(rig_idx);
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            let map = BodyMap::recognise(&names).unwrap();
            assert_eq!(map.rig(), rig.name);
            assert_eq!(map.missing().count(), 0);
        }
    }

    #[test]
    fn prefixes_and_case_do_not_matter_but_parts_of_names_do() {
        let rig = Rig::from_toml("name = 'r'\n[points]\nchest = ['Spine1']\nroot = ['hips']").unwrap();
        let map = BodyMap::with_rig(&["mixamorig:Hips", "Spine1_split", "SPINE1"], &rig);
        assert_eq!(map.joint(BodyPoint::Root), Some(0));
        assert_eq!(map.joint(BodyPoint::Chest), Some(2));
        assert_eq!(map.joint(BodyPoint::Neck), None);
        assert_eq!(map.n_placed(), 2);
    }

    #[test]
    fn nothing_is_recognised_in_foreign_names() {
        assert_eq!(BodyMap::recognise(&["a", "b"]), None);
        assert_eq!(BodyMap::recognise(&[]), None);
    }

    #[test]
    fn a_misspelt_body_point_is_an_error_with_its_place() {
        let error = Rig::from_toml("name = 'r'\n[points]\nchset = ['Spine1']").unwrap_err();
        assert_eq!((error.line, error.column), (3, 1));
    }
}
