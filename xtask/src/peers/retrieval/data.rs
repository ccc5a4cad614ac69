//! Documents of feature words from the built-in corpus, and queries cut out of them.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result};

use super::super::Fact;
use super::super::dice::Dice;

/// About a million frames.
pub(super) const DOCUMENTS: usize = 8000;
const QUERIES: usize = 1000;
/// Of the feature set the corpus is indexed with.
const FEATURES: f64 = 39.0;
const SEED: u64 = 20_051_122;

/// A word and the number of frames it lasts.
type Segment = [u64; 2];

/// The segments of each document.
pub(super) struct Words(Vec<Vec<Segment>>);

/// Stretches of as many segments each.
pub(super) struct Queries {
    n_segments: usize,
    stretches: Vec<Vec<Segment>>,
}

impl Words {
    /// Reads documents: each its number of frames, then its words.
    pub(super) fn read(path: &Path) -> Result<Words> {
        let bytes = fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
        let (numbers, _) = bytes.as_chunks();
        let mut numbers = numbers.iter().map(|bytes| u64::from_le_bytes(*bytes));
        let mut documents = Vec::new();
        while let Some(n_frames) = numbers.next() {
            let words: Vec<u64> = numbers.by_ref().take(n_frames as usize).collect();
            let runs = words.chunk_by(|a, b| a == b);
            documents.push(runs.map(|run| [run[0], run.len() as u64]).collect());
        }
        Ok(Words(documents))
    }

    /// Writes what [`read`](Self::read) reads.
    pub(super) fn write(&self, path: &Path) -> Result<()> {
        let mut numbers = Vec::new();
        for document in &self.0 {
            numbers.push(document.iter().map(|[_, n_frames]| n_frames).sum());
            for &[word, n_frames] in document {
                numbers.extend(std::iter::repeat_n(word, n_frames as usize));
            }
        }
        write_numbers(path, &numbers)
    }

    /// The same with one feature of each document turned over.
    ///
    /// The corpus repeats its few motions and has few distinct words for its size. With this
    /// 14,000 segments have 9,200 distinct words; 14,000 of HDM05 and CMU have 9,400.
    pub(super) fn turned(&self) -> Words {
        let mut dice = Dice::seeded(SEED);
        let turn = |document: &Vec<Segment>| {
            let feature = 1 << (FEATURES * dice.uniform()) as u32;
            let segments = document.iter();
            segments.map(|&[word, n]| [word ^ feature, n]).collect()
        };
        Words(self.0.iter().map(turn).collect())
    }

    pub(super) fn n_segments(&self) -> usize {
        self.0.iter().map(Vec::len).sum()
    }

    /// Stretches from anywhere, so each of them is found at least once.
    pub(super) fn queries(&self, n_segments: usize) -> Queries {
        let mut dice = Dice::seeded(SEED);
        let stretches: Vec<&[Segment]> = self
            .0
            .iter()
            .flat_map(|document| document.windows(n_segments))
            .collect();
        let draw = |_| stretches[(stretches.len() as f64 * dice.uniform()) as usize].to_vec();
        Queries {
            n_segments,
            stretches: (0..QUERIES).map(draw).collect(),
        }
    }
}

impl Queries {
    pub(super) fn len(&self) -> usize {
        self.stretches.len()
    }

    /// Writes the number of segments of each query, then their words and frames.
    pub(super) fn write(&self, path: &Path) -> Result<()> {
        let segments = self.stretches.iter().flatten().flatten().copied();
        let numbers: Vec<u64> = std::iter::once(self.n_segments as u64)
            .chain(segments)
            .collect();
        write_numbers(path, &numbers)
    }

    /// By looking everywhere: hits, the sum of their documents' numbers and their places there, and
    /// how many documents have hits, all queries together.
    pub(super) fn facts(&self, words: &Words) -> Vec<Fact> {
        let (mut n_hits, mut places, mut n_documents) = (0, 0, 0);
        for stretch in &self.stretches {
            for (number, document) in words.0.iter().enumerate() {
                let same = |(a, b): (&Segment, &Segment)| a[0] == b[0];
                let windows = document.windows(self.n_segments).enumerate();
                let found = windows.filter(|(_, window)| window.iter().zip(stretch).all(same));
                let before = n_hits;
                for (place, _) in found {
                    n_hits += 1;
                    places += number + place;
                }
                n_documents += usize::from(n_hits > before);
            }
        }
        let fact = |key, n: usize| Fact {
            key,
            value: n as f64,
            tolerance: 0.0,
        };
        vec![
            fact("hits", n_hits),
            fact("places", places),
            fact("documents", n_documents),
        ]
    }
}

fn write_numbers(path: &Path, numbers: &[u64]) -> Result<()> {
    let bytes: Vec<u8> = numbers.iter().flat_map(|n| n.to_le_bytes()).collect();
    fs::write(path, bytes).with_context(|| format!("cannot write {}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words() -> Words {
        Words(vec![
            vec![[1, 2], [2, 1], [1, 3], [2, 1], [3, 1]],
            vec![],
            vec![[4, 1], [1, 5], [2, 9]],
        ])
    }

    #[test]
    fn facts_count_hits_places_and_documents() {
        let queries = Queries {
            n_segments: 2,
            stretches: vec![vec![[1, 7], [2, 7]], vec![[4, 1], [1, 1]], vec![[2, 1]; 2]],
        };
        let facts = queries.facts(&words());
        let values: Vec<f64> = facts.iter().map(|fact| fact.value).collect();
        // The first at 0 and 2 of document 0 and at 1 of document 2, the second at 0 of document 2.
        assert_eq!(values, [4.0, 7.0, 3.0]);
    }

    #[test]
    fn documents_are_read_as_they_were_written_and_queries_are_cut_out_of_them() {
        let scratch = tempfile::tempdir().unwrap();
        let path = scratch.path().join("words");
        words().write(&path).unwrap();
        let read = Words::read(&path).unwrap();
        assert_eq!(read.0, words().0);
        let queries = read.queries(3);
        let facts = queries.facts(&read);
        assert!(facts[0].value >= QUERIES as f64, "each query has a hit");
    }

    #[test]
    fn turning_keeps_segments_and_changes_one_feature_of_each_document() {
        for (before, after) in words().0.iter().zip(words().turned().0) {
            let changes: Vec<u64> = before
                .iter()
                .zip(&after)
                .map(|(b, a)| b[0] ^ a[0])
                .collect();
            assert!(changes.iter().all(|change| *change == changes[0]));
            assert!(
                changes
                    .first()
                    .is_none_or(|change| change.count_ones() == 1)
            );
            assert!(before.iter().zip(&after).all(|(b, a)| b[1] == a[1]));
        }
    }
}
