//! m-mismatch hits against their definition.

use proptest::collection::vec;
use proptest::prelude::*;
use segidx::{
    Engine, FuzzySet, Hit, Index, IndexBuilder, Mask, MismatchError, MismatchQuery, Query,
    search_exact, search_mismatch, search_mismatch_with,
};

use crate::naive::{self, Set};

pub(crate) const BITS: u32 = 3;
pub(crate) const WORDS: u64 = 1 << BITS;
pub(crate) const ENGINES: [Engine; 4] = [Engine::Auto, Engine::Lists, Engine::Pivot, Engine::Scan];

/// A hit as `(cost, document, frame ranges, mismatching positions)`.
pub(crate) type NaiveHit = (u64, usize, Vec<(usize, usize)>, Vec<usize>);

/// What is asked for, without a type of the crate: the example, the bits compared, and the mismatches.
#[derive(Clone, Debug)]
pub(crate) struct Asked {
    pub(crate) words: Vec<u64>,
    pub(crate) care: u64,
    pub(crate) m: usize,
    /// Positions that may mismatch; `None` for all.
    pub(crate) at: Option<Vec<usize>>,
}

impl Asked {
    pub(crate) fn sets(&self) -> Vec<(Set, usize)> {
        naive::segments(&self.words)
            .iter()
            .map(|&(word, first, last)| {
                (naive::set_of_mask(self.care, word, BITS), last + 1 - first)
            })
            .collect()
    }

    fn query(&self) -> Query {
        Query::exact(&self.words, self.care)
    }

    /// `None` where the definition asks for m < L.
    pub(crate) fn mismatch_query(&self) -> Option<MismatchQuery> {
        let query = MismatchQuery::new(self.query(), self.m).ok()?;
        match &self.at {
            None => Some(query),
            Some(at) => Some(query.at(at.iter().copied()).unwrap()),
        }
    }

    fn with(&self, m: usize) -> Asked {
        Asked { m, ..self.clone() }
    }
}

/// Spec j.2, word for word: every k of every document is tried.
pub(crate) fn mismatch_hits(
    documents: &[Vec<u64>],
    sets: &[(Set, usize)],
    asked: &Asked,
) -> Vec<NaiveHit> {
    let mut hits = Vec::new();
    for (doc, words) in documents.iter().enumerate() {
        let segments = naive::segments(words);
        for k in 0..segments.len() {
            if k + sets.len() > segments.len() {
                continue;
            }
            let wrong: Vec<usize> = (0..sets.len())
                .filter(|&l| !sets[l].0.contains(&segments[k + l].0))
                .collect();
            let may = |l: &usize| asked.at.as_ref().is_none_or(|at| at.contains(l));
            if wrong.len() > asked.m || !wrong.iter().all(may) {
                continue;
            }
            let here = || segments[k..].iter().zip(sets);
            let cost = here().map(|(s, (_, frames))| frames.abs_diff(s.2 + 1 - s.1) as u64);
            let ranges = here().map(|(s, _)| (s.1, s.2 + 1)).collect();
            hits.push((cost.sum(), doc, ranges, wrong));
        }
    }
    hits.sort();
    hits
}

pub(crate) fn plain(hits: &[Hit]) -> Vec<NaiveHit> {
    hits.iter()
        .map(|hit| {
            let ranges = hit.segments.iter().map(|range| (range.start, range.end));
            (
                hit.cost,
                hit.doc.index(),
                ranges.collect(),
                hit.mismatches.clone(),
            )
        })
        .collect()
}

pub(crate) fn index_of(documents: &[Vec<u64>]) -> Index {
    let mut builder = IndexBuilder::new();
    for words in documents {
        builder.push("", [], words).unwrap();
    }
    builder.build()
}

/// Small alphabets, so that repetitions, near misses and empty clips are common.
fn clip(max_frames: usize) -> impl Strategy<Value = Vec<u64>> {
    prop_oneof![
        vec(0..WORDS, 0..=max_frames),
        vec(0..4u64, 0..=max_frames),
        vec(0..2u64, 0..=max_frames),
    ]
}

