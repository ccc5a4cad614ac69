//! The random queries of Table 3.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use segidx::{Query, Segment};

use crate::naive::coarsen;

/// What counts as the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mode {
    /// All features.
    Exact,
    /// All but [`FREE`] features, under adaptive segmentation.
    Fuzzy,
}

/// Features left free in a fuzzy query, so that each of its sets has 2^6 = 64 words, as in the paper.
const FREE: usize = 6;

/// Draws of free features before an index is taken to have no query of the length.
const ATTEMPTS: usize = 1000;

/// An excerpt of the index.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Excerpt {
    /// The features compared.
    pub(crate) care: u64,
    /// One per query position, each a maximal run of frames that agree on `care`.
    pub(crate) segments: Vec<Segment>,
}

impl Excerpt {
    /// The excerpt as a query by example, frame by frame.
    pub(crate) fn query(&self) -> Query {
        let frames = self.segments.iter();
        let words: Vec<u64> = frames
            .flat_map(|segment| std::iter::repeat_n(segment.word, segment.len))
            .collect();
        Query::fuzzy(&words, self.care)
    }
}

/// Seeded draws.
pub(crate) struct Dice(ChaCha8Rng);

impl Dice {
    pub(crate) fn seeded(seed: u64) -> Dice {
        Dice(ChaCha8Rng::seed_from_u64(seed))
    }

    /// Of `0..n`; the bias is below n / 2^64.
    fn below(&mut self, n: usize) -> usize {
        ((u128::from(self.0.next_u64()) * n as u128) >> u64::BITS) as usize
    }

    /// All but `n_free` of `n_features` bits; every choice is as likely.
    fn care(&mut self, n_features: usize, n_free: usize) -> u64 {
        let mut features: Vec<usize> = (0..n_features).collect();
        for _ in 0..n_free.min(n_features) {
            features.swap_remove(self.below(features.len()));
        }
        features.into_iter().fold(0, |bits, i| bits | 1 << i)
    }

    /// An excerpt of `n_positions` consecutive segments of one document, so a search for it has at
    /// least one hit. All excerpts of the length are as likely.
    ///
    /// A fuzzy one first draws which features are free; the segments are then those of the features
    /// that are left, and the draw is repeated if no document has as many. `None` if none ever has.
    pub(crate) fn excerpt(
        &mut self,
        documents: &[Vec<Segment>],
        n_features: usize,
        (mode, n_positions): (Mode, usize),
    ) -> Option<Excerpt> {
        for _ in 0..ATTEMPTS {
            let care = match mode {
                Mode::Exact => u64::MAX,
                Mode::Fuzzy => self.care(n_features, FREE),
            };
            let documents: Vec<Vec<Segment>> = documents.iter().map(|d| coarsen(d, care)).collect();
            let windows = || documents.iter().flat_map(|d| d.windows(n_positions));
            let n_windows = windows().count();
            if n_windows > 0 {
                let segments = windows().nth(self.below(n_windows))?.to_vec();
                return Some(Excerpt { care, segments });
            }
        }
        None
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use segidx::{IndexBuilder, search_adaptive, search_exact, segment};

    use crate::naive::scan;

    /// Words of a few features that change one at a time.
    pub(crate) fn library(n_features: u32) -> Vec<Vec<u64>> {
        let mut dice = Dice::seeded(1);
        let document = |n: usize| {
            let mut word = 0;
            let frame = |_| {
                if dice.below(3) == 0 {
                    word ^= 1 << dice.below(n_features as usize);
                }
                word
            };
            (0..n).map(frame).collect()
        };
        [0, 1, 40, 200].map(document).to_vec()
    }

    #[test]
    fn excerpts_have_the_length_and_are_found_as_the_scan_finds_them() {
        let n_features = 8;
        let words = library(n_features);
        let mut builder = IndexBuilder::new();
        for words in &words {
            builder.push("", [], words).unwrap();
        }
        let index = builder.build();
        let documents: Vec<Vec<Segment>> = words.iter().map(|w| segment(w)).collect();
        let mut dice = Dice::seeded(2);
        for mode in [Mode::Exact, Mode::Fuzzy] {
            for n in [1, 2, 5, 9] {
                let excerpt = dice
                    .excerpt(&documents, n_features as usize, (mode, n))
                    .unwrap();
                let query = excerpt.query();
                assert_eq!(query.positions().len(), n);
                let hits = match mode {
                    Mode::Exact => search_exact(&index, &query).unwrap(),
                    Mode::Fuzzy => search_adaptive(&index, &query).unwrap(),
                };
                let places = scan(&documents, &excerpt.segments, excerpt.care);
                assert_eq!(hits.len(), places.len());
                assert!(hits.iter().zip(&places).all(|(hit, place)| {
                    (hit.cost, hit.doc, &hit.segments) == (place.cost, place.doc, &place.segments)
                }));
                assert_eq!(hits[0].cost, 0);
            }
        }
    }

    #[test]
    fn fuzzy_sets_have_64_words() {
        let mut dice = Dice::seeded(3);
        for _ in 0..100 {
            let care = dice.care(12, FREE);
            assert_eq!((0..1u64 << 12).filter(|word| word & care == 0).count(), 64);
        }
        assert_eq!(dice.care(4, FREE), 0);
    }

    #[test]
    fn every_excerpt_is_drawn() {
        let documents = [segment(&[1, 2, 3]), segment(&[4]), segment(&[5, 6])];
        let mut dice = Dice::seeded(4);
        let mut first: Vec<u64> = (0..200)
            .filter_map(|_| dice.excerpt(&documents, 3, (Mode::Exact, 2)))
            .map(|excerpt| excerpt.segments[0].word)
            .collect();
        first.sort_unstable();
        first.dedup();
        assert_eq!(first, [1, 2, 5]);
    }

    #[test]
    fn there_is_no_excerpt_longer_than_every_document() {
        let documents = [segment(&[1, 2, 3])];
        for mode in [Mode::Exact, Mode::Fuzzy] {
            assert_eq!(Dice::seeded(5).excerpt(&documents, 8, (mode, 4)), None);
        }
    }
}
