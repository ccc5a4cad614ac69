use super::*;

#[track_caller]
fn check(documents: &[&[u64]], limit: u32, expected: &str) {
    let mut builder = IndexBuilder::with_limit(limit);
    let (last, first) = documents.split_last().unwrap();
    for words in first {
        builder.push("", [], words).unwrap();
    }
    let before = builder.clone().build();
    let error = builder.push("", [], last).unwrap_err();
    assert_eq!(error.to_string(), expected);
    assert_eq!(builder.build(), before);
}

#[test]
fn too_many_frames() {
    let expected = "document 0: expected at most 3 frames, found 4";
    check(&[&[1, 1, 1, 1]], 3, expected);
}

#[test]
fn too_many_segments() {
    let expected = "document 1: expected at most 3 segments in one index, found 4";
    check(&[&[1, 2], &[1, 2]], 3, expected);
}

#[test]
fn too_many_documents() {
    let expected = "document 2: expected at most 2 documents in one index, found 3";
    check(&[&[], &[], &[]], 2, expected);
}

#[test]
fn the_limit_itself_fits() {
    let mut builder = IndexBuilder::with_limit(3);
    builder.push("a", [7, 7], &[1, 2, 3]).unwrap();
    let index = builder.build();
    assert_eq!(index.n_segments(), 3);
    assert_eq!(index.verify(), Ok(()));
}

#[test]
fn too_long_names_and_metadata() {
    let mut builder = IndexBuilder::with_limit(3);
    builder.push("a", [7], &[]).unwrap();
    let error = builder.push("b", [7], &[]).unwrap_err();
    let expected =
        "document 1: expected at most 3 bytes of names and metadata in one index, found 4";
    assert_eq!(error.to_string(), expected);
    assert_eq!(builder.n_documents(), 1);
}
