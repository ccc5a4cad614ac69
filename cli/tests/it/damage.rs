//! A damaged library is refused, never believed.

use std::fs;
use std::path::Path;

use cli::corpus_files::ClipFile;
use cli::failure::Failure;
use cli::library::{Library, verify};
use cli::recording::ReadOptions;
use segidx::{Hit, Manifest, Query, Shard, ShardEntry, search_adaptive};

use crate::corpus::{Fixture, build, index};

fn small_library(dir: &Path) {
    let ClipFile { path, .. } = &Fixture::get().files[0];
    build(std::slice::from_ref(path), dir);
}

/// What is found by `query`, which compares no features but `care`, in the whole library and in its parts.
fn search_it(dir: &Path, query: &Query, care: u64) -> Result<Vec<(String, Hit)>, Failure> {
    let library = Library::open(dir)?;
    let search = |shard: &Shard<_>| search_adaptive(shard, query);
    let mut hits = library.search(search)?;
    hits.extend(library.search_adaptive(care, search)?);
    let clips = library.clips()?;
    let name = |id| {
        clips
            .iter()
            .find(|clip| clip.id == id)
            .unwrap()
            .name
            .clone()
    };
    Ok(hits.into_iter().map(|(id, hit)| (name(id), hit)).collect())
}

#[test]
fn every_flipped_byte_is_noticed_and_never_believed() {
    let dir = tempfile::tempdir().unwrap();
    let files = &Fixture::get().files;
    // Two shards, and a clip of the first one replaced in the second.
    build(&[files[0].path.clone(), files[1].path.clone()], dir.path());
    let options = ReadOptions {
        fill: Some(0.1),
        ..ReadOptions::default()
    };
    let again = index(&[files[0].path.clone()], dir.path(), &options);
    assert_eq!(again.result.replaced, 1);
    let library = Library::open(dir.path()).unwrap();
    let care = library.features.set.select("lower").unwrap();
    let words = library.words(library.clips().unwrap()[1].id).unwrap();
    let query = Query::fuzzy(&words[..words.len() / 2], care);
    let expected = search_it(dir.path(), &query, care).unwrap();
    assert!(!expected.is_empty());
    for file in [
        "manifest",
        "library.toml",
        "shards/0001.shard",
        "shards/0001-lower.shard",
        "shards/0001-upper.shard",
        "shards/0001-mix.shard",
        "shards/0002.shard",
        "shards/0002-lower.shard",
        "shards/0002-upper.shard",
        "shards/0002-mix.shard",
    ] {
        let path = dir.path().join(file);
        let intact = fs::read(&path).unwrap();
        // The description is long and checked as a whole, a part has the form of a shard: the others' bytes are flipped in
        // more ways.
        let n_ways = if file == "library.toml" || file.contains('-') {
            1
        } else {
            3
        };
        let flips = 0..intact.len();
        let ways = |i: usize| {
            let ways = [1u8 << (i % 8), 0x81, 0xff].into_iter().take(n_ways);
            ways.map(move |flip| (i, flip))
        };
        for (i, flip) in flips.flat_map(ways) {
            let mut damaged = intact.clone();
            damaged[i] ^= flip;
            fs::write(&path, &damaged).unwrap();
            let verified = verify(dir.path()).unwrap();
            let [damage] = verified.damage.as_slice() else {
                panic!("byte {i} of {file}: {verified:?}");
            };
            assert_eq!(damage.path, path.display().to_string(), "byte {i}");
            assert!(damage.error.contains("byte "), "byte {i}: {damage:?}");
            match search_it(dir.path(), &query, care) {
                Ok(found) => assert_eq!(found, expected, "byte {i} of {file}"),
                Err(failure) => assert!(failure.to_string().contains(file), "byte {i}: {failure}"),
            }
        }
        fs::write(&path, &intact).unwrap();
    }
    assert_eq!(verify(dir.path()).unwrap().damage, []);
    assert_eq!(search_it(dir.path(), &query, care).unwrap(), expected);
}

