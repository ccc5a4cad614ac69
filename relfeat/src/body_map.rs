use std::collections::BTreeMap;

use serde::Deserialize;
use toml::Spanned;

use crate::{BodyPoint, ConfigError};

/// Where the body points are, for the joints of one skeleton.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyMap {
    rig: String,
    /// Per body point the joints that it is made of, with weights that sum to 1; none if unplaced.
    sources: Vec<Vec<(usize, f64)>>,
}

/// A naming convention: how each body point is found among joint names.
#[derive(Clone, Debug, PartialEq)]
pub struct Rig {
    /// What to call the convention.
    pub name: String,
    /// Joints without which it is another convention with some of the same names.
    pub requires: Vec<String>,
    /// A rule per body point.
    pub points: BTreeMap<BodyPoint, PointRule>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawRig {
    name: String,
    #[serde(default)]
    requires: Vec<String>,
    points: BTreeMap<BodyPoint, Spanned<PointRule>>,
}

/// How a body point is found among joint names.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(
    untagged,
    expecting = "expected a list of joint names or a table of names and weights"
)]
pub enum PointRule {
    /// It is the first of these joints that exists.
    Joint(Vec<String>),
    /// It is the sum of these joints times their weights, which sum to 1: a point between joints,
    /// or in the prolongation of a bone.
    Mix(BTreeMap<String, f64>),
}

/// Sums of weights may be off by the rounding of decimal fractions.
const WEIGHT_TOLERANCE: f64 = 1e-9;

/// The rigs that [`BodyMap::recognise`] knows, in order of preference when two fit equally well.
const RIGS: [&str; 6] = [
    include_str!("rigs/acclaim-bvh.toml"),
    include_str!("rigs/acclaim.toml"),
    include_str!("rigs/cmu-bvh.toml"),
    include_str!("rigs/cmu-bvh-max.toml"),
    include_str!("rigs/cmu-bvh-daz.toml"),
    include_str!("rigs/motionbuilder.toml"),
];

impl Rig {
    /// Reads a rig from TOML: `name`, and a table `points` of lists of joint names
    /// (`lknee = ["LeftLeg", "LeftKnee"]`) or of weights (`lwrist = { LeftHand = 1.5, LeftForeArm = -0.5 }`).
    ///
    /// # Errors
    /// [`ConfigError`] with line and column; weights that do not sum to 1 are one.
    pub fn from_toml(text: &str) -> Result<Rig, ConfigError> {
        let raw: RawRig = toml::from_str(text).map_err(|e| ConfigError::from_toml(text, &e))?;
        for (point, rule) in &raw.points {
            if let PointRule::Mix(weights) = rule.get_ref() {
                let sum: f64 = weights.values().sum();
                if sum.is_nan() || (sum - 1.0).abs() > WEIGHT_TOLERANCE {
                    let message = format!("expected weights of {point} that sum to 1, found {sum}");
                    return Err(ConfigError::at(text, rule.span().start, message));
                }
            }
        }
        let rules = raw.points.into_iter();
        Ok(Rig {
            name: raw.name,
            requires: raw.requires,
            points: rules
                .map(|(point, rule)| (point, rule.into_inner()))
                .collect(),
        })
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
    /// earlier rig. A rig whose required joints are not all there is passed over. `None` if no rig
    /// places a single point.
    ///
    /// Names are compared whole, without regard to case and without what comes before a colon
    /// (`mixamorig:Hips`). O(joints · names).
    #[must_use]
    pub fn recognise(joint_names: &[&str]) -> Option<BodyMap> {
        let mut best: Option<BodyMap> = None;
        let bare: Vec<String> = joint_names.iter().map(|n| bare(n)).collect();
        for rig in Rig::builtin() {
            if !rig
                .requires
                .iter()
                .all(|name| bare.contains(&self::bare(name)))
            {
                continue;
            }
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
        let source = |point: &BodyPoint| match rig.points.get(point)? {
            PointRule::Joint(names) => Some(vec![(names.iter().find_map(find)?, 1.0)]),
            PointRule::Mix(weights) => weights
                .iter()
                .map(|(name, &weight)| Some((find(name)?, weight)))
                .collect(),
        };
        BodyMap {
            rig: rig.name.clone(),
            sources: BodyPoint::ALL
                .iter()
                .map(|p| source(p).unwrap_or_default())
                .collect(),
        }
    }

    /// The name of the rig.
    #[must_use]
    pub fn rig(&self) -> &str {
        &self.rig
    }

    /// The joints that a body point is made of, with weights that sum to 1; empty if the rig does
    /// not place it.
    #[must_use]
    pub fn sources(&self, point: BodyPoint) -> &[(usize, f64)] {
        &self.sources[point.idx()]
    }

    /// Whether the rig places a body point.
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

    /// The largest joint index in the map.
    pub(crate) fn last_joint(&self) -> Option<usize> {
        self.sources.iter().flatten().map(|&(joint, _)| joint).max()
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
        let names = rig.points.into_values().flat_map(|rule| match rule {
            PointRule::Joint(names) => names.into_iter().take(1).collect::<Vec<_>>(),
            PointRule::Mix(weights) => weights.into_keys().collect(),
        });
        names.chain(rig.requires).collect()
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
        let rig =
            Rig::from_toml("name = 'r'\n[points]\nchest = ['Spine1']\nroot = ['hips']").unwrap();
        let map = BodyMap::with_rig(&["mixamorig:Hips", "Spine1_split", "SPINE1"], &rig);
        assert_eq!(map.sources(BodyPoint::Root), [(0, 1.0)]);
        assert_eq!(map.sources(BodyPoint::Chest), [(2, 1.0)]);
        assert!(!map.places(BodyPoint::Neck));
        assert_eq!(map.n_placed(), 2);
    }

    #[test]
    fn a_required_joint_tells_like_named_rigs_apart() {
        let names = names_of(2);
        let plain: Vec<&str> = names
            .iter()
            .map(String::as_str)
            .filter(|n| *n != "LowerBack")
            .collect();
        assert_eq!(BodyMap::recognise(&plain).unwrap().rig(), "motionbuilder");
    }

    #[test]
    fn nothing_is_recognised_in_foreign_names() {
        assert_eq!(BodyMap::recognise(&["a", "b"]), None);
        assert_eq!(BodyMap::recognise(&[]), None);
    }

    #[test]
    fn a_mix_needs_all_its_joints_and_weights_that_sum_to_one() {
        let text = "name = 'r'\n[points]\nlwrist = { a = 1.5, b = -0.5 }";
        let rig = Rig::from_toml(text).unwrap();
        let map = BodyMap::with_rig(&["b", "a"], &rig);
        assert_eq!(map.sources(BodyPoint::LWrist), [(1, 1.5), (0, -0.5)]);
        assert_eq!(BodyMap::with_rig(&["a"], &rig).n_placed(), 0);
        let error = Rig::from_toml(&text.replace("1.5", "1.6")).unwrap_err();
        assert_eq!((error.line, error.column), (3, 10));
    }

    #[test]
    fn a_misspelt_body_point_is_an_error_with_its_place() {
        let error = Rig::from_toml("name = 'r'\n[points]\nchset = ['Spine1']").unwrap_err();
        assert_eq!((error.line, error.column), (3, 1));
    }
}
