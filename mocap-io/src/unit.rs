use std::fmt;

use crate::{OffsetFrame, Skeleton};

/// Metres per file unit: positive and finite.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct LengthUnit(f64);

/// An inch.
const INCH: f64 = 0.0254;

impl LengthUnit {
    /// A metre.
    pub const METRE: LengthUnit = LengthUnit(1.0);
    /// A centimetre.
    pub const CENTIMETRE: LengthUnit = LengthUnit(0.01);
    /// A millimetre.
    pub const MILLIMETRE: LengthUnit = LengthUnit(0.001);
    /// An inch.
    pub const INCH: LengthUnit = LengthUnit(INCH);
    /// The unit of the CMU and HDM05 skeletons, 1/0.45 inch, which conversions to BVH often keep.
    pub const ACCLAIM_CMU: LengthUnit = LengthUnit(INCH / 0.45);

    /// `None` unless `metres` is positive and finite.
    #[must_use]
    pub fn from_metres(metres: f64) -> Option<Self> {
        (metres > 0.0 && metres.is_finite()).then_some(LengthUnit(metres))
    }

    /// The unit of an Acclaim file with this `length` in its `:units`: 1/`length` inch
    /// (spec.md f). `None` unless `length` is positive and finite.
    #[must_use]
    pub fn from_acclaim_length(length: f64) -> Option<Self> {
        Self::from_metres(INCH / length)
    }

    /// Reads `m`, `cm`, `mm`, `inch` (`in`), `foot` (`ft`), `cmu`, or a number of metres.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        match name.trim().to_ascii_lowercase().as_str() {
            "m" | "metre" | "meter" => Some(Self::METRE),
            "cm" => Some(Self::CENTIMETRE),
            "mm" => Some(Self::MILLIMETRE),
            "in" | "inch" => Some(Self::INCH),
            "ft" | "foot" => Some(LengthUnit(12.0 * INCH)),
            "cmu" => Some(Self::ACCLAIM_CMU),
            number => number.parse().ok().and_then(Self::from_metres),
        }
    }

    /// Metres per unit.
    #[must_use]
    pub fn metres(self) -> f64 {
        self.0
    }
}

impl fmt::Display for LengthUnit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::METRE => write!(f, "m"),
            Self::CENTIMETRE => write!(f, "cm"),
            Self::MILLIMETRE => write!(f, "mm"),
            Self::INCH => write!(f, "inch"),
            Self::ACCLAIM_CMU => write!(f, "1/0.45 inch"),
            LengthUnit(metres) => write!(f, "{metres} m"),
        }
    }
}

/// Where a motion's length unit comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum UnitSource {
    /// The file says it.
    File,
    /// Guessed from the size of the rest skeleton, or of a typical frame of markers.
    Guessed {
        /// Largest extent of the rest pose or the typical frame along an axis, in file units.
        rest_extent: f64,
        /// Whether the guess makes the figure the size of a person.
        plausible: bool,
    },
    /// Said by the caller.
    Given,
}

/// Where a motion's frame rate comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RateSource {
    /// The file says it.
    File,
    /// The file says nothing; the usual rate of the format was taken.
    Default,
    /// Said by the caller.
    Given,
}

/// The size of a person, in metres: what a guessed unit must give to be plausible.
const PERSON: std::ops::RangeInclusive<f64> = 1.2..=2.2;
/// The size from which implausible skeletons are measured.
const TYPICAL: f64 = 1.7;

/// Guesses the unit of a file that names none, from its rest pose.
///
/// The largest extent of the rest pose along an axis (its height, or its arm span when the rest
/// pose lies along another axis) is compared with a person of 1.2 to 2.2 m, for metres,
/// centimetres, millimetres, the CMU unit and inches in this order; the first that fits is taken.
/// If none fits, metres, centimetres or millimetres, whichever comes closest to 1.7 m by ratio.
/// A skeleton without extent counts as centimetres.
///
/// O(joints).
#[must_use]
pub fn guess_unit(skeleton: &Skeleton) -> (LengthUnit, UnitSource) {
    guess_from_extent(rest_extent(skeleton))
}

/// What [`guess_unit`] does, from the extent of a rest pose or of a cloud of markers.
pub(crate) fn guess_from_extent(rest_extent: f64) -> (LengthUnit, UnitSource) {
    let metric = [
        LengthUnit::METRE,
        LengthUnit::CENTIMETRE,
        LengthUnit::MILLIMETRE,
    ];
    let others = [LengthUnit::ACCLAIM_CMU, LengthUnit::INCH];
    let fits = |unit: &&LengthUnit| PERSON.contains(&(rest_extent * unit.metres()));
    let fit = metric.iter().chain(&others).find(fits);
    let misfit = |unit: &LengthUnit| (rest_extent * unit.metres() / TYPICAL).ln().abs();
    let nearest = if rest_extent > 0.0 {
        metric
            .into_iter()
            .min_by(|a, b| misfit(a).total_cmp(&misfit(b)))
    } else {
        None
    };
    let unit = fit.copied().or(nearest).unwrap_or(LengthUnit::CENTIMETRE);
    let source = UnitSource::Guessed {
        rest_extent,
        plausible: fit.is_some(),
    };
    (unit, source)
}

/// Largest extent of the rest pose along an axis, in file units.
fn rest_extent(skeleton: &Skeleton) -> f64 {
    let mut rest: Vec<[f64; 3]> = Vec::with_capacity(skeleton.joints().len());
    let mut low = [f64::INFINITY; 3];
    let mut high = [f64::NEG_INFINITY; 3];
    for joint in skeleton.joints() {
        let from = joint.parent.map_or([0.0; 3], |p| rest[p]);
        // The root's offset only places the figure; in an Acclaim skeleton it is no bone either.
        let is_bone = joint.parent.is_some() || skeleton.offset_frame() == OffsetFrame::Parent;
        let at: [f64; 3] =
            std::array::from_fn(|i| from[i] + if is_bone { joint.offset[i] } else { 0.0 });
        for i in 0..3 {
            low[i] = low[i].min(at[i]);
            high[i] = high[i].max(at[i]);
        }
        rest.push(at);
    }
    (0..3).map(|i| high[i] - low[i]).fold(0.0, f64::max)
}
