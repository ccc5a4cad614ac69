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
        let query = Query::fuzzy(&part.words[stretch.doc][stretch.span.clone()], care);
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
