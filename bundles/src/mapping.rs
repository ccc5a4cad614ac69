//! f(j): the frame at which a submotion begins or ends, within the frames of its letter (section 3.5).

use ndarray::{Array1, ArrayView1, ArrayView2};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use thiserror::Error;

use crate::draw::shuffle;
use crate::extract::check;
use crate::{ExtractError, MotionString, Partition};

mod moments;

use moments::Moments;

/// A frame for each letter at which a substring begins or ends.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct FrameMapping {
    pub(crate) frames: Vec<Option<usize>>,
}

impl FrameMapping {
    /// The frame f(j) of letter `position`; `None` where no substring begins or ends.
    pub fn frame(&self, position: usize) -> Option<usize> {
        self.frames.get(position).copied().flatten()
    }
}

/// How frames are chosen.
#[derive(Debug, Clone, PartialEq)]
pub struct MappingOptions {
    /// Weight of the variance of durations in equation 6, beside the poses' variance in the
    /// caller's unit squared; finite and at least 0.
    pub duration_weight: f64,
    /// The largest number of sweeps over all letters.
    pub max_sweeps: usize,
    /// Seed of the order of letters in each sweep.
    pub seed: u64,
    /// Frames that stay as they are, of the first letters of the string; those of an earlier
    /// mapping when clips were added.
    pub fixed: FrameMapping,
}

impl Default for MappingOptions {
    /// Weight 1, up to 100 sweeps under seed 0, nothing fixed.
    fn default() -> Self {
        Self {
            duration_weight: 1.0,
            max_sweeps: 100,
            seed: 0,
            fixed: FrameMapping::default(),
        }
    }
}

/// Why substrings cannot be mapped to frames.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum MappingError {
    /// The substrings are none of the string's.
    #[error(transparent)]
    Partition(#[from] ExtractError),
    /// The string has more frames than there are poses.
    #[error("expected a pose for each of {expected} frames, found {found}")]
    Poses {
        /// One past the last frame of the string.
        expected: usize,
        /// Number of poses.
        found: usize,
    },
    /// A pose is not finite.
    #[error("frame {frame}, dimension {dim}: expected a finite number, found {found}")]
    Pose {
        /// The frame.
        frame: usize,
        /// The dimension.
        dim: usize,
        /// The number.
        found: f64,
    },
    /// The weight is negative or not finite.
    #[error("expected a finite duration weight of at least 0, found {found}")]
    Weight {
        /// The weight.
        found: f64,
    },
    /// A fixed frame is not one of its letter's.
    #[error("letter {position}: expected a fixed frame of the letter, found {found:?}")]
    Fixed {
        /// The letter.
        position: usize,
        /// Its frame.
        found: Option<usize>,
    },
}

/// A gain below this share of what is compared is rounding, and moves nothing.
const LEAST_GAIN: f64 = 1e-12;

/// Chooses the frame of each letter at which a substring of `partition` begins or ends, so that the
/// submotions of a bundle begin alike, end alike and last as long.
///
/// The objective is the sum over all bundles of tr cov{first poses} + tr cov{last poses} +
/// w·var{durations} (equation 6), `poses` being of shape `(frames, dims)`. The determinant of the
/// paper would be 0 for bundles of fewer members than dimensions; the trace is the analogue of the
/// variance. Covariances are those of a population. Frames begin at ⌊F̄(j)⌋. Each sweep visits the
/// letters in random order and moves each to the frame of F(j) where the objective is least (ties:
/// where it is, then the first). The objective never increases. Sweeps end when one moves nothing.
///
/// The letters of a clip have disjoint frames in order, so f is strictly increasing within a clip.
///
/// # Errors
///
/// When the partition is not one of `string`, a pose is missing or not finite, the weight is out of
/// range, or a fixed frame is not of its letter.
///
/// # Cost
///
/// O(frames·dims) for each sweep, where only frames of the letters moved count.
pub fn map_frames(
    string: &MotionString,
    partition: &Partition,
    poses: ArrayView2<'_, f64>,
    options: &MappingOptions,
) -> Result<FrameMapping, MappingError> {
    check(partition, string)?;
    check_poses(string, poses)?;
    let found = options.duration_weight;
    if !(found.is_finite() && found >= 0.0) {
        return Err(MappingError::Weight { found });
    }
    let mut mapping = initial(string, partition, &options.fixed)?;
    let mut descent = Descent::new(string, partition, poses, options);
    let mut order = descent.movable(options.fixed.frames.len());
    descent.fill(&mapping);
    let mut dice = ChaCha8Rng::seed_from_u64(options.seed);
    for _ in 0..options.max_sweeps {
        shuffle(&mut dice, &mut order);
        let mut is_changed = false;
        for &position in &order {
            is_changed |= descent.place(&mut mapping, position);
        }
        if !is_changed {
            break;
        }
    }
    Ok(mapping)
}

