//! The frame around a saved model: magic, version, length and checksum before the payload.

use thiserror::Error;
use xxhash_rust::xxh3::Xxh3;

/// Bytes before the payload.
pub(super) const HEADER_LEN: usize = 28;

const MAGIC: &[u8; 8] = b"MOTIFMBG";
const VERSION: u32 = 1;
const VERSION_AT: usize = 8;
const LEN_AT: usize = 12;
const CHECKSUM_AT: usize = 20;

/// What is wrong with the header of a saved model, or with its relation to the bytes that follow.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum EnvelopeError {
    /// The bytes are something else.
    #[error("expected model magic \"MOTIFMBG\", found \"{found}\"")]
    Magic {
        /// The first eight bytes, escaped.
        found: String,
    },
    /// The model is of another version.
    #[error("expected model version {expected}, found {found}")]
    Version {
        /// The version this crate reads.
        expected: u32,
        /// The version of the model.
        found: u32,
    },
    /// The bytes end too early.
    #[error("expected {expected} bytes of {what}, found {found}")]
    Truncated {
        /// The part that is cut off.
        what: &'static str,
        /// Its length.
        expected: u64,
        /// Bytes of it that are there.
        found: u64,
    },
    /// Bytes follow the end.
    #[error("expected the end of the model, found {found} more bytes")]
    Trailing {
        /// How many.
        found: u64,
    },
    /// Header or payload changed since they were written.
    #[error("expected model checksum {expected:#018x}, found {found:#018x} in the bytes")]
    Checksum {
        /// The checksum the header states.
        expected: u64,
        /// The checksum of the bytes.
        found: u64,
    },
}

/// `payload` behind its header.
pub(super) fn seal(payload: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(HEADER_LEN + payload.len());
    bytes.extend(MAGIC);
    bytes.extend(VERSION.to_le_bytes());
    bytes.extend((payload.len() as u64).to_le_bytes());
    bytes.extend(digest(&bytes, payload).to_le_bytes());
    bytes.extend(payload);
    bytes
}

/// The payload, or the byte offset and the nature of what is wrong.
pub(super) fn open(bytes: &[u8]) -> Result<&[u8], (usize, EnvelopeError)> {
    let Some((header, payload)) = bytes.split_first_chunk::<HEADER_LEN>() else {
        let (expected, found) = (HEADER_LEN as u64, bytes.len() as u64);
        return Err((bytes.len(), truncated("header", expected, found)));
    };
    let (magic, fields) = header.split_at(VERSION_AT);
    if magic != MAGIC {
        let found = magic.escape_ascii().to_string();
        return Err((0, EnvelopeError::Magic { found }));
    }
    let (version, fields) = fields.split_at(LEN_AT - VERSION_AT);
    let (len, sum) = fields.split_at(CHECKSUM_AT - LEN_AT);
    let (expected, found) = (VERSION, little_endian(version) as u32);
    if found != expected {
        return Err((VERSION_AT, EnvelopeError::Version { expected, found }));
    }
    let (expected, found) = (little_endian(len), payload.len() as u64);
    if found < expected {
        return Err((bytes.len(), truncated("payload", expected, found)));
    }
    if found > expected {
        let at = bytes.len() - (found - expected) as usize;
        let found = found - expected;
        return Err((at, EnvelopeError::Trailing { found }));
    }
    let (expected, found) = (little_endian(sum), digest(&header[..CHECKSUM_AT], payload));
    if found != expected {
        return Err((CHECKSUM_AT, EnvelopeError::Checksum { expected, found }));
    }
    Ok(payload)
}

fn truncated(what: &'static str, expected: u64, found: u64) -> EnvelopeError {
    EnvelopeError::Truncated {
        what,
        expected,
        found,
    }
}

/// The checksum covers the other header fields, so that a changed bit in them cannot pass for
/// another valid model.
fn digest(fields: &[u8], payload: &[u8]) -> u64 {
    let mut state = Xxh3::new();
    state.update(fields);
    state.update(payload);
    state.digest()
}

/// At most eight bytes, least significant first.
fn little_endian(bytes: &[u8]) -> u64 {
    let fold = |value, &byte: &u8| value << 8 | u64::from(byte);
    bytes.iter().rev().fold(0, fold)
}
