//! One query of an example, and a law that its hits obey.

use std::time::Instant;

use anyhow::{Result, ensure};
use segidx::{Hit, Query, search_adaptive};

use crate::indexing::PartIndex;
use crate::judgement::{Judgement, Quality, Stretch};

/// A query of an example by one selection, and its hits in order of rank.
pub(crate) struct Asked {
    pub(crate) stretch: Stretch,
    pub(crate) query: Query,
    pub(crate) hits: Vec<Hit>,
    pub(crate) ms: f64,
    pub(crate) quality: Quality,
}

impl Asked {
    pub(crate) fn ask(
        part: &PartIndex,
        stretch: &Stretch,
        care: u64,
        judged: &[Judgement],
    ) -> Result<Asked> {
        let (words, span) = (&part.words[stretch.doc], stretch.span.clone());
        let query = Query::fuzzy(&words[span.clone()], care);
        let query = query.of_excerpt(&words[..span.start], &words[span.end..]);
        let start = Instant::now();
        let hits = search_adaptive(&part.index, &query)?;
        let ms = start.elapsed().as_secs_f64() * 1e3;
        let stretches: Vec<Stretch> = hits.iter().map(stretch_of).collect();
        let is_itself = |hit: &Stretch| hit.contains(stretch);
        ensure!(
            stretches.iter().any(is_itself),
            "{stretch:?} does not find itself"
        );
        Ok(Asked {
            quality: Quality::of(stretch, &stretches, judged),
            stretch: stretch.clone(),
            query,
            hits,
            ms,
        })
    }
}

pub(crate) fn stretch_of(hit: &Hit) -> Stretch {
    Stretch {
        doc: hit.doc.index(),
        span: hit.span(),
    }
}

/// Every hit by more features lies inside one by fewer, and if the query by fewer still has two
/// positions, no two in the same: where two of its positions meet fixes where those of the other do.
pub(crate) fn check_fewer_find_more(more: &[Asked], fewer: &[Asked]) -> Result<()> {
    for (more, fewer) in more.iter().zip(fewer) {
        let wider: Vec<Stretch> = fewer.hits.iter().map(stretch_of).collect();
        let stretches = more.hits.iter().map(stretch_of);
        let mut homes = stretches.map(|hit| wider.iter().position(|wide| wide.contains(&hit)));
        ensure!(
            homes.all(|home| home.is_some()),
            "{:?}: a hit by more features is lost by fewer",
            more.stretch
        );
        ensure!(
            fewer.query.positions().len() < 2 || more.hits.len() <= fewer.hits.len(),
            "{:?}: fewer features have fewer hits",
            more.stretch
        );
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use segidx::{Index, IndexBuilder};

    use crate::queries::tests::library;

    fn asked(index: &Index, words: &[Vec<u64>], stretch: &Stretch, care: u64) -> Asked {
        let query = Query::fuzzy(&words[stretch.doc][stretch.span.clone()], care);
        Asked {
            stretch: stretch.clone(),
            hits: search_adaptive(index, &query).unwrap(),
            query,
            ms: 0.0,
            quality: Quality {
                ranked: Vec::new(),
                found: (0, 0),
            },
        }
    }

    #[test]
    fn fewer_features_find_all_that_more_do() {
        let words = library(6);
        let mut builder = IndexBuilder::new();
        for words in &words {
            builder.push("", [], words).unwrap();
        }
        let index = builder.build();
        let doc = words.len() - 1;
        let mut n_gained = 0;
        for start in (0..words[doc].len() - 40).step_by(7) {
            let span = start..start + 20 + start % 20;
            let stretch = Stretch { doc, span };
            let by = |care| [asked(&index, &words, &stretch, care)];
            for (more, fewer) in [(0b11, 0b01), (0b11_1100, 0b10_1000), (0b11_1111, 0b1)] {
                let (more, fewer) = (by(more), by(fewer));
                check_fewer_find_more(&more, &fewer).unwrap();
                if more[0].hits.len() < fewer[0].hits.len() {
                    n_gained += 1;
                    check_fewer_find_more(&fewer, &more).unwrap_err();
                }
            }
        }
        assert!(n_gained > 0);
    }
}
