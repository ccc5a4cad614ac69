//! From keyframes to the stretches of a clip that are matched.

use std::ops::{Range, RangeInclusive};

use thiserror::Error;

use super::chains::{runs, spans, united};
use crate::{Keyframe, KeyframeError};

/// Why keyframes do not belong to a template.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum PreselectionError {
    /// There are none.
    #[error("expected one keyframe or more, found none")]
    None,
    /// One breaks a rule.
    #[error("keyframe {keyframe}: {kind}")]
    Keyframe {
        /// Its index.
        keyframe: usize,
        /// The rule.
        kind: KeyframeError,
    },
}

/// Keyframes of one template: in which stretches of a clip it is worth matching.
///
/// A *chain* is a frame for each keyframe that is as it asks, in order, with ⌈σd⌉ to ⌊d/σ⌋ frames from each to the next; d
/// is the distance of the two columns and σ the stiffness of the later keyframe. The stretch of a chain reaches as far
/// to both sides as a match that has its keyframes there can, which passes at most two frames per column: 2·c frames
/// before a first keyframe in column c (0-based), 2·(K − 1 − c) frames after a last one (spec.md e).
#[derive(Debug, Clone, PartialEq)]
pub struct Preselection {
    keyframes: Vec<Keyframe>,
    n_columns: usize,
}

impl Preselection {
    /// Keyframes of a template of `n_columns`, in the order of their columns.
    ///
    /// # Errors
    ///
    /// No keyframes, columns that descend or lie outside, a stiffness outside (0, 1].
    pub fn new(keyframes: &[Keyframe], n_columns: usize) -> Result<Self, PreselectionError> {
        if keyframes.is_empty() {
            return Err(PreselectionError::None);
        }
        let mut before = 0;
        for (index, keyframe) in keyframes.iter().enumerate() {
            let found = keyframe.column;
            let stiffness = keyframe.stiffness;
            let kind = if found >= n_columns {
                KeyframeError::Column { n_columns, found }
            } else if found < before {
                KeyframeError::Order { before, found }
            } else if !(stiffness > 0.0 && stiffness <= 1.0) {
                KeyframeError::Stiffness { found: stiffness }
            } else {
                before = found;
                continue;
            };
            let keyframe = index;
            return Err(PreselectionError::Keyframe { keyframe, kind });
        }
        Ok(Self {
            keyframes: keyframes.to_vec(),
            n_columns,
        })
    }

    /// The keyframes.
    pub fn keyframes(&self) -> &[Keyframe] {
        &self.keyframes
    }

    /// Frames from each keyframe to the next: one range fewer than there are keyframes.
    pub fn gaps(&self) -> Vec<RangeInclusive<usize>> {
        let gap = |pair: &[Keyframe]| gap(pair[1].column - pair[0].column, pair[1].stiffness);
        self.keyframes.windows(2).map(gap).collect()
    }

    /// The most frames of a chain that the rule of 2006 allows, both ends counted: 2·(d + 1) for a distance d of the
    /// first and last column.
    pub fn greedy_frames(&self) -> usize {
        2 * (self.last().column - self.keyframes[0].column + 1)
    }

    /// The stretch of chains that begin no earlier than with frame `first` and end no later than with frame `last`, in a
    /// clip of `n_frames`.
    pub fn stretch(&self, first: usize, last: usize, n_frames: usize) -> Range<usize> {
        let before = 2 * self.keyframes[0].column;
        let after = 2 * (self.n_columns - 1 - self.last().column);
        let end = last.saturating_add(after).saturating_add(1);
        first.saturating_sub(before)..end.min(n_frames)
    }

    /// Stretches in ascending order, those that overlap or touch made one.
    pub fn merge(stretches: &mut Vec<Range<usize>>) {
        stretches.sort_unstable_by_key(|stretch| (stretch.start, stretch.end));
        *stretches = united(stretches.drain(..));
    }

    /// The stretches of all chains of a clip, in ascending order, none touching another; found frame by frame.
    ///
    /// Cost: O(frames · keyframes).
    pub fn stretches(&self, words: &[u64]) -> Vec<Range<usize>> {
        let runs: Vec<_> = self
            .keyframes
            .iter()
            .map(|keyframe| runs(words, |word| keyframe.accepts(word)))
            .collect();
        let runs: Vec<_> = runs.iter().map(Vec::as_slice).collect();
        self.stretches_of(&runs, &self.gaps(), words.len())
    }

    pub(super) fn stretches_of(
        &self,
        runs: &[&[Range<usize>]],
        gaps: &[RangeInclusive<usize>],
        n_frames: usize,
    ) -> Vec<Range<usize>> {
        let spans = spans(runs, gaps).into_iter();
        let mut stretches = spans
            .map(|span| self.stretch(span.start, span.end - 1, n_frames))
            .collect();
        Self::merge(&mut stretches);
        stretches
    }

    fn last(&self) -> &Keyframe {
        &self.keyframes[self.keyframes.len() - 1]
    }
}

/// From ⌈σd⌉ to ⌊d/σ⌋.
pub(super) fn gap(distance: usize, stiffness: f64) -> RangeInclusive<usize> {
    let distance = distance as f64;
    // σd is one product, off by half a unit in the last place; a whole number must not become the next one.
    let least = (stiffness * distance * (1.0 - ROUNDING)).ceil() as usize;
    let most = (distance / stiffness * (1.0 + ROUNDING)).floor() as usize;
    least..=most
}

/// Several times the relative error of a product or quotient of two numbers.
const ROUNDING: f64 = 4.0 * f64::EPSILON;
