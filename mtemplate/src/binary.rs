//! The binary form of a [`ClassTemplate`]: a header, then the parts in postcard.

use ndarray::{Array1, Array2};
use serde::{Deserialize, Serialize};
use xxhash_rust::xxh3::Xxh3;

use crate::{
    ClassError, ClassTemplate, FileError, FileErrorKind, Keyframe, MAX_COLUMNS, MAX_FEATURES,
    MotionTemplate, Place,
};

const MAGIC: &[u8; 8] = b"MOTIFTPL";
/// Version of the binary form.
const VERSION: u32 = 1;
const VERSION_AT: usize = 8;
const LEN_AT: usize = 12;
const CHECKSUM_AT: usize = 20;
/// Bytes before the payload.
const HEADER_LEN: usize = 28;

/// What is wrong, and at which byte.
type Located<T> = Result<T, (usize, FileErrorKind)>;

#[derive(Serialize, Deserialize)]
struct Parts {
    name: String,
    feature_set: String,
    rate: f64,
    features: Vec<String>,
    columns: usize,
    /// Column by column.
    values: Vec<f64>,
    weights: Vec<f64>,
    n_motions: Option<usize>,
    tau: Option<f64>,
    keyframes: Vec<KeyframeParts>,
}

#[derive(Serialize, Deserialize)]
struct KeyframeParts {
    column: usize,
    care: u64,
    value: u64,
    stiffness: f64,
}

impl ClassTemplate {
    /// The template in binary form.
    ///
    /// Eight bytes `MOTIFTPL`; then, least significant byte first, the version of the form (four
    /// bytes), the length of the payload (eight), the xxh3-64 checksum of all other bytes (eight); then
    /// the payload in postcard.
    ///
    /// # Errors
    ///
    /// As [`check`](Self::check).
    pub fn to_bytes(&self) -> Result<Vec<u8>, ClassError> {
        self.check()?;
        let keyframes = self.keyframes.iter().map(|one| KeyframeParts {
            column: one.column,
            care: one.care,
            value: one.value,
            stiffness: one.stiffness,
        });
        let parts = Parts {
            name: self.name.clone(),
            feature_set: self.feature_set.clone(),
            rate: self.rate,
            features: self.features.clone(),
            columns: self.template.n_columns(),
            values: self.template.values().iter().copied().collect(),
            weights: self.template.weights().to_vec(),
            n_motions: self.n_motions,
            tau: self.tau,
            keyframes: keyframes.collect(),
        };
        let payload = postcard::to_stdvec(&parts).expect("lists of known length");
        let mut bytes = MAGIC.to_vec();
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend((payload.len() as u64).to_le_bytes());
        bytes.extend(digest(&bytes, &payload).to_le_bytes());
        bytes.extend(payload);
        Ok(bytes)
    }

    /// Reads a template in either form: binary if the bytes start with `MOTIFTPL`, else text. `names`
    /// is as for [`from_text`](Self::from_text); a binary template has all its features, and is laid
    /// out [`over`](Self::over) those of its set.
    ///
    /// # Errors
    ///
    /// [`FileError`]: as [`from_text`](Self::from_text); in binary form another version, missing or
    /// surplus bytes, a changed bit anywhere, or parts that do not fit. What is wrong inside the payload
    /// is reported at its start.
    pub fn from_bytes(
        bytes: &[u8],
        names: impl Fn(&str) -> Option<Vec<String>>,
    ) -> Result<ClassTemplate, FileError> {
        if bytes.starts_with(MAGIC) {
            return read(bytes, names).map_err(|(byte, kind)| FileError {
                at: Place::Binary { byte },
                kind,
            });
        }
        match str::from_utf8(bytes) {
            Ok(text) => Self::from_text(text, names),
            Err(error) => Err(FileError {
                at: Place::in_text(bytes, error.valid_up_to()),
                kind: FileErrorKind::NoText,
            }),
        }
    }
}

fn read(bytes: &[u8], names: impl Fn(&str) -> Option<Vec<String>>) -> Located<ClassTemplate> {
    let payload = open(bytes)?;
    let in_payload = |kind| (HEADER_LEN, kind);
    let (parts, rest) = postcard::take_from_bytes::<Parts>(payload)
        .map_err(|error| in_payload(FileErrorKind::Payload(error.to_string())))?;
    if !rest.is_empty() {
        let found = rest.len();
        return Err((bytes.len() - found, FileErrorKind::Trailing { found }));
    }
    let class = parts.class().map_err(in_payload)?;
    match names(&class.feature_set) {
        None => Ok(class),
        Some(names) => class.over(&names).map_err(|error| in_payload(error.into())),
    }
}

/// The payload of a whole file.
fn open(bytes: &[u8]) -> Located<&[u8]> {
    let truncated = |what, expected, found| FileErrorKind::Truncated {
        what,
        expected,
        found,
    };
    let Some((header, payload)) = bytes.split_first_chunk::<HEADER_LEN>() else {
        let kind = truncated("header", HEADER_LEN as u64, bytes.len() as u64);
        return Err((bytes.len(), kind));
    };
    let number = |from: usize, to: usize| {
        let bytes = header[from..to].iter().rev();
        bytes.fold(0, |value: u64, &byte| value << 8 | u64::from(byte))
    };
    let (expected, found) = (VERSION, number(VERSION_AT, LEN_AT) as u32);
    if found != expected {
        return Err((VERSION_AT, FileErrorKind::Version { expected, found }));
    }
    let (expected, found) = (number(LEN_AT, CHECKSUM_AT), payload.len() as u64);
    if found < expected {
        return Err((bytes.len(), truncated("payload", expected, found)));
    }
    let len = expected as usize;
    if payload.len() > len {
        let found = payload.len() - len;
        return Err((HEADER_LEN + len, FileErrorKind::Trailing { found }));
    }
    let expected = number(CHECKSUM_AT, HEADER_LEN);
    let found = digest(&header[..CHECKSUM_AT], payload);
    if found != expected {
        return Err((CHECKSUM_AT, FileErrorKind::Checksum { expected, found }));
    }
    Ok(payload)
}

/// The checksum covers the other fields of the header, so that a changed bit in them cannot pass.
fn digest(fields: &[u8], payload: &[u8]) -> u64 {
    let mut state = Xxh3::new();
    state.update(fields);
    state.update(payload);
    state.digest()
}

impl Parts {
    fn class(self) -> Result<ClassTemplate, FileErrorKind> {
        let (columns, n_features) = (self.columns, self.features.len());
        if columns > MAX_COLUMNS {
            return Err(ClassError::Columns { found: columns }.into());
        }
        if !(1..=MAX_FEATURES).contains(&n_features) {
            return Err(ClassError::Features { found: n_features }.into());
        }
        let n_values = self.values.len();
        let values = Array2::from_shape_vec((columns, n_features), self.values).map_err(|_| {
            let expected = columns * n_features;
            FileErrorKind::Payload(format!("{n_values} values instead of {expected}"))
        })?;
        let keyframes = self.keyframes.into_iter().map(|one| Keyframe {
            column: one.column,
            care: one.care,
            value: one.value,
            stiffness: one.stiffness,
        });
        let class = ClassTemplate {
            name: self.name,
            feature_set: self.feature_set,
            rate: self.rate,
            features: self.features,
            template: MotionTemplate::new(values, Array1::from(self.weights))?,
            n_motions: self.n_motions,
            tau: self.tau,
            keyframes: keyframes.collect(),
        };
        class.check()?;
        Ok(class)
    }
}
