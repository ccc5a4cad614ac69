use super::*;

fn shard(words: &[u64]) -> crate::Index {
    let mut builder = crate::IndexBuilder::new();
    builder.push("", [], words).unwrap();
    builder.build()
}

fn sample() -> Manifest {
    let mut entry = ShardEntry::new("shards/0000.shard", &self::shard(&[1]));
    entry.removed = vec![DocId::from_number(1), DocId::from_number(4)];
    Manifest {
        feature_set: "mueller2006".to_owned(),
        description_checksum: crate::checksum(b"[features]"),
        rate_hz: 29.97,
        shards: vec![
            entry,
            ShardEntry::new("shards/0001.shard", &self::shard(&[])),
        ],
    }
}

fn seal(payload: &[u8]) -> Vec<u8> {
    [&MANIFEST.header(payload)[..], payload].concat()
}

#[track_caller]
fn check(bytes: &[u8], expected: &str) {
    let error = Manifest::from_bytes(bytes).unwrap_err();
    assert_eq!(error.to_string(), expected);
}

#[test]
fn round_trip() {
    let bytes = sample().to_bytes().unwrap();
    assert_eq!(Manifest::from_bytes(&bytes), Ok(sample()));
}

#[test]
fn entries_know_their_file_and_what_was_removed() {
    let entry = &sample().shards[0];
    assert!(
        entry.matches(&shard(&[1])) && !entry.matches(&shard(&[2])) && !entry.matches(&shard(&[]))
    );
    assert!(entry.is_removed(DocId::from_number(4)));
    assert!(!entry.is_removed(DocId::from_number(2)));
}

#[test]
fn another_kind_of_file() {
    let mut bytes = sample().to_bytes().unwrap();
    bytes[..8].copy_from_slice(b"MOTIFSHD");
    check(
        &bytes,
        r#"byte 0: expected manifest magic "MOTIFMAN", found "MOTIFSHD""#,
    );
}

/// A manifest of version 2 names no restrictions, so its libraries are to be built again.
#[test]
fn another_version() {
    let mut bytes = sample().to_bytes().unwrap();
    bytes[8] = 2;
    check(&bytes, "byte 8: expected manifest version 3, found 2");
}

#[test]
fn a_sealed_payload_that_is_none() {
    let error = Manifest::from_bytes(&seal(&[0xff])).unwrap_err();
    assert!(
        matches!(error.kind, ManifestErrorKind::Payload(_)),
        "{error}"
    );
    let bytes = sample().to_bytes().unwrap();
    let payload = [&bytes[HEADER_LEN..], &[0]].concat();
    let expected = format!(
        "byte {}: expected the end of the payload, found 1 more bytes",
        bytes.len()
    );
    check(&seal(&payload), &expected);
}

#[test]
fn rates_that_are_none() {
    for rate in [0.0, -30.0, f64::NAN, f64::INFINITY] {
        let mut manifest = sample();
        manifest.rate_hz = rate;
        let expected = format!("byte 28: expected a positive and finite rate, found {rate}");
        assert_eq!(manifest.to_bytes().unwrap_err().to_string(), expected);
        check(&seal(&postcard::to_stdvec(&manifest).unwrap()), &expected);
    }
}

#[test]
fn removed_documents_out_of_order() {
    let mut manifest = sample();
    manifest.shards[0].removed.reverse();
    let expected = "byte 28: expected increasing removed documents for shard 0, found 1";
    assert_eq!(manifest.to_bytes().unwrap_err().to_string(), expected);
    check(&seal(&postcard::to_stdvec(&manifest).unwrap()), expected);
}
