//! Hits of several feature sets, combined and verified, against the definitions.

use std::collections::BTreeSet;

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::Index as Selector;
use segidx::{DocId, Hit, Index, Query, combine, search_adaptive, search_adaptive_around};

use crate::mismatch::{config, index_of};

/// The bits of three feature sets.
const SETS: [u64; 3] = [0b00_0011, 0b00_1100, 0b11_0000];

/// A hit of one feature set: document, cost, frame ranges.
type SetHit = (usize, u64, Vec<(usize, usize)>);

/// A combined hit: cost, document, first frame and end, number of the hit of each set.
type NaiveCombined = (u64, usize, usize, usize, Vec<usize>);

/// Spec j.3: every choice of one hit per set is tried, frame by frame.
fn by_every_choice(sets: &[Vec<SetHit>]) -> Vec<NaiveCombined> {
    let mut choices: Vec<Vec<usize>> = vec![Vec::new()];
    for set in sets {
        choices = choices
            .iter()
            .flat_map(|choice| (0..set.len()).map(|hit| [&choice[..], &[hit]].concat()))
            .collect();
    }
    let mut found = Vec::new();
    for choice in choices.into_iter().filter(|choice| !choice.is_empty()) {
        let hits: Vec<&SetHit> = choice.iter().zip(sets).map(|(&i, set)| &set[i]).collect();
        let frames = |range: (usize, usize)| (range.0..range.1).collect::<BTreeSet<usize>>();
        let hulls: Vec<_> = hits
            .iter()
            .map(|(.., ranges)| frames((ranges[0].0, ranges[ranges.len() - 1].1)))
            .collect();
        let cores: Vec<_> = hits
            .iter()
            .map(|(.., ranges)| match ranges.len() {
                1 => BTreeSet::new(),
                n => frames((ranges[0].1 - 1, ranges[n - 1].0 + 1)),
            })
            .collect();
        let common = hulls.iter().skip(1).fold(hulls[0].clone(), |a, b| &a & b);
        let meet = |core: &BTreeSet<usize>| {
            core.is_empty() || hulls.iter().all(|hull| !core.is_disjoint(hull))
        };
        if hits.iter().any(|hit| hit.0 != hits[0].0) || common.is_empty() || !cores.iter().all(meet)
        {
            continue;
        }
        let all: BTreeSet<usize> = cores.into_iter().flatten().collect();
        let span = if all.is_empty() { common } else { all };
        let (first, last) = (span.first(), span.last());
        let (Some(first), Some(last)) = (first, last) else {
            continue;
        };
        let cost = hits.iter().map(|hit| hit.1).sum();
        found.push((cost, hits[0].0, *first, last + 1, choice));
    }
    found.sort();
    found
}

fn hit_of((doc, cost, ranges): &SetHit) -> Hit {
    Hit {
        doc: DocId::from_number(*doc as u32),
        cost: *cost,
        first_segment: 0,
        first_segment_in_doc: 0,
        segments: ranges.iter().map(|&(start, end)| start..end).collect(),
        mismatches: Vec::new(),
    }
}

/// Any hits, not only those that one query could have.
fn any_hits() -> impl Strategy<Value = Vec<SetHit>> {
    let hit = (0..2usize, 0..5u64, 0..12usize, vec(1..6usize, 1..4));
    let ranges = |(doc, cost, mut end, lengths): (usize, u64, usize, Vec<usize>)| {
        let ranges = lengths.iter().map(|len| {
            end += len;
            (end - len, end)
        });
        (doc, cost, ranges.collect())
    };
    vec(hit.prop_map(ranges), 0..6)
}

/// Frames of a clip, which changes a bit now and then and goes through part of it again.
fn clip() -> impl Strategy<Value = Vec<u64>> {
    let steps = prop_oneof![
        vec(0..10u32, 0..24),
        // Few bits, so that sets have little to tell apart.
        vec(0..3u32, 0..24),
    ];
    (0..64u64, steps, 1..4usize).prop_map(|(mut word, steps, n_times)| {
        let once: Vec<u64> = steps
            .iter()
            .map(|&step| {
                word ^= if step < 6 { 1 << step } else { 0 };
                word
            })
            .collect();
        once.repeat(n_times)
    })
}

/// Documents, an example that is often cut from one of them, and the bits that count.
fn library_and_example() -> impl Strategy<Value = (Vec<Vec<u64>>, Vec<u64>, u64)> {
    let cut = any::<Option<(Selector, Selector, Selector)>>();
    let care = prop_oneof![Just(63u64), 0..64u64, Just(0b01_0101), Just(0b00_1111)];
    (vec(clip(), 0..4), clip(), cut, care).prop_map(|(documents, free, cut, care)| {
        let example = match cut {
            Some((doc, start, len)) if !documents.is_empty() => {
                let words = doc.get(&documents);
                let start = start.index(words.len() + 1);
                words[start..words.len().min(start + len.index(12))].to_vec()
            }
            _ => free,
        };
        (documents, example, care)
    })
}

