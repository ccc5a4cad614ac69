use std::collections::{BTreeMap, BTreeSet};

use serde::Deserialize;
use toml::Spanned;

use crate::{BodyMap, BodyPoint, ConfigError, Quantity, Test, Unavailable};

/// Most features that fit into a word.
pub const MAX_FEATURES: usize = 64;

/// A list of features; feature `i` (0-based) is bit `i` of a word.
#[derive(Clone, Debug, PartialEq)]
pub struct FeatureSet {
    name: String,
    lengths: BTreeMap<String, Vec<[BodyPoint; 2]>>,
    features: Vec<Feature>,
}

/// A boolean feature: a quantity and two tests.
#[derive(Clone, Debug, PartialEq)]
pub struct Feature {
    /// Such as `rknee_bent`.
    pub name: String,
    /// The part of the set that the feature belongs to, such as `upper`.
    pub set: String,
    /// 0-based index of the feature that a left/right mirrored body turns this one into.
    pub mirror: usize,
    /// What is measured.
    pub quantity: Quantity,
    /// The strict test θ1: where it first holds, the feature goes on.
    pub enter: Test,
    /// The loose test θ2: where it first fails, the feature goes off.
    pub stay: Test,
}

/// Names of the sets that come with the crate, the default first.
pub const BUILTIN_SETS: [&str; 4] = [
    "mueller2006",
    "mueller2006-table6",
    "mueller2005",
    "mueller2005-text",
];

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawSet {
    name: String,
    #[serde(default)]
    lengths: BTreeMap<Spanned<String>, Vec<[BodyPoint; 2]>>,
    #[serde(default)]
    feature: Vec<Spanned<RawFeature>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawFeature {
    name: String,
    set: String,
    mirror: String,
    quantity: Quantity,
    enter: Test,
    stay: Test,
}

impl FeatureSet {
    /// One of [`BUILTIN_SETS`].
    #[must_use]
    pub fn builtin(name: &str) -> Option<FeatureSet> {
        let text = Self::builtin_toml(name)?;
        Some(FeatureSet::from_toml(text).expect("the sets are read by a test"))
    }

    /// The text of one of [`BUILTIN_SETS`].
    #[must_use]
    pub fn builtin_toml(name: &str) -> Option<&'static str> {
        match name {
            "mueller2006" => Some(include_str!("sets/mueller2006.toml")),
            "mueller2006-table6" => Some(include_str!("sets/mueller2006-table6.toml")),
            "mueller2005" => Some(include_str!("sets/mueller2005.toml")),
            "mueller2005-text" => Some(include_str!("sets/mueller2005-text.toml")),
            _ => None,
        }
    }

    /// Reads a set from TOML; the built-in sets show the form.
    ///
    /// # Errors
    /// [`ConfigError`] with line and column: bad TOML, an unknown body point or unit, a quantity
    /// tested in a unit of another dimension, a strict test that does not imply its loose one,
    /// a quantity of nothing or of unlike dimensions, names that repeat, mirrors that do not come in pairs, a length without points or with the name
    /// of a unit, more than [`MAX_FEATURES`] features.
    pub fn from_toml(text: &str) -> Result<FeatureSet, ConfigError> {
        let raw: RawSet = toml::from_str(text).map_err(|e| ConfigError::from_toml(text, &e))?;
        for (name, pairs) in &raw.lengths {
            let problem = match name.get_ref().as_str() {
                "m" | "deg" => "the name of this length is taken by a unit",
                _ if pairs.is_empty() => "expected pairs of body points, found none",
                _ => continue,
            };
            return Err(ConfigError::at(text, name.span().start, problem.to_owned()));
        }
        let lengths: BTreeMap<String, Vec<[BodyPoint; 2]>> = raw
            .lengths
            .into_iter()
            .map(|(name, pairs)| (name.into_inner(), pairs))
            .collect();
        let fail = |feature: &Spanned<RawFeature>, message| {
            Err(ConfigError::at(text, feature.span().start, message))
        };
        if let Some(extra) = raw.feature.get(MAX_FEATURES) {
            let found = raw.feature.len();
            return fail(
                extra,
                format!("expected at most {MAX_FEATURES} features, found {found}"),
            );
        }
        let idx_of = |name: &str| raw.feature.iter().position(|f| f.get_ref().name == name);
        let mut names = BTreeSet::new();
        let mut features = Vec::with_capacity(raw.feature.len());
        for feature in &raw.feature {
            let one = feature.get_ref();
            if !names.insert(&one.name) {
                return fail(feature, format!("feature {:?} appears twice", one.name));
            }
            if let Err(message) = one.check(&lengths) {
                return fail(feature, message);
            }
            let Some(mirror) = idx_of(&one.mirror) else {
                let message = format!(
                    "mirror names no feature of this set, found {:?}",
                    one.mirror
                );
                return fail(feature, message);
            };
            if raw.feature[mirror].get_ref().mirror != one.name {
                let message = format!("{:?} is not mirrored back to {:?}", one.mirror, one.name);
                return fail(feature, message);
            }
            features.push(Feature {
                name: one.name.clone(),
                set: one.set.clone(),
                mirror,
                quantity: one.quantity.clone(),
                enter: one.enter.clone(),
                stay: one.stay.clone(),
            });
        }
        Ok(FeatureSet {
            name: raw.name,
            lengths,
            features,
        })
    }

    /// The set's name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The features; index = bit.
    #[must_use]
    pub fn features(&self) -> &[Feature] {
        &self.features
    }

    /// The pairs of body points whose distances in the first frame add up to the named length.
    #[must_use]
    pub fn length(&self, name: &str) -> Option<&[[BodyPoint; 2]]> {
        self.lengths.get(name).map(Vec::as_slice)
    }

    /// A word with the bits of all features.
    #[must_use]
    pub fn all(&self) -> u64 {
        match self.features.len() {
            0 => 0,
            n => u64::MAX >> (MAX_FEATURES - n),
        }
    }

    /// The bits that a left/right mirrored body has where the body has `bits`. Bits beyond the
    /// features are dropped.
    #[must_use]
    pub fn mirrored(&self, bits: u64) -> u64 {
        let all = self.features.iter().enumerate();
        all.filter(|(i, _)| bits >> i & 1 == 1)
            .fold(0, |mirrored, (_, feature)| mirrored | 1 << feature.mirror)
    }

    /// The features that cannot be computed with a body map, and what they lack.
    #[must_use]
    pub fn unavailable(&self, map: &BodyMap) -> Vec<Unavailable> {
        let lacking = self
            .features
            .iter()
            .enumerate()
            .map(|(feature_idx, feature)| Unavailable {
                feature_idx,
                missing: self.missing_points(feature, map),
            });
        lacking.filter(|u| !u.missing.is_empty()).collect()
    }

    /// Body points that a feature, or the length that its thresholds are multiples of, needs and the
    /// map does not place.
    pub(crate) fn missing_points(&self, feature: &Feature, map: &BodyMap) -> Vec<BodyPoint> {
        let unit = feature
            .enter
            .unit
            .length()
            .and_then(|name| self.length(name));
        let mut missing = feature.quantity.body_points();
        missing.extend(unit.into_iter().flatten().flatten());
        missing.retain(|&p| !map.places(p));
        missing.sort_unstable();
        missing.dedup();
        missing
    }

    /// The bits that `pattern` names: a feature's name, its number as in the papers (`F1` is bit 0),
    /// one of the set's parts (`upper`), or any of these names with `*` for whatever stands there
    /// (`*knee*`). `None` if it names nothing.
    #[must_use]
    pub fn select(&self, pattern: &str) -> Option<u64> {
        let number = pattern
            .strip_prefix(['F', 'f'])
            .and_then(|n| n.parse::<usize>().ok());
        let is_named = |f: &Feature| [&f.name, &f.set].iter().any(|name| fits(pattern, name));
        let bits = self
            .features
            .iter()
            .enumerate()
            .filter(|(i, f)| is_named(f) || number == Some(i + 1))
            .fold(0, |bits, (i, _)| bits | 1 << i);
        (bits != 0).then_some(bits)
    }
}

