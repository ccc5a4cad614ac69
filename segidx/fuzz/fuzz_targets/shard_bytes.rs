//! Arbitrary bytes as a shard and as a manifest, once as they are and once under right checksums, so that these do not
//! keep the fuzzer out. Whatever opens as a shard must be searched and verified without harm.

#![no_main]

#[path = "../../tests/it/seal.rs"]
mod seal;

use libfuzzer_sys::fuzz_target;
use segidx::{
    Answer, Engine, Hit, Manifest, MismatchQuery, Query, Shard, ShardError, estimate_adaptive,
    search_adaptive_around, search_adaptive_with, search_exact_with, search_mismatch_with,
};

fuzz_target!(|bytes: &[u8]| {
    try_shard(bytes);
    try_manifest(bytes);
    let mut sealed = bytes.to_vec();
    seal::reseal(&mut sealed);
    try_shard(&sealed);
    try_manifest(&sealed);
});

fn try_shard(bytes: &[u8]) {
    let Ok(shard) = Shard::open(bytes) else {
        return;
    };
    let is_sound = shard.verify().is_ok();
    let mut example = Vec::new();
    for document in shard.documents() {
        assert!(document.is_ok() || !is_sound);
        // Frame counts are free to be huge, so the words are never unrolled here.
        let segments = document.and_then(|document| document.segments());
        assert!(segments.is_ok() || !is_sound);
        example.extend(segments.iter().flatten().map(|segment| segment.word));
    }
    example.truncate(4);
    let (exact, fuzzy) = (
        Query::exact(&example, u64::MAX),
        Query::fuzzy(&example, 0xff),
    );
    let hits_of = |answer: Result<Answer, _>| answer.map(|answer| answer.hits);
    let check = |hits: Result<Vec<Hit>, ShardError>| {
        assert!(hits.is_ok() || !is_sound);
        for hit in hits.iter().flatten().filter(|_| is_sound) {
            let document = shard.document(hit.doc).expect("a sound shard");
            let n_frames = document.map(|document| document.n_frames());
            assert!(Some(hit.span().end) <= n_frames);
        }
        hits
    };
    for engine in [Engine::Auto, Engine::Lists, Engine::Pivot, Engine::Scan] {
        let _ = check(hits_of(search_exact_with(&shard, &exact, engine)));
        for care in [u64::MAX, 0xff] {
            if let Ok(query) = MismatchQuery::new(exact.clone(), 1) {
                let query = query.restricted_to(care);
                let _ = check(hits_of(search_mismatch_with(&shard, &query, engine)));
            }
        }
        let adaptive = check(hits_of(search_adaptive_with(&shard, &fuzzy, engine)));
        let places = adaptive.iter().flatten().map(|hit| (hit.doc, hit.span()));
        let again = check(search_adaptive_around(&shard, &fuzzy, places));
        assert!(again == adaptive || !is_sound);
    }
    assert!(estimate_adaptive(&shard, &fuzzy).is_ok() || !is_sound);
}

fn try_manifest(bytes: &[u8]) {
    if let Ok(manifest) = Manifest::from_bytes(bytes) {
        let again = manifest.to_bytes().expect("what is read can be written");
        assert_eq!(Manifest::from_bytes(&again), Ok(manifest));
    }
}
