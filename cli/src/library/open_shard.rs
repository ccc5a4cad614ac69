//! Shards of a library that is open.

use std::path::{Path, PathBuf};

use memmap2::Mmap;
use segidx::{Document, Restriction, Shard, ShardEntry};

use super::{Clip, ClipId, map, shards_dir};
use crate::failure::Failure;

/// A shard, the parts of it, and what of it no longer counts.
#[derive(Debug)]
pub struct OpenShard {
    /// Its file.
    pub path: PathBuf,
    /// Its entry in the manifest.
    pub entry: ShardEntry,
    /// Its content.
    pub shard: Shard<Mmap>,
    /// The same clips, in the same order and with the same frames, under the features of one part
    /// each; none if the feature set has one part.
    pub parts: Vec<OpenPart>,
}

/// A shard of the features of one part.
#[derive(Debug)]
pub struct OpenPart {
    /// Its file.
    pub path: PathBuf,
    /// Its entry in the manifest: name and bits of the part.
    pub entry: Restriction,
    /// Its content: neither names nor metadata, and segment numbers of its own.
    pub shard: Shard<Mmap>,
}

impl OpenShard {
    pub(super) fn open(dir: &Path, entry: ShardEntry) -> Result<OpenShard, Failure> {
        let mut open = Self::open_whole(dir, entry)?;
        let parts = open.entry.restrictions.iter();
        let parts: Result<Vec<OpenPart>, Failure> =
            parts.map(|part| OpenPart::open(dir, part)).collect();
        open.parts = parts?;
        Ok(open)
    }

    /// The shard of all features alone.
    pub(super) fn open_whole(dir: &Path, entry: ShardEntry) -> Result<OpenShard, Failure> {
        let (path, shard) = open_file(dir, &entry.file, |shard| entry.matches(shard))?;
        Ok(OpenShard {
            path,
            entry,
            shard,
            parts: Vec::new(),
        })
    }

    /// The part that has all features of `care`, the first of several; `None` if `care` goes across
    /// parts. An adaptive query that compares no others has the same hits there, but for the numbers
    /// of their segments.
    #[must_use]
    pub fn part_for(&self, care: u64) -> Option<&OpenPart> {
        let mut parts = self.parts.iter();
        parts.find(|part| care & !part.entry.bits == 0)
    }

    /// The file and the content of the smallest index with all features of `care`: that of
    /// [`part_for`](Self::part_for), or of all features.
    #[must_use]
    pub fn index_for(&self, care: u64) -> (&Path, &Shard<Mmap>) {
        match self.part_for(care) {
            Some(part) => (&part.path, &part.shard),
            None => (&self.path, &self.shard),
        }
    }

    /// The clips that count, in order, of what is shard number `shard` of its library.
    pub(super) fn clips(&self, shard: usize) -> Result<Vec<Clip>, Failure> {
        let mut clips = Vec::new();
        for document in self.shard.documents() {
            let document = document.map_err(|e| Failure::input(&self.path, e))?;
            if !self.entry.is_removed(document.id()) {
                clips.push(self.clip(shard, &document)?);
            }
        }
        Ok(clips)
    }

    pub(super) fn clip(&self, shard: usize, document: &Document<'_>) -> Result<Clip, Failure> {
        let meta = postcard::from_bytes(document.meta())
            .map_err(|e| Failure::input(&self.path, format!("clip {:?}: {e}", document.name())))?;
        let doc = document.id();
        Ok(Clip {
            id: ClipId { shard, doc },
            name: document.name().to_owned(),
            meta,
            n_words: document.n_frames(),
            n_segments: document.n_segments(),
        })
    }
}

impl OpenPart {
    pub(super) fn open(dir: &Path, entry: &Restriction) -> Result<OpenPart, Failure> {
        let (path, shard) = open_file(dir, &entry.file, |shard| entry.matches(shard))?;
        Ok(OpenPart {
            path,
            entry: entry.clone(),
            shard,
        })
    }
}

fn open_file(
    dir: &Path,
    file: &str,
    is_named: impl Fn(&Shard<Mmap>) -> bool,
) -> Result<(PathBuf, Shard<Mmap>), Failure> {
    let path = shards_dir(dir).join(file);
    let bytes = map::map(&path).map_err(|e| Failure::io(&path, e))?;
    let shard = Shard::open(bytes).map_err(|e| Failure::input(&path, e))?;
    if !is_named(&shard) {
        let message = "byte 0: the shard is not the one that the manifest names";
        return Err(Failure::input(&path, message));
    }
    Ok((path, shard))
}
