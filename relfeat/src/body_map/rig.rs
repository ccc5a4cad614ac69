use std::collections::BTreeMap;
use std::fmt::Write;
use std::sync::LazyLock;

use serde::Deserialize;
use toml::Spanned;

use super::joint_name::{Names, Reading, Spelling};
use crate::{BodyPoint, ConfigError};

/// A naming convention: how each body point is found among joint names.
#[derive(Clone, Debug, PartialEq)]
pub struct Rig {
    /// What to call the convention.
    pub name: String,
    /// Joints without which it is another convention with some of the same names.
    pub requires: Vec<String>,
    /// Rules per body point: it is placed by the first one whose joints all exist.
    pub points: BTreeMap<BodyPoint, Vec<PointRule>>,
}

/// A place in terms of joints.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(untagged)]
pub enum PointRule {
    /// A joint.
    Joint(String),
    /// The sum of joints times their weights, which sum to 1: a point between joints, or in the
    /// prolongation of a bone. It is missing (NaN) in a frame where one of them is.
    Mix(BTreeMap<String, f64>),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawRig {
    name: String,
    #[serde(default)]
    requires: Vec<String>,
    points: BTreeMap<Spanned<String>, Spanned<RawRules>>,
}

#[derive(Deserialize)]
#[serde(
    untagged,
    expecting = "expected a joint name, a table of joint names and weights, or a list of these"
)]
enum RawRules {
    Several(Vec<PointRule>),
    One(PointRule),
}

/// Sums of weights may be off by the rounding of decimal fractions.
const WEIGHT_TOLERANCE: f64 = 1e-9;

/// The built-in rigs, in order of preference when two find equally many body points: a rig that
/// requires some joint comes before those that make do without it.
const TEXTS: [&str; 32] = [
    include_str!("../rigs/acclaim-bvh.toml"),
    include_str!("../rigs/acclaim.toml"),
    include_str!("../rigs/cmu-kitchen.toml"),
    include_str!("../rigs/cmu-bvh.toml"),
    include_str!("../rigs/cmu-bvh-max.toml"),
    include_str!("../rigs/cmu-bvh-daz.toml"),
    include_str!("../rigs/mixamo.toml"),
    include_str!("../rigs/lafan1.toml"),
    include_str!("../rigs/perception-neuron.toml"),
    include_str!("../rigs/axis-studio.toml"),
    include_str!("../rigs/rokoko.toml"),
    include_str!("../rigs/rokoko-newton.toml"),
    include_str!("../rigs/vicon.toml"),
    include_str!("../rigs/soma.toml"),
    include_str!("../rigs/motionbuilder-3.toml"),
    include_str!("../rigs/mass.toml"),
    include_str!("../rigs/motionbuilder.toml"),
    include_str!("../rigs/xsens.toml"),
    include_str!("../rigs/xsens-bvh.toml"),
    include_str!("../rigs/optitrack.toml"),
    include_str!("../rigs/optitrack-bvh.toml"),
    include_str!("../rigs/max-bvh.toml"),
    include_str!("../rigs/max-bvh-1.toml"),
    include_str!("../rigs/biovision.toml"),
    include_str!("../rigs/unreal5.toml"),
    include_str!("../rigs/unreal.toml"),
    include_str!("../rigs/rigify.toml"),
    include_str!("../rigs/biped.toml"),
    include_str!("../rigs/iclone.toml"),
    include_str!("../rigs/smpl.toml"),
    include_str!("../rigs/hdm05-cmu-markers.toml"),
    include_str!("../rigs/plug-in-gait.toml"),
];

pub(super) static RIGS: LazyLock<Vec<Rig>> = LazyLock::new(|| {
    TEXTS
        .iter()
        .map(|text| Rig::from_toml(text).expect("the rigs are read by a test"))
        .collect()
});

pub(super) static BUILTIN: LazyLock<Vec<Compiled<'static>>> =
    LazyLock::new(|| RIGS.iter().map(Compiled::new).collect());

impl Rig {
    /// Reads a rig from TOML: `name`, perhaps a list `requires`, and a table `points` with for each
    /// body point a joint (`lknee = "LeftLeg"`), a table of weights
    /// (`lwrist = { LeftHand = 1.5, LeftForeArm = -0.5 }`), or a list of such, of which the first
    /// counts whose joints exist (`lknee = ["LKJC", { LKNE = 0.5, LKNM = 0.5 }]`).
    ///
    /// # Errors
    /// [`ConfigError`] with line and column; weights that do not sum to 1 are one.
    pub fn from_toml(text: &str) -> Result<Rig, ConfigError> {
        let raw: RawRig = toml::from_str(text).map_err(|e| ConfigError::from_toml(text, &e))?;
        let mut points = BTreeMap::new();
        for (name, rules) in raw.points {
            let at = |message| ConfigError::at(text, name.span().start, message);
            let point = point_named(name.get_ref()).map_err(at)?;
            let start = rules.span().start;
            let rules = match rules.into_inner() {
                RawRules::Several(rules) => rules,
                RawRules::One(rule) => vec![rule],
            };
            check(point, &rules).map_err(|message| ConfigError::at(text, start, message))?;
            points.insert(point, rules);
        }
        Ok(Rig {
            name: raw.name,
            requires: raw.requires,
            points,
        })
    }

