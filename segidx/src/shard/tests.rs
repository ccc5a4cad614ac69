use super::layout::Part;
use super::*;
use crate::IndexBuilder;

fn sample() -> Vec<u8> {
    let mut builder = IndexBuilder::new();
    builder.push("a", [1, 2], &[5, 5, 6, 5]).unwrap();
    builder.push("empty", [], &[]).unwrap();
    builder.push("b", [], &[5, 7, 7]).unwrap();
    builder.build().as_bytes().to_vec()
}

/// Where a section of the sample lies in the file.
fn start_of(part: Part) -> usize {
    let shard = Shard::open(sample()).unwrap();
    shard.body_start + shard.layout.start_of(part)
}

/// A file of these bytes behind a head with right checksums.
fn seal(payload: &[u8], body: &[u8]) -> Vec<u8> {
    let mut payload = payload.to_vec();
    for sum in Pages::sums_of(body) {
        payload.extend(sum.to_le_bytes());
    }
    [&SHARD.header(&payload)[..], &payload, body].concat()
}

/// The sample with a byte changed and all checksums right.
fn spoiled(at: usize, value: u8) -> Vec<u8> {
    let mut bytes = sample();
    bytes[at] = value;
    let (payload, body) = SHARD.split(&bytes).map_or_else(
        |_| {
            let len = Shard::open(sample()).unwrap().body_start;
            (bytes[HEADER_LEN..len].to_vec(), bytes[len..].to_vec())
        },
        |(payload, body)| (payload.to_vec(), body.to_vec()),
    );
    seal(&payload[..payload.len() - 8], &body)
}

#[track_caller]
fn check(bytes: &[u8], expected: &str) {
    let error = Shard::open(bytes).unwrap_err();
    assert_eq!(error.to_string(), expected);
}

/// The flaw that a changed byte of a section makes.
#[track_caller]
fn check_flaw(part: Part, offset: usize, value: u8, expected: &str) {
    let start = start_of(part);
    let bytes = spoiled(start + offset, value);
    let error = Shard::open(bytes).unwrap().verify().unwrap_err();
    assert_eq!(error.kind.to_string(), expected);
}

#[test]
fn counts_and_lists() {
    let shard = Shard::open(sample()).unwrap();
    assert_eq!((shard.n_documents(), shard.n_segments()), (3, 5));
    assert_eq!((shard.n_frames(), shard.n_lists()), (7, 3));
    assert_eq!(shard.list(5).unwrap(), [0, 2, 3]);
    assert_eq!(shard.list(8).unwrap(), [0; 0]);
    let lists = shard.lists().unwrap();
    let words: Vec<_> = lists.iter().map(|list| list.word).collect();
    assert_eq!(words, [5, 6, 7]);
    assert_eq!(shard.verify(), Ok(()));
}

#[test]
fn documents_give_back_what_was_put_in() {
    let shard = Shard::open(sample()).unwrap();
    let documents: Vec<_> = shard.documents().map(Result::unwrap).collect();
    assert_eq!(
        (documents[0].name(), documents[0].meta()),
        ("a", &[1, 2][..])
    );
    assert_eq!(documents[0].to_words().unwrap(), [5, 5, 6, 5]);
    assert_eq!((documents[1].n_frames(), documents[1].n_segments()), (0, 0));
    assert_eq!(documents[2].id(), DocId::from_number(2));
    assert_eq!(documents[2].first_segment(), 3);
    assert_eq!(documents[2].to_words().unwrap(), [5, 7, 7]);
    assert!(shard.document(DocId::from_number(3)).unwrap().is_none());
}

#[test]
fn segments_are_located_past_empty_documents() {
    let shard = Shard::open(sample()).unwrap();
    let place = |doc, segment| Ok(Some((DocId::from_number(doc), segment)));
    assert_eq!(shard.locate(2), place(0, 2));
    assert_eq!(shard.locate(3), place(2, 0));
    assert_eq!(shard.locate(5), Ok(None));
}

