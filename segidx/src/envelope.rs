//! The frame around everything this crate persists: magic, version, length and checksum before the payload.

use xxhash_rust::xxh3::{Xxh3, xxh3_64};

/// Bytes before the payload.
pub(crate) const HEADER_LEN: usize = 28;

const VERSION_AT: usize = 8;
const LEN_AT: usize = 12;
const CHECKSUM_AT: usize = 20;

/// What is wrong with the header of a persisted file, or with its relation to the bytes that follow.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum EnvelopeError {
    /// The file is of another kind.
    #[error("expected {what} magic \"{expected}\", found \"{found}\"")]
    Magic {
        /// Kind of file.
        what: &'static str,
        /// The magic of that kind.
        expected: &'static str,
        /// The first eight bytes, escaped.
        found: String,
    },
    /// The file is of another version.
    #[error("expected {what} version {expected}, found {found}")]
    Version {
        /// Kind of file.
        what: &'static str,
        /// The version this crate reads.
        expected: u32,
        /// The version of the file.
        found: u32,
    },
    /// The bytes end too early.
    #[error("expected {expected} bytes of {what}, found {found}")]
    Truncated {
        /// The part of the file that is cut off.
        what: &'static str,
        /// Its length.
        expected: u64,
        /// Bytes of it that are there.
        found: u64,
    },
    /// Bytes follow the end.
    #[error("expected the end of the {what}, found {found} more bytes")]
    Trailing {
        /// Kind of file.
        what: &'static str,
        /// How many.
        found: u64,
    },
    /// Header or payload changed since they were written.
    #[error("expected {what} checksum {expected:#018x}, found {found:#018x} in the bytes")]
    Checksum {
        /// Kind of file.
        what: &'static str,
        /// The checksum the header states.
        expected: u64,
        /// The checksum of the bytes.
        found: u64,
    },
}

/// The xxh3-64 checksum of `bytes`, as headers and pages use it.
pub fn checksum(bytes: &[u8]) -> u64 {
    xxh3_64(bytes)
}

/// A result, or the byte offset and the nature of what is wrong.
type Located<T> = Result<T, (usize, EnvelopeError)>;

/// A kind of file.
pub(crate) struct Envelope {
    pub(crate) what: &'static str,
    /// Eight ASCII bytes.
    pub(crate) magic: &'static str,
    pub(crate) version: u32,
}

impl Envelope {
    /// The header that belongs before `payload`.
    pub(crate) fn header(&self, payload: &[u8]) -> [u8; HEADER_LEN] {
        let mut header = [0; HEADER_LEN];
        header[..VERSION_AT].copy_from_slice(self.magic.as_bytes());
        header[VERSION_AT..LEN_AT].copy_from_slice(&self.version.to_le_bytes());
        header[LEN_AT..CHECKSUM_AT].copy_from_slice(&(payload.len() as u64).to_le_bytes());
        let sum = digest(&header[..CHECKSUM_AT], payload);
        header[CHECKSUM_AT..].copy_from_slice(&sum.to_le_bytes());
        header
    }

    /// The payload of a whole file, or the byte offset and the nature of what is wrong.
    pub(crate) fn open<'a>(&self, bytes: &'a [u8]) -> Located<&'a [u8]> {
        let (payload, rest) = self.split(bytes)?;
        if rest.is_empty() {
            return Ok(payload);
        }
        let (what, found) = (self.what, rest.len() as u64);
        Err((
            HEADER_LEN + payload.len(),
            EnvelopeError::Trailing { what, found },
        ))
    }

    /// The payload at the start of a longer file and what follows it, or what [`open`](Self::open) gives.
    pub(crate) fn split<'a>(&self, bytes: &'a [u8]) -> Located<(&'a [u8], &'a [u8])> {
        let what = self.what;
        let Some((header, payload)) = bytes.split_first_chunk::<HEADER_LEN>() else {
            let expected = HEADER_LEN as u64;
            let found = bytes.len() as u64;
            let what = "header";
            let error = EnvelopeError::Truncated {
                what,
                expected,
                found,
            };
            return Err((bytes.len(), error));
        };
        let (magic, fields) = header.split_at(VERSION_AT);
        if magic != self.magic.as_bytes() {
            let (expected, found) = (self.magic, magic.escape_ascii().to_string());
            return Err((
                0,
                EnvelopeError::Magic {
                    what,
                    expected,
                    found,
                },
            ));
        }
        let (version, fields) = fields.split_at(LEN_AT - VERSION_AT);
        let (len, sum) = fields.split_at(CHECKSUM_AT - LEN_AT);
        let (expected, found) = (self.version, little_endian(version) as u32);
        if found != expected {
            return Err((
                VERSION_AT,
                EnvelopeError::Version {
                    what,
                    expected,
                    found,
                },
            ));
        }
        let (expected, found) = (little_endian(len), payload.len() as u64);
        // A length beyond what an address can hold is beyond the bytes at hand, too.
        let Some((payload, rest)) =
            payload.split_at_checked(usize::try_from(expected).unwrap_or(usize::MAX))
        else {
            let what = "payload";
            let error = EnvelopeError::Truncated {
                what,
                expected,
                found,
            };
            return Err((bytes.len(), error));
        };
        let (expected, found) = (little_endian(sum), digest(&header[..CHECKSUM_AT], payload));
        if found != expected {
            return Err((
                CHECKSUM_AT,
                EnvelopeError::Checksum {
                    what,
                    expected,
                    found,
                },
            ));
        }
        Ok((payload, rest))
    }
}

/// The checksum that the header at the start of `bytes` states.
pub(crate) fn stated_checksum(bytes: &[u8]) -> u64 {
    little_endian(bytes.get(CHECKSUM_AT..HEADER_LEN).unwrap_or_default())
}

/// The checksum covers the other header fields, so that a changed bit in them cannot pass for another valid file.
fn digest(fields: &[u8], payload: &[u8]) -> u64 {
    let mut state = Xxh3::new();
    state.update(fields);
    state.update(payload);
    state.digest()
}

/// At most eight bytes, least significant first.
pub(crate) fn little_endian(bytes: &[u8]) -> u64 {
    let fold = |value, &byte: &u8| value << 8 | u64::from(byte);
    bytes.iter().rev().fold(0, fold)
}
