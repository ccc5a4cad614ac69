//! Laws over small random inputs, against the textbook twins.

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::Index as Selector;
use segidx::{Engine, FuzzySet, Hit, Index, IndexBuilder, Mask, Query, segment};

use crate::naive::{self, NaiveHit, Set};

const BITS: u32 = 3;
const WORDS: u64 = 1 << BITS;
const ENGINES: [Engine; 4] = [Engine::Auto, Engine::Lists, Engine::Pivot, Engine::Scan];

fn search_exact_with(index: &Index, query: &Query, engine: Engine) -> Vec<Hit> {
    segidx::search_exact_with(index, query, engine)
        .unwrap()
        .hits
}

fn search_adaptive_with(index: &Index, query: &Query, engine: Engine) -> Vec<Hit> {
    segidx::search_adaptive_with(index, query, engine)
        .unwrap()
        .hits
}

fn config(cases: u32) -> ProptestConfig {
    ProptestConfig {
        cases,
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

/// Words of one clip; few alphabets and few frames, so that repetitions and empty clips are common.
fn clip(max_frames: usize) -> impl Strategy<Value = Vec<u64>> {
    prop_oneof![
        4 => vec(0..WORDS, 0..=max_frames),
        3 => vec(0..4u64, 0..=max_frames),
        2 => vec(0..2u64, 0..=max_frames),
        1 => (0..WORDS, 0..=max_frames).prop_map(|(word, n)| vec![word; n]),
    ]
}

fn library() -> impl Strategy<Value = Vec<Vec<u64>>> {
    vec(clip(12), 0..5)
}

/// Masks as (care, value), so that the twins see no type of the crate.
type RawSet = Vec<(u64, u64)>;

fn raw_sets() -> impl Strategy<Value = Vec<(RawSet, usize)>> {
    let n_masks = prop_oneof![6 => Just(1usize), 3 => Just(2), 1 => Just(0)];
    let set = n_masks.prop_flat_map(|n| vec((0..WORDS, 0..WORDS), n));
    vec((set, 0..5usize), 0..5)
}

/// Documents and an example, which is often cut from one of them.
fn library_and_example() -> impl Strategy<Value = (Vec<Vec<u64>>, Vec<u64>)> {
    let cut = any::<Option<(Selector, Selector)>>();
    (library(), clip(6), cut).prop_map(|(documents, free, cut)| {
        let example = match cut {
            Some((doc, start)) if !documents.is_empty() => {
                let words = doc.get(&documents);
                let start = start.index(words.len() + 1);
                words[start..words.len().min(start + 6)].to_vec()
            }
            _ => free,
        };
        (documents, example)
    })
}

/// Documents and sets; half the time the sets are grown around the segments of an example, so that long hits occur.
fn library_and_sets() -> impl Strategy<Value = (Vec<Vec<u64>>, Vec<(RawSet, usize)>)> {
    let grown = (library_and_example(), raw_sets(), 1..WORDS).prop_map(
        |((documents, example), extra, care)| {
            let mut extra = extra.into_iter();
            let sets = naive::segments(&example)
                .into_iter()
                .map(|(word, first, last)| {
                    let mut set = vec![(care, word)];
                    match extra.next() {
                        Some((masks, _)) if masks.len() == 1 => set[0].0 |= masks[0].0,
                        Some((masks, _)) => set.extend(masks.into_iter().skip(1)),
                        None => {}
                    }
                    (set, last + 1 - first)
                });
            let sets = sets.collect();
            (documents, sets)
        },
    );
    prop_oneof![(library(), raw_sets()), grown]
}

fn query_of(sets: &[(RawSet, usize)]) -> Query {
    let masks =
        |raw: &RawSet| FuzzySet::new(raw.iter().map(|&(care, value)| Mask::new(care, value)));
    Query::from_sets(sets.iter().map(|(raw, frames)| (masks(raw), Some(*frames))))
}

fn naive_sets(sets: &[(RawSet, usize)]) -> Vec<(Set, usize)> {
    let words = |raw: &RawSet| {
        raw.iter()
            .flat_map(|&(care, value)| naive::set_of_mask(care, value, BITS))
            .collect()
    };
    sets.iter()
        .map(|(raw, frames)| (words(raw), *frames))
        .collect()
}

/// The naive form of the query an example stands for, without conjoining.
fn naive_example(words: &[u64], care: u64) -> Vec<(Set, usize)> {
    naive::segments(words)
        .iter()
        .map(|&(word, first, last)| (naive::set_of_mask(care, word, BITS), last + 1 - first))
        .collect()
}

fn index_of(documents: &[Vec<u64>]) -> Index {
    let mut builder = IndexBuilder::new();
    for words in documents {
        builder.push("", [], words).unwrap();
    }
    builder.build()
}

fn plain(hits: &[Hit]) -> Vec<NaiveHit> {
    hits.iter()
        .map(|hit| {
            let ranges = hit.segments.iter().map(|range| (range.start, range.end));
            (hit.cost, hit.doc.index(), ranges.collect())
        })
        .collect()
}

fn first(query: &[(Set, usize)]) -> Vec<(Set, usize)> {
    naive::conjoin(query.to_vec(), |_| 0)
}

proptest! {
    #![proptest_config(config(4_000))]

    #[test]
    fn segments_tile_the_clip(words in clip(20)) {
        let segments = segment(&words);
        let naive = naive::segments(&words);
        let plain: Vec<_> = segments.iter().map(|s| (s.word, s.start, s.start + s.len - 1)).collect();
        prop_assert_eq!(plain, naive);
        let unrolled: Vec<u64> = segments.iter().flat_map(|s| vec![s.word; s.len]).collect();
        prop_assert_eq!(unrolled, words);
        prop_assert!(segments.windows(2).all(|pair| pair[0].span().end == pair[1].start));
    }

    #[test]
    fn an_index_holds_what_was_put_in(documents in library()) {
        let index = index_of(&documents);
        prop_assert_eq!(index.verify(), Ok(()));
        prop_assert_eq!(index.n_documents(), documents.len());
        let mut global = 0;
        for (document, words) in index.documents().zip(&documents) {
            let document = document.unwrap();
            prop_assert_eq!(&document.to_words().unwrap(), words);
            prop_assert_eq!(document.n_frames(), words.len());
            let segments = document.segments().unwrap();
            prop_assert_eq!(&segments, &segment(words));
            for (in_doc, segment) in segments.iter().enumerate() {
                prop_assert_eq!(index.locate(global), Ok(Some((document.id(), in_doc))));
                prop_assert!(index.list(segment.word).unwrap().binary_search(&(global as u32)).is_ok());
                global += 1;
            }
        }
        prop_assert_eq!(index.locate(global), Ok(None));
        let lengths: Vec<(u64, usize)> =
            index.lists().unwrap().iter().map(|list| (list.word, list.segments.len())).collect();
        prop_assert_eq!(index.list_lengths().unwrap(), lengths);
        prop_assert_eq!(index.lists().unwrap().iter().map(|list| list.segments.len()).sum::<usize>(), global);
    }

    #[test]
    fn conjoining_does_not_depend_on_the_order(sets in raw_sets(), picks in vec(any::<usize>(), 5)) {
        let mut picks = picks.into_iter().cycle();
        let expected = naive::conjoin(naive_sets(&sets), |_| picks.next().unwrap_or(0));
        let query = query_of(&sets);
        let found: Vec<(Set, usize)> = query
            .positions()
            .iter()
            .map(|position| {
                let words = (0..WORDS).filter(|&word| position.set.matches(word));
                (words.collect(), position.n_frames.unwrap())
            })
            .collect();
        prop_assert_eq!(found, expected);
        // The map from given sets to positions tiles the query and holds each set.
        for (given, (set, _)) in naive_sets(&sets).iter().enumerate() {
            let position = &query.positions()[query.position_of(given).unwrap()];
            prop_assert!(position.segments.contains(&given));
            prop_assert!(set.iter().all(|&word| position.set.matches(word)));
        }
        prop_assert_eq!(query.position_of(sets.len()), None);
    }
}

proptest! {
    #![proptest_config(config(40_000))]

    #[test]
    fn exact_hits_are_those_of_eq_9((documents, words) in library_and_example(), care in 0..WORDS) {
        let query = Query::exact(&words, care);
        let expected = naive::search(&documents, &naive_example(&words, care), naive::exact);
        let index = index_of(&documents);
        for engine in ENGINES {
            prop_assert_eq!(plain(&search_exact_with(&index, &query, engine)), expected.clone());
        }
    }

    #[test]
    fn adaptive_hits_are_those_of_the_definition((documents, sets) in library_and_sets()) {
        let expected = naive::search(&documents, &first(&naive_sets(&sets)), naive::adaptive);
        let (index, query) = (index_of(&documents), query_of(&sets));
        for engine in ENGINES {
            let hits = search_adaptive_with(&index, &query, engine);
            prop_assert_eq!(plain(&hits), expected.clone());
            for hit in &hits {
                prop_assert_eq!(index.locate(hit.first_segment), Ok(Some((hit.doc, hit.first_segment_in_doc))));
                prop_assert!(hit.span().end <= documents[hit.doc.index()].len());
            }
        }
    }

    #[test]
    fn adaptive_hits_of_an_example_are_those_of_the_definition(
        (documents, words) in library_and_example(), care in 0..WORDS,
    ) {
        let expected = naive::search(&documents, &first(&naive_example(&words, care)), naive::adaptive);
        let index = index_of(&documents);
        for query in [Query::fuzzy(&words, care), Query::exact(&words, care)] {
            for engine in ENGINES {
                let hits = search_adaptive_with(&index, &query, engine);
                prop_assert_eq!(plain(&hits), expected.clone());
            }
        }
    }

    #[test]
    fn masked_adaptive_hits_are_exact_hits_of_the_restricted_segmentation(
        (documents, words) in library_and_example(), care in 0..WORDS,
    ) {
        let restrict = |words: &[u64]| -> Vec<u64> { words.iter().map(|word| word & care).collect() };
        let restricted: Vec<Vec<u64>> = documents.iter().map(|words| restrict(words)).collect();
        let query = Query::exact(&restrict(&words), u64::MAX);
        let coarse = search_exact_with(&index_of(&restricted), &query, Engine::Auto);
        let query = Query::fuzzy(&words, care);
        let adaptive = search_adaptive_with(&index_of(&documents), &query, Engine::Auto);
        prop_assert_eq!(plain(&adaptive), plain(&coarse));
    }

    #[test]
    fn hits_are_sorted((documents, sets) in library_and_sets()) {
        let (index, query) = (index_of(&documents), query_of(&sets));
        for search in [search_exact_with, search_adaptive_with] {
            let hits = search(&index, &query, Engine::Auto);
            let keys: Vec<_> = hits.iter().map(|hit| (hit.cost, hit.doc, hit.span().start)).collect();
            prop_assert!(keys.windows(2).all(|pair| pair[0] < pair[1]));
        }
    }
}

/// Documents large enough that the plan samples and that both sources of candidates are worth choosing.
#[test]
fn engines_agree_on_a_large_index() {
    let mut state = 1u64;
    let mut random = |below: u64| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) % below
    };
    let documents: Vec<Vec<u64>> = (0..40)
        .map(|_| {
            let mut word = random(1 << 10);
            (0..random(600))
                .map(|_| {
                    if random(3) == 0 {
                        word ^= 1 << random(10);
                    }
                    word
                })
                .collect()
        })
        .collect();
    let index = index_of(&documents);
    assert!(index.n_segments() > 2_000);
    let mut n_hits = 0;
    for _ in 0..300 {
        let source = &documents[random(40) as usize];
        if source.len() < 30 {
            continue;
        }
        let start = random(source.len() as u64 - 20) as usize;
        let example = &source[start..start + 5 + random(15) as usize];
        let care = random(1 << 10) & random(1 << 10);
        for query in [Query::exact(example, u64::MAX), Query::fuzzy(example, care)] {
            for search in [search_exact_with, search_adaptive_with] {
                let hits = search(&index, &query, Engine::Auto);
                for engine in ENGINES {
                    assert_eq!(hits, search(&index, &query, engine));
                }
                n_hits += hits.len();
            }
        }
    }
    assert!(n_hits > 1_000);
}

