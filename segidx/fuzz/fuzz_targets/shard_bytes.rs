//! Arbitrary bytes as a shard and as a manifest, once as they are and once as the payload behind a valid header, so
//! that the checksum does not keep the fuzzer out. What is accepted must be searchable and survive a round trip.

#![no_main]

use libfuzzer_sys::fuzz_target;
use segidx::{Index, Manifest, Query, checksum, search_adaptive, search_exact};

fuzz_target!(|bytes: &[u8]| {
    try_shard(bytes);
    try_manifest(bytes);
    try_shard(&sealed(b"MOTIFSHD", bytes));
    try_manifest(&sealed(b"MOTIFMAN", bytes));
    // The corpus holds whole files; their payloads are the seeds worth mutating.
    if let Some((_, payload)) = bytes.split_at_checked(28) {
        try_shard(&sealed(b"MOTIFSHD", payload));
        try_manifest(&sealed(b"MOTIFMAN", payload));
    }
});

fn sealed(magic: &[u8; 8], payload: &[u8]) -> Vec<u8> {
    let mut fields = magic.to_vec();
    fields.extend(1u32.to_le_bytes());
    fields.extend((payload.len() as u64).to_le_bytes());
    let sum = checksum(&[&fields[..], payload].concat());
    [&fields[..], &sum.to_le_bytes(), payload].concat()
}

fn try_shard(bytes: &[u8]) {
    let Ok(index) = Index::from_shard_bytes(bytes) else {
        return;
    };
    assert_eq!(index.debug_validate(), Ok(()));
    // Frame counts are free to be huge, so the words are never unrolled here.
    let mut example = Vec::new();
    for document in index.documents() {
        assert_eq!(
            document.segments().map(|s| s.len).sum::<usize>(),
            document.n_frames()
        );
        example.extend(document.segments().map(|segment| segment.word));
    }
    example.truncate(4);
    let exact = search_exact(&index, &Query::exact(&example, u64::MAX));
    let adaptive = search_adaptive(&index, &Query::fuzzy(&example, 0xff));
    for hit in exact.iter().chain(&adaptive) {
        let n_frames = index.document(hit.doc).map(|document| document.n_frames());
        assert!(Some(hit.span().end) <= n_frames);
    }
    let mut again = Vec::new();
    index
        .write_shard(&mut again)
        .expect("a vector takes all bytes");
    assert_eq!(Index::from_shard_bytes(&again), Ok(index));
}

fn try_manifest(bytes: &[u8]) {
    if let Ok(manifest) = Manifest::from_bytes(bytes) {
        let again = manifest.to_bytes().expect("what is read can be written");
        assert_eq!(Manifest::from_bytes(&again), Ok(manifest));
    }
}
