//! The committed seeds of the fuzz targets, which also fix the bytes of the format. `UPDATE_GOLDEN=1` rewrites
//! them.

use std::path::Path;

use segidx::{DocId, IndexBuilder, Manifest, Shard, ShardEntry};

#[track_caller]
fn check(seed: &str, expected: &[u8]) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("fuzz/corpus")
        .join(seed);
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, expected).unwrap();
    }
    let found = std::fs::read(&path).unwrap_or_default();
    assert_eq!(found, expected, "{} differs", path.display());
}

fn shard(documents: &[(&str, &[u64])]) -> Vec<u8> {
    let mut builder = IndexBuilder::new();
    for &(name, words) in documents {
        builder.push(name, [120], words).unwrap();
    }
    builder.build().as_bytes().to_vec()
}

fn entry(file: &str, bytes: Vec<u8>) -> ShardEntry {
    ShardEntry::new(file, &Shard::open(bytes).unwrap())
}

fn walking() -> Vec<u8> {
    let walk = [3, 1, 1, 3, 2, 2, 3, 1, 3, 3, 2, 3, 1];
    shard(&[("walk", &walk), ("still", &[]), ("jump", &[0, 1 << 63])])
}

#[test]
fn shard_seeds() {
    check("shard_bytes/walking.shard", &walking());
    check("shard_bytes/empty.shard", &shard(&[]));
    check("shard_bytes/cut.shard", &walking()[..100]);
    assert_eq!(Shard::open(walking()).unwrap().verify(), Ok(()));
}

#[test]
fn manifest_seed() {
    let mut first = entry("0000.shard", walking());
    first.removed = vec![DocId::from_number(1), DocId::from_number(2)];
    let low = Shard::open(shard(&[("", &[3, 1])])).unwrap();
    first.add_restriction(("low", 0b11), "0000-low.shard", &low);
    let manifest = Manifest {
        feature_set: "mueller2006".to_owned(),
        description_checksum: segidx::checksum(b""),
        rate_hz: 30.0,
        shards: vec![first, entry("0001.shard", shard(&[]))],
    };
    check("shard_bytes/two.manifest", &manifest.to_bytes().unwrap());
}

/// Frames below 0x80, 0xff between documents, 0x80 before the care mask and the example.
#[test]
fn index_ops_seeds() {
    let walk = [3, 1, 1, 3, 2, 2, 3, 1, 3, 3, 2, 3, 1];
    check(
        "index_ops/walking",
        &[&walk[..], &[0x80, 0b010, 1, 3, 1]].concat(),
    );
    check(
        "index_ops/boundaries",
        &[1, 0xff, 1, 2, 0xff, 0xff, 2, 3, 0x80, 0b111, 1, 2],
    );
    check("index_ops/no_care", &[1, 2, 0xff, 3, 0x80, 0, 5, 6]);
    check("index_ops/no_query", &[4, 4, 0xff, 4]);
}
