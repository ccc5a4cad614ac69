//! A library on disk (design.md §2): `library.toml`, `manifest`, `shards/NNNN.shard`.

use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};

use relfeat::FeatureSet;
use segidx::{Document, Index, IndexBuilder, Manifest, ShardEntry, checksum};
use serde::{Deserialize, Serialize};

use crate::failure::Failure;
use crate::wire::{ClipMeta, ClipWords};

/// Version of the folder's layout.
const VERSION: u32 = 1;

/// A feature set with the text that it was read from.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedSet {
    /// The features.
    pub set: FeatureSet,
    /// TOML.
    pub text: String,
}

impl NamedSet {
    /// A built-in set by its name, or a set from a TOML file.
    ///
    /// # Errors
    /// [`Failure`] if there is no such set or file, or the file is no set.
    pub fn find(name: &str) -> Result<NamedSet, Failure> {
        if let Some(text) = FeatureSet::builtin_toml(name) {
            return Self::from_text(Path::new(name), text);
        }
        let path = Path::new(name);
        if !path.exists() {
            return Err(Failure::Usage(format!(
                "expected {} or a TOML file, found {name:?}",
                relfeat::BUILTIN_SETS.join(", ")
            )));
        }
        let text = fs::read_to_string(path).map_err(|e| Failure::io(path, e))?;
        Self::from_text(path, &text)
    }

    fn from_text(path: &Path, text: &str) -> Result<NamedSet, Failure> {
        let set = FeatureSet::from_toml(text).map_err(|e| Failure::input(path, e))?;
        Ok(NamedSet {
            set,
            text: text.to_owned(),
        })
    }
}

/// The human-readable part: what the words mean.
#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct LibraryToml {
    version: u32,
    rate: f64,
    feature_set: String,
    feature_set_toml: String,
}

/// An open library.
#[derive(Debug)]
pub struct Library {
    /// Its folder.
    pub dir: PathBuf,
    /// What the words mean.
    pub features: NamedSet,
    /// Words per second.
    pub rate: f64,
    /// All clips.
    pub index: Index,
    shard_number: u32,
}

impl Library {
    /// Opens the library in `dir`, checking every byte of its manifest and shard.
    ///
    /// # Errors
    /// [`Failure::Io`] if a file is missing, [`Failure::Input`] if one is damaged.
    pub fn open(dir: &Path) -> Result<Library, Failure> {
        let toml_path = dir.join("library.toml");
        let text = fs::read_to_string(&toml_path).map_err(|e| Failure::io(&toml_path, e))?;
        let about: LibraryToml = toml::from_str(&text)
            .map_err(|e| Failure::input(&toml_path, e.to_string().trim().replace('\n', " ")))?;
        if about.version != VERSION {
            let message = format!(
                "expected library version {VERSION}, found {}",
                about.version
            );
            return Err(Failure::input(&toml_path, message));
        }
        let features = NamedSet::from_text(&toml_path, &about.feature_set_toml)?;
        let manifest_path = dir.join("manifest");
        let manifest = read(&manifest_path)?;
        let manifest =
            Manifest::from_bytes(&manifest).map_err(|e| Failure::input(&manifest_path, e))?;
        let same_rate = manifest.rate_hz.to_bits() == about.rate.to_bits();
        if manifest.feature_set_checksum != checksum(features.text.as_bytes()) || !same_rate {
            let message =
                "the feature set or the rate was edited; the words were computed with another";
            return Err(Failure::input(&toml_path, message));
        }
        let [shard] = manifest.shards.as_slice() else {
            let found = manifest.shards.len();
            let message = format!("expected one shard, found {found}");
            return Err(Failure::input(&manifest_path, message));
        };
        let shard_path = dir.join("shards").join(&shard.file);
        let bytes = read(&shard_path)?;
        let index = Index::from_shard_bytes(&bytes).map_err(|e| Failure::input(&shard_path, e))?;
        if !shard.matches(&bytes) {
            let message = "the shard is not the one that the manifest names";
            return Err(Failure::input(&shard_path, message));
        }
        Ok(Library {
            dir: dir.to_owned(),
            features,
            rate: manifest.rate_hz,
            index,
            shard_number: shard_number(&shard.file),
        })
    }

