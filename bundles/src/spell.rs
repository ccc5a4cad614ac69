//! s(j), F(j) and its mean F̄(j): letters without consecutive repetitions, and the frames of each.

use std::ops::Range;

use crate::BundlesError;

/// A cluster of similar poses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Letter(u32);

impl Letter {
    /// The letter of cluster `label`.
    pub const fn from_label(label: u32) -> Self {
        Self(label)
    }

    /// The label of its cluster.
    pub const fn label(self) -> u32 {
        self.0
    }
}

/// Consecutive frames of one clip that share a letter, as many as there are.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Run {
    /// Their letter s(j).
    pub letter: Letter,
    /// Index of their clip.
    pub clip: usize,
    /// The frames F(j); never empty in a [`MotionString`].
    pub frames: Range<usize>,
}

impl Run {
    /// The mean F̄(j) of the frame indices.
    pub fn mean_frame(&self) -> f64 {
        // The mean of start..=last, split so that no sum of two indices can overflow.
        let length = self.frames.end.saturating_sub(self.frames.start);
        self.frames.start as f64 + length.saturating_sub(1) as f64 / 2.0
    }
}

/// A clip as [`MotionString::from_lengths`] takes it.
pub(crate) type Lengths = (usize, Vec<(u32, usize)>);

/// All clips, spelt one after the other.
///
/// The runs of a clip tile it and are in order; neighbours within a clip have different letters.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MotionString {
    runs: Vec<Run>,
    /// End of each clip's runs.
    clip_ends: Vec<usize>,
}

impl MotionString {
    /// The string of clips given as frames between the end of the clip before and the clip's start,
    /// and the letter and number of frames of each of its runs; or clip and run where that cannot
    /// be. Frames stay below half of what can be counted, so that any two of them can be added.
    pub(crate) fn from_lengths(clips: &[Lengths]) -> Result<Self, (usize, usize)> {
        const MOST: usize = usize::MAX / 2;
        let (mut runs, mut clip_ends): (Vec<Run>, Vec<usize>) = (Vec::new(), Vec::new());
        let mut end = 0_usize;
        for (clip, (gap, lengths)) in clips.iter().enumerate() {
            end = end.saturating_add(*gap);
            let mut before = None;
            for (index, &(label, length)) in lengths.iter().enumerate() {
                let start = end;
                end = start.saturating_add(length);
                if length == 0 || end > MOST || before == Some(label) {
                    return Err((clip, index));
                }
                before = Some(label);
                let (letter, frames) = (Letter(label), start..end);
                runs.push(Run {
                    letter,
                    clip,
                    frames,
                });
            }
            clip_ends.push(runs.len());
        }
        Ok(Self { runs, clip_ends })
    }

    /// All runs, clip by clip.
    pub fn runs(&self) -> &[Run] {
        &self.runs
    }

    /// Number of letters m.
    pub fn len(&self) -> usize {
        self.runs.len()
    }

    /// Whether there is no letter: no clip, or empty clips alone.
    pub fn is_empty(&self) -> bool {
        self.runs.is_empty()
    }

    /// Number of clips, empty ones included.
    pub fn n_clips(&self) -> usize {
        self.clip_ends.len()
    }

    /// Indices of the runs of `clip`; `None` past the last clip.
    pub fn clip_span(&self, clip: usize) -> Option<Range<usize>> {
        let end = *self.clip_ends.get(clip)?;
        let start = clip
            .checked_sub(1)
            .map_or(0, |before| self.clip_ends[before]);
        Some(start..end)
    }

    /// Frames from the middle of run `from` to the middle of run `to`, F̄(to) - F̄(from); `None`
    /// unless both are runs of one clip with `from <= to`.
    pub fn width(&self, from: usize, to: usize) -> Option<f64> {
        let (first, last) = (self.runs.get(from)?, self.runs.get(to)?);
        (from <= to && first.clip == last.clip).then(|| last.mean_frame() - first.mean_frame())
    }
}

/// Spells `clips`, given the label of every frame.
///
/// Clips are in ascending order and do not overlap; frames between them are not spelt.
///
/// # Errors
///
/// [`BundlesError::Clip`] for a clip that ends before it starts, starts inside the one before it,
/// or ends past the labels.
pub fn spell(labels: &[u32], clips: &[Range<usize>]) -> Result<MotionString, BundlesError> {
    let mut string = MotionString {
        runs: Vec::new(),
        clip_ends: Vec::with_capacity(clips.len()),
    };
    let mut free = 0;
    for (clip, span) in clips.iter().enumerate() {
        let allowed = free..labels.len();
        if span.start < allowed.start || span.end > allowed.end || span.start > span.end {
            return Err(BundlesError::Clip {
                clip,
                allowed,
                found: span.clone(),
            });
        }
        let mut start = span.start;
        for same in labels[span.clone()].chunk_by(|a, b| a == b) {
            let frames = start..start + same.len();
            start = frames.end;
            string.runs.push(Run {
                letter: Letter(same[0]),
                clip,
                frames,
            });
        }
        string.clip_ends.push(string.runs.len());
        free = span.end;
    }
    Ok(string)
}
