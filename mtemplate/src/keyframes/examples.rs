//! Keyframes from clips that have the motion and clips that have not.
//!
//! Each positive is matched with the template, which tells its frame for each column. A *literal* asks for one feature in
//! one column; it is admissible if all positives have it in the frame of that column and a few frames around. Keyframes
//! are sets of literals of one column. Beginning with none, the one literal is added, to a keyframe or as a new one, that
//! leaves the fewest frames of the negatives in stretches; as long as it takes away a share worth having. Stiffness
//! follows from the distances of the frames in the positives. So at any time the best match of every positive has all
//! keyframes, and lies in a stretch of its clip.

use super::chains::runs;
use super::preselection::Preselection;
use super::trace::best_match;
use crate::{Keyframe, QuantizedTemplate};

/// Clips as words, one per frame.
#[derive(Debug, Clone, Copy)]
pub struct Examples<'a> {
    /// Clips with one motion of the class each, such as the template was learned from.
    pub positives: &'a [&'a [u64]],
    /// Clips without.
    pub negatives: &'a [&'a [u64]],
}

/// What keyframes may be like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExampleConfig {
    /// The features that may be asked for.
    pub features: u64,
    /// The most keyframes.
    pub max_keyframes: usize,
    /// The columns that may become keyframes, spread evenly.
    pub max_columns: usize,
    /// A feature has to be the same in all positives this many frames to either side.
    pub margin: usize,
    /// Stiffness is this share of the largest that suits all positives.
    pub slack: f64,
    /// A literal has to take away this share of what is still kept.
    pub min_gain: f64,
}

impl ExampleConfig {
    /// Five keyframes of these features at most: the median of the hand-set ones of 2008 (spec.md e).
    pub fn of_features(features: u64) -> Self {
        Self {
            features,
            max_keyframes: 5,
            max_columns: 32,
            margin: 2,
            slack: 0.75,
            min_gain: 0.1,
        }
    }
}

/// Keyframes, and what they are worth.
#[derive(Debug, Clone, PartialEq)]
pub struct LearnedKeyframes {
    /// In ascending order of columns; none if no literal is worth its while.
    pub keyframes: Vec<Keyframe>,
    /// Share of the negatives' frames that lie in stretches; 1 without keyframes, 0 without negatives.
    pub kept: f64,
    /// Positives that the template cannot be matched with, which had no say.
    pub unmatched: Vec<usize>,
}

/// Learns keyframes that lose no positive and keep little of the negatives.
///
/// Ties go to the earlier column, then to the lower feature. The result does not depend on the order of the clips.
///
/// Cost: O(literals added · columns · features · frames of the negatives · keyframes) at worst.
pub fn learn_keyframes(
    template: &QuantizedTemplate,
    examples: &Examples<'_>,
    config: &ExampleConfig,
) -> LearnedKeyframes {
    let traced: Vec<Option<Vec<usize>>> = examples
        .positives
        .iter()
        .map(|words| best_match(template, words))
        .collect();
    let unmatched = (0..traced.len()).filter(|&i| traced[i].is_none()).collect();
    let positives = examples.positives.iter().zip(traced);
    let learner = Learner {
        n_columns: template.n_columns(),
        positives: positives
            .filter_map(|(words, frames)| Some((*words, frames?)))
            .collect(),
        negatives: examples.negatives,
        config,
    };
    let n_frames: usize = examples.negatives.iter().map(|words| words.len()).sum();
    let (keyframes, kept) = learner.learn(n_frames);
    LearnedKeyframes {
        keyframes,
        kept: kept as f64 / n_frames.max(1) as f64,
        unmatched,
    }
}

struct Learner<'a> {
    n_columns: usize,
    /// Words, and the frame of each column.
    positives: Vec<(&'a [u64], Vec<usize>)>,
    negatives: &'a [&'a [u64]],
    config: &'a ExampleConfig,
}

