use super::*;
use crate::IndexBuilder;

fn sample() -> Index {
    let mut builder = IndexBuilder::new();
    builder.push("a", [1, 2], &[5, 5, 6, 5]).unwrap();
    builder.push("empty", [], &[]).unwrap();
    builder.push("b", [], &[5, 7, 7]).unwrap();
    builder.build()
}

fn bytes_of(index: &Index) -> Vec<u8> {
    let mut bytes = Vec::new();
    index.write_shard(&mut bytes).unwrap();
    bytes
}

fn seal(payload: &[u8]) -> Vec<u8> {
    [&SHARD.header(payload)[..], payload].concat()
}

#[track_caller]
fn check(bytes: &[u8], expected: &str) {
    let error = Index::from_shard_bytes(bytes).unwrap_err();
    assert_eq!(error.to_string(), expected);
}

#[test]
fn round_trip() {
    for index in [sample(), IndexBuilder::new().build()] {
        assert_eq!(Index::from_shard_bytes(&bytes_of(&index)), Ok(index));
    }
}

#[test]
fn another_kind_or_version_of_file() {
    let mut bytes = bytes_of(&sample());
    bytes[8] = 7;
    check(&bytes, "byte 8: expected shard version 1, found 7");
    bytes[0] = b'\n';
    let expected = r#"byte 0: expected shard magic "MOTIFSHD", found "\nOTIFSHD""#;
    check(&bytes, expected);
}

#[test]
fn missing_and_surplus_bytes() {
    let mut bytes = bytes_of(&sample());
    let (len, payload) = (bytes.len(), bytes.len() - HEADER_LEN);
    check(&[], "byte 0: expected 28 bytes of header, found 0");
    let expected = format!(
        "byte {}: expected {payload} bytes of payload, found {}",
        len - 1,
        payload - 1
    );
    check(&bytes[..len - 1], &expected);
    bytes.push(0);
    let expected = format!("byte {len}: expected the end of the shard, found 1 more bytes");
    check(&bytes, &expected);
}

#[test]
fn a_length_of_all_ones_is_only_a_wrong_length() {
    let mut bytes = bytes_of(&sample());
    bytes[12..20].fill(0xff);
    let error = Index::from_shard_bytes(&bytes).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("expected 18446744073709551615 bytes of payload")
    );
}

#[test]
fn a_changed_payload() {
    let mut bytes = bytes_of(&sample());
    let last = bytes.len() - 1;
    bytes[last] ^= 1;
    let error = Index::from_shard_bytes(&bytes).unwrap_err();
    let kind = ShardErrorKind::Envelope(EnvelopeError::Checksum {
        what: "shard",
        expected: u64::from_le_bytes(bytes[20..28].try_into().unwrap()),
        found: crate::checksum(&[&bytes[..20], &bytes[28..]].concat()),
    });
    assert_eq!(error, ShardError { at: 20, kind });
}

#[test]
fn a_sealed_payload_that_is_none() {
    let error = Index::from_shard_bytes(&seal(&[0xff])).unwrap_err();
    assert!(matches!(error.kind, ShardErrorKind::Payload(_)), "{error}");
    assert_eq!(error.at, HEADER_LEN);
}

#[test]
fn a_sealed_payload_that_promises_more_than_it_holds() {
    // 2^63 documents, and a first column of as many bytes: refused without room being made for them.
    let huge = [0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x01];
    for payload in [huge.to_vec(), [&[0][..], &huge].concat()] {
        let error = Index::from_shard_bytes(&seal(&payload)).unwrap_err();
        assert!(matches!(error.kind, ShardErrorKind::Payload(_)), "{error}");
    }
}

#[test]
fn a_sealed_payload_with_more_behind_it() {
    let bytes = bytes_of(&sample());
    let payload = [&bytes[HEADER_LEN..], &[0, 0]].concat();
    let expected = format!(
        "byte {}: expected the end of the payload, found 2 more bytes",
        bytes.len()
    );
    check(&seal(&payload), &expected);
}

#[test]
fn a_column_cut_inside_an_entry() {
    let empty = || Column(&[]);
    let payload = Payload {
        documents: Vec::new(),
        segment_words: Column(&[0; 9]),
        segment_starts: empty(),
        list_words: empty(),
        list_offsets: empty(),
        postings: empty(),
    };
    let expected = "byte 30: expected entries of 8 bytes, found a column of 9 bytes";
    check(&seal(&postcard::to_stdvec(&payload).unwrap()), expected);
}

#[test]
fn more_segments_than_can_be_numbered() {
    let row = |n_segments| DocumentRow {
        name: "x",
        meta: Column(&[]),
        n_frames: 1,
        n_segments,
    };
    let empty = || Column(&[]);
    let payload = Payload {
        documents: vec![row(u32::MAX), row(1)],
        segment_words: empty(),
        segment_starts: empty(),
        list_words: empty(),
        list_offsets: empty(),
        postings: empty(),
    };
    let bytes = seal(&postcard::to_stdvec(&payload).unwrap());
    let expected =
        "byte 39: document 1: expected at most 4294967295 segments in all, found 4294967296";
    check(&bytes, expected);
}

#[test]
fn flaws_carry_the_offset_of_their_entry() {
    let mut index = sample();
    index.postings[4] = 9;
    let bytes = bytes_of(&index);
    let expected = format!(
        "byte {}: posting 4: expected a segment that carries the word of its list, found 9",
        bytes.len() - 4
    );
    check(&bytes, &expected);

    let mut index = sample();
    index.rows[1].n_frames = 3;
    let bytes = bytes_of(&index);
    let name = bytes
        .windows(5)
        .position(|window| window == b"empty")
        .unwrap();
    let expected = format!("byte {name}: document 1: expected no frames without segments, found 3");
    check(&bytes, &expected);
}
