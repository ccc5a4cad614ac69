//! The invariants of an index.

use std::fmt;

use super::Index;

/// A part of an [`Index`], as a shard stores it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Part {
    /// The clip table; entries are documents.
    Documents,
    /// The words of the segments; entries are global segment numbers.
    SegmentWords,
    /// The first frames of the segments; entries are global segment numbers.
    SegmentStarts,
    /// The distinct words; entries are lists.
    ListWords,
    /// The places of the lists among the postings; entries are lists.
    ListOffsets,
    /// The segment numbers of all lists; entries are postings.
    Postings,
}

impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Part::Documents => "document",
            Part::SegmentWords => "segment word",
            Part::SegmentStarts => "segment start",
            Part::ListWords => "list word",
            Part::ListOffsets => "list offset",
            Part::Postings => "posting",
        })
    }
}

/// An invariant of an [`Index`] that does not hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{part} {entry}: expected {expected}, found {found}")]
pub struct Flaw {
    /// Where it shows.
    pub part: Part,
    /// Which entry of the part, 0-based.
    pub entry: usize,
    /// What should be there.
    pub expected: &'static str,
    /// What is there.
    pub found: u64,
}

pub(super) fn check(index: &Index) -> Result<(), Flaw> {
    check_segments(index)?;
    check_lists(index)
}

fn require(holds: bool, flaw: impl FnOnce() -> Flaw) -> Result<(), Flaw> {
    if holds { Ok(()) } else { Err(flaw()) }
}

fn flaw(part: Part, entry: usize, expected: &'static str, found: impl Into<u64>) -> Flaw {
    Flaw {
        part,
        entry,
        expected,
        found: found.into(),
    }
}

/// The segments of every document tile it and are maximal.
fn check_segments(index: &Index) -> Result<(), Flaw> {
    let n_segments = index.words.len();
    require(index.starts.len() == n_segments, || {
        let found = index.starts.len() as u64;
        flaw(Part::SegmentStarts, 0, "one start per segment word", found)
    })?;
    let total = index.offsets.last().copied().unwrap_or(0);
    require(total as usize == n_segments, || {
        let expected = "as many segments in the documents as segment words";
        flaw(Part::Documents, index.rows.len(), expected, total)
    })?;
    for (doc, (row, bounds)) in index.rows.iter().zip(index.offsets.windows(2)).enumerate() {
        let (first, end) = (bounds[0] as usize, bounds[1] as usize);
        if first == end {
            require(row.n_frames == 0, || {
                let expected = "no frames without segments";
                flaw(Part::Documents, doc, expected, row.n_frames)
            })?;
            continue;
        }
        require(index.starts[first] == 0, || {
            let expected = "start 0 for the first segment of a document";
            flaw(Part::SegmentStarts, first, expected, index.starts[first])
        })?;
        for k in first + 1..end {
            require(index.starts[k - 1] < index.starts[k], || {
                let expected = "a start after that of the segment before";
                flaw(Part::SegmentStarts, k, expected, index.starts[k])
            })?;
            require(index.words[k - 1] != index.words[k], || {
                let expected = "a word other than that of the segment before";
                flaw(Part::SegmentWords, k, expected, index.words[k])
            })?;
        }
        require(index.starts[end - 1] < row.n_frames, || {
            let expected = "more frames than the start of the last segment";
            flaw(Part::Documents, doc, expected, row.n_frames)
        })?;
    }
    Ok(())
}

/// Every segment stands in the list of its word, once.
fn check_lists(index: &Index) -> Result<(), Flaw> {
    let (words, offsets) = (&index.list_words, &index.list_offsets);
    require(offsets.len() == words.len() + 1, || {
        let expected = "one offset per list and one more";
        flaw(Part::ListOffsets, 0, expected, offsets.len() as u64)
    })?;
    require(offsets[0] == 0, || {
        flaw(Part::ListOffsets, 0, "offset 0", offsets[0])
    })?;
    let n_postings = offsets[words.len()];
    require(index.postings.len() == index.words.len(), || {
        let expected = "one posting per segment";
        flaw(Part::Postings, 0, expected, index.postings.len() as u64)
    })?;
    require(n_postings as usize == index.postings.len(), || {
        let expected = "the number of postings";
        flaw(Part::ListOffsets, words.len(), expected, n_postings)
    })?;
    for list in 0..words.len() {
        require(list == 0 || words[list - 1] < words[list], || {
            let expected = "a word above that of the list before";
            flaw(Part::ListWords, list, expected, words[list])
        })?;
        require(
            offsets[list] < offsets[list + 1] && offsets[list + 1] <= n_postings,
            || {
                let expected = "an offset above the one before";
                flaw(Part::ListOffsets, list + 1, expected, offsets[list + 1])
            },
        )?;
        // Increasing postings of the right word in every list, as many in all as segments: no segment can be missing.
        let first = offsets[list] as usize;
        for (i, &segment) in index.postings_of(list).iter().enumerate() {
            let entry = first + i;
            require(i == 0 || index.postings[entry - 1] < segment, || {
                let expected = "a segment after the one before";
                flaw(Part::Postings, entry, expected, segment)
            })?;
            let word = index.words.get(segment as usize);
            require(word == Some(&words[list]), || {
                let expected = "a segment that carries the word of its list";
                flaw(Part::Postings, entry, expected, segment)
            })?;
        }
    }
    Ok(())
}
