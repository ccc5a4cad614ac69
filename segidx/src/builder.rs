//! Building an index, document by document.

use crate::shard::{Collected, write};
use crate::{Index, Shard, segment};

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
    /// Names and metadata of all documents together are too long.
    #[error("expected at most {limit} bytes of names and metadata in one index, found {found}")]
    Text {
        /// The largest number of bytes.
        limit: u32,
        /// Bytes up to and with this document.
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
/// assert_eq!(index.list(6)?, [1]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct IndexBuilder {
    collected: Collected,
    text_len: usize,
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
            collected: Collected::default(),
            text_len: 0,
            limit,
        }
    }

    /// Number of documents added so far.
    pub fn n_documents(&self) -> usize {
        self.collected.names.len()
    }

    /// Number of segments of all documents added so far.
    pub fn n_segments(&self) -> usize {
        self.collected.words.len()
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
        let (name, meta) = (name.into(), meta.into());
        let limit = self.limit;
        let document = self.n_documents();
        let fail = |kind| Err(BuildError { document, kind });
        if document >= limit as usize {
            let found = document + 1;
            return fail(BuildErrorKind::Documents { limit, found });
        }
        if words.len() > limit as usize {
            let found = words.len();
            return fail(BuildErrorKind::Frames { limit, found });
        }
        let text_len = self.text_len + name.len() + meta.len();
        if text_len > limit as usize {
            let found = text_len;
            return fail(BuildErrorKind::Text { limit, found });
        }
        let segments = segment(words);
        let found = self.n_segments() + segments.len();
        if found > limit as usize {
            return fail(BuildErrorKind::Segments { limit, found });
        }
        let collected = &mut self.collected;
        collected.words.extend(segments.iter().map(|s| s.word));
        let lengths = segments.iter().map(|s| s.len as u32);
        collected.lengths.extend(lengths);
        collected.offsets.push(found as u32);
        collected.names.push(name);
        collected.metas.push(meta);
        self.text_len = text_len;
        Ok(())
    }

    /// The index of all documents added, as a shard in memory: [`Shard::as_bytes`] is its file.
    ///
    /// Cost: O(n log n) in the segments, n; memory for the shard and about 40 bytes per segment.
    pub fn build(&self) -> Index {
        Shard::from_trusted(write(&self.collected))
    }

    /// The index of all documents added under the bits in `bits` alone: the same documents in the same order with the
    /// same frames, but segments of `word & bits`, and neither names nor metadata. Those are in [`build`](Self::build)'s.
    ///
    /// An adaptive query that has no care outside `bits` finds the same frames at the same costs in both; this one has
    /// far fewer distinct words and segments. Cost: as [`build`](Self::build). Source: 2005 paper, section 6.1, the
    /// indexes I_ℓ, I_u and I_m of the parts of its feature set.
    ///
    /// ```
    /// let mut builder = segidx::IndexBuilder::new();
    /// builder.push("clip", [], &[0b01, 0b11, 0b10])?;
    /// let high = builder.build_restricted(0b10);
    /// assert_eq!((builder.build().n_segments(), high.n_segments()), (3, 2));
    /// assert_eq!(high.list(0b10)?, [1]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn build_restricted(&self, bits: u64) -> Index {
        Shard::from_trusted(write(&self.collected.restricted(bits)))
    }
}

impl Default for IndexBuilder {
    fn default() -> IndexBuilder {
        IndexBuilder::new()
    }
}

#[cfg(test)]
mod tests;