/// Whether `name` is `pattern`, in which `*` stands for any characters, or none.
fn fits(pattern: &str, name: &str) -> bool {
    let Some((start, rest)) = pattern.split_once('*') else {
        return pattern == name;
    };
    let Some(mut name) = name.strip_prefix(start) else {
        return false;
    };
    let mut pieces: Vec<&str> = rest.split('*').collect();
    let end = pieces.pop().unwrap_or_default();
    // The first place for each piece leaves the most to those after it.
    for piece in pieces {
        match name.split_once(piece) {
            Some((_, after)) => name = after,
            None => return false,
        }
    }
    name.ends_with(end)
}

impl RawFeature {
    fn check(&self, lengths: &BTreeMap<String, Vec<[BodyPoint; 2]>>) -> Result<(), String> {
        let looks_like_number = self
            .name
            .strip_prefix(['F', 'f'])
            .is_some_and(|n| n.parse::<u32>().is_ok());
        if self.name.is_empty() || looks_like_number {
            return Err(format!(
                "expected a name that is not a number, found {:?}",
                self.name
            ));
        }
        self.check_quantity(&self.quantity)?;
        for test in [&self.enter, &self.stay] {
            if test.unit.dimension() != self.quantity.dimension() {
                return Err(format!(
                    "feature {:?} measures {}, its test a unit of {}",
                    self.name,
                    dimension_name(self.quantity.dimension()),
                    dimension_name(test.unit.dimension())
                ));
            }
            if let Some(name) = test
                .unit
                .length()
                .filter(|&n| n != "m" && !lengths.contains_key(n))
            {
                let known: Vec<&str> = lengths.keys().map(String::as_str).collect();
                return Err(format!(
                    "unknown unit {name:?}; known are m, {}",
                    known.join(", ")
                ));
            }
        }
        if self.enter.unit != self.stay.unit || !self.enter.bound.implies(self.stay.bound) {
            return Err(format!(
                "feature {:?}: whatever passes `enter` must pass `stay`, in the same unit",
                self.name
            ));
        }
        Ok(())
    }

