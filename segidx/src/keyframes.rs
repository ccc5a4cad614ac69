//! Chains of poses at bounded distances: where a search for something longer has to look.

mod chains;
mod windows;

use std::ops::{Range, RangeInclusive};

use self::windows::Windows;
use crate::shard::{Dictionary, View};
use crate::{DocId, Mask, Shard, ShardError};

/// Poses that follow each other: masks, and how they have to.
///
/// ```
/// use segidx::{IndexBuilder, KeyframeQuery, Mask, search_keyframes};
///
/// let mut builder = IndexBuilder::new();
/// builder.push("clip", [], &[0b00, 0b01, 0b01, 0b00, 0b10, 0b10, 0b00])?;
/// // Bit 0 is on, and two or three frames later bit 1 is.
/// let query = KeyframeQuery::new(Mask::new(0b01, 0b01)).then(2..=3, Mask::new(0b10, 0b10));
/// let hits = search_keyframes(&builder.build(), &query)?.hits;
/// assert_eq!((hits[0].first.clone(), hits[0].last.clone()), (1..3, 4..6));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct KeyframeQuery {
    /// Never empty.
    masks: Vec<Mask>,
    rule: Rule,
}

#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum Rule {
    /// Frames from one keyframe to the next, one range fewer than there are masks.
    Gaps(Vec<RangeInclusive<usize>>),
    /// Most frames from the first to the last, both counted, and for each mask the bits that segments go by.
    Greedy(usize, Vec<u64>),
}

impl KeyframeQuery {
    /// A single pose.
    pub fn new(first: Mask) -> KeyframeQuery {
        KeyframeQuery {
            masks: vec![first],
            rule: Rule::Gaps(Vec::new()),
        }
    }

    /// And then another, `gap` frames after the last one: 1 is the next frame. With an empty range nothing is found.
    ///
    /// A [`greedy`](Self::greedy) query looks at no gap, and at segments of all bits.
    #[must_use]
    pub fn then(mut self, gap: RangeInclusive<usize>, next: Mask) -> KeyframeQuery {
        self.masks.push(next);
        match &mut self.rule {
            Rule::Gaps(gaps) => gaps.push(gap),
            Rule::Greedy(_, bits) => bits.push(u64::MAX),
        }
        self
    }

    /// The same poses by the rule of 2006: from the last frame of a segment that the first mask accepts to the first frame
    /// of the next segment for each following mask that begins no earlier, if these are no more than `max_frames` with both
    /// ends.
    ///
    /// The segments of a mask are longest runs of frames that agree on the bits that `segmented_by` has for it, all bits if
    /// it has none: the paper has an index, and so segments, for each part of its feature set. Neighbouring segments that
    /// a mask accepts stay two.
    #[must_use]
    pub fn greedy(
        self,
        max_frames: usize,
        segmented_by: impl IntoIterator<Item = u64>,
    ) -> KeyframeQuery {
        let bits = segmented_by.into_iter().chain(std::iter::repeat(u64::MAX));
        let bits = self.masks.iter().zip(bits);
        let bits = bits.map(|(mask, bits)| bits | mask.care()).collect();
        KeyframeQuery {
            rule: Rule::Greedy(max_frames, bits),
            ..self
        }
    }

    /// The masks in order.
    pub fn masks(&self) -> &[Mask] {
        &self.masks
    }

    /// The bits that are looked at: the search finds the same in an index restricted to them.
    pub fn care(&self) -> u64 {
        let segments = match &self.rule {
            Rule::Gaps(_) => &[][..],
            Rule::Greedy(_, bits) => bits,
        };
        let masks = self.masks.iter().map(Mask::care);
        masks
            .chain(segments.iter().copied())
            .fold(0, |all, bits| all | bits)
    }

    /// What ends a run of a mask although the mask accepts the next word as well.
    fn segmented_by(&self) -> Option<&[u64]> {
        match &self.rule {
            Rule::Gaps(_) => None,
            Rule::Greedy(_, bits) => Some(bits),
        }
    }
}

/// Where keyframes were found: frames of one document, 0-based and end-exclusive.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct KeyframeHit {
    /// The document.
    pub doc: DocId,
    /// Frames that a chain can begin with, each of them; the frames before and after cannot.
    pub first: Range<usize>,
    /// From the first to the last frame that a chain from there can end with.
    pub last: Range<usize>,
}