/// Hits of a masked query by a plain pass over the runs of the masked words of each document, which is
/// what the definition comes to for sets that are masks with the same care.
fn linear_scan(documents: &[Vec<u64>], example: &[u64], care: u64) -> Vec<NaiveHit> {
    let runs = |words: &[u64]| -> Vec<(u64, usize, usize)> {
        let mut runs: Vec<(u64, usize, usize)> = Vec::new();
        for (frame, word) in words.iter().map(|word| word & care).enumerate() {
            match runs.last_mut() {
                Some(run) if run.0 == word => run.2 = frame + 1,
                _ => runs.push((word, frame, frame + 1)),
            }
        }
        runs
    };
    let wanted = runs(example);
    let mut hits = Vec::new();
    for (doc, words) in documents.iter().enumerate() {
        for window in runs(words).windows(wanted.len().max(1)) {
            let pairs = || window.iter().zip(&wanted);
            if !wanted.is_empty() && pairs().all(|(run, wanted)| run.0 == wanted.0) {
                let differences = pairs().map(|(a, b)| (a.2 - a.1).abs_diff(b.2 - b.1) as u64);
                let ranges = window.iter().map(|run| (run.1, run.2)).collect();
                hits.push((differences.sum(), doc, ranges));
            }
        }
    }
    hits.sort();
    hits
}