pub(crate) fn library() -> impl Strategy<Value = Vec<Vec<u64>>> {
    vec(clip(16), 0..5)
}

pub(crate) fn asked() -> impl Strategy<Value = Asked> {
    let care = prop_oneof![Just(WORDS - 1), 0..WORDS];
    let at = prop_oneof![
        Just(None),
        vec(any::<prop::sample::Index>(), 0..5).prop_map(Some)
    ];
    (clip(7), care, 0..6usize, at).prop_map(|(words, care, m, at)| {
        let n = naive::segments(&words).len();
        let at = at.map(|at| at.iter().filter(|_| n > 0).map(|i| i.index(n)).collect());
        Asked { words, care, m, at }
    })
}

pub(crate) fn config(cases: u32) -> ProptestConfig {
    ProptestConfig {
        cases,
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

proptest! {
    #![proptest_config(config(60_000))]

    #[test]
    fn mismatch_hits_are_those_of_the_definition(documents in library(), asked in asked()) {
        let sets = asked.sets();
        let Some(query) = asked.mismatch_query() else {
            prop_assert!(asked.m >= sets.len());
            return Ok(());
        };
        prop_assert!(asked.m < sets.len());
        let expected = mismatch_hits(&documents, &sets, &asked);
        let index = index_of(&documents);
        for engine in ENGINES {
            let hits = search_mismatch_with(&index, &query, engine).unwrap().hits;
            prop_assert_eq!(plain(&hits), expected.clone());
            for hit in &hits {
                prop_assert_eq!(index.locate(hit.first_segment), Ok(Some((hit.doc, hit.first_segment_in_doc))));
            }
        }
    }
}

/// Sets by their masks as (care, value), with their lengths.
type RawSets = Vec<(Vec<(u64, u64)>, usize)>;

fn raw_sets() -> impl Strategy<Value = RawSets> {
    vec((vec((0..WORDS, 0..WORDS), 0..3), 0..5usize), 1..6)
}

proptest! {
    #![proptest_config(config(20_000))]

    /// Unions of masks, sets without any word, and whatever conjoining left of them.
    #[test]
    fn hits_of_any_sets_are_those_of_the_definition(documents in library(), raw in raw_sets(), m in 0..4usize) {
        let masks = |raw: &[(u64, u64)]| FuzzySet::new(raw.iter().map(|&(care, value)| Mask::new(care, value)));
        let query = Query::from_sets(raw.iter().map(|(raw, frames)| (masks(raw), Some(*frames))));
        let sets = raw.iter().map(|(raw, frames)| {
            let words = raw.iter().flat_map(|&(care, value)| naive::set_of_mask(care, value, BITS));
            (words.collect(), *frames)
        });
        let sets = naive::conjoin(sets.collect(), |_| 0);
        if let Ok(query) = MismatchQuery::new(query, m) {
            let asked = Asked { words: Vec::new(), care: 0, m, at: None };
            let expected = mismatch_hits(&documents, &sets, &asked);
            for engine in ENGINES {
                let hits = search_mismatch_with(&index_of(&documents), &query, engine).unwrap().hits;
                prop_assert_eq!(plain(&hits), expected.clone());
            }
        } else {
            prop_assert!(m >= sets.len());
        }
    }

    #[test]
    fn no_mismatch_is_an_exact_search(documents in library(), asked in asked()) {
        let index = index_of(&documents);
        let exact = search_exact(&index, &asked.query()).unwrap();
        if let Some(query) = asked.with(0).mismatch_query() {
            prop_assert_eq!(search_mismatch(&index, &query).unwrap(), exact.clone());
        }
        let nowhere = Asked { at: Some(Vec::new()), ..asked };
        if let Some(query) = nowhere.mismatch_query() {
            prop_assert_eq!(search_mismatch(&index, &query).unwrap(), exact);
        }
    }

    #[test]
    fn more_mismatches_find_more(documents in library(), asked in asked()) {
        let index = index_of(&documents);
        let (Some(fewer), Some(more)) = (asked.mismatch_query(), asked.with(asked.m + 1).mismatch_query()) else {
            return Ok(());
        };
        let more = search_mismatch(&index, &more).unwrap();
        let within: Vec<Hit> = more.into_iter().filter(|hit| hit.mismatches.len() <= asked.m).collect();
        prop_assert_eq!(search_mismatch(&index, &fewer).unwrap(), within);
    }
}

/// Documents so many that the plan samples, and lists are cheaper than a scan for some queries.
#[test]
fn engines_agree_on_a_large_index() {
    let mut state = 1u64;
    let mut random = |below: u64| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) % below
    };
    let documents: Vec<Vec<u64>> = (0..20)
        .map(|_| {
            let mut word = random(1 << 8);
            let step = |_| {
                word ^= 1 << random(8);
                word
            };
            (0..120).map(step).collect()
        })
        .collect();
    let index = index_of(&documents);
    let all = naive::set_of_mask(0, 0, 8);
    let mut n_inexact = 0;
    for _ in 0..60 {
        let document = &documents[random(20) as usize];
        let start = random(110) as usize;
        let n = 4 + random(4) as usize;
        let mut words = document[start..start + n].to_vec();
        words[random(n as u64) as usize] ^= 0b101;
        let care = if random(2) == 0 { 255 } else { 0b1111_0111 };
        let n = naive::segments(&words).len();
        let m = 1 + random(n as u64 - 1) as usize;
        let at =
            (random(2) == 0).then(|| vec![random(n as u64) as usize, random(n as u64) as usize]);
        let asked = Asked { words, care, m, at };
        let sets = naive::segments(&asked.words)
            .into_iter()
            .map(|(word, first, last)| {
                let set = all.iter().filter(|&&w| (w ^ word) & care == 0);
                (set.copied().collect(), last + 1 - first)
            });
        let expected = mismatch_hits(&documents, &sets.collect::<Vec<_>>(), &asked);
        let query = asked.mismatch_query().unwrap();
        for engine in ENGINES {
            let hits = search_mismatch_with(&index, &query, engine).unwrap().hits;
            assert_eq!(plain(&hits), expected);
        }
        n_inexact += expected.iter().filter(|hit| !hit.3.is_empty()).count();
    }
    assert!(n_inexact > 100, "{n_inexact}");
}