fn check_poses(string: &MotionString, poses: ArrayView2<'_, f64>) -> Result<(), MappingError> {
    let expected = string.runs().last().map_or(0, |run| run.frames.end);
    let found = poses.nrows();
    if found < expected {
        return Err(MappingError::Poses { expected, found });
    }
    for ((frame, dim), &found) in poses.indexed_iter() {
        if !found.is_finite() {
            return Err(MappingError::Pose { frame, dim, found });
        }
    }
    Ok(())
}

/// Mean frames, rounded down, but for those that are fixed.
pub(crate) fn initial(
    string: &MotionString,
    partition: &Partition,
    fixed: &FrameMapping,
) -> Result<FrameMapping, MappingError> {
    let mut frames = vec![None; string.len()];
    for substring in partition.substrings() {
        for position in [substring.first, substring.last] {
            let run = &string.runs()[position];
            frames[position] = Some(run.mean_frame() as usize);
        }
    }
    for (position, &found) in fixed.frames.iter().enumerate() {
        let place = frames.get_mut(position);
        let run = string.runs().get(position).zip(found);
        let is_inside = run.is_none_or(|(run, frame)| run.frames.contains(&frame));
        match place {
            Some(place) if is_inside && place.is_some() == found.is_some() => *place = found,
            _ => return Err(MappingError::Fixed { position, found }),
        }
    }
    Ok(FrameMapping { frames })
}

/// A submotion that begins or ends at a letter: its bundle, and its other letter.
#[derive(Debug, Clone, Copy)]
struct Side {
    bundle: usize,
    other: usize,
}

struct Descent<'a> {
    string: &'a MotionString,
    poses: ArrayView2<'a, f64>,
    duration_weight: f64,
    /// Of each letter: the submotion of a bundle that begins there, and the one that ends there.
    begins: Vec<Option<Side>>,
    ends: Vec<Option<Side>>,
    moments: Vec<Moments>,
}

impl<'a> Descent<'a> {
    fn new(
        string: &'a MotionString,
        partition: &Partition,
        poses: ArrayView2<'a, f64>,
        options: &MappingOptions,
    ) -> Self {
        let mut begins = vec![None; string.len()];
        let mut ends = vec![None; string.len()];
        for (bundle, members) in partition.bundles.iter().map(|b| &b.members).enumerate() {
            for member in members {
                let other = member.last;
                begins[member.first] = Some(Side { bundle, other });
                let other = member.first;
                ends[member.last] = Some(Side { bundle, other });
            }
        }
        let heights = partition.bundles.iter().map(|bundle| bundle.members.len());
        Self {
            string,
            poses,
            duration_weight: options.duration_weight,
            begins,
            ends,
            moments: heights.map(|n| Moments::new(n, poses.ncols())).collect(),
        }
    }

    /// The letters from `first` on whose frames matter to a bundle.
    fn movable(&self, first: usize) -> Vec<usize> {
        let matters = |&j: &usize| self.begins[j].is_some() || self.ends[j].is_some();
        (first..self.string.len()).filter(matters).collect()
    }

