//! m-mismatch hits on the segmentation by some bits alone.

use proptest::prelude::*;
use segidx::{MismatchQuery, Query, search_adaptive, search_mismatch_with};

use crate::mismatch::{
    Asked, BITS, ENGINES, WORDS, asked, config, index_of, library, mismatch_hits, plain,
};
use crate::naive::{self, Set};

fn restrict(words: &[u64], care: u64) -> Vec<u64> {
    words.iter().map(|word| word & care).collect()
}

/// Restricted runs of the example, as sets of the words that agree on `care`.
fn restricted_sets(words: &[u64], care: u64) -> Vec<(Set, usize)> {
    let runs = naive::segments(&restrict(words, care));
    let set = |word| naive::set_of_mask(care, word, BITS);
    runs.iter()
        .map(|&(word, first, last)| (set(word), last + 1 - first))
        .collect()
}

proptest! {
    #![proptest_config(config(60_000))]

    /// Spec j.2 on documents of restricted words, whatever bits the sets of the query look at.
    #[test]
    fn hits_are_those_of_the_definition_on_restricted_words(
        documents in library(), asked in asked(), care in 0..WORDS,
    ) {
        let Some(query) = asked.mismatch_query() else {
            return Ok(());
        };
        let restricted: Vec<Vec<u64>> = documents.iter().map(|words| restrict(words, care)).collect();
        let expected = mismatch_hits(&restricted, &asked.sets(), &asked);
        let index = index_of(&documents);
        let query = query.restricted_to(care);
        for engine in ENGINES {
            let hits = search_mismatch_with(&index, &query, engine).unwrap().hits;
            prop_assert_eq!(plain(&hits), expected.clone());
            for hit in &hits {
                prop_assert_eq!(index.locate(hit.first_segment), Ok(Some((hit.doc, hit.first_segment_in_doc))));
            }
        }
        // An index of the restricted words gives the same, with segment numbers of its own.
        let coarse = search_mismatch_with(&index_of(&restricted), &query, ENGINES[0]).unwrap().hits;
        prop_assert_eq!(plain(&coarse), expected);
    }

    /// The use it is made for: an example seen through the bits that documents are segmented by.
    #[test]
    fn hits_of_an_example_are_those_of_the_definition(
        documents in library(), asked in asked(), care in 0..WORDS, all_at in any::<bool>(),
    ) {
        let sets = restricted_sets(&asked.words, care);
        let at = asked.at.clone().filter(|_| !all_at);
        let at = at.map(|at| at.into_iter().filter(|&i| i < sets.len()).collect());
        let asked = Asked { at, ..asked };
        let Ok(query) = MismatchQuery::new(Query::fuzzy(&asked.words, care), asked.m) else {
            prop_assert!(asked.m >= sets.len());
            return Ok(());
        };
        let query = match &asked.at {
            None => query,
            Some(at) => query.at(at.iter().copied()).unwrap(),
        };
        let restricted: Vec<Vec<u64>> = documents.iter().map(|words| restrict(words, care)).collect();
        let expected = mismatch_hits(&restricted, &sets, &asked);
        let index = index_of(&documents);
        for engine in ENGINES {
            let hits = search_mismatch_with(&index, &query.clone().restricted_to(care), engine).unwrap().hits;
            prop_assert_eq!(plain(&hits), expected.clone());
        }
    }
}

proptest! {
    #![proptest_config(config(20_000))]

    #[test]
    fn without_mismatches_they_are_the_adaptive_hits(
        documents in library(), asked in asked(), care in 0..WORDS,
    ) {
        let query = Query::fuzzy(&asked.words, care);
        let index = index_of(&documents);
        let adaptive = search_adaptive(&index, &query).unwrap();
        if let Ok(query) = MismatchQuery::new(query, 0) {
            for engine in ENGINES {
                let answer = search_mismatch_with(&index, &query.clone().restricted_to(care), engine);
                prop_assert_eq!(&answer.unwrap().hits, &adaptive);
            }
        }
    }
}