    /// The rig in TOML. [`Rig::from_toml`] reads the same rig back.
    #[must_use]
    pub fn to_toml(&self) -> String {
        let mut out = format!("name = {}\n", quoted(&self.name));
        if !self.requires.is_empty() {
            let names: Vec<String> = self.requires.iter().map(|n| quoted(n)).collect();
            out += &format!("requires = [{}]\n", names.join(", "));
        }
        out += "\n[points]\n";
        for (point, rules) in &self.points {
            let rules: Vec<String> = rules.iter().map(PointRule::to_toml).collect();
            let value = match rules.as_slice() {
                [one] => one.clone(),
                several => format!("[{}]", several.join(", ")),
            };
            out += &format!("{point} = {value}\n");
        }
        out
    }

    /// The rigs that come with the crate.
    #[must_use]
    pub fn builtin() -> &'static [Rig] {
        &RIGS
    }
}

impl PointRule {
    fn to_toml(&self) -> String {
        match self {
            PointRule::Joint(name) => quoted(name),
            PointRule::Mix(weights) => {
                // The debug form of a number has a point or an exponent, as TOML demands.
                let weights = weights
                    .iter()
                    .map(|(name, w)| format!("{} = {w:?}", quoted(name)));
                format!("{{ {} }}", weights.collect::<Vec<_>>().join(", "))
            }
        }
    }
}

fn quoted(text: &str) -> String {
    let mut out = String::from('"');
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            c if c.is_control() => {
                let _ = write!(out, "\\u{:04X}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

fn point_named(name: &str) -> Result<BodyPoint, String> {
    if let Some(point) = BodyPoint::ALL.into_iter().find(|p| p.name() == name) {
        return Ok(point);
    }
    let distance = |p: &BodyPoint| strsim::damerau_levenshtein(p.name(), &name.to_lowercase());
    let nearest = BodyPoint::ALL.into_iter().min_by_key(distance);
    let nearest = nearest.map_or("", BodyPoint::name);
    Err(format!(
        "expected a body point, found `{name}`; the nearest is `{nearest}`"
    ))
}

fn check(point: BodyPoint, rules: &[PointRule]) -> Result<(), String> {
    if rules.is_empty() {
        return Err(format!("expected a joint for {point}, found an empty list"));
    }
    for rule in rules {
        if let PointRule::Mix(weights) = rule {
            let sum: f64 = weights.values().sum();
            if sum.is_nan() || (sum - 1.0).abs() > WEIGHT_TOLERANCE {
                return Err(format!(
                    "expected weights of {point} that sum to 1, found {sum}"
                ));
            }
        }
    }
    Ok(())
}

/// A rig whose names have been split into words.
#[derive(Debug)]
pub(super) struct Compiled<'a> {
    name: &'a str,
    requires: Vec<Spelling>,
    /// Per body point its rules, each a list of joints and weights.
    points: Vec<Vec<Vec<(Spelling, f64)>>>,
}

/// Per body point the joints and weights that it is made of; none if it was not found.
type Sources = Vec<Vec<(usize, f64)>>;

impl<'a> Compiled<'a> {
    pub(super) fn new(rig: &'a Rig) -> Self {
        let compile = |rule: &PointRule| match rule {
            PointRule::Joint(name) => vec![(Spelling::new(name), 1.0)],
            PointRule::Mix(weights) => weights
                .iter()
                .map(|(name, &weight)| (Spelling::new(name), weight))
                .collect(),
        };
        let rules = |p: &BodyPoint| rig.points.get(p).map_or(&[][..], Vec::as_slice);
        Compiled {
            name: &rig.name,
            requires: rig.requires.iter().map(|n| Spelling::new(n)).collect(),
            points: BodyPoint::ALL
                .iter()
                .map(|p| rules(p).iter().map(compile).collect())
                .collect(),
        }
    }

    pub(super) fn name(&self) -> &'a str {
        self.name
    }

    /// The most body points that a reading of the names with all required joints has, and where they
    /// are; on a tie the earlier reading. Required joints may also stand beside those that share a prefix.
    /// `None` if no reading has them.
    pub(super) fn place(&self, names: &Names) -> Option<(usize, Sources)> {
        let has = |r: &Reading, name| r.find(name).is_some();
        let stands_beside = |name| {
            names
                .readings()
                .iter()
                .any(|r| r.is_whole() && has(r, name))
        };
        let has_all = |r: &&Reading| {
            let mut required = self.requires.iter();
            required.all(|name| has(r, name) || stands_beside(name))
        };
        self.best(names.readings().iter().filter(has_all))
    }

    /// The same without regard to required joints.
    pub(super) fn place_any(&self, names: &Names) -> (usize, Sources) {
        self.best(names.readings().iter())
            .unwrap_or((0, vec![Vec::new(); BodyPoint::COUNT]))
    }

    fn best<'r>(&self, readings: impl Iterator<Item = &'r Reading>) -> Option<(usize, Sources)> {
        let mut best: Option<(usize, Sources)> = None;
        for reading in readings {
            let sources: Sources = self
                .points
                .iter()
                .map(|rules| find(rules, reading))
                .collect();
            let n_found = sources.iter().filter(|s| !s.is_empty()).count();
            if best.as_ref().is_none_or(|(most, _)| n_found > *most) {
                best = Some((n_found, sources));
            }
        }
        best
    }
}

/// The first rule whose joints all exist.
fn find(rules: &[Vec<(Spelling, f64)>], reading: &Reading) -> Vec<(usize, f64)> {
    let resolve = |rule: &Vec<(Spelling, f64)>| {
        rule.iter()
            .map(|(name, weight)| Some((reading.find(name)?, *weight)))
            .collect::<Option<Vec<_>>>()
    };
    rules.iter().find_map(resolve).unwrap_or_default()
}
