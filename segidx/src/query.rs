//! Queries: a sequence of fuzzy sets with the frames each stands for.

use std::borrow::Cow;
use std::ops::Range;

use crate::{FuzzySet, Mask, segment};

/// One position of a [`Query`].
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct QueryPosition {
    /// The words this position accepts.
    pub set: FuzzySet,
    /// Frames of the query at this position, for ranking; `None` when the query has no durations, then the position
    /// adds nothing to the cost of a hit.
    pub n_frames: Option<usize>,
    /// The query segments united here, 0-based and end-exclusive. A segment is one of the query's full-word
    /// segments, one of the given sets for [`Query::from_sets`], or a position of the query before
    /// [`Query::map_sets`].
    pub segments: Range<usize>,
}

/// What to look for: fuzzy sets V_1..V_L in order, each with its length in the query.
///
/// A query without positions is allowed and has no hits.
///
/// Source: 2005 paper, section 5.2.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Query {
    positions: Vec<QueryPosition>,
}

impl Query {
    /// One position per segment of the example `words`, compared on the bits of `care`; nothing is conjoined.
    ///
    /// With `care == u64::MAX` this is the exact query of eq. 4. With fewer bits it is the fuzzy query of eq. 9
    /// without its disjointness condition: the segmentation is still that of the full words.
    ///
    /// Cost: O(frames).
    pub fn exact(words: &[u64], care: u64) -> Query {
        let positions = segment(words)
            .iter()
            .enumerate()
            .map(|(i, segment)| QueryPosition {
                set: Mask::new(care, segment.word).into(),
                n_frames: Some(segment.len),
                segments: i..i + 1,
            })
            .collect();
        Query { positions }
    }

    /// The example `words` seen through the bits of `care` alone: neighbouring segments that agree on them are one
    /// position.
    ///
    /// Under [`search_adaptive`](crate::search_adaptive) its hits are the exact hits of the segmentation by the
    /// features of `care`.
    ///
    /// Cost: O(frames). Source: 2005 paper, section 5.2; spec j.1.
    pub fn fuzzy(words: &[u64], care: u64) -> Query {
        let exact = Query::exact(words, care);
        Query {
            positions: conjoin(exact.positions),
        }
    }

    /// A query from explicit sets, each with its length in frames if it has one. Neighbouring sets that share a word
    /// are conjoined until none do.
    ///
    /// Cost: O(m² log m) for m masks in all. Source: 2005 paper, section 5.2, before eq. 9.
    pub fn from_sets(sets: impl IntoIterator<Item = (FuzzySet, Option<usize>)>) -> Query {
        let positions = sets
            .into_iter()
            .enumerate()
            .map(|(i, (set, n_frames))| QueryPosition {
                set,
                n_frames,
                segments: i..i + 1,
            })
            .collect();
        Query {
            positions: conjoin(positions),
        }
    }

    /// The positions in order.
    pub fn positions(&self) -> &[QueryPosition] {
        &self.positions
    }

    /// The position that holds query segment `query_segment` (0-based), `None` past the last one.
    pub fn position_of(&self, query_segment: usize) -> Option<usize> {
        let position = self
            .positions
            .partition_point(|position| position.segments.end <= query_segment);
        (position < self.positions.len()).then_some(position)
    }

    /// The frames of the example at `position`, 0-based and end-exclusive; `None` past the last position, or if a
    /// position up to it has no length.
    pub fn frames_of(&self, position: usize) -> Option<Range<usize>> {
        let mut frames = 0..0usize;
        for position in self.positions.get(..=position)? {
            frames = frames.end..frames.end.saturating_add(position.n_frames?);
        }
        Some(frames)
    }

