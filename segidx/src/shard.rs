//! The persisted form of an index.

use std::io::{self, Write};

use serde::{Deserialize, Serialize, Serializer};

use crate::envelope::{Envelope, EnvelopeError, HEADER_LEN};
use crate::index::{Flaw, Index, Part, Row};

const SHARD: Envelope = Envelope {
    what: "shard",
    magic: "MOTIFSHD",
    version: 1,
};

/// Why bytes are not a shard.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("byte {at}: {kind}")]
pub struct ShardError {
    /// Where it shows, a 0-based byte offset. A checksum cannot tell which byte changed; its error points at the
    /// checksum itself.
    pub at: usize,
    /// What is wrong.
    pub kind: ShardErrorKind,
}

/// What is wrong with a shard.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ShardErrorKind {
    /// The header is not that of an intact shard.
    #[error(transparent)]
    Envelope(#[from] EnvelopeError),
    /// The payload is not a clip table and five columns.
    #[error("expected a clip table and five columns, found {0}")]
    Payload(String),
    /// Bytes follow the last column inside the payload.
    #[error("expected the end of the payload, found {0} more bytes")]
    Trailing(usize),
    /// A column is cut inside an entry.
    #[error("expected entries of {width} bytes, found a column of {found} bytes")]
    Column {
        /// Bytes per entry.
        width: usize,
        /// Bytes of the column.
        found: usize,
    },
    /// The parts contradict each other.
    #[error(transparent)]
    Flaw(#[from] Flaw),
}

/// The payload in the order of its fields, by postcard.
#[derive(Serialize, Deserialize)]
struct Payload<'a> {
    #[serde(borrow)]
    documents: Vec<DocumentRow<'a>>,
    segment_words: Column<'a>,
    segment_starts: Column<'a>,
    list_words: Column<'a>,
    list_offsets: Column<'a>,
    postings: Column<'a>,
}

#[derive(Serialize, Deserialize)]
struct DocumentRow<'a> {
    name: &'a str,
    #[serde(borrow)]
    meta: Column<'a>,
    n_frames: u32,
    n_segments: u32,
}

/// Numbers of one width, least significant byte first: reading is a copy, where variable-length numbers would be
/// decoded one by one.
#[derive(Deserialize)]
#[serde(transparent)]
struct Column<'a>(&'a [u8]);

impl Serialize for Column<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_bytes(self.0)
    }
}

impl Column<'_> {
    /// Where the column starts in `file`, which it is borrowed from.
    fn offset_in(&self, file: &[u8]) -> usize {
        offset_in(file, self.0)
    }

    fn entries<const WIDTH: usize>(&self, file: &[u8]) -> Result<&[[u8; WIDTH]], ShardError> {
        let (entries, rest) = self.0.as_chunks::<WIDTH>();
        if rest.is_empty() {
            return Ok(entries);
        }
        Err(ShardError {
            at: self.offset_in(file),
            kind: ShardErrorKind::Column {
                width: WIDTH,
                found: self.0.len(),
            },
        })
    }

    fn u64s(&self, file: &[u8]) -> Result<Vec<u64>, ShardError> {
        let entries = self.entries(file)?.iter();
        Ok(entries.map(|&entry| u64::from_le_bytes(entry)).collect())
    }

    fn u32s(&self, file: &[u8]) -> Result<Vec<u32>, ShardError> {
        let entries = self.entries(file)?.iter();
        Ok(entries.map(|&entry| u32::from_le_bytes(entry)).collect())
    }
}

impl Index {
    /// Writes the index as a shard.
    ///
    /// A shard is `MOTIFSHD`, the format version (u32), the payload length in bytes (u64) and an xxh3-64 checksum of
    /// all other bytes (u64), numbers little-endian, then the payload: clip table, segment words and starts, words,
    /// offsets and postings of the inverted lists. The same index gives the same bytes.
    ///
    /// Cost: O(shard bytes) time and memory.
    ///
    /// # Errors
    ///
    /// Those of the writer.
    pub fn write_shard(&self, mut writer: impl Write) -> io::Result<()> {
        let payload = self.payload()?;
        writer.write_all(&SHARD.header(&payload))?;
        writer.write_all(&payload)
    }

