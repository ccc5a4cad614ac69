use ndarray::ArrayView3;

use crate::hysteresis::schmitt;
use crate::measure::{Kept, Paths};
use crate::{BodyMap, Bound, ExtractError, Feature, FeatureSet, Test, Unavailable};

/// The words of a motion.
#[derive(Clone, Debug, PartialEq)]
pub struct FeatureWords {
    /// One word per frame at `rate`; bit `i` = feature `i`.
    pub words: Vec<u64>,
    /// Frames per second of `words`.
    pub rate: f64,
    /// Features whose body points the rig lacks. Their bits are 0 in every word.
    pub unavailable: Vec<Unavailable>,
}

/// Computes every feature of `set` at the motion's own rate and keeps one word in each step of
/// `library_rate`, that of the nearest frame (spec.md a.1, j.4).
///
/// `positions` has shape `(frames, joints, 3)`, metres, Y up; `rate` and `library_rate` are in frames
/// per second. Word `k` belongs to source frame [`source_frame`]`(k)`.
///
/// A NaN coordinate makes the features that need it 0: poses in its own frame, mean velocities in
/// the frames whose window begins or ends there. In the first frame, where lengths are measured, it
/// makes every feature that is tested in such a length 0 throughout.
///
/// O(frames · features).
///
/// # Errors
/// [`ExtractError`] for a shape, a map or rates that do not fit.
pub fn extract(
    set: &FeatureSet,
    positions: ArrayView3<'_, f32>,
    map: &BodyMap,
    rate: f64,
    library_rate: f64,
) -> Result<FeatureWords, ExtractError> {
    check_shape(positions, map)?;
    check_rates(rate, library_rate)?;
    let n_frames = positions.dim().0;
    let n_words = n_words(n_frames, rate, library_rate).ok_or(ExtractError::TooManyFrames {
        n_frames,
        rate,
        library_rate,
    })?;
    let paths = Paths::gather(positions, map, rate);
    let unavailable = set.unavailable(map);
    let mut native = vec![0u64; n_frames];
    for (feature_idx, feature) in set.features().iter().enumerate() {
        if unavailable.iter().any(|u| u.feature_idx == feature_idx) {
            continue;
        }
        let values = paths.measure(&feature.quantity, &mut Kept::default());
        if let Some(bounds) = bounds(set, &paths, feature) {
            schmitt(&values, bounds, false, |t| native[t] |= 1 << feature_idx);
        }
    }
    let words = (0..n_words)
        .map(|k| native[source_frame(k, rate, library_rate)])
        .collect();
    Ok(FeatureWords {
        words,
        rate: library_rate,
        unavailable,
    })
}

pub(crate) fn check_shape(
    positions: ArrayView3<'_, f32>,
    map: &BodyMap,
) -> Result<(), ExtractError> {
    let (n_frames, n_joints, n_axes) = positions.dim();
    if n_axes != 3 {
        return Err(ExtractError::Shape(n_frames, n_joints, n_axes));
    }
    match map.last_joint().filter(|&j| j >= n_joints) {
        None => Ok(()),
        Some(joint_idx) => Err(ExtractError::BodyMap {
            joint_idx,
            n_joints,
        }),
    }
}

pub(crate) fn check_rates(rate: f64, library_rate: f64) -> Result<(), ExtractError> {
    for (what, found) in [("the rate", rate), ("the library rate", library_rate)] {
        if !(found > 0.0 && found.is_finite()) {
            return Err(ExtractError::Rate { what, found });
        }
    }
    Ok(())
}

/// The numbers that the features are tested on.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// One value per frame, in metres, metres per second or degrees.
    pub values: Vec<f64>,
    /// The strict test in the same unit, scaled by the body's lengths.
    pub enter: Bound,
    /// The loose test, likewise.
    pub stay: Bound,
}

/// What one feature measures at the motion's own rate, with its thresholds: to see why it is on.
///
/// Arguments as in [`extract`]. `None` if the rig lacks a body point, the motion has no frame, or
/// an argument does not fit.
///
/// O(frames).
#[must_use]
pub fn measure(
    set: &FeatureSet,
    feature_idx: usize,
    positions: ArrayView3<'_, f32>,
    map: &BodyMap,
    rate: f64,
) -> Option<Measured> {
    let feature = set.features().get(feature_idx)?;
    let (_, n_joints, n_axes) = positions.dim();
    let map_fits = map.last_joint().is_none_or(|j| j < n_joints);
    let fits = n_axes == 3 && map_fits && rate > 0.0 && rate.is_finite();
    if !fits || !set.missing_points(feature, map).is_empty() {
        return None;
    }
    let paths = Paths::gather(positions, map, rate);
    let [enter, stay] = bounds(set, &paths, feature)?;
    let values = paths.measure(&feature.quantity, &mut Kept::default());
    Some(Measured {
        values,
        enter,
        stay,
    })
}

/// The frame of the motion that word `k` was taken from: the one nearest in time, the later one on
/// a tie. 0-based.
#[must_use]
pub fn source_frame(k: usize, rate: f64, library_rate: f64) -> usize {
    // Half a frame up, then down: ties go up. With whole-numbered rates the product is exact, and so is
    // the quotient wherever there is a tie.
    (k as f64 * rate / library_rate + 0.5).floor() as usize
}

/// Number of words of a motion: all k whose [`source_frame`] exists.
pub(crate) fn n_words(n_frames: usize, rate: f64, library_rate: f64) -> Option<usize> {
    /// Two gigabytes of words. Who asks for more of a shorter motion has mistyped a rate.
    const LIMIT: f64 = (1u64 << 28) as f64;
    let estimate = n_frames as f64 * (library_rate / rate);
    if estimate > LIMIT.max(n_frames as f64) {
        return None;
    }
    // Rounding moves the count by at most a few from the estimate.
    let mut n_words = estimate as usize + 2;
    while n_words > 0 && source_frame(n_words - 1, rate, library_rate) >= n_frames {
        n_words -= 1;
    }
    Some(n_words)
}

/// The strict and the loose test, as [`in_metres`].
pub(crate) fn bounds(set: &FeatureSet, paths: &Paths, feature: &Feature) -> Option<[Bound; 2]> {
    Some([
        in_metres(set, paths, &feature.enter)?,
        in_metres(set, paths, &feature.stay)?,
    ])
}

/// The test in metres, degrees or metres per second; `None` if the motion has no frame to measure.
fn in_metres(set: &FeatureSet, paths: &Paths, test: &Test) -> Option<Bound> {
    let unit = match test.unit.length() {
        None | Some("m") => 1.0,
        Some(name) => paths.first_frame_length(set.length(name)?)?,
    };
    Some(test.bound.scaled(unit))
}