/// Hits, and what was read for them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct KeyframeAnswer {
    /// Sorted by document and first frame.
    pub hits: Vec<KeyframeHit>,
    /// The keyframe whose inverted lists gave the places to look at; `None` if all segments were.
    pub pivot: Option<usize>,
    /// Number of segments each mask accepts.
    pub n_accepted: Vec<usize>,
    /// Segments whose words were read.
    pub n_segments: usize,
}

/// Where one segment in so many has the rarest mask, all are read: windows around them would touch.
const RARE: usize = 16;

/// All places where the keyframes of a query follow each other inside one document.
///
/// A chain is a frame t_i for each mask, whose word the mask accepts, with t_{i+1} − t_i in the gap between the two. A
/// hit stands for all chains that begin with one of its first frames; ranges of frames are handed on from mask to mask,
/// forwards and back, so chains are never tried one by one.
///
/// Cost: O(distinct words · masks + postings of the rarest mask + segments around these · masks), at most
/// O(segments · masks). Source: Baak, Müller and Seidel 2008 as spec e restates it, and for the greedy rule Müller and
/// Röder 2006, section 5.4. Against 2008, where a hit is one chain traced back from a last keyframe, hits are all chains.
///
/// # Errors
///
/// [`ShardError`] if a page that the search needs is damaged.
pub fn search_keyframes<B: AsRef<[u8]>>(
    shard: &Shard<B>,
    query: &KeyframeQuery,
) -> Result<KeyframeAnswer, ShardError> {
    let view = shard.view();
    let Some(dictionary) = view.dictionary() else {
        return view.finish(KeyframeAnswer::default());
    };
    let n_accepted = count(dictionary, &query.masks);
    // The first of the rarest.
    let pivot = (0..n_accepted.len()).min_by_key(|&mask| n_accepted[mask]);
    let pivot = pivot.unwrap_or_default();
    let mut answer = KeyframeAnswer {
        pivot: (n_accepted[pivot] <= view.n_segments() / RARE).then_some(pivot),
        n_accepted,
        ..KeyframeAnswer::default()
    };
    if answer.n_accepted[pivot] == 0 {
        return view.finish(answer);
    }
    let windows = match answer.pivot {
        None => {
            view.know_segments();
            Windows::all(&view)
        }
        Some(pivot) => {
            let segments = segments_of(&view, dictionary, query.masks[pivot]);
            Windows::around(&view, &segments, query.reach(pivot))
        }
    };
    let mut frames = view.frames();
    let mut runs = vec![Vec::new(); query.masks.len()];
    for window in windows.0 {
        answer.n_segments += window.segments.len();
        window.read_runs((&view, dictionary), &mut frames, query, &mut runs);
        let chains = match &query.rule {
            Rule::Gaps(gaps) => chains::with_gaps(&runs, gaps),
            Rule::Greedy(max_frames, _) => chains::greedy(&runs, *max_frames),
        };
        let hits = chains.into_iter().map(|(first, last)| KeyframeHit {
            doc: window.doc,
            first,
            last,
        });
        answer.hits.extend(hits);
        if view.failed() {
            break;
        }
    }
    view.finish(answer)
}

impl KeyframeQuery {
    /// The most frames from a keyframe back to the first and on to the last; `None` if the runs of a whole document
    /// count, however far away.
    fn reach(&self, keyframe: usize) -> Option<[usize; 2]> {
        let Rule::Gaps(gaps) = &self.rule else {
            return None;
        };
        let sum = |gaps: &[RangeInclusive<usize>]| {
            let longest = gaps.iter().map(|gap| *gap.end());
            longest.fold(0, usize::saturating_add)
        };
        Some([sum(&gaps[..keyframe]), sum(&gaps[keyframe..])])
    }
}

fn count(dictionary: &Dictionary, masks: &[Mask]) -> Vec<usize> {
    let mut counts = vec![0; masks.len()];
    for (list, &word) in dictionary.words.iter().enumerate() {
        let len = dictionary.list_len(list);
        for (count, mask) in counts.iter_mut().zip(masks) {
            *count += if mask.matches(word) { len } else { 0 };
        }
    }
    counts
}

/// The segments that a mask accepts, increasing.
fn segments_of(view: &View<'_>, dictionary: &Dictionary, mask: Mask) -> Vec<usize> {
    let lists = dictionary.words.iter().enumerate();
    let lists = lists.filter(|(_, word)| mask.matches(**word));
    let mut segments: Vec<usize> = lists
        .flat_map(|(list, _)| view.postings(dictionary, list))
        .collect();
    segments.sort_unstable();
    segments
}
