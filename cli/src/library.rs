//! A library on disk (design.md §2): `library.toml`, `manifest`, `shards/NNNN.shard`, and beside each
//! shard one for each part of the feature set, `shards/NNNN-PART.shard`.
//!
//! Any number of processes may read a library while one writes it. Everything is written beside its
//! place and renamed there, the manifest last; shards never change. So a reader sees the old library
//! or the new one, and what a killed writer leaves behind is in nobody's way.

mod description;
mod files;
mod map;
mod open_shard;
mod parts;
mod verify;
mod writer;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use memmap2::Mmap;
use rayon::prelude::*;
use segidx::{DocId, Hit, KeyframeHit, Manifest, SceneHit, Shard, ShardError, checksum};

pub use self::description::NamedSet;
pub use self::open_shard::{OpenPart, OpenShard};
pub use self::verify::{Damage, Verified, verify};
pub use self::writer::{SEGMENTS_PER_SHARD, Writer};
use crate::failure::Failure;
use crate::wire::ClipMeta;

/// An open library. What it shows does not change, whatever is written meanwhile.
#[derive(Debug)]
pub struct Library {
    /// Its folder.
    pub dir: PathBuf,
    /// What the words mean.
    pub features: NamedSet,
    /// Words per second.
    pub rate: f64,
    shards: Vec<OpenShard>,
}

/// The place of a clip in a library. Clips are ordered by shard, then by document; this is the order
/// of results that are otherwise equal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct ClipId {
    shard: usize,
    doc: DocId,
}

/// A clip of a library.
#[derive(Clone, Debug)]
pub struct Clip {
    /// Its place.
    pub id: ClipId,
    /// Path as indexed, with its span.
    pub name: String,
    /// What is kept of it beside its words.
    pub meta: ClipMeta,
    /// Number of its words.
    pub n_words: usize,
    /// Number of its segments.
    pub n_segments: usize,
}

impl Library {
    /// Opens the library in `dir`. Manifest, description and the heads of the shards are checked now,
    /// everything else when it is first read.
    ///
    /// # Errors
    /// [`Failure::Io`] if a file is missing, [`Failure::Input`] if one is damaged.
    pub fn open(dir: &Path) -> Result<Library, Failure> {
        unless_replaced(dir, |manifest| Self::open_by(dir, manifest))?
    }

    fn open_by(dir: &Path, manifest: &[u8]) -> Result<Library, Failure> {
        let manifest =
            Manifest::from_bytes(manifest).map_err(|e| Failure::input(&manifest_path(dir), e))?;
        let (features, rate) = describe(dir, &manifest)?;
        let shards = manifest.shards.into_iter();
        let shards: Result<Vec<OpenShard>, Failure> =
            shards.map(|entry| OpenShard::open(dir, entry)).collect();
        Ok(Library {
            dir: dir.to_owned(),
            features,
            rate,
            shards: shards?,
        })
    }

    /// Whether `dir` holds a finished library.
    #[must_use]
    pub fn exists(dir: &Path) -> bool {
        manifest_path(dir).exists()
    }

    /// The shards in order.
    #[must_use]
    pub fn shards(&self) -> &[OpenShard] {
        &self.shards
    }

    /// The clips that count, in order.
    ///
    /// # Errors
    /// [`Failure::Input`] where the library is damaged.
    pub fn clips(&self) -> Result<Vec<Clip>, Failure> {
        let mut clips = Vec::new();
        for (number, open) in self.shards.iter().enumerate() {
            clips.extend(open.clips(number)?);
        }
        Ok(clips)
    }

    /// A clip that a search has found.
    ///
    /// # Errors
    /// [`Failure::Input`] where the library is damaged.
    pub fn clip(&self, id: ClipId) -> Result<Clip, Failure> {
        let open = &self.shards[id.shard];
        let missing = || Failure::input(&open.path, format!("there is no clip {}", id.doc));
        let document = open.shard.document(id.doc);
        let document = document.map_err(|e| Failure::input(&open.path, e))?;
        open.clip(id.shard, &document.ok_or_else(missing)?)
    }

    /// The clips that count whose rigs lack a feature of `care`. Only shards with such a clip are looked
    /// through.
    ///
    /// # Errors
    /// [`Failure::Input`] where the library is damaged.
    pub fn lacking(&self, care: u64) -> Result<BTreeSet<ClipId>, Failure> {
        let mut lacking = BTreeSet::new();
        for (number, open) in self.shards.iter().enumerate() {
            if care & !open.entry.usable == 0 {
                continue;
            }
            for clip in open.clips(number)? {
                if care & !clip.meta.available != 0 {
                    lacking.insert(clip.id);
                }
            }
        }
        Ok(lacking)
    }

    /// The words of a clip.
    ///
    /// # Errors
    /// [`Failure::Input`] where the library is damaged.
    pub fn words(&self, clip: ClipId) -> Result<Vec<u64>, Failure> {
        let open = &self.shards[clip.shard];
        let document = open.shard.document(clip.doc);
        let words = document.and_then(|document| document.map_or(Ok(Vec::new()), |d| d.to_words()));
        words.map_err(|e| Failure::input(&open.path, e))
    }

