//! Whether one shard is another one under some of its bits.

use super::Shard;
use crate::{DocId, Segment, ShardError};

/// Why a shard is not the restriction of another.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RestrictionError {
    /// The numbers of documents differ.
    #[error("expected {expected} documents as in the whole index, found {found}")]
    Documents {
        /// Documents of the whole index.
        expected: usize,
        /// Documents of the restriction.
        found: usize,
    },
    /// A document has other segments than those of its words under the bits.
    #[error("document {0}: expected the segments of the whole index under {1:#x}, found others")]
    Segments(DocId, u64),
    /// One of the two is damaged.
    #[error(transparent)]
    Damaged(#[from] ShardError),
}

impl<B: AsRef<[u8]>> Shard<B> {
    /// Checks that `restricted` is what
    /// [`IndexBuilder::build_restricted`](crate::IndexBuilder::build_restricted) makes of this shard's documents.
    ///
    /// Cost: O(segments of both), memory for those of one document.
    ///
    /// # Errors
    ///
    /// [`RestrictionError`]: the first document that differs. It does not say which of the two is damaged, if one is:
    /// [`verify`](Self::verify) does.
    pub fn verify_restriction<R: AsRef<[u8]>>(
        &self,
        restricted: &Shard<R>,
        bits: u64,
    ) -> Result<(), RestrictionError> {
        let (expected, found) = (self.n_documents(), restricted.n_documents());
        if expected != found {
            return Err(RestrictionError::Documents { expected, found });
        }
        for (whole, part) in self.documents().zip(restricted.documents()) {
            let (whole, part) = (whole?, part?);
            if part.segments()? != masked(whole.segments()?, bits) {
                return Err(RestrictionError::Segments(whole.id(), bits));
            }
        }
        Ok(())
    }
}

/// The segments of the same frames under `bits`.
fn masked(segments: Vec<Segment>, bits: u64) -> Vec<Segment> {
    let mut masked: Vec<Segment> = Vec::with_capacity(segments.len());
    for segment in segments {
        let word = segment.word & bits;
        match masked.last_mut() {
            Some(last) if last.word == word => last.len += segment.len,
            _ => masked.push(Segment { word, ..segment }),
        }
    }
    masked
}