    fn check_quantity(&self, quantity: &Quantity) -> Result<(), String> {
        if let Quantity::Smallest { of } | Quantity::Largest { of } = quantity {
            let dimension = quantity.dimension();
            if of.is_empty() {
                return Err(format!("feature {:?} measures nothing", self.name));
            }
            if let Some(other) = of.iter().find(|q| q.dimension() != dimension) {
                return Err(format!(
                    "feature {:?} compares {} with {}",
                    self.name,
                    dimension_name(dimension),
                    dimension_name(other.dimension())
                ));
            }
            return of.iter().try_for_each(|q| self.check_quantity(q));
        }
        if let Quantity::Speed { of, .. }
        | Quantity::HorizontalDiameter { of }
        | Quantity::SegmentDistance { of, .. } = quantity
            && of.is_empty()
        {
            return Err(format!("feature {:?} measures no point", self.name));
        }
        if let Quantity::Velocity { window_ms, .. } | Quantity::Speed { window_ms, .. } = quantity
            && !(0.0..=60_000.0).contains(window_ms)
        {
            return Err(format!(
                "expected window_ms from 0 to 60000, found {window_ms}"
            ));
        }
        if let Quantity::SegmentDistance { radius, .. } = quantity
            && !(0.0..=1000.0).contains(radius)
        {
            return Err(format!("expected a radius from 0 to 1000, found {radius}"));
        }
        Ok(())
    }
}

fn dimension_name(dimension: crate::Dimension) -> &'static str {
    match dimension {
        crate::Dimension::Length => "a length",
        crate::Dimension::Speed => "a speed",
        crate::Dimension::Angle => "an angle",
    }
}

#[cfg(test)]
mod tests;