    fn fill(&mut self, mapping: &FrameMapping) {
        for position in 0..self.begins.len() {
            if let Some(frame) = mapping.frame(position) {
                self.shift(position, frame, 1.0);
            }
            let Some(Side { bundle, other }) = self.begins[position] else {
                continue;
            };
            if let (Some(from), Some(to)) = (mapping.frame(position), mapping.frame(other)) {
                self.moments[bundle].add_duration((to - from) as f64, 1.0);
            }
        }
    }

    /// Adds the pose at `frame` to the sums of the bundles at `position`, or takes it away.
    fn shift(&mut self, position: usize, frame: usize, sign: f64) {
        let pose = self.poses.row(frame);
        if let Some(side) = self.begins[position] {
            self.moments[side.bundle].add_first(pose, sign);
        }
        if let Some(side) = self.ends[position] {
            self.moments[side.bundle].add_last(pose, sign);
        }
    }

    /// Moves one letter to its best frame; whether it moved.
    fn place(&mut self, mapping: &mut FrameMapping, position: usize) -> bool {
        let Some(current) = mapping.frame(position) else {
            return false;
        };
        self.shift(position, current, -1.0);
        self.shift_durations(mapping, position, current, -1.0);
        let at_current = self.cost(mapping, position, current);
        let mut best = (at_current, current);
        for frame in self.string.runs()[position].frames.clone() {
            let cost = self.cost(mapping, position, frame);
            if cost < best.0 {
                best = (cost, frame);
            }
        }
        let is_gain = at_current - best.0 > LEAST_GAIN * at_current;
        let chosen = if is_gain { best.1 } else { current };
        self.shift(position, chosen, 1.0);
        self.shift_durations(mapping, position, chosen, 1.0);
        mapping.frames[position] = Some(chosen);
        chosen != current
    }

    fn shift_durations(&mut self, mapping: &FrameMapping, at: usize, frame: usize, sign: f64) {
        for (bundle, duration) in self.durations(mapping, at, frame).into_iter().flatten() {
            self.moments[bundle].add_duration(duration, sign);
        }
    }

    /// Bundles and durations of the submotions that end and begin at letter `at`, if that is at
    /// `frame`.
    fn durations(
        &self,
        mapping: &FrameMapping,
        at: usize,
        frame: usize,
    ) -> [Option<(usize, f64)>; 2] {
        let duration = |side: Side| {
            let other = mapping.frame(side.other)?;
            Some((side.bundle, frame.abs_diff(other) as f64))
        };
        [
            self.ends[at].and_then(duration),
            self.begins[at].and_then(duration),
        ]
    }

    /// What the objective gains over its value without this letter's poses and durations, if the
    /// letter is at `frame`, but for a part that is the same at every frame.
    fn cost(&self, mapping: &FrameMapping, position: usize, frame: usize) -> f64 {
        let pose = self.poses.row(frame);
        let first = self.begins[position].map(|side| self.moments[side.bundle].first_cost(pose));
        let last = self.ends[position].map(|side| self.moments[side.bundle].last_cost(pose));
        let durations = match self.durations(mapping, position, frame) {
            [Some((a, before)), Some((b, after))] if a == b => {
                self.moments[a].duration_cost(&[before, after])
            }
            sides => {
                let costs = sides.into_iter().flatten();
                costs
                    .map(|(bundle, d)| self.moments[bundle].duration_cost(&[d]))
                    .sum()
            }
        };
        first.unwrap_or(0.0) + last.unwrap_or(0.0) + self.duration_weight * durations
    }
}

/// The squared distance of `pose` to the mean whose sum over `n` poses is `sum`.
fn distance_to_mean(pose: ArrayView1<'_, f64>, sum: &Array1<f64>, n: f64) -> f64 {
    let pairs = pose.iter().zip(sum);
    pairs.map(|(x, sum)| (x - sum / n).powi(2)).sum()
}