/// Documents whose lists fill several blocks of 128, or whose words and lengths are as wide as they can be.
fn long_library() -> impl Strategy<Value = Vec<Vec<u64>>> {
    let words = prop_oneof![
        Just(vec![0, 1]),
        Just(vec![5, 9, 1 << 63, u64::MAX]),
        vec(any::<u64>(), 1..4),
        vec(0..64u64, 20..40),
    ];
    words.prop_flat_map(|words| {
        let len = prop_oneof![8 => 1..4usize, 1 => 1..300usize];
        let run = (proptest::sample::select(words), len);
        let clip = prop_oneof![vec(run.clone(), 0..3), vec(run, 100..700)];
        let unroll = |runs: Vec<(u64, usize)>| -> Vec<u64> {
            let runs = runs.into_iter();
            runs.flat_map(|(word, len)| std::iter::repeat_n(word, len))
                .collect()
        };
        vec(clip.prop_map(unroll), 1..5)
    })
}

proptest! {
    #![proptest_config(config(400))]

    #[test]
    fn long_lists_give_the_hits_of_a_linear_scan(
        documents in long_library(), doc in any::<Selector>(), start in any::<Selector>(), n_frames in 0..40usize,
        care in prop_oneof![Just(u64::MAX), Just(0), any::<u64>(), 0..4u64],
    ) {
        let words = doc.get(&documents);
        let start = start.index(words.len() + 1);
        let example = &words[start..words.len().min(start + n_frames)];
        let index = index_of(&documents);
        prop_assert_eq!(index.verify(), Ok(()));
        let all = linear_scan(&documents, example, u64::MAX);
        let masked = linear_scan(&documents, example, care);
        for engine in ENGINES {
            let exact = search_exact_with(&index, &Query::exact(example, u64::MAX), engine);
            prop_assert_eq!(plain(&exact), all.clone());
            let adaptive = search_adaptive_with(&index, &Query::fuzzy(example, care), engine);
            prop_assert_eq!(plain(&adaptive), masked.clone());
        }
        for (document, words) in index.documents().zip(&documents) {
            prop_assert_eq!(&document.unwrap().to_words().unwrap(), words);
        }
    }
}