#[test]
fn names_that_share_a_beginning_are_whole_again() {
    for names in [
        &["data/ä1", "data/ä2", "data/å"][..],
        &["x", ""],
        &["same", "same"],
        &["alone"],
    ] {
        let mut builder = IndexBuilder::new();
        for &name in names {
            builder.push(name, [9], &[1]).unwrap();
        }
        let index = builder.build();
        let found: Vec<String> = index
            .documents()
            .map(|document| document.unwrap().name().to_owned())
            .collect();
        assert_eq!(found, names);
        assert_eq!(index.verify(), Ok(()));
    }
}

#[test]
fn another_kind_or_version_of_file() {
    let mut bytes = sample();
    bytes[8] = 7;
    check(&bytes, "byte 8: expected shard version 2, found 7");
    bytes[0] = b'\n';
    let expected = r#"byte 0: expected shard magic "MOTIFSHD", found "\nOTIFSHD""#;
    check(&bytes, expected);
}

#[test]
fn missing_and_surplus_bytes() {
    let bytes = sample();
    let (len, body) = (bytes.len(), bytes.len() - start_of(Part::Documents));
    check(&[], "byte 0: expected 28 bytes of header, found 0");
    check(
        &bytes[..60],
        "byte 60: expected 96 bytes of payload, found 32",
    );
    let expected = format!(
        "byte 28: expected {body} bytes behind the head, found {}",
        body - 1
    );
    check(&bytes[..len - 1], &expected);
    let expected = format!(
        "byte 28: expected {body} bytes behind the head, found {}",
        body + 1
    );
    check(&[&bytes[..], &[0]].concat(), &expected);
}

#[test]
fn a_length_of_all_ones_is_only_a_wrong_length() {
    let mut bytes = sample();
    bytes[12..20].fill(0xff);
    let error = Shard::open(bytes).unwrap_err().to_string();
    assert!(error.contains("expected 18446744073709551615 bytes of payload"));
}

#[test]
fn a_sealed_head_that_is_none() {
    check(
        &seal(&[1, 2], &[]),
        "byte 28: expected a head of 88 bytes, found 2",
    );
    let mut head = [0; 88];
    check(
        &seal(&head, &[0; 16]),
        "byte 28: expected 20 bytes for the document section, found 0",
    );
    // 2^32 - 1 documents: refused by the length of their table, without room being made for them.
    head[..4].fill(0xff);
    check(
        &seal(&head, &[0; 16]),
        "byte 28: expected 85899345920 bytes for the document section, found 0",
    );
    let bytes = sample();
    let mut head = bytes[HEADER_LEN..HEADER_LEN + 88].to_vec();
    let body = &bytes[start_of(Part::Documents)..];
    check(
        &seal(&[&head[..], &[0; 8]].concat(), body),
        "byte 28: expected a head of 96 bytes, found 104",
    );
    // A text of nearly 2^64 bytes.
    head[32..40].fill(0xff);
    let error = Shard::open(seal(&head, body)).unwrap_err().to_string();
    assert!(error.contains("expected 18446744073709551615 bytes behind the head"));
}

#[test]
fn words_without_segments() {
    let bytes = sample();
    let mut head = bytes[HEADER_LEN..HEADER_LEN + 88].to_vec();
    // Of one width in bits, so that all lengths fit: four words, then eight.
    head[8] = 4;
    let body = &bytes[start_of(Part::Documents)..];
    let error = Shard::open(seal(&head, body))
        .unwrap()
        .verify()
        .unwrap_err();
    let expected = "list 3: expected lists of as many segments as there are, found 6";
    assert_eq!(error.kind.to_string(), expected);
    let mut builder = IndexBuilder::new();
    builder.push("", [], &[]).unwrap();
    let empty = builder.build();
    let mut head = empty.as_bytes()[HEADER_LEN..HEADER_LEN + 88].to_vec();
    head[12 - 4] = 1;
    let error = Shard::open(seal(&head, &[0; 40])).unwrap_err();
    assert!(error.to_string().contains("word section"), "{error}");
}

