use proptest::prelude::*;

use super::sheet::tail;
use super::*;
use crate::picture::agreement::Cell;

/// By definition: the word of the query whose middle is nearest in time when both segments are as long; of two the
/// later one.
fn nearest(k: usize, (n_query, n_hit): (usize, usize)) -> usize {
    let distance = |j: usize| ((2 * k + 1) * n_query).abs_diff((2 * j + 1) * n_hit);
    (0..n_query).rev().min_by_key(|&j| distance(j)).unwrap()
}

/// Lengths to ranges that follow each other.
fn ranges(lengths: &[usize]) -> Vec<Range<usize>> {
    let mut start = 0;
    let ranges = lengths.iter().map(|n| {
        let range = start..start + n;
        start = range.end;
        range
    });
    ranges.collect()
}

#[derive(Clone, Debug)]
struct Case {
    query: Vec<u64>,
    hit: Vec<u64>,
    stretches: Vec<Stretch>,
    known: u64,
}

/// Words of few different values, so that they often agree.
fn words(n: usize) -> impl Strategy<Value = Vec<u64>> {
    let word = prop_oneof![Just(0), Just(u64::MAX), any::<u64>()];
    proptest::collection::vec(word, n)
}

fn cases() -> impl Strategy<Value = Case> {
    let mask = || prop_oneof![Just(0), Just(u64::MAX), any::<u64>()];
    let stretch = (1..9_usize, 1..9_usize, mask());
    let stretches = proptest::collection::vec(stretch, 1..5);
    (stretches, mask()).prop_flat_map(|(stretches, known)| {
        let query: Vec<usize> = stretches.iter().map(|s| s.0).collect();
        let hit: Vec<usize> = stretches.iter().map(|s| s.1).collect();
        let n_words = (query.iter().sum(), hit.iter().sum());
        let ranges = ranges(&query).into_iter().zip(ranges(&hit));
        let ranges = ranges.zip(&stretches);
        let stretches: Vec<Stretch> = ranges
            .map(|((query, hit), &(_, _, compared))| Stretch {
                query,
                hit,
                compared,
            })
            .collect();
        (words(n_words.0), words(n_words.1)).prop_map(move |(query, hit)| Case {
            query,
            hit,
            stretches: stretches.clone(),
            known,
        })
    })
}

fn explain(case: &Case, set: &FeatureSet) -> Explained {
    let agreement = Agreement::new(&case.query, &case.hit, case.stretches.clone(), case.known);
    let frames = vec![([0, 0], [0, 0]); case.stretches.len()];
    Explained::new(set, agreement, &frames)
}

fn set() -> FeatureSet {
    FeatureSet::builtin("mueller2006").unwrap()
}

proptest! {
    #[test]
    fn features_agree_as_defined(mut case in cases()) {
        let set = set();
        case.known &= set.all();
        let explained = explain(&case, &set);
        prop_assert_eq!(explained.segments.len(), case.stretches.len());
        for (stretch, segment) in case.stretches.iter().zip(&explained.segments) {
            let mut expected = (Vec::new(), Vec::new(), Vec::new());
            for (bit, feature) in set.features().iter().enumerate() {
                let n_words = (stretch.query.len(), stretch.hit.len());
                let n_alike = (0..n_words.1).filter(|&k| {
                    let asked = case.query[stretch.query.start + nearest(k, n_words)];
                    let found = case.hit[stretch.hit.start + k];
                    (asked >> bit) % 2 == (found >> bit) % 2
                }).count();
                let name = feature.name.clone();
                match (case.known >> bit & 1 == 1, stretch.compared >> bit & 1 == 1) {
                    (false, _) => {}
                    (true, true) if n_alike == n_words.1 => expected.0.push(name),
                    (true, true) => expected.1.push(name),
                    (true, false) => expected.2.push(MaskedJson {
                        feature: name,
                        agreement: n_alike as f64 / n_words.1 as f64,
                    }),
                }
            }
            prop_assert_eq!(&segment.equal, &expected.0);
            prop_assert_eq!(&segment.different, &expected.1);
            prop_assert_eq!(&segment.masked, &expected.2);
        }
    }

    #[test]
    fn cells_say_the_same_as_the_segments(mut case in cases()) {
        let set = set();
        case.known &= set.all();
        let explained = explain(&case, &set);
        for (bit, feature) in set.features().iter().enumerate() {
            let cells = explained.agreement.cells(bit);
            prop_assert_eq!(cells.len(), case.hit.len());
            for (stretch, segment) in case.stretches.iter().zip(&explained.segments) {
                let cells = &cells[stretch.hit.clone()];
                let has = |names: &[String]| names.contains(&feature.name);
                let masked = segment.masked.iter().find(|m| m.feature == feature.name);
                let n = |wanted: Cell| cells.iter().filter(|cell| **cell == wanted).count();
                if has(&segment.equal) {
                    prop_assert_eq!(n(Cell::Equal), cells.len());
                } else if has(&segment.different) {
                    prop_assert!(n(Cell::Different) > 0);
                    prop_assert_eq!(n(Cell::Equal) + n(Cell::Different), cells.len());
                } else if let Some(masked) = masked {
                    prop_assert_eq!(n(Cell::Alike) + n(Cell::Unlike), cells.len());
                    prop_assert_eq!(n(Cell::Alike) as f64 / cells.len() as f64, masked.agreement);
                } else {
                    prop_assert_eq!(n(Cell::Unknown), cells.len());
                }
            }
        }
    }

    #[test]
    fn the_example_agrees_with_itself(mut case in cases()) {
        let set = set();
        case.known &= set.all();
        case.hit = case.query.clone();
        for stretch in &mut case.stretches {
            stretch.hit = stretch.query.clone();
        }
        for segment in explain(&case, &set).segments {
            prop_assert_eq!(segment.different.len(), 0);
            prop_assert!(segment.masked.iter().all(|m| m.agreement == 1.0));
        }
    }
}

#[test]
fn the_summary_names_what_differs_and_what_is_least_alike() {
    let set = set();
    let name = |bit: usize| &set.features()[bit].name;
    let stretch = |words: Range<usize>| Stretch {
        query: words.clone(),
        hit: words,
        compared: 0b11,
    };
    let explained = explain(
        &Case {
            query: vec![0; 8],
            hit: vec![0b0001, 0b0100, 0b0100, 0, 0b1101, 0b0100, 0, 0],
            stretches: vec![stretch(0..4), stretch(4..8)],
            known: 0b1111,
        },
        &set,
    );
    assert_eq!(
        explained.summary,
        format!(
            "1 of 2 features equal, different {} (1, 2); 2 masked, alike 68 %, least {} 50 %, {} 87 %",
            name(0),
            name(2),
            name(3)
        )
    );
}

#[test]
fn words_that_are_not_there_agree_with_nothing() {
    let stretch = Stretch {
        query: 0..2,
        hit: 0..2,
        compared: 1,
    };
    let agreement = Agreement::new(&[], &[1], vec![stretch], 1);
    assert_eq!(agreement.alike, [0]);
    assert_eq!(tail("a/b/c.amc"), "b/c.amc");
    assert_eq!(tail("c.amc"), "c.amc");
}
