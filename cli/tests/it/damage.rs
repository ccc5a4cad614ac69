//! A damaged library is refused, never believed.

use std::fs;
use std::path::Path;

use cli::corpus_files::ClipFile;
use cli::library::Library;

use crate::corpus::{Fixture, build};

fn small_library(dir: &Path) {
    let ClipFile { path, .. } = &Fixture::get().files[0];
    build(std::slice::from_ref(path), dir);
}

#[test]
fn every_flipped_byte_of_manifest_and_shard_is_noticed() {
    let dir = tempfile::tempdir().unwrap();
    small_library(dir.path());
    assert!(Library::open(dir.path()).is_ok());
    for file in ["manifest", "shards/0001.shard"] {
        let path = dir.path().join(file);
        let intact = fs::read(&path).unwrap();
        for i in 0..intact.len() {
            let mut damaged = intact.clone();
            damaged[i] ^= 1 << (i % 8);
            fs::write(&path, &damaged).unwrap();
            let failure = Library::open(dir.path()).unwrap_err();
            let message = failure.to_string();
            assert!(message.contains(file), "byte {i} of {file}: {message}");
            assert_eq!(failure.exit() as u8, 3);
        }
        fs::write(&path, &intact).unwrap();
    }
    assert!(Library::open(dir.path()).is_ok());
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
        ("version = 1", "version = 2"),
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
    assert_eq!(Library::open(dir.path()).unwrap().index.n_documents(), 1);
}