    /// The same positions and lengths with other sets: `set_of` gives the one for each position and its number. It says
    /// where other features count, and what else is accepted somewhere.
    ///
    /// [`QueryPosition::segments`] count the positions of `self` from here on, also when they are conjoined later. This
    /// does not conjoin: [`search_adaptive`](crate::search_adaptive) does, and [`conjoined`](Self::conjoined) gives
    /// what it searches for.
    ///
    /// Cost: O(positions). Source: 2005 paper, section 5.2, after eq. 9: sets may be given for each position.
    ///
    /// ```
    /// use segidx::{FuzzySet, Mask, Query};
    ///
    /// let example = [0b00, 0b01, 0b11, 0b10];
    /// let query = Query::fuzzy(&example, 0b11);
    /// let query = query.map_sets(|position, was| match (position, query.frames_of(position)) {
    ///     // At the beginning the word 0b10 will do as well.
    ///     (0, _) => was.set.union(&Mask::word(0b10).into()),
    ///     // Bit 1 alone in position 2, as the example has it there.
    ///     (2, Some(frames)) => FuzzySet::of_example(&example[frames], 0b10),
    ///     _ => was.set.clone(),
    /// });
    /// assert_eq!(query.positions()[2].set, Mask::new(0b10, 0b10).into());
    /// // Positions 2 and 3 share the word 0b10 now.
    /// let query = query.conjoined();
    /// assert_eq!(query.positions().len(), 3);
    /// assert_eq!(query.positions()[2].segments, 2..4);
    /// assert_eq!(query.position_of(3), Some(2));
    /// ```
    #[must_use]
    pub fn map_sets(&self, mut set_of: impl FnMut(usize, &QueryPosition) -> FuzzySet) -> Query {
        let positions = self.positions.iter().enumerate();
        let positions = positions.map(|(i, position)| QueryPosition {
            set: set_of(i, position),
            n_frames: position.n_frames,
            segments: i..i + 1,
        });
        Query {
            positions: positions.collect(),
        }
    }

    /// The query with the first and the last position as long as the runs that an excerpt was cut out of: `before` and
    /// `after` are the words next to the example, in its order. Hits have whole runs, so they are ranked by whole runs.
    ///
    /// Positions without a length stay without. Cost: O(words of these runs · masks). Source: 2005 paper, section 6.2,
    /// which ranks by the lengths of query and hit segments; it does not say how long a segment is that was cut.
    ///
    /// ```
    /// use segidx::Query;
    ///
    /// let clip = [1, 1, 1, 2, 3, 3];
    /// let (before, rest) = clip.split_at(2);
    /// let (example, after) = rest.split_at(3);
    /// let query = Query::exact(example, u64::MAX).of_excerpt(before, after);
    /// let n_frames = |position: usize| query.positions()[position].n_frames;
    /// assert_eq!([0, 1, 2].map(n_frames), [Some(3), Some(1), Some(2)]);
    /// ```
    #[must_use]
    pub fn of_excerpt(mut self, before: &[u64], after: &[u64]) -> Query {
        let lengthen = |position: Option<&mut QueryPosition>,
                        words: &mut dyn Iterator<Item = &u64>| {
            if let Some(QueryPosition { set, n_frames, .. }) = position {
                let n_more = words.take_while(|word| set.matches(**word)).count();
                *n_frames = n_frames.map(|n| n.saturating_add(n_more));
            }
        };
        lengthen(self.positions.first_mut(), &mut before.iter().rev());
        lengthen(self.positions.last_mut(), &mut after.iter());
        self
    }

    /// The query with neighbouring sets disjoint, conjoined where they are not; borrowed when nothing changes.
    ///
    /// [`search_adaptive`](crate::search_adaptive) runs on this form.
    pub fn conjoined(&self) -> Cow<'_, Query> {
        let touching = |pair: &[QueryPosition]| pair[0].set.intersects(&pair[1].set);
        if self.positions.windows(2).any(touching) {
            Cow::Owned(Query {
                positions: conjoin(self.positions.clone()),
            })
        } else {
            Cow::Borrowed(self)
        }
    }
}

/// Unites adjacent intersecting sets until no two neighbours intersect. The result does not depend on the order of
/// the unions (spec j.1), so one pass with a stack serves.
fn conjoin(positions: Vec<QueryPosition>) -> Vec<QueryPosition> {
    let mut done: Vec<QueryPosition> = Vec::with_capacity(positions.len());
    // Invariant: neighbours in `done` are disjoint. Termination: each inner step shortens `done`.
    for mut next in positions {
        while let Some(last) = done.pop_if(|last| last.set.intersects(&next.set)) {
            if last.set != next.set {
                next.set = last.set.union(&next.set);
            }
            next.n_frames = last
                .n_frames
                .zip(next.n_frames)
                .map(|(a, b)| a.saturating_add(b));
            next.segments.start = last.segments.start;
        }
        done.push(next);
    }
    done
}

#[cfg(test)]
mod tests;
