//! Changing a library: one writer at a time, and nothing half done is ever seen.

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use segidx::{Index, IndexBuilder, Manifest, Shard, ShardEntry, checksum};

use super::files::{Lock, files_in, lock, replace, temporary};
use super::parts::{part_file, parts, shard_file};
use super::{
    ClipId, Library, NamedSet, description, description_path, manifest_path, read, shards_dir,
};
use crate::failure::Failure;
use crate::wire::ClipMeta;

/// Segments and clips after which a shard is full and is written. A shard of so many takes about 50 MB
/// with its parts and, while it is made, about 100 bytes of memory for each segment. A library of 10^8
/// frames has about a dozen, so that what a query costs per shard, whatever it finds, is small.
pub const SEGMENTS_PER_SHARD: usize = 4 << 20;

/// The only one who may write a library, for as long as it lives.
///
/// Clips are [pushed](Self::push) one after another and go into shards in this order; a full shard is
/// written at once, so that a writer holds the clips of one shard at most. Nothing counts before
/// [`commit`](Self::commit). After an error a writer is to be dropped: the next one clears away what it
/// left.
#[derive(Debug)]
pub struct Writer {
    library: Library,
    parts: Vec<(String, u64)>,
    segments_per_shard: usize,
    /// The clips of the shard to come.
    builder: IndexBuilder,
    /// The features that all of its clips have.
    usable: u64,
    /// Shards that are written and in no manifest yet.
    written: Vec<ShardEntry>,
    /// Closing the file gives the lock back, however the process ends.
    _lock: Lock,
}

impl Writer {
    /// Opens the library in `dir` for writing and clears away what a killed writer left there.
    ///
    /// # Errors
    /// [`Failure::Io`] if somebody else is writing, else as [`Library::open`].
    pub fn open(dir: &Path) -> Result<Writer, Failure> {
        // Not to leave a lock in a folder that is no library.
        read(&manifest_path(dir))?;
        let lock = lock(dir)?;
        Writer::new(Library::open(dir)?, lock)
    }

    /// A library that is not on disk yet, in a folder that is made if need be. If somebody else
    /// finished one there meanwhile, that one.
    ///
    /// # Errors
    /// [`Failure::Io`].
    pub fn create(dir: &Path, features: NamedSet, rate: f64) -> Result<Writer, Failure> {
        fs::create_dir_all(dir).map_err(|e| Failure::io(dir, e))?;
        let lock = lock(dir)?;
        if Library::exists(dir) {
            drop(lock);
            return Writer::open(dir);
        }
        let library = Library {
            dir: dir.to_owned(),
            features,
            rate,
            shards: Vec::new(),
        };
        Writer::new(library, lock)
    }

    fn new(library: Library, lock: Lock) -> Result<Writer, Failure> {
        let writer = Writer {
            parts: parts(&library.features.set),
            library,
            segments_per_shard: SEGMENTS_PER_SHARD,
            builder: IndexBuilder::new(),
            usable: u64::MAX,
            written: Vec::new(),
            _lock: lock,
        };
        writer.sweep()?;
        Ok(writer)
    }

    /// Another limit than [`SEGMENTS_PER_SHARD`].
    #[must_use]
    pub fn with_segments_per_shard(self, segments_per_shard: usize) -> Writer {
        Writer {
            segments_per_shard,
            ..self
        }
    }

    /// Whether `dir` holds nothing but what a writer leaves that is killed before its first shard.
    #[must_use]
    pub fn may_create(dir: &Path) -> bool {
        let known = [
            "lock",
            "library.toml",
            "library.toml.tmp",
            "shards",
            "manifest.tmp",
        ];
        fs::read_dir(dir).map_or(true, |entries| {
            entries
                .flatten()
                .all(|entry| known.iter().any(|known| entry.file_name() == *known))
        })
    }

    /// The library as it is on disk.
    #[must_use]
    pub fn library(&self) -> &Library {
        &self.library
    }

    /// Adds a clip behind those that were pushed before it, to count after the next commit.
    ///
    /// # Errors
    /// [`Failure::Io`]; [`Failure::Input`] if the clip is too long for any shard.
    pub fn push(&mut self, name: &str, meta: &ClipMeta, words: &[u64]) -> Result<(), Failure> {
        let stored = postcard::to_stdvec(meta).map_err(|e| Failure::input(&self.library.dir, e))?;
        let pushed = self.builder.push(name, stored, words);
        pushed.map_err(|e| Failure::input(&self.library.dir, e))?;
        self.usable &= meta.available;
        // Clips count, too: a clip without words has no segments, but a name.
        if self.builder.n_segments() + self.builder.n_documents() >= self.segments_per_shard {
            self.finish_shard()?;
        }
        Ok(())
    }

    /// Lets the clips that were pushed count and those in `removed` count no more, in one step.
    ///
    /// # Errors
    /// [`Failure::Io`].
    pub fn commit(&mut self, removed: &BTreeSet<ClipId>) -> Result<(), Failure> {
        self.finish_shard()?;
        let is_new = !Library::exists(&self.library.dir);
        if self.written.is_empty() && removed.is_empty() && !is_new {
            return Ok(());
        }
        let dir = self.library.dir.clone();
        let description = self.description()?;
        let mut entries = self.remaining(removed);
        entries.extend(self.written.iter().cloned());
        let manifest = Manifest {
            feature_set: self.library.features.set.name().to_owned(),
            description_checksum: checksum(&description),
            rate_hz: self.library.rate,
            shards: entries,
        };
        let path = manifest_path(&dir);
        let bytes = manifest.to_bytes().map_err(|e| Failure::input(&path, e))?;
        replace(&path, &bytes)?;
        self.written.clear();
        self.library = Library::open(&dir)?;
        self.sweep()
    }