#[test]
fn flaws_of_the_clip_table_are_found() {
    use Part::{Documents, Text};
    let row = |n: usize, field: usize| n * layout::ROW + field;
    check_flaw(
        Documents,
        row(0, 0),
        1,
        "document 0: expected a first document at frame 0 and segment 0, found 1",
    );
    check_flaw(
        Documents,
        row(1, 0),
        9,
        "document 1: expected an end after at most 4294967295 frames, found 4",
    );
    check_flaw(
        Documents,
        row(2, 0),
        5,
        "document 1: expected no frames without segments, found 1",
    );
    check_flaw(
        Documents,
        row(1, 8),
        4,
        "document 1: expected a later end of its segments, found 3",
    );
    check_flaw(
        Documents,
        row(3, 8),
        4,
        "document 3: expected an end after the last segment and frame, found 7",
    );
    check_flaw(
        Documents,
        row(3, 16),
        8,
        "document 3: expected an end of the text, found 8",
    );
    check_flaw(
        Documents,
        row(1, 12),
        200,
        "text 1: expected a place within the text, found 200",
    );
    check_flaw(Text, 0, 0xff, "text 0: expected a name in UTF-8, found 0");
}

#[test]
fn flaws_of_the_segments_are_found() {
    // Two bits of word number above one for the first of a document: 1, 2, 0 | 1, 4.
    check_flaw(
        Part::Segments,
        0,
        0b011_001,
        "segment 1: expected a mark on the first segment of each document alone, found 1",
    );
    check_flaw(
        Part::Segments,
        0,
        0b000_001,
        "segment 1: expected a word other than that of the segment before, found 0",
    );
    check_flaw(
        Part::Segments,
        0,
        0b110_001,
        "segment 1: expected the number of a word, found 3",
    );
    check_flaw(
        Part::Frames,
        0,
        1,
        "frame block 0: expected the end of the segment before, found 1",
    );
    // Behind 16 bytes of directory: 2, 1, 1 | 1, 2, less one.
    check_flaw(
        Part::Lengths,
        16,
        0b11001,
        "frame block 5: expected the number of all frames, found 8",
    );
    check_flaw(
        Part::Lengths,
        16,
        0b10011,
        "document 1: expected the frame of its first segment, found 4",
    );
    check_flaw(
        Part::Lengths,
        8,
        65,
        "length 0: expected a width of at most 64 bits, found 65",
    );
}

#[test]
fn flaws_of_the_lists_are_found() {
    check_flaw(
        Part::Lists,
        16,
        0b00_01,
        "list 3: expected lists of as many segments as there are, found 4",
    );
    // 0, gap 1, gap 0 | 1 | 4, of three bits each.
    check_flaw(
        Part::Postings,
        16,
        0b00_000_000,
        "list 0: expected a segment that carries the word of its list, found 1",
    );
    check_flaw(
        Part::Postings,
        16,
        0b00_001_111,
        "posting 0: expected the number of a segment, found 7",
    );
}

#[test]
fn words_beyond_64_bits_are_found() {
    let mut builder = IndexBuilder::new();
    builder.push("", [], &[3, u64::MAX]).unwrap();
    let index = builder.build();
    assert_eq!(index.verify(), Ok(()));
    let start = index.layout.start_of(Part::Words);
    let bytes = index.as_bytes();
    let (head, body) = bytes.split_at(index.body_start);
    let mut body = body.to_vec();
    // The first word is now 255, and the gap to the second one leads past the end.
    body[start + 16] = 0xff;
    let bytes = seal(&head[HEADER_LEN..head.len() - 8], &body);
    let error = Shard::open(bytes).unwrap().verify().unwrap_err();
    let expected = "word 1: expected a word of 64 bits, found 18446744073709551611";
    assert_eq!(error.kind.to_string(), expected);
}
