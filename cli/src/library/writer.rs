//! Changing a library: one writer at a time, and nothing half done is ever seen.

use std::collections::BTreeSet;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use segidx::{Index, IndexBuilder, Manifest, ShardEntry, checksum};

use super::{
    Clip, ClipId, Library, NamedSet, description, description_path, manifest_path, read, shards_dir,
};
use crate::failure::Failure;
use crate::wire::ClipWords;

/// The only one who may write a library, for as long as it lives.
#[derive(Debug)]
pub struct Writer {
    library: Library,
    /// Closing the file gives the lock back, however the process ends.
    _lock: File,
}

impl Writer {
    /// Opens the library in `dir` for writing and clears away what a killed writer left there.
    ///
    /// # Errors
    /// [`Failure::Io`] if somebody else is writing, else as [`Library::open`].
    pub fn open(dir: &Path) -> Result<Writer, Failure> {
        // Not to leave a lock in a folder that is no library.
        read(&manifest_path(dir))?;
        let writer = Writer {
            _lock: lock(dir)?,
            library: Library::open(dir)?,
        };
        writer.sweep()?;
        Ok(writer)
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
        let writer = Writer {
            _lock: lock,
            library: Library {
                dir: dir.to_owned(),
                features,
                rate,
                shards: Vec::new(),
            },
        };
        writer.sweep()?;
        Ok(writer)
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

    /// Adds clips in a shard of their own and removes others, in one step.
    ///
    /// # Errors
    /// [`Failure::Io`]; [`Failure::Input`] if the clips are too many for one shard.
    pub fn update(
        &mut self,
        clips: &[(String, ClipWords)],
        removed: &BTreeSet<ClipId>,
    ) -> Result<(), Failure> {
        if clips.is_empty() && removed.is_empty() && Library::exists(&self.library.dir) {
            return Ok(());
        }
        let dir = &self.library.dir;
        let mut builder = IndexBuilder::new();
        for (name, clip) in clips {
            let meta = postcard::to_stdvec(&clip.meta).map_err(|e| Failure::input(dir, e))?;
            let pushed = builder.push(name.as_str(), meta, &clip.words);
            pushed.map_err(|e| Failure::input(dir, e))?;
        }
        self.commit(builder, removed)
    }

    /// Puts all clips that count into one shard, in their order. Says whether there was anything to
    /// do.
    ///
    /// # Errors
    /// [`Failure::Io`]; [`Failure::Input`] if the library is damaged, or too large for one shard.
    pub fn compact(&mut self) -> Result<bool, Failure> {
        let shards = &self.library.shards;
        if shards.len() < 2 && shards.iter().all(|open| open.entry.removed.is_empty()) {
            return Ok(false);
        }
        let mut builder = IndexBuilder::new();
        let clips = self.library.clips()?;
        for clip in &clips {
            let open = &shards[clip.id.shard];
            let refused = |e| Failure::input(&open.path, e);
            let Some(document) = open.shard.document(clip.id.doc).map_err(refused)? else {
                continue;
            };
            let words = document.to_words().map_err(refused)?;
            let pushed = builder.push(document.name(), document.meta(), &words);
            pushed.map_err(|e| Failure::input(&self.library.dir, e))?;
        }
        let removed: BTreeSet<ClipId> = clips.iter().map(|clip: &Clip| clip.id).collect();
        self.commit(builder, &removed)?;
        Ok(true)
    }

    /// Writes the new shard, then the manifest, which makes it count; then removes what no longer does.
    fn commit(&mut self, builder: IndexBuilder, removed: &BTreeSet<ClipId>) -> Result<(), Failure> {
        let dir = self.library.dir.clone();
        let shards = shards_dir(&dir);
        fs::create_dir_all(&shards).map_err(|e| Failure::io(&shards, e))?;
        let description = self.description()?;
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
        if builder.n_documents() > 0 {
            let file = format!("{:04}.shard", self.next_number());
            let index: Index = builder.build();
            replace(&shards.join(&file), index.as_bytes())?;
            entries.push(ShardEntry::new(file, &index));
        }
        let manifest = Manifest {
            feature_set: self.library.features.set.name().to_owned(),
            description_checksum: checksum(&description),
            rate_hz: self.library.rate,
            shards: entries,
        };
        let path = manifest_path(&dir);
        let bytes = manifest.to_bytes().map_err(|e| Failure::input(&path, e))?;
        replace(&path, &bytes)?;
        self.library = Library::open(&dir)?;
        self.sweep()
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
        let numbers = self.library.shards.iter().map(|open| {
            let digits = open.entry.file.split('.').next().unwrap_or_default();
            digits.parse().unwrap_or(0)
        });
        numbers.max().map_or(1, |last: u32| last.saturating_add(1))
    }

    /// Removes files that the manifest does not name: shards that were replaced, and what a killed
    /// writer left.
    fn sweep(&self) -> Result<(), Failure> {
        let dir = &self.library.dir;
        let shards = shards_dir(dir);
        let is_named = |path: &PathBuf| self.library.shards.iter().any(|open| open.path == *path);
        for path in files_in(&shards)? {
            let is_ours = path.extension().is_some_and(|e| e == "shard" || e == "tmp");
            if is_ours && !is_named(&path) {
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

/// Takes the lock of a library.
fn lock(dir: &Path) -> Result<File, Failure> {
    let path = dir.join("lock");
    let mut options = OpenOptions::new();
    // The file stays: whoever removed it would let two writers hold locks of two files.
    let file = options.create(true).truncate(false).write(true).open(&path);
    let file = file.map_err(|e| Failure::io(&path, e))?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::Error(e)) => Err(Failure::io(&path, e)),
        Err(TryLockError::WouldBlock) => {
            let message = "locked: another motif is writing to this library";
            Err(Failure::io(&path, io::Error::other(message)))
        }
    }
}

fn files_in(dir: &Path) -> Result<Vec<PathBuf>, Failure> {
    let fail = |e| Failure::io(dir, e);
    let entries = match fs::read_dir(dir) {
        Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        entries => entries.map_err(fail)?,
    };
    entries
        .map(|entry| Ok(entry.map_err(fail)?.path()))
        .collect()
}

fn temporary(path: &Path) -> PathBuf {
    let mut temporary = path.as_os_str().to_owned();
    temporary.push(".tmp");
    temporary.into()
}

/// Writes a file beside its place and renames it there, so that nobody ever sees a part of it.
fn replace(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let fail = |e| Failure::io(path, e);
    let temporary = temporary(path);
    let mut file = File::create(&temporary).map_err(fail)?;
    file.write_all(bytes).map_err(fail)?;
    file.sync_all().map_err(fail)?;
    fs::rename(&temporary, path).map_err(fail)?;
    if let Some(dir) = path.parent() {
        // The rename itself must reach the disk. Not every file system can sync a folder.
        if let Ok(dir) = File::open(dir) {
            let _ = dir.sync_all();
        }
    }
    Ok(())
}
