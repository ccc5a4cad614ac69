//! Which features of a hit agree with the query's when.

use std::ops::Range;

use crate::picture::agreement::Cell;

/// A position of a query and its segment of a hit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stretch {
    /// Words of the query.
    pub query: Range<usize>,
    /// Words of the hit, counted from its first one.
    pub hit: Range<usize>,
    /// The features compared.
    pub compared: u64,
}

/// Which features agree when.
///
/// Each word of a segment of the hit is held against the word of the query that is nearest to it in time when both
/// segments are given the same duration: the one that its middle falls into. A feature agrees if its bits are equal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Agreement {
    /// Positions in order; their segments follow each other and begin with the hit.
    pub stretches: Vec<Stretch>,
    /// Per word of the hit the features that agree.
    pub alike: Vec<u64>,
    /// The features that both rigs have; bits of others mean nothing.
    pub known: u64,
}

impl Agreement {
    /// Compares the words of a hit with those of a query. O(words of the hit).
    #[must_use]
    pub fn new(query: &[u64], hit: &[u64], stretches: Vec<Stretch>, known: u64) -> Agreement {
        let mut alike = vec![0; hit.len()];
        for stretch in &stretches {
            let n_words = (stretch.query.len(), stretch.hit.len());
            for (k, at) in stretch.hit.clone().enumerate() {
                let nearest = stretch.query.start + (2 * k + 1) * n_words.0 / (2 * n_words.1);
                if let (Some(asked), Some(found)) = (query.get(nearest), hit.get(at)) {
                    alike[at] = !(asked ^ found);
                }
            }
        }
        Agreement {
            stretches,
            alike,
            known,
        }
    }

    /// The words of a segment in which a feature agrees.
    pub(super) fn n_alike(&self, stretch: &Stretch, bit: usize) -> usize {
        let words = self.alike.get(stretch.hit.clone()).unwrap_or_default();
        words.iter().filter(|alike| *alike >> bit & 1 == 1).count()
    }

    /// The features compared at `stretch` that agree all the time, and those that do not.
    pub(super) fn compared(&self, stretch: &Stretch) -> (u64, u64) {
        let compared = stretch.compared & self.known;
        let words = self.alike.get(stretch.hit.clone()).unwrap_or_default();
        let always = words.iter().fold(u64::MAX, |all, alike| all & alike);
        (compared & always, compared & !always)
    }

    /// How a feature stands in each word of the hit.
    #[must_use]
    pub fn cells(&self, bit: usize) -> Vec<Cell> {
        let cell = |stretch: &Stretch, alike: u64| {
            let is = |bits: u64| bits >> bit & 1 == 1;
            match (is(self.known), is(stretch.compared), is(alike)) {
                (false, _, _) => Cell::Unknown,
                (true, true, true) => Cell::Equal,
                (true, true, false) => Cell::Different,
                (true, false, true) => Cell::Alike,
                (true, false, false) => Cell::Unlike,
            }
        };
        let stretches = self.stretches.iter();
        let words = |stretch: &Stretch| {
            self.alike
                .get(stretch.hit.clone())
                .unwrap_or_default()
                .to_vec()
        };
        stretches
            .flat_map(|stretch| {
                words(stretch)
                    .into_iter()
                    .map(move |alike| cell(stretch, alike))
            })
            .collect()
    }
}