impl Learner<'_> {
    fn learn(&self, n_frames: usize) -> (Vec<Keyframe>, usize) {
        let mut keyframes: Vec<Keyframe> = Vec::new();
        let mut kept = n_frames;
        if self.positives.is_empty() {
            return (keyframes, kept);
        }
        let stride = self
            .n_columns
            .div_ceil(self.config.max_columns.max(1))
            .max(1);
        let columns = (stride / 2..self.n_columns).step_by(stride);
        let literals: Vec<(usize, u64, u64)> = columns
            .map(|column| {
                let (care, value) = self.common(column);
                (column, care, value)
            })
            .collect();
        // Termination: each turn keeps fewer frames.
        while kept > 0 {
            let mut best: Option<(Vec<Keyframe>, usize)> = None;
            for &(column, care, value) in &literals {
                for bit in bits(care) {
                    let Some((longer, changed)) = self.with(&keyframes, column, (bit, value & bit))
                    else {
                        continue;
                    };
                    let least = best.as_ref().map_or(kept, |(_, least)| *least);
                    if let Some(now) = self.kept(&longer, changed, least) {
                        best = Some((longer, now));
                    }
                }
            }
            match best {
                Some((longer, now)) if now as f64 <= (1.0 - self.config.min_gain) * kept as f64 => {
                    (keyframes, kept) = (longer, now);
                }
                _ => break,
            }
        }
        (keyframes, kept)
    }

    /// Features that all positives share around their frames of a column, and what they are.
    fn common(&self, column: usize) -> (u64, u64) {
        let (mut ones, mut zeros) = (self.config.features, self.config.features);
        for (words, frames) in &self.positives {
            let frame = frames[column];
            let margin = self.config.margin;
            let around = frame.saturating_sub(margin)..(frame + margin + 1).min(words.len());
            for word in &words[around] {
                ones &= word;
                zeros &= !word;
            }
        }
        (ones | zeros, ones)
    }

    /// Keyframes with one more literal, and the one that it belongs to; `None` if it is there already, or there would be
    /// too many keyframes.
    fn with(
        &self,
        keyframes: &[Keyframe],
        column: usize,
        (bit, value): (u64, u64),
    ) -> Option<(Vec<Keyframe>, usize)> {
        let mut keyframes = keyframes.to_vec();
        let at = keyframes.partition_point(|keyframe| keyframe.column < column);
        let is_there = |keyframe: &Keyframe| keyframe.column == column;
        if let Some(keyframe) = keyframes.get_mut(at).filter(|keyframe| is_there(keyframe)) {
            if keyframe.care & bit != 0 {
                return None;
            }
            keyframe.care |= bit;
            keyframe.value |= value;
            return Some((keyframes, at));
        }
        if keyframes.len() == self.config.max_keyframes {
            return None;
        }
        let new = Keyframe {
            column,
            care: bit,
            value,
            stiffness: 1.0,
        };
        keyframes.insert(at, new);
        for i in at..(at + 2).min(keyframes.len()) {
            keyframes[i].stiffness = match i.checked_sub(1) {
                None => 1.0,
                Some(before) => self.stiffness(keyframes[before].column, keyframes[i].column)?,
            };
        }
        Some((keyframes, at))
    }

    /// Stiffness between two columns; `None` if a positive has both in one frame.
    fn stiffness(&self, from: usize, to: usize) -> Option<f64> {
        let distance = (to - from) as f64;
        let mut stiffness: f64 = 1.0;
        for (_, frames) in &self.positives {
            let gap = (frames[to] - frames[from]) as f64;
            if gap == 0.0 {
                return None;
            }
            stiffness = stiffness.min(gap / distance).min(distance / gap);
        }
        Some(stiffness * self.config.slack)
    }

    /// Frames of the negatives in stretches; `None` if they are no fewer than `least`.
    fn kept(&self, keyframes: &[Keyframe], changed: usize, least: usize) -> Option<usize> {
        let preselection = Preselection::new(keyframes, self.n_columns).ok()?;
        let gaps = preselection.gaps();
        let mut kept = 0;
        for words in self.negatives {
            let runs_of = |keyframe: &Keyframe| runs(words, |word| keyframe.accepts(word));
            // The new literal is the likeliest to be nowhere.
            let new = runs_of(&keyframes[changed]);
            if new.is_empty() {
                continue;
            }
            let others: Vec<_> = keyframes.iter().map(runs_of).collect();
            let runs: Vec<_> = others.iter().map(Vec::as_slice).collect();
            let stretches = preselection.stretches_of(&runs, &gaps, words.len());
            kept += stretches.iter().map(|stretch| stretch.len()).sum::<usize>();
            if kept >= least {
                return None;
            }
        }
        Some(kept)
    }
}

/// The bits of a word as words, lowest first.
fn bits(word: u64) -> impl Iterator<Item = u64> {
    (0..u64::BITS)
        .map(|bit| 1 << bit)
        .filter(move |bit| word & bit != 0)
}
