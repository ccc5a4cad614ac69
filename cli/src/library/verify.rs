//! Looking at every byte of a library.

use std::collections::BTreeSet;
use std::path::Path;

use segidx::{Manifest, Restriction, ShardEntry};
use serde::Serialize;

use super::{OpenPart, OpenShard, describe, description_path, manifest_path, unless_replaced};
use crate::failure::{Failure, Skipped};

/// What was looked at, and what is wrong with it.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Verified {
    /// Files looked at.
    pub files: usize,
    /// Their bytes.
    pub bytes: u64,
    /// The files that are damaged or missing.
    pub damage: Vec<Damage>,
}

/// A damaged file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Damage {
    /// The file.
    pub path: String,
    /// Where it shows, if that is known, and what is wrong.
    pub error: String,
}

impl Verified {
    fn count(&mut self, path: &Path, len: Option<u64>) {
        let len = len.or_else(|| std::fs::metadata(path).ok().map(|m| m.len()));
        self.files += 1;
        self.bytes += len.unwrap_or(0);
    }

    fn note(&mut self, path: &Path, failure: &Failure) {
        let Skipped { path, error, .. } = Skipped::new(path, failure);
        self.damage.push(Damage { path, error });
    }
}

/// Checks every byte of the library in `dir`: all checksums, and that all parts fit together.
///
/// # Errors
/// [`Failure::Io`] if there is no library.
pub fn verify(dir: &Path) -> Result<Verified, Failure> {
    // While the manifest is being replaced, what looks like damage may be a shard that was removed.
    let looked = unless_replaced(dir, |manifest| {
        let verified = verify_by(dir, manifest);
        if verified.damage.is_empty() {
            Ok(verified)
        } else {
            Err(verified)
        }
    })?;
    Ok(looked.unwrap_or_else(|damaged| damaged))
}

fn verify_by(dir: &Path, bytes: &[u8]) -> Verified {
    let mut verified = Verified::default();
    let path = manifest_path(dir);
    verified.count(&path, Some(bytes.len() as u64));
    let manifest = match Manifest::from_bytes(bytes) {
        Ok(manifest) => manifest,
        Err(e) => {
            verified.note(&path, &Failure::input(&path, e));
            return verified;
        }
    };
    let path = description_path(dir);
    verified.count(&path, None);
    if let Err(failure) = describe(dir, &manifest) {
        verified.note(&path, &failure);
    }
    let mut names = BTreeSet::new();
    for entry in manifest.shards {
        let path = super::shards_dir(dir).join(&entry.file);
        verified.count(&path, Some(entry.len));
        let parts = entry.restrictions.clone();
        let whole = check_shard(dir, entry, &mut names);
        if let Err(failure) = &whole {
            verified.note(&path, failure);
        }
        for part in parts {
            let path = super::shards_dir(dir).join(&part.file);
            verified.count(&path, Some(part.len));
            if let Err(failure) = check_part(dir, &part, whole.as_ref().ok()) {
                verified.note(&path, &failure);
            }
        }
    }
    verified
}

/// The part is whole, and agrees with the shard if that one is whole, too.
fn check_part(dir: &Path, entry: &Restriction, whole: Option<&OpenShard>) -> Result<(), Failure> {
    let part = OpenPart::open(dir, entry)?;
    part.shard
        .verify()
        .map_err(|e| Failure::input(&part.path, e))?;
    let Some(whole) = whole else { return Ok(()) };
    whole
        .shard
        .verify_restriction(&part.shard, entry.bits)
        .map_err(|e| Failure::input(&part.path, e))
}

/// The shard is whole, what is removed is there, and no clip counts twice in the library.
fn check_shard(
    dir: &Path,
    entry: ShardEntry,
    names: &mut BTreeSet<String>,
) -> Result<OpenShard, Failure> {
    let open = OpenShard::open_whole(dir, entry)?;
    let refused = |e| Failure::input(&open.path, e);
    open.shard.verify().map_err(refused)?;
    let n_documents = open.shard.n_documents();
    if let Some(last) = open.entry.removed.last()
        && last.index() >= n_documents
    {
        let message = format!("expected a removed clip below {n_documents}, found {last}");
        return Err(Failure::input(&manifest_path(dir), message));
    }
    for document in open.shard.documents() {
        let document = document.map_err(refused)?;
        let clip = open.clip(0, &document)?;
        if !open.entry.is_removed(document.id()) && !names.insert(clip.name) {
            let message = format!("the clip {:?} counts twice", document.name());
            return Err(Failure::input(&open.path, message));
        }
    }
    Ok(open)
}