#[test]
fn impossible_queries_are_errors_that_say_why() {
    let query = Query::exact(&[1, 2, 3], u64::MAX);
    let error = MismatchQuery::new(query.clone(), 3).unwrap_err();
    assert_eq!(
        error,
        MismatchError::TooMany {
            n_positions: 3,
            found: 3
        }
    );
    assert_eq!(
        error.to_string(),
        "expected fewer mismatches than the query has positions, 3, found 3"
    );
    assert!(MismatchQuery::new(Query::default(), 0).is_err());
    let query = MismatchQuery::new(query, 2).unwrap();
    let error = query.at([0, 3]).unwrap_err();
    assert_eq!(error.to_string(), "expected a position below 3, found 3");
}

#[test]
fn hits_never_cross_documents() {
    let index = index_of(&[vec![1, 2], vec![3, 4, 5], vec![]]);
    let query = MismatchQuery::new(Query::exact(&[1, 2, 3], u64::MAX), 2).unwrap();
    let hits = search_mismatch(&index, &query).unwrap();
    // Nothing of it is where it should be in 3 4 5, and 1 2 is too short.
    assert_eq!(hits, []);
    let query = MismatchQuery::new(Query::exact(&[9, 4, 9], u64::MAX), 2).unwrap();
    let hits = search_mismatch(&index, &query).unwrap();
    assert_eq!(
        (hits.len(), hits[0].doc.index(), hits[0].span()),
        (1, 1, 0..3)
    );
    assert_eq!(hits[0].mismatches, [0, 2]);
}