fn shard_of(documents: &[Vec<u64>], set: u64) -> Index {
    let restrict = |words: &Vec<u64>| words.iter().map(|word| word & set).collect();
    index_of(&documents.iter().map(restrict).collect::<Vec<_>>())
}

/// Everything but the segment numbers, which are those of the shard.
fn in_frames(hits: &[Hit]) -> Vec<SetHit> {
    let ranges = |hit: &Hit| hit.segments.iter().map(|r| (r.start, r.end)).collect();
    hits.iter()
        .map(|hit| (hit.doc.index(), hit.cost, ranges(hit)))
        .collect()
}

proptest! {
    #![proptest_config(config(40_000))]

    #[test]
    fn combinations_are_those_of_the_definition(sets in vec(any_hits(), 0..4)) {
        let hits: Vec<Vec<Hit>> = sets.iter().map(|set| set.iter().map(hit_of).collect()).collect();
        let hits: Vec<&[Hit]> = hits.iter().map(|hits| &hits[..]).collect();
        let found: Vec<_> = combine(&hits)
            .into_iter()
            .map(|hit| (hit.cost, hit.doc.index(), hit.span.start, hit.span.end, hit.hits))
            .collect();
        prop_assert_eq!(found, by_every_choice(&sets));
    }

    #[test]
    fn combined_and_verified_hits_are_those_of_the_joint_query(
        (documents, example, care) in library_and_example(),
    ) {
        let joint = index_of(&documents);
        let query = Query::fuzzy(&example, care);
        let expected = search_adaptive(&joint, &query).unwrap();
        let mut of_sets = Vec::new();
        for set in SETS.into_iter().filter(|set| set & care != 0) {
            let part = Query::fuzzy(&example, set & care);
            let hits = search_adaptive(&shard_of(&documents, set), &part).unwrap();
            // The joint shard has the same hits of a single set.
            let same = search_adaptive(&joint, &part).unwrap();
            prop_assert_eq!(in_frames(&hits), in_frames(&same));
            of_sets.push(hits);
        }
        if of_sets.is_empty() {
            return Ok(());
        }
        let of_sets: Vec<&[Hit]> = of_sets.iter().map(|hits| &hits[..]).collect();
        let combined = combine(&of_sets);
        // Every joint hit lies within the hulls and around the cores of some combination.
        for hit in &expected {
            let span = hit.span();
            let is_around = combined.iter().any(|combination| {
                let hits = || combination.hits.iter().zip(&of_sets).map(|(&i, hits)| &hits[i]);
                combination.doc == hit.doc
                    && hits().all(|hit| hit.span().start <= span.start && span.end <= hit.span().end)
                    && span.start <= combination.span.start && combination.span.end <= span.end
            });
            prop_assert!(is_around);
        }
        let places = combined.into_iter().map(|hit| (hit.doc, hit.span));
        prop_assert_eq!(search_adaptive_around(&joint, &query, places).unwrap(), expected);
    }

    #[test]
    fn hits_around_places_are_the_hits_that_contain_one(
        (documents, example, care) in library_and_example(),
        places in vec((0..5u32, 0..30usize, 0..8usize), 0..4),
    ) {
        let index = index_of(&documents);
        let query = Query::exact(&example, care);
        let places: Vec<_> = places
            .into_iter()
            .map(|(doc, start, len)| (DocId::from_number(doc), start..start + len))
            .collect();
        let contains = |hit: &Hit| places.iter().any(|(doc, place)| {
            let span = hit.span();
            *doc == hit.doc && !place.is_empty() && span.start <= place.start && place.end <= span.end
        });
        let expected: Vec<Hit> = search_adaptive(&index, &query).unwrap().into_iter().filter(contains).collect();
        prop_assert_eq!(search_adaptive_around(&index, &query, places).unwrap(), expected);
    }
}

/// Two sets that go through the same changes in the other order: combined, but no joint hit.
#[test]
fn a_combination_needs_not_be_a_joint_hit() {
    let example = [0b000, 0b001, 0b101, 0b100, 0b000];
    let other = [0b000, 0b100, 0b101, 0b001, 0b000];
    let documents = [example.to_vec(), other.to_vec()];
    let (joint, query) = (index_of(&documents), Query::fuzzy(&example, 0b101));
    let [lower, upper] = [0b001, 0b100].map(|set| {
        let part = Query::fuzzy(&example, set);
        search_adaptive(&shard_of(&documents, set), &part).unwrap()
    });
    let combined = combine(&[&lower, &upper]);
    let found: Vec<_> = combined
        .iter()
        .map(|hit| (hit.doc.index(), hit.cost, hit.span.clone()))
        .collect();
    assert_eq!(found, [(0, 0, 0..5), (1, 4, 0..5)]);
    let places = combined.into_iter().map(|hit| (hit.doc, hit.span));
    let hits = search_adaptive_around(&joint, &query, places).unwrap();
    assert_eq!(
        in_frames(&hits),
        [(0, 0, vec![(0, 1), (1, 2), (2, 3), (3, 4), (4, 5)])]
    );
}