    /// Searches all shards: the hits in clips that count, by cost, then clip, then start.
    ///
    /// # Errors
    /// [`Failure::Input`] where the library is damaged.
    pub fn search<H: Ranked>(
        &self,
        search: impl Fn(&Shard<Mmap>) -> Result<Vec<H>, ShardError> + Sync,
    ) -> Result<Vec<(ClipId, H)>, Failure> {
        let search =
            |open: &OpenShard| search(&open.shard).map_err(|e| Failure::input(&open.path, e));
        Ok(self.search_each(|open| Ok((search(open)?, ())))?.0)
    }

    /// Searches all shards, whichever index of each: the hits in clips that count, by cost, then clip, then
    /// start, and what `search` gives beside them, in the order of the shards.
    ///
    /// # Errors
    /// The first of `search`, in the order of the shards.
    pub fn search_each<H: Ranked, S: Send>(
        &self,
        search: impl Fn(&OpenShard) -> Result<(Vec<H>, S), Failure> + Sync,
    ) -> Result<Gathered<H, S>, Failure> {
        let of_shards: Vec<Result<(Vec<H>, S), Failure>> =
            self.shards.par_iter().map(&search).collect();
        let (mut found, mut beside) = (Vec::new(), Vec::new());
        for (shard, (open, of_shard)) in self.shards.iter().zip(of_shards).enumerate() {
            let (hits, more) = of_shard?;
            beside.push(more);
            let hits = hits.into_iter().map(|hit| (hit.doc(), hit));
            let counting = hits.filter(|(doc, _)| !open.entry.is_removed(*doc));
            found.extend(counting.map(|(doc, hit)| (ClipId { shard, doc }, hit)));
        }
        found.sort_by_key(|(clip, hit)| (hit.cost(), *clip, hit.start()));
        Ok((found, beside))
    }

    /// [`search`](Self::search) for an adaptive query that compares no features but `care`: in the smallest
    /// index that has them all. The hits are the same, but for the numbers of their segments, which are
    /// those of the index.
    ///
    /// # Errors
    /// As [`search`](Self::search).
    pub fn search_adaptive<H: Ranked>(
        &self,
        care: u64,
        search: impl Fn(&Shard<Mmap>) -> Result<Vec<H>, ShardError> + Sync,
    ) -> Result<Vec<(ClipId, H)>, Failure> {
        let found = self.search_each(|open| {
            let (path, shard) = open.index_for(care);
            let hits = search(shard).map_err(|e| Failure::input(path, e))?;
            Ok((hits, ()))
        })?;
        Ok(found.0)
    }

    /// Name and bits of each part of the feature set that has an index of its own.
    #[must_use]
    pub fn parts(&self) -> Vec<(String, u64)> {
        parts::parts(&self.features.set)
    }
}

/// The hits of all shards with their clips, and what each shard gave beside them.
pub type Gathered<H, S> = (Vec<(ClipId, H)>, Vec<S>);

/// What hits of all shards are put in order by.
pub trait Ranked: Send {
    /// The document within its shard.
    fn doc(&self) -> DocId;
    /// 0 is best.
    fn cost(&self) -> u64;
    /// First frame within the document.
    fn start(&self) -> usize;
}

impl Ranked for Hit {
    fn doc(&self) -> DocId {
        self.doc
    }

    fn cost(&self) -> u64 {
        self.cost
    }

    fn start(&self) -> usize {
        self.span().start
    }
}

impl Ranked for SceneHit {
    fn doc(&self) -> DocId {
        self.doc
    }

    fn cost(&self) -> u64 {
        SceneHit::cost(self)
    }

    fn start(&self) -> usize {
        self.span.start
    }
}

impl Ranked for KeyframeHit {
    fn doc(&self) -> DocId {
        self.doc
    }

    /// One is as good as another.
    fn cost(&self) -> u64 {
        0
    }

    fn start(&self) -> usize {
        self.first.start
    }
}

/// Does `work` by the manifest of `dir`, and once more if it fails and the manifest was replaced
/// meanwhile: then a writer may have removed shards that the old one names. Termination: every further
/// attempt follows a finished write.
fn unless_replaced<T, E>(
    dir: &Path,
    work: impl Fn(&[u8]) -> Result<T, E>,
) -> Result<Result<T, E>, Failure> {
    let path = manifest_path(dir);
    let mut manifest = read(&path)?;
    loop {
        let done = work(&manifest);
        if done.is_ok() {
            return Ok(done);
        }
        let now = read(&path)?;
        if now == manifest {
            return Ok(done);
        }
        manifest = now;
    }
}

/// The features and the words per second, as `library.toml` says and the manifest confirms.
fn describe(dir: &Path, manifest: &Manifest) -> Result<(NamedSet, f64), Failure> {
    let path = description_path(dir);
    let bytes = read(&path)?;
    if checksum(&bytes) != manifest.description_checksum {
        let message =
            "byte 0: the text was edited or damaged; the words were computed with another";
        return Err(Failure::input(&path, message));
    }
    let (features, rate) = description::read(&path, &bytes)?;
    if rate.to_bits() != manifest.rate_hz.to_bits() {
        let found = manifest.rate_hz;
        let message = format!("byte 0: expected the manifest's rate of {found}, found {rate}");
        return Err(Failure::input(&path, message));
    }
    Ok((features, rate))
}

fn manifest_path(dir: &Path) -> PathBuf {
    dir.join("manifest")
}

fn description_path(dir: &Path) -> PathBuf {
    dir.join("library.toml")
}

fn shards_dir(dir: &Path) -> PathBuf {
    dir.join("shards")
}

fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    fs::read(path).map_err(|e| Failure::io(path, e))
}