    /// Reads a shard; `bytes` is the whole file.
    ///
    /// Cost: O(bytes) time; memory in proportion to the bytes.
    ///
    /// # Errors
    ///
    /// [`ShardError`] with the byte offset: another kind or version of file, missing or surplus bytes, a changed bit
    /// anywhere, or parts that contradict each other although the checksum is right.
    ///
    /// ```
    /// let mut builder = segidx::IndexBuilder::new();
    /// builder.push("clip", [], &[1, 1, 2])?;
    /// let index = builder.build();
    /// let mut bytes = Vec::new();
    /// index.write_shard(&mut bytes)?;
    /// assert_eq!(segidx::Index::from_shard_bytes(&bytes)?, index);
    /// bytes[8] = 7;
    /// let error = segidx::Index::from_shard_bytes(&bytes).unwrap_err();
    /// assert_eq!(error.to_string(), "byte 8: expected shard version 1, found 7");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn from_shard_bytes(bytes: &[u8]) -> Result<Index, ShardError> {
        let payload = SHARD.open(bytes).map_err(|(at, error)| ShardError {
            at,
            kind: error.into(),
        })?;
        let (payload, rest) =
            postcard::take_from_bytes::<Payload<'_>>(payload).map_err(|error| ShardError {
                at: HEADER_LEN,
                kind: ShardErrorKind::Payload(error.to_string()),
            })?;
        if !rest.is_empty() {
            return Err(ShardError {
                at: bytes.len() - rest.len(),
                kind: ShardErrorKind::Trailing(rest.len()),
            });
        }
        payload.into_index(bytes)
    }

    fn payload(&self) -> io::Result<Vec<u8>> {
        let segment_words = bytes_of_u64s(&self.words);
        let segment_starts = bytes_of_u32s(&self.starts);
        let list_words = bytes_of_u64s(&self.list_words);
        let list_offsets = bytes_of_u32s(&self.list_offsets);
        let postings = bytes_of_u32s(&self.postings);
        let documents = self.rows.iter().zip(self.offsets.windows(2));
        let payload = Payload {
            documents: documents
                .map(|(row, bounds)| DocumentRow {
                    name: &row.name,
                    meta: Column(&row.meta),
                    n_frames: row.n_frames,
                    n_segments: bounds[1] - bounds[0],
                })
                .collect(),
            segment_words: Column(&segment_words),
            segment_starts: Column(&segment_starts),
            list_words: Column(&list_words),
            list_offsets: Column(&list_offsets),
            postings: Column(&postings),
        };
        postcard::to_stdvec(&payload).map_err(io::Error::other)
    }
}

impl Payload<'_> {
    fn into_index(self, file: &[u8]) -> Result<Index, ShardError> {
        let mut offsets = Vec::with_capacity(self.documents.len() + 1);
        let mut end = 0u32;
        offsets.push(end);
        for (entry, row) in self.documents.iter().enumerate() {
            end = end.checked_add(row.n_segments).ok_or_else(|| {
                let flaw = Flaw {
                    part: Part::Documents,
                    entry,
                    expected: "at most 4294967295 segments in all",
                    found: u64::from(end) + u64::from(row.n_segments),
                };
                self.locate(file, flaw)
            })?;
            offsets.push(end);
        }
        let rows = self.documents.iter().map(|row| Row {
            name: row.name.to_owned(),
            meta: row.meta.0.to_owned(),
            n_frames: row.n_frames,
        });
        let index = Index {
            rows: rows.collect(),
            offsets,
            words: self.segment_words.u64s(file)?,
            starts: self.segment_starts.u32s(file)?,
            list_words: self.list_words.u64s(file)?,
            list_offsets: self.list_offsets.u32s(file)?,
            postings: self.postings.u32s(file)?,
        };
        match index.debug_validate() {
            Ok(()) => Ok(index),
            Err(flaw) => Err(self.locate(file, flaw)),
        }
    }

    /// The flaw with its place in the file; past the last document, the end of the clip table.
    fn locate(&self, file: &[u8], flaw: Flaw) -> ShardError {
        let (column, width) = match flaw.part {
            Part::Documents => match self.documents.get(flaw.entry) {
                Some(row) => {
                    let at = offset_in(file, row.name.as_bytes());
                    let kind = flaw.into();
                    return ShardError { at, kind };
                }
                None => (&self.segment_words, 0),
            },
            Part::SegmentWords => (&self.segment_words, 8),
            Part::SegmentStarts => (&self.segment_starts, 4),
            Part::ListWords => (&self.list_words, 8),
            Part::ListOffsets => (&self.list_offsets, 4),
            Part::Postings => (&self.postings, 4),
        };
        ShardError {
            at: column.offset_in(file) + width * flaw.entry,
            kind: flaw.into(),
        }
    }
}

/// Where `part` starts in `file`, which it is borrowed from.
fn offset_in(file: &[u8], part: &[u8]) -> usize {
    (part.as_ptr() as usize).saturating_sub(file.as_ptr() as usize)
}

fn bytes_of_u64s(numbers: &[u64]) -> Vec<u8> {
    numbers.iter().flat_map(|n| n.to_le_bytes()).collect()
}

fn bytes_of_u32s(numbers: &[u32]) -> Vec<u8> {
    numbers.iter().flat_map(|n| n.to_le_bytes()).collect()
}

#[cfg(test)]
mod tests;