    /// A library that is not on disk yet.
    #[must_use]
    pub fn new(dir: &Path, features: NamedSet, rate: f64) -> Library {
        Library {
            dir: dir.to_owned(),
            features,
            rate,
            index: IndexBuilder::new().build(),
            shard_number: 0,
        }
    }

    /// Whether `dir` holds a finished library.
    #[must_use]
    pub fn exists(dir: &Path) -> bool {
        dir.join("manifest").exists()
    }

    /// The index with `clips` added; a clip of the same name is replaced. Gives the index and the
    /// number of replaced clips.
    ///
    /// # Errors
    /// [`Failure::Input`] if the clips are too many for one index.
    pub fn with_clips(&self, clips: &[(String, ClipWords)]) -> Result<(Index, usize), Failure> {
        let mut builder = IndexBuilder::new();
        let fail = |e: segidx::BuildError| Failure::input(&self.dir, e);
        let new_names: std::collections::BTreeSet<&str> =
            clips.iter().map(|(name, _)| name.as_str()).collect();
        let mut n_replaced = 0;
        for document in self.index.documents() {
            if new_names.contains(document.name()) {
                n_replaced += 1;
            } else {
                builder
                    .push(document.name(), document.meta(), &document.to_words())
                    .map_err(fail)?;
            }
        }
        for (name, clip) in clips {
            let meta = postcard::to_stdvec(&clip.meta).map_err(|e| Failure::input(&self.dir, e))?;
            builder
                .push(name.as_str(), meta, &clip.words)
                .map_err(fail)?;
        }
        Ok((builder.build(), n_replaced))
    }

    /// Writes the library with `index` in place of its clips. The old shard stays until the manifest
    /// names the new one, so a crash leaves the old library or the new one.
    ///
    /// # Errors
    /// [`Failure::Io`].
    pub fn save(&mut self, index: Index) -> Result<(), Failure> {
        let shards = self.dir.join("shards");
        fs::create_dir_all(&shards).map_err(|e| Failure::io(&shards, e))?;
        if self.shard_number == 0 {
            let about = LibraryToml {
                version: VERSION,
                rate: self.rate,
                feature_set: self.features.set.name().to_owned(),
                feature_set_toml: self.features.text.clone(),
            };
            let path = self.dir.join("library.toml");
            let text = toml::to_string_pretty(&about).map_err(|e| Failure::input(&path, e))?;
            replace(&path, text.as_bytes())?;
        }
        let number = self.shard_number.saturating_add(1);
        let file = format!("{number:04}.shard");
        let shard_path = shards.join(&file);
        let mut bytes = Vec::new();
        index
            .write_shard(&mut bytes)
            .map_err(|e| Failure::io(&shard_path, e))?;
        replace(&shard_path, &bytes)?;
        let manifest = Manifest {
            feature_set: self.features.set.name().to_owned(),
            feature_set_checksum: checksum(self.features.text.as_bytes()),
            rate_hz: self.rate,
            shards: vec![ShardEntry::new(file, &bytes)],
        };
        let manifest_path = self.dir.join("manifest");
        let bytes = manifest
            .to_bytes()
            .map_err(|e| Failure::input(&manifest_path, e))?;
        replace(&manifest_path, &bytes)?;
        if self.shard_number > 0 {
            let old = shards.join(format!("{:04}.shard", self.shard_number));
            fs::remove_file(&old).map_err(|e| Failure::io(&old, e))?;
        }
        self.shard_number = number;
        self.index = index;
        Ok(())
    }

    /// What the library keeps of a clip beside its words.
    ///
    /// # Errors
    /// [`Failure::Input`] if it is of another version.
    pub fn meta(&self, document: &Document<'_>) -> Result<ClipMeta, Failure> {
        postcard::from_bytes(document.meta())
            .map_err(|e| Failure::input(&self.dir, format!("clip {:?}: {e}", document.name())))
    }
}

fn shard_number(file: &str) -> u32 {
    let digits = file.split('.').next().unwrap_or_default();
    digits.parse().unwrap_or(0)
}

fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    fs::read(path).map_err(|e| Failure::io(path, e))
}

/// Writes a file beside its place and renames it there, so that nobody ever sees a part of it.
fn replace(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let fail = |e| Failure::io(path, e);
    let mut temporary = path.as_os_str().to_owned();
    temporary.push(".tmp");
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
