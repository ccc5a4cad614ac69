//! Reading lists and frames in order.

use super::layout::Part;
use super::packed::{BLOCK, Unpacker};
use super::view::View;

/// The segments of one inverted list.
pub(crate) struct Postings<'v, 'a> {
    view: &'v View<'a>,
    numbers: Unpacker<'v, 'a>,
    left: usize,
    /// The number of the next posting through all lists.
    entry: usize,
    last: Option<u64>,
}

impl<'v, 'a> Postings<'v, 'a> {
    /// `len` postings from number `start` on, which is the first of a list.
    pub(super) fn new(view: &'v View<'a>, start: usize, len: usize) -> Postings<'v, 'a> {
        Postings {
            view,
            numbers: Unpacker::new(view, Part::Postings, view.n_segments(), start),
            left: len,
            entry: start,
            last: None,
        }
    }
}

impl Iterator for Postings<'_, '_> {
    type Item = usize;

    fn next(&mut self) -> Option<usize> {
        self.left = self.left.checked_sub(1)?;
        let number = self.numbers.next();
        let segment = match self.last {
            None => number,
            Some(last) => number.saturating_add(1).saturating_add(last),
        };
        if segment >= self.view.n_segments() as u64 {
            let expected = "the number of a segment";
            self.view
                .flaw(Part::Postings, self.entry, expected, segment);
            self.left = 0;
            return None;
        }
        self.entry += 1;
        self.last = Some(segment);
        Some(segment as usize)
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        (0, Some(self.left))
    }
}

/// Where segments begin, quick for segments that follow each other.
pub(crate) struct Frames<'v, 'a> {
    view: &'v View<'a>,
    lengths: Unpacker<'v, 'a>,
    /// The segment whose length is next, and where it begins.
    segment: usize,
    frame: u64,
}

impl<'v, 'a> Frames<'v, 'a> {
    /// Before the first segment is asked for.
    pub(super) fn new(view: &'v View<'a>) -> Frames<'v, 'a> {
        Frames {
            view,
            lengths: Unpacker::new(view, Part::Lengths, view.n_segments(), 0),
            segment: usize::MAX,
            frame: 0,
        }
    }

    /// The first frame of `segment`, counted through the shard; for the number of segments, the end of all frames.
    ///
    /// Cost: O(block), O(1) from one segment to the next.
    pub(crate) fn start_of(&mut self, segment: usize) -> u64 {
        let view = self.view;
        let n_segments = view.n_segments();
        if segment >= n_segments {
            return view.counts().n_frames;
        }
        let block = segment / BLOCK;
        let is_ahead = self.segment <= segment && self.segment / BLOCK == block;
        if !is_ahead || segment.is_multiple_of(BLOCK) {
            self.segment = block * BLOCK;
            self.frame = view.u64_at(view.start_of(Part::Frames) + 8 * block);
            self.lengths = Unpacker::new(view, Part::Lengths, n_segments, self.segment);
        }
        self.step(segment - self.segment);
        self.frame
    }

    /// One past the last frame of `segment`, by its length.
    pub(super) fn end_of(&mut self, segment: usize) -> u64 {
        self.start_of(segment);
        self.step(1);
        self.frame
    }

    fn step(&mut self, n: usize) {
        let frames = self.lengths.sum(n).wrapping_add(n as u64);
        self.frame = self.frame.wrapping_add(frames);
        self.segment += n;
    }
}
