//! Building an index, document by document.

use crate::index::Row;
use crate::{Index, segment};

/// Why a document or an index could not be built.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("document {document}: {kind}")]
pub struct BuildError {
    /// The document at fault, 0-based in order of insertion.
    pub document: usize,
    /// What is wrong with it.
    pub kind: BuildErrorKind,
}

/// The limits of one index: its numbers have 32 bits.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum BuildErrorKind {
    /// Too many frames in one document.
    #[error("expected at most {limit} frames, found {found}")]
    Frames {
        /// The largest number of frames.
        limit: u32,
        /// Frames of the document.
        found: usize,
    },
    /// Too many segments in all documents together.
    #[error("expected at most {limit} segments in one index, found {found}")]
    Segments {
        /// The largest number of segments.
        limit: u32,
        /// Segments up to and with this document.
        found: usize,
    },
    /// Too many documents.
    #[error("expected at most {limit} documents in one index, found {found}")]
    Documents {
        /// The largest number of documents.
        limit: u32,
        /// Documents up to and with this one.
        found: usize,
    },
}

/// Collects documents and builds an [`Index`] of them.
///
/// ```
/// let mut builder = segidx::IndexBuilder::new();
/// builder.push("clip", b"120".to_vec(), &[5, 5, 6])?;
/// let index = builder.build();
/// assert_eq!(index.n_segments(), 2);
/// assert_eq!(index.list(6), [1]);
/// # Ok::<(), segidx::BuildError>(())
/// ```
#[derive(Clone, Debug)]
pub struct IndexBuilder {
    rows: Vec<Row>,
    offsets: Vec<u32>,
    words: Vec<u64>,
    starts: Vec<u32>,
    limit: u32,
}

impl IndexBuilder {
    /// A builder without documents.
    pub fn new() -> IndexBuilder {
        IndexBuilder::with_limit(u32::MAX)
    }

    /// The limits in small, so that tests can reach them.
    pub(crate) fn with_limit(limit: u32) -> IndexBuilder {
        IndexBuilder {
            rows: Vec::new(),
            offsets: vec![0],
            words: Vec::new(),
            starts: Vec::new(),
            limit,
        }
    }

    /// Adds a document: a name, bytes of the caller's own, and one feature word per frame.
    ///
    /// A document may be empty, and names may repeat. Cost: O(frames).
    ///
    /// # Errors
    ///
    /// [`BuildError`] if the document has more than `u32::MAX` frames or the index would have more than `u32::MAX`
    /// segments or documents. The builder is unchanged then.
    pub fn push(
        &mut self,
        name: impl Into<String>,
        meta: impl Into<Vec<u8>>,
        words: &[u64],
    ) -> Result<(), BuildError> {
        let limit = self.limit;
        let document = self.rows.len();
        let fail = |kind| Err(BuildError { document, kind });
        if document >= limit as usize {
            let found = document + 1;
            return fail(BuildErrorKind::Documents { limit, found });
        }
        let Some(n_frames) = within(words.len(), limit) else {
            let found = words.len();
            return fail(BuildErrorKind::Frames { limit, found });
        };
        let segments = segment(words);
        let found = self.words.len() + segments.len();
        let Some(end) = within(found, limit) else {
            return fail(BuildErrorKind::Segments { limit, found });
        };
        self.words.extend(segments.iter().map(|s| s.word));
        self.starts.extend(segments.iter().map(|s| s.start as u32));
        self.offsets.push(end);
        self.rows.push(Row {
            name: name.into(),
            meta: meta.into(),
            n_frames,
        });
        Ok(())
    }

    /// The index of all documents added.
    ///
    /// Cost: O(n log n) in the segments.
    pub fn build(self) -> Index {
        let words = self.words;
        let mut postings: Vec<u32> = (0..words.len() as u32).collect();
        // The number breaks ties, so each list comes out increasing.
        postings.sort_unstable_by_key(|&k| (words[k as usize], k));
        let mut list_words = Vec::new();
        let mut list_offsets = vec![0];
        for list in postings.chunk_by(|&a, &b| words[a as usize] == words[b as usize]) {
            list_words.push(words[list[0] as usize]);
            let before = list_offsets.last().copied().unwrap_or(0);
            list_offsets.push(before + list.len() as u32);
        }
        Index {
            rows: self.rows,
            offsets: self.offsets,
            words,
            starts: self.starts,
            list_words,
            list_offsets,
            postings,
        }
    }
}

impl Default for IndexBuilder {
    fn default() -> IndexBuilder {
        IndexBuilder::new()
    }
}

fn within(count: usize, limit: u32) -> Option<u32> {
    u32::try_from(count).ok().filter(|&count| count <= limit)
}

#[cfg(test)]
mod tests;
