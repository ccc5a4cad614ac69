//! What was written is read back, and nothing else is.

use proptest::collection::vec;
use proptest::prelude::*;
use segidx::{DocId, IndexBuilder, Manifest, Restriction, Shard, ShardEntry};

fn shard_of(documents: &[(String, Vec<u8>, Vec<u64>)]) -> Vec<u8> {
    let mut builder = IndexBuilder::new();
    for (name, meta, words) in documents {
        builder.push(name.as_str(), meta.as_slice(), words).unwrap();
    }
    builder.build().as_bytes().to_vec()
}

fn small_shard() -> Vec<u8> {
    let document = |name: &str, words: &[u64]| (name.to_owned(), vec![120], words.to_vec());
    let documents = [
        document("walk", &[3, 3, 1, 3, 2, 2]),
        document("still", &[]),
        document("hop", &[1, u64::MAX]),
    ];
    shard_of(&documents)
}

fn small_manifest() -> Vec<u8> {
    let shard = Shard::open(small_shard()).unwrap();
    let mut entry = ShardEntry::new("0000.shard", &shard);
    entry.removed.push(DocId::from_number(1));
    entry.add_restriction(("low", 0b11), "0000-low.shard", &shard);
    let manifest = Manifest {
        feature_set: "mueller2006".to_owned(),
        description_checksum: segidx::checksum(b"text"),
        rate_hz: 30.0,
        shards: vec![entry],
    };
    manifest.to_bytes().unwrap()
}

/// Every changed bit, every changed byte, every prefix and a longer file are refused.
fn check_guarded(bytes: &[u8], accepts: impl Fn(&[u8]) -> bool) {
    assert!(accepts(bytes));
    for at in 0..bytes.len() {
        let mut changed = bytes.to_vec();
        for flip in 1..=255 {
            changed[at] = bytes[at] ^ flip;
            assert!(
                !accepts(&changed),
                "byte {at} xor {flip:#04x} goes unnoticed"
            );
        }
        assert!(
            !accepts(&bytes[..at]),
            "the first {at} bytes pass for the file"
        );
    }
    assert!(!accepts(&[bytes, &[0]].concat()));
}

#[test]
fn every_changed_byte_of_a_shard_is_noticed() {
    check_guarded(&small_shard(), |bytes| {
        Shard::open(bytes).is_ok_and(|shard| shard.verify().is_ok())
    });
}

#[test]
fn every_changed_byte_of_a_manifest_is_noticed() {
    check_guarded(&small_manifest(), |bytes| {
        Manifest::from_bytes(bytes).is_ok()
    });
}

#[test]
fn a_shard_is_no_manifest() {
    assert!(Manifest::from_bytes(&small_shard()).is_err());
    assert!(Shard::open(small_manifest()).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 1_000,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn shards_round_trip(
        documents in vec((".{0,8}", vec(any::<u8>(), 0..4), vec(prop_oneof![0..4u64, any::<u64>()], 0..30)), 0..6),
    ) {
        let bytes = shard_of(&documents);
        prop_assert_eq!(&shard_of(&documents), &bytes);
        let shard = Shard::open(bytes.as_slice()).unwrap();
        prop_assert_eq!(shard.verify(), Ok(()));
        prop_assert_eq!(shard.n_documents(), documents.len());
        for (found, (name, meta, words)) in shard.documents().zip(&documents) {
            let found = found.unwrap();
            prop_assert_eq!((found.name(), found.meta()), (name.as_str(), meta.as_slice()));
            prop_assert_eq!(&found.to_words().unwrap(), words);
        }
        for list in shard.lists().unwrap() {
            prop_assert_eq!(shard.list(list.word).unwrap(), list.segments);
        }
    }

    #[test]
    fn manifests_round_trip(
        feature_set in ".{0,12}",
        sums in any::<(u64, u64, u64)>(),
        rate_hz in 1e-3..1e6f64,
        files in vec(".{0,8}", 0..5),
        removed in proptest::collection::btree_set(any::<u32>(), 0..5),
    ) {
        let restrictions: Vec<Restriction> = files.iter().map(|file| Restriction {
            name: feature_set.clone(),
            bits: sums.0,
            file: file.clone(),
            len: sums.1,
            checksum: sums.2,
        }).collect();
        let shards = files.into_iter().map(|file| ShardEntry {
            file,
            len: sums.1,
            checksum: sums.2,
            removed: removed.iter().map(|&doc| DocId::from_number(doc)).collect(),
            usable: sums.0,
            restrictions: restrictions.clone(),
        });
        let manifest = Manifest { feature_set, description_checksum: sums.0, rate_hz, shards: shards.collect() };
        let bytes = manifest.to_bytes().unwrap();
        prop_assert_eq!(Manifest::from_bytes(&bytes), Ok(manifest));
    }

    #[test]
    fn foreign_bytes_are_refused(bytes in vec(any::<u8>(), 0..200)) {
        prop_assert!(Shard::open(bytes.as_slice()).is_err());
        prop_assert!(Manifest::from_bytes(&bytes).is_err());
    }
}
