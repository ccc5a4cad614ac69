//! The persisted list of the shards a library consists of.

use serde::{Deserialize, Serialize};

use crate::envelope::{Envelope, EnvelopeError, HEADER_LEN};
use crate::{DocId, Shard};

const MANIFEST: Envelope = Envelope {
    what: "manifest",
    magic: "MOTIFMAN",
    version: 3,
};

/// What all shards of a library share, and which they are.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// Name of the feature set the words come from.
    pub feature_set: String,
    /// [`checksum`](crate::checksum) of the text that says what the words mean, to notice that it was edited.
    pub description_checksum: u64,
    /// Frames per second of the words, positive and finite.
    pub rate_hz: f64,
    /// The shards in the order of their insertion.
    pub shards: Vec<ShardEntry>,
}

/// One shard of a [`Manifest`].
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ShardEntry {
    /// File name, as the caller chose it.
    pub file: String,
    /// Length of the file in bytes.
    pub len: u64,
    /// [`Shard::checksum`] of the file.
    pub checksum: u64,
    /// Documents that no longer count, in increasing order.
    pub removed: Vec<DocId>,
    /// Bits that mean something in every document, if the caller says so; all of them to begin with. A query on these
    /// bits need not ask each document whether it has them.
    pub usable: u64,
    /// Shards of the same documents under some of the bits alone.
    pub restrictions: Vec<Restriction>,
}

/// A shard that [`IndexBuilder::build_restricted`](crate::IndexBuilder::build_restricted) made beside that of a
/// [`ShardEntry`].
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Restriction {
    /// What the caller calls these bits.
    pub name: String,
    /// The bits of its words.
    pub bits: u64,
    /// File name, as the caller chose it.
    pub file: String,
    /// Length of the file in bytes.
    pub len: u64,
    /// [`Shard::checksum`] of the file.
    pub checksum: u64,
}

impl Restriction {
    /// Whether `shard` is the one of this entry, without looking at its pages.
    pub fn matches<B: AsRef<[u8]>>(&self, shard: &Shard<B>) -> bool {
        self.len == shard.as_bytes().len() as u64 && self.checksum == shard.checksum()
    }
}

impl ShardEntry {
    /// The entry of a shard with no document removed and no restriction.
    pub fn new<B: AsRef<[u8]>>(file: impl Into<String>, shard: &Shard<B>) -> ShardEntry {
        ShardEntry {
            file: file.into(),
            len: shard.as_bytes().len() as u64,
            checksum: shard.checksum(),
            removed: Vec::new(),
            usable: u64::MAX,
            restrictions: Vec::new(),
        }
    }

    /// Adds the entry of this shard's restriction to `bits`.
    pub fn add_restriction<B: AsRef<[u8]>>(
        &mut self,
        (name, bits): (impl Into<String>, u64),
        file: impl Into<String>,
        shard: &Shard<B>,
    ) {
        self.restrictions.push(Restriction {
            name: name.into(),
            bits,
            file: file.into(),
            len: shard.as_bytes().len() as u64,
            checksum: shard.checksum(),
        });
    }

    /// Whether `shard` is the one of this entry, without looking at its pages.
    pub fn matches<B: AsRef<[u8]>>(&self, shard: &Shard<B>) -> bool {
        self.len == shard.as_bytes().len() as u64 && self.checksum == shard.checksum()
    }

    /// Whether a document no longer counts. Cost: O(log removed).
    pub fn is_removed(&self, doc: DocId) -> bool {
        self.removed.binary_search(&doc).is_ok()
    }
}

/// Why bytes are not a manifest, or a manifest cannot be written.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("byte {at}: {kind}")]
pub struct ManifestError {
    /// Where it shows, a 0-based byte offset; the start of the payload for what is wrong in there.
    pub at: usize,
    /// What is wrong.
    pub kind: ManifestErrorKind,
}

/// What is wrong with a manifest.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ManifestErrorKind {
    /// The header is not that of an intact manifest.
    #[error(transparent)]
    Envelope(#[from] EnvelopeError),
    /// The payload has another form.
    #[error("expected a feature set, a rate and a list of shards, found {0}")]
    Payload(String),
    /// Bytes follow the list of shards inside the payload.
    #[error("expected the end of the payload, found {0} more bytes")]
    Trailing(usize),
    /// The rate is zero, negative, infinite or not a number.
    #[error("expected a positive and finite rate, found {0}")]
    Rate(f64),
    /// The removed documents of a shard are out of order or repeat.
    #[error("expected increasing removed documents for shard {shard}, found {found}")]
    Removed {
        /// Which shard, 0-based.
        shard: usize,
        /// The document that does not follow the one before it.
        found: DocId,
    },
}

impl Manifest {
    /// The manifest as a file: `MOTIFMAN`, then as in the head of a [`Shard`](crate::Shard::open).
    ///
    /// # Errors
    ///
    /// [`ManifestError`] if the rate or the removed documents break their rules.
    pub fn to_bytes(&self) -> Result<Vec<u8>, ManifestError> {
        self.check().map_err(in_payload)?;
        let payload = postcard::to_stdvec(self)
            .map_err(|error| in_payload(ManifestErrorKind::Payload(error.to_string())))?;
        let mut bytes = MANIFEST.header(&payload).to_vec();
        bytes.extend_from_slice(&payload);
        Ok(bytes)
    }

    /// Reads a manifest; `bytes` is the whole file. Cost: O(bytes) time; memory in proportion to the bytes.
    ///
    /// # Errors
    ///
    /// [`ManifestError`]: another kind or version of file, missing or surplus bytes, a changed bit anywhere, or
    /// values that break their rules.
    pub fn from_bytes(bytes: &[u8]) -> Result<Manifest, ManifestError> {
        let payload = MANIFEST.open(bytes).map_err(|(at, error)| ManifestError {
            at,
            kind: error.into(),
        })?;
        let (manifest, rest) = postcard::take_from_bytes::<Manifest>(payload)
            .map_err(|error| in_payload(ManifestErrorKind::Payload(error.to_string())))?;
        if !rest.is_empty() {
            return Err(ManifestError {
                at: bytes.len() - rest.len(),
                kind: ManifestErrorKind::Trailing(rest.len()),
            });
        }
        manifest.check().map_err(in_payload)?;
        Ok(manifest)
    }

    fn check(&self) -> Result<(), ManifestErrorKind> {
        if !(self.rate_hz.is_finite() && self.rate_hz > 0.0) {
            return Err(ManifestErrorKind::Rate(self.rate_hz));
        }
        for (shard, entry) in self.shards.iter().enumerate() {
            if let Some(pair) = entry.removed.windows(2).find(|pair| pair[0] >= pair[1]) {
                let found = pair[1];
                return Err(ManifestErrorKind::Removed { shard, found });
            }
        }
        Ok(())
    }
}

fn in_payload(kind: ManifestErrorKind) -> ManifestError {
    ManifestError {
        at: HEADER_LEN,
        kind,
    }
}

#[cfg(test)]
mod tests;
