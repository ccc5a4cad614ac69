//! Other features and alternatives at some positions of a query, against the definition.

use proptest::collection::vec;
use proptest::prelude::*;
use segidx::{FuzzySet, Hit, Mask, Query, search_adaptive};

use crate::mismatch::{BITS, WORDS, config, index_of, library};
use crate::naive::{self, NaiveHit, Set};

/// What is changed at a position: the bits compared there, if other ones, and masks accepted besides.
type Change = (Option<u64>, Vec<(u64, u64)>);

fn plain(hits: &[Hit]) -> Vec<NaiveHit> {
    let ranges = |hit: &Hit| hit.segments.iter().map(|r| (r.start, r.end)).collect();
    hits.iter()
        .map(|hit| (hit.cost, hit.doc.index(), ranges(hit)))
        .collect()
}

fn changed(query: &Query, example: &[u64], changes: &[Change]) -> Query {
    query.map_sets(|position, was| {
        let Some((care, masks)) = changes.get(position) else {
            return was.set.clone();
        };
        let frames = query.frames_of(position).unwrap();
        let set = match care {
            Some(care) => FuzzySet::of_example(&example[frames], *care),
            None => was.set.clone(),
        };
        set.union(&FuzzySet::new(
            masks.iter().map(|&(care, value)| Mask::new(care, value)),
        ))
    })
}

proptest! {
    #![proptest_config(config(40_000))]

    #[test]
    fn hits_of_changed_positions_are_those_of_the_definition(
        documents in library(),
        example in vec(0..WORDS, 0..8),
        care in 0..WORDS,
        changes in vec((proptest::option::of(0..WORDS), vec((0..WORDS, 0..WORDS), 0..2)), 0..6),
    ) {
        let restricted: Vec<u64> = example.iter().map(|word| word & care).collect();
        let printed = naive::segments(&restricted);
        let sets = printed.iter().enumerate().map(|(i, &(word, first, last))| {
            let change = changes.get(i).cloned().unwrap_or_default();
            let mut set: Set = match change.0 {
                None => naive::set_of_mask(care, word, BITS),
                Some(care) => example[first..=last]
                    .iter()
                    .flat_map(|&word| naive::set_of_mask(care, word, BITS))
                    .collect(),
            };
            set.extend(change.1.iter().flat_map(|&(care, value)| naive::set_of_mask(care, value, BITS)));
            (set, last + 1 - first)
        });
        let sets: Vec<(Set, usize)> = sets.collect();
        let query = changed(&Query::fuzzy(&example, care), &example, &changes);
        prop_assert_eq!(query.positions().len(), printed.len());
        let united = naive::conjoin(sets.clone(), |_| 0);
        let expected = naive::search(&documents, &united, naive::adaptive);
        prop_assert_eq!(plain(&search_adaptive(&index_of(&documents), &query).unwrap()), expected);

        // Each printed position is in the united one that holds its words; in order, without gaps.
        let conjoined = query.conjoined();
        let lengths: Vec<_> = conjoined.positions().iter().map(|position| position.n_frames).collect();
        prop_assert_eq!(lengths, united.iter().map(|&(_, frames)| Some(frames)).collect::<Vec<_>>());
        let mut next = 0;
        for (position, (set, _)) in conjoined.positions().iter().zip(&united) {
            prop_assert_eq!(position.segments.start, next);
            next = position.segments.end;
            let merged: Set = position.segments.clone().flat_map(|i| sets[i].0.clone()).collect();
            prop_assert_eq!(&merged, set);
            prop_assert!((0..WORDS).all(|word| position.set.matches(word) == set.contains(&word)));
        }
        prop_assert_eq!(next, printed.len());
    }

    #[test]
    fn frames_of_positions_tile_the_example(example in vec(0..WORDS, 0..10), care in 0..WORDS) {
        for query in [Query::fuzzy(&example, care), Query::exact(&example, care)] {
            let mut next = 0;
            for position in 0..query.positions().len() {
                let frames = query.frames_of(position).unwrap();
                prop_assert_eq!(frames.start, next);
                let set = &query.positions()[position].set;
                prop_assert!(example[frames.clone()].iter().all(|&word| set.matches(word)));
                next = frames.end;
            }
            prop_assert_eq!(next, example.len());
            prop_assert_eq!(query.frames_of(query.positions().len()), None);
        }
    }
}

#[test]
fn a_position_without_length_hides_where_later_ones_lie() {
    let sets = [(1, Some(2)), (2, None), (3, Some(1))];
    let query = Query::from_sets(sets.map(|(word, n)| (Mask::word(word).into(), n)));
    let frames: Vec<_> = (0..3).map(|i| query.frames_of(i)).collect();
    assert_eq!(frames, [Some(0..2), None, None]);
}
