//! Searches in damaged shards: the right answer or an error, and no panic whatever the bytes say.

use proptest::collection::vec;
use proptest::prelude::*;
use segidx::{
    Engine, Hit, Index, IndexBuilder, Query, Shard, ShardError, ShardErrorKind,
    search_adaptive_with, search_exact_with,
};

use crate::seal::reseal;

const ENGINES: [Engine; 4] = [Engine::Auto, Engine::Lists, Engine::Pivot, Engine::Scan];

fn index_of(documents: &[Vec<u64>]) -> Index {
    let mut builder = IndexBuilder::new();
    for (i, words) in documents.iter().enumerate() {
        builder.push(format!("clip {i}"), [1, 2, 3], words).unwrap();
    }
    builder.build()
}

/// Both searches by all engines.
fn search(shard: &Shard<&[u8]>, query: &Query) -> Vec<Result<Vec<Hit>, ShardError>> {
    let both = ENGINES.map(|engine| {
        [
            search_exact_with(shard, query, engine),
            search_adaptive_with(shard, query, engine),
        ]
        .map(|answer| Ok(answer?.hits))
    });
    both.concat()
}

/// A walk over words of `bits` bits, of which neighbours differ in one.
fn walk(state: &mut u64, bits: u64, n_frames: usize) -> Vec<u64> {
    let mut random = |below: u64| {
        *state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (*state >> 33) % below
    };
    let mut word = random(1 << bits);
    let frames = (0..n_frames).map(|_| {
        if random(3) == 0 {
            word ^= 1 << random(bits);
        }
        word
    });
    frames.collect()
}

#[test]
fn a_flipped_bit_is_noticed_or_changes_no_answer() {
    let mut state = 1;
    let documents: Vec<Vec<u64>> = (0..4).map(|_| walk(&mut state, 3, 40)).collect();
    let index = index_of(&documents);
    let intact = index.as_bytes();
    let query = Query::fuzzy(&documents[1][5..20], 0b101);
    let expected = search(&Shard::open(intact).unwrap(), &query);
    for at in 0..intact.len() {
        for bit in 0..8 {
            let mut damaged = intact.to_vec();
            damaged[at] ^= 1 << bit;
            let Ok(shard) = Shard::open(damaged.as_slice()) else {
                continue;
            };
            let error = shard.verify().unwrap_err();
            let ShardErrorKind::Page { .. } = error.kind else {
                panic!("byte {at}: {error}");
            };
            assert!(
                error.at <= at && at < error.at + (1 << 16),
                "byte {at}: {error}"
            );
            for (found, expected) in search(&shard, &query).into_iter().zip(&expected) {
                assert!(found.is_err() || found == *expected, "byte {at}");
            }
        }
    }
}

#[test]
fn a_damaged_page_spoils_only_the_searches_that_need_it() {
    let mut state = 7;
    let mut documents: Vec<Vec<u64>> = (0..300).map(|_| walk(&mut state, 12, 900)).collect();
    documents[170].extend([1 << 40, 1 << 41, 1 << 42]);
    let index = index_of(&documents);
    let intact = index.as_bytes();
    assert!(intact.len() > 4 << 16, "only {} bytes", intact.len());
    let common = Query::fuzzy(&documents[3][..60], 0b11);
    let rare = Query::exact(&[1 << 40, 1 << 41, 1 << 42], u64::MAX);
    let expected = [&common, &rare].map(|query| search(&Shard::open(intact).unwrap(), query));
    assert_eq!(expected[1][0].as_ref().unwrap().len(), 1);
    let n_pages = intact.len().div_ceil(1 << 16);
    let (mut n_right, mut n_refused) = (0, 0);
    for page in 0..n_pages {
        let at = (page * (1 << 16) + 5_000).min(intact.len() - 1);
        let mut damaged = intact.to_vec();
        damaged[at] ^= 0x10;
        let shard = Shard::open(damaged.as_slice()).unwrap();
        for (query, expected) in [&common, &rare].into_iter().zip(&expected) {
            for (found, expected) in search(&shard, query).into_iter().zip(expected) {
                match found {
                    Err(error) => {
                        assert!(error.at <= at && at < error.at + (1 << 16), "{error}");
                        n_refused += 1;
                    }
                    Ok(_) => {
                        assert_eq!(found, *expected);
                        n_right += 1;
                    }
                }
            }
        }
        assert!(shard.verify().is_err());
    }
    assert!(
        n_right > 0 && n_refused > 0,
        "{n_right} right, {n_refused} refused"
    );
}

#[test]
fn threads_share_a_shard() {
    let mut state = 3;
    let documents: Vec<Vec<u64>> = (0..100).map(|_| walk(&mut state, 10, 900)).collect();
    let index = index_of(&documents);
    let query = Query::fuzzy(&documents[3][..60], 0b11);
    let expected = search(&Shard::open(index.as_bytes()).unwrap(), &query);
    let shard = Shard::open(index.as_bytes()).unwrap();
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..4)
            .map(|_| scope.spawn(|| search(&shard, &query)))
            .collect();
        for thread in threads {
            assert_eq!(thread.join().unwrap(), expected);
        }
    });
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 4_000,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    /// Wrong bytes under right checksums: everything ends, and nothing panics.
    #[test]
    fn sealed_nonsense_does_no_harm(
        documents in vec(vec(0..6u64, 0..40), 0..5),
        changes in vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        example in vec(0..6u64, 1..6),
        care in 0..8u64,
    ) {
        let index = index_of(&documents);
        let mut bytes = index.as_bytes().to_vec();
        for (at, value) in changes {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        reseal(&mut bytes);
        let Ok(shard) = Shard::open(bytes.as_slice()) else {
            return Ok(());
        };
        let is_sound = shard.verify().is_ok();
        for hits in search(&shard, &Query::fuzzy(&example, care)) {
            prop_assert!(hits.is_ok() || !is_sound);
            prop_assert!(hits.map_or(0, |hits| hits.len()) <= shard.n_segments());
        }
        for document in shard.documents() {
            prop_assert!(document.is_ok() || !is_sound);
            let segments = document.and_then(|document| document.segments());
            prop_assert!(segments.is_ok() || !is_sound);
        }
    }
}