    /// Puts all clips that count into as few shards as the limit allows, in their order. Says whether
    /// there was anything to do.
    ///
    /// # Errors
    /// [`Failure::Io`]; [`Failure::Input`] if the library is damaged.
    pub fn compact(&mut self) -> Result<bool, Failure> {
        if self.is_compact() {
            return Ok(false);
        }
        // While the lock is held, this is what `self.library` shows.
        let old = Library::open(&self.library.dir)?;
        let mut removed = BTreeSet::new();
        for (shard, open) in old.shards.iter().enumerate() {
            let refused = |e| Failure::input(&open.path, e);
            for document in open.shard.documents() {
                let document = document.map_err(refused)?;
                let doc = document.id();
                if !open.entry.is_removed(doc) {
                    let words = document.to_words().map_err(refused)?;
                    let clip = open.clip(shard, &document)?;
                    self.push(&clip.name, &clip.meta, &words)?;
                    removed.insert(ClipId { shard, doc });
                }
            }
        }
        self.commit(&removed)?;
        Ok(true)
    }

    /// Whether every shard but the last is full, and all clips count.
    fn is_compact(&self) -> bool {
        let shards = &self.library.shards;
        let is_full =
            |shard: &Shard<_>| shard.n_segments() + shard.n_documents() >= self.segments_per_shard;
        let mut but_last = shards.iter().rev().skip(1);
        shards.iter().all(|open| open.entry.removed.is_empty())
            && but_last.all(|open| is_full(&open.shard))
    }

    /// Writes the clips that were pushed since the last shard, if there are any, as a shard with its
    /// parts.
    fn finish_shard(&mut self) -> Result<(), Failure> {
        if self.builder.n_documents() == 0 {
            return Ok(());
        }
        let shards = shards_dir(&self.library.dir);
        fs::create_dir_all(&shards).map_err(|e| Failure::io(&shards, e))?;
        let number = self.next_number();
        let write = |file: String, index: Index| {
            replace(&shards.join(&file), index.as_bytes())?;
            Ok((file, index))
        };
        let whole = || write(shard_file(number), self.builder.build());
        let part = |(name, bits): &(String, u64)| {
            write(
                part_file(number, name),
                self.builder.build_restricted(*bits),
            )
        };
        let (whole, parts) = rayon::join(whole, || -> Vec<Result<_, Failure>> {
            self.parts.par_iter().map(part).collect()
        });
        let (file, whole) = whole?;
        let mut entry = ShardEntry::new(file, &whole);
        entry.usable = std::mem::replace(&mut self.usable, u64::MAX);
        for ((name, bits), written) in self.parts.iter().zip(parts) {
            let (file, part) = written?;
            entry.add_restriction((name, *bits), file, &part);
        }
        self.written.push(entry);
        self.builder = IndexBuilder::new();
        Ok(())
    }

    /// The shards that still have a clip without those that are removed.
    fn remaining(&self, removed: &BTreeSet<ClipId>) -> Vec<ShardEntry> {
        let mut entries = Vec::new();
        for (number, open) in self.library.shards.iter().enumerate() {
            let mut entry = open.entry.clone();
            let of_shard = removed.iter().filter(|clip| clip.shard == number);
            entry.removed.extend(of_shard.map(|clip| clip.doc));
            entry.removed.sort_unstable();
            entry.removed.dedup();
            if entry.removed.len() < open.shard.n_documents() {
                entries.push(entry);
            }
        }
        entries
    }

    /// The content of `library.toml`, which is written before the first manifest and stays.
    fn description(&self) -> Result<Vec<u8>, Failure> {
        let path = description_path(&self.library.dir);
        if Library::exists(&self.library.dir) {
            return read(&path);
        }
        let text = description::write(&self.library.features, self.library.rate)
            .map_err(|e| Failure::input(&path, e))?;
        replace(&path, text.as_bytes())?;
        Ok(text.into_bytes())
    }

    /// A number above those of all shards, so that no reader takes a new file for an old one.
    fn next_number(&self) -> u32 {
        let in_manifest = self.library.shards.iter().map(|open| &open.entry);
        let numbers = in_manifest.chain(&self.written).map(|entry| {
            let digits = entry.file.split('.').next().unwrap_or_default();
            digits.parse().unwrap_or(0)
        });
        numbers.max().map_or(1, |last: u32| last.saturating_add(1))
    }

    /// Removes files that the manifest does not name: shards that were replaced, and what a killed
    /// writer left.
    fn sweep(&self) -> Result<(), Failure> {
        let dir = &self.library.dir;
        let shards = shards_dir(dir);
        let named: BTreeSet<&PathBuf> = self
            .library
            .shards
            .iter()
            .flat_map(|open| std::iter::once(&open.path).chain(open.parts.iter().map(|p| &p.path)))
            .collect();
        for path in files_in(&shards)? {
            let is_ours = path.extension().is_some_and(|e| e == "shard" || e == "tmp");
            if is_ours && !named.contains(&path) {
                fs::remove_file(&path).map_err(|e| Failure::io(&path, e))?;
            }
        }
        for of in [manifest_path(dir), description_path(dir)] {
            match fs::remove_file(temporary(&of)) {
                Err(e) if e.kind() != io::ErrorKind::NotFound => return Err(Failure::io(&of, e)),
                _ => {}
            }
        }
        Ok(())
    }
}
