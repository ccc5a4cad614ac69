//! Segmentation of a word sequence into runs of maximal length.

use std::ops::Range;

/// A maximal run of frames that carry the same feature word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Segment {
    /// The word all frames of the run share.
    pub word: u64,
    /// First frame, 0-based within the document.
    pub start: usize,
    /// Number of frames, at least 1.
    pub len: usize,
}

impl Segment {
    /// The frames of the segment, 0-based and end-exclusive.
    pub fn span(&self) -> Range<usize> {
        self.start..self.start + self.len
    }
}

/// Splits the words of one clip (one per frame) into its segments.
///
/// The segments tile the clip in order, and neighbouring segments differ in their word. No words give no segments.
///
/// Cost: O(frames). Source: 2005 paper, section 4, "F-segments".
///
/// ```
/// let segments = segidx::segment(&[7, 7, 7, 2, 7]);
/// assert_eq!(segments.len(), 3);
/// assert_eq!(segments[1].span(), 3..4);
/// ```
pub fn segment(words: &[u64]) -> Vec<Segment> {
    let mut start = 0;
    words
        .chunk_by(|a, b| a == b)
        .map(|run| {
            let segment = Segment {
                word: run[0],
                start,
                len: run.len(),
            };
            start += run.len();
            segment
        })
        .collect()
}

#[cfg(test)]
mod tests;