#[test]
fn a_missing_shard_is_noticed() {
    let dir = tempfile::tempdir().unwrap();
    small_library(dir.path());
    fs::remove_file(dir.path().join("shards/0001.shard")).unwrap();
    assert_eq!(Library::open(dir.path()).unwrap_err().exit() as u8, 4);
    let damage = verify(dir.path()).unwrap().damage;
    assert!(damage[0].path.ends_with("0001.shard"), "{damage:?}");
}

#[test]
fn a_missing_part_is_noticed() {
    let dir = tempfile::tempdir().unwrap();
    small_library(dir.path());
    fs::remove_file(dir.path().join("shards/0001-mix.shard")).unwrap();
    assert_eq!(Library::open(dir.path()).unwrap_err().exit() as u8, 4);
    let damage = verify(dir.path()).unwrap().damage;
    assert!(damage[0].path.ends_with("0001-mix.shard"), "{damage:?}");
}

/// Whole files that do not belong together: the manifest names the lower part as the upper one.
#[test]
fn a_part_of_other_features_is_noticed() {
    let dir = tempfile::tempdir().unwrap();
    small_library(dir.path());
    let path = dir.path().join("manifest");
    let mut manifest = Manifest::from_bytes(&fs::read(&path).unwrap()).unwrap();
    let parts: &mut ShardEntry = &mut manifest.shards[0];
    let lower = parts
        .restrictions
        .iter()
        .position(|part| part.name == "lower");
    let upper = parts
        .restrictions
        .iter()
        .position(|part| part.name == "upper");
    let bits = parts.restrictions[upper.unwrap()].bits;
    parts.restrictions[lower.unwrap()].bits = bits;
    fs::write(&path, manifest.to_bytes().unwrap()).unwrap();
    let damage = verify(dir.path()).unwrap().damage;
    assert_eq!(damage.len(), 1, "{damage:?}");
    assert!(damage[0].path.ends_with("0001-lower.shard"), "{damage:?}");
    assert!(damage[0].error.contains("document 0"), "{damage:?}");
}

#[test]
fn an_edited_feature_set_is_noticed() {
    let dir = tempfile::tempdir().unwrap();
    small_library(dir.path());
    let path = dir.path().join("library.toml");
    let text = fs::read_to_string(&path).unwrap();
    assert!(text.contains("rate = 30.0"), "{text}");
    for (old, new) in [
        ("0..110 deg", "0..100 deg"),
        ("rate = 30.0", "rate = 25.0"),
        ("version = 3", "version = 2"),
    ] {
        assert!(text.contains(old), "{old}");
        fs::write(&path, text.replace(old, new)).unwrap();
        let message = Library::open(dir.path()).unwrap_err().to_string();
        assert!(message.contains("library.toml"), "{message}");
    }
}

#[test]
fn a_shard_of_another_library_is_noticed() {
    let (one, other) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    small_library(one.path());
    let ClipFile { path, .. } = &Fixture::get().files[1];
    build(std::slice::from_ref(path), other.path());
    let shard = "shards/0001.shard";
    fs::copy(other.path().join(shard), one.path().join(shard)).unwrap();
    let message = Library::open(one.path()).unwrap_err().to_string();
    assert!(
        message.contains("not the one that the manifest names"),
        "{message}"
    );
}

#[test]
fn what_an_interrupted_writer_leaves_is_no_library_but_can_become_one() {
    let dir = tempfile::tempdir().unwrap();
    small_library(dir.path());
    fs::remove_file(dir.path().join("manifest")).unwrap();
    fs::write(dir.path().join("shards/0001.shard.tmp"), "half of a sh").unwrap();
    assert_eq!(Library::open(dir.path()).unwrap_err().exit() as u8, 4);
    small_library(dir.path());
    assert_eq!(Library::open(dir.path()).unwrap().clips().unwrap().len(), 1);
}
