use super::*;
use crate::IndexBuilder;

fn sample() -> Index {
    let mut builder = IndexBuilder::new();
    builder.push("a", [1, 2], &[5, 5, 6, 5]).unwrap();
    builder.push("empty", [], &[]).unwrap();
    builder.push("b", [], &[5, 7, 7]).unwrap();
    builder.build()
}

#[test]
fn counts_and_lists() {
    let index = sample();
    assert_eq!((index.n_documents(), index.n_segments()), (3, 5));
    assert_eq!((index.n_frames(), index.n_lists()), (7, 3));
    assert_eq!(index.list(5), [0, 2, 3]);
    assert_eq!(index.list(8), []);
    let words: Vec<_> = index.lists().map(|list| list.word).collect();
    assert_eq!(words, [5, 6, 7]);
    assert_eq!(index.debug_validate(), Ok(()));
}

#[test]
fn documents_give_back_what_was_put_in() {
    let index = sample();
    let documents: Vec<_> = index.documents().collect();
    assert_eq!(
        (documents[0].name(), documents[0].meta()),
        ("a", &[1, 2][..])
    );
    assert_eq!(documents[0].to_words(), [5, 5, 6, 5]);
    assert_eq!((documents[1].n_frames(), documents[1].n_segments()), (0, 0));
    assert_eq!(
        (documents[2].id(), documents[2].first_segment()),
        (DocId(2), 3)
    );
    assert_eq!(documents[2].to_words(), [5, 7, 7]);
    assert!(index.document(DocId::from_number(3)).is_none());
}

#[test]
fn segments_are_located_past_empty_documents() {
    let index = sample();
    assert_eq!(index.locate(2), Some((DocId(0), 2)));
    assert_eq!(index.locate(3), Some((DocId(2), 0)));
    assert_eq!(index.locate(5), None);
}

#[track_caller]
fn check_flaw(spoil: impl Fn(&mut Index), expected: &str) {
    let mut index = sample();
    spoil(&mut index);
    let flaw = index.debug_validate().unwrap_err();
    assert_eq!(flaw.to_string(), expected);
}

#[test]
fn flaws_of_the_segments_are_found() {
    check_flaw(
        |index| index.starts.truncate(4),
        "segment start 0: expected one start per segment word, found 4",
    );
    check_flaw(
        |index| index.offsets[3] = 6,
        "document 3: expected as many segments in the documents as segment words, found 6",
    );
    check_flaw(
        |index| index.rows[1].n_frames = 1,
        "document 1: expected no frames without segments, found 1",
    );
    check_flaw(
        |index| index.starts[3] = 1,
        "segment start 3: expected start 0 for the first segment of a document, found 1",
    );
    check_flaw(
        |index| index.starts[2] = 2,
        "segment start 2: expected a start after that of the segment before, found 2",
    );
    check_flaw(
        |index| index.words[1] = 5,
        "segment word 1: expected a word other than that of the segment before, found 5",
    );
    check_flaw(
        |index| index.rows[2].n_frames = 1,
        "document 2: expected more frames than the start of the last segment, found 1",
    );
}

#[test]
fn flaws_of_the_lists_are_found() {
    check_flaw(
        |index| index.list_offsets.clear(),
        "list offset 0: expected one offset per list and one more, found 0",
    );
    check_flaw(
        |index| index.list_offsets[0] = 1,
        "list offset 0: expected offset 0, found 1",
    );
    check_flaw(
        |index| index.postings.truncate(4),
        "posting 0: expected one posting per segment, found 4",
    );
    check_flaw(
        |index| index.list_offsets[3] = 4,
        "list offset 3: expected the number of postings, found 4",
    );
    check_flaw(
        |index| index.list_words[1] = 5,
        "list word 1: expected a word above that of the list before, found 5",
    );
    check_flaw(
        |index| index.list_offsets[1] = u32::MAX,
        "list offset 1: expected an offset above the one before, found 4294967295",
    );
    check_flaw(
        |index| index.postings.swap(0, 1),
        "posting 1: expected a segment after the one before, found 0",
    );
    check_flaw(
        |index| index.postings[4] = 9,
        "posting 4: expected a segment that carries the word of its list, found 9",
    );
}
