//! What an example asks of a library, and which of its indexes answer.
//!
//! A library has an index of all features and one for each part of its feature set (2005 paper, section
//! 6.1). An adaptive query that compares features of one part has the same hits in the index of that
//! part, which is smaller. One that goes across parts is put to the indexes of the parts it has changes
//! in; where their hits go together (spec j.3), the index of all features is asked. It gets the query
//! at once where that is expected to cost less. So the hits are the same whichever are searched.

use std::path::Path;

use memmap2::Mmap;
use segidx::{
    Answer, Engine, EngineCosts, Hit, Index, IndexBuilder, MismatchQuery, Query, Shard, ShardError,
    combine, estimate_adaptive, search_adaptive_around, search_adaptive_with, search_exact_with,
    search_mismatch_with,
};

use super::What;
use super::example::Example;
use super::plan::PlanStep;
use super::segments::Changes;
use crate::args::{IndexArg, Mode};
use crate::failure::Failure;
use crate::library::{Clip, Gathered, Library, OpenPart, OpenShard};

/// A query, and what counts as a hit.
#[derive(Debug)]
pub(super) struct Asked {
    form: Form,
    /// The query with the lengths of the example, which may be cut out of longer runs.
    shown: Query,
    /// The features that any segment is compared on.
    pub(super) care: u64,
    /// The same query, coarsened to the features of each part, for an adaptive query that compares the
    /// same features everywhere. In the order of the parts; `None` where it has no change.
    of_parts: Vec<(u64, Query)>,
    indexes: IndexArg,
    engine: Engine,
}

#[derive(Debug)]
enum Form {
    /// A segment of all features per position.
    Exact(Query),
    /// A run of segments per position.
    Adaptive(Query),
    /// A segment per position, but for some.
    Mismatch(MismatchQuery),
}

/// Checking one place against all features, in units of one segment read in order.
const VERIFY_COST: u64 = 64;

/// The hits of a shard, and how they were found.
type Found = (Vec<Hit>, Vec<PlanStep>);

/// The words of a clip, and an index of it alone.
pub(super) fn index_of(library: &Library, clip: &Clip) -> Result<(Vec<u64>, Index), Failure> {
    let words = library.words(clip.id)?;
    let mut builder = IndexBuilder::new();
    let pushed = builder.push(clip.name.as_str(), [], &words);
    pushed.map_err(|e| Failure::input(Path::new(&clip.name), e))?;
    Ok((words, builder.build()))
}

impl Asked {
    pub(super) fn new(
        example: &Example,
        what: &What<'_>,
        changes: &Changes,
        library: &Library,
    ) -> Result<Asked, Failure> {
        let words = &example.clip.words;
        let query = match what.mode {
            Mode::Exact => Query::exact(words, example.care),
            Mode::Fuzzy | Mode::Adaptive => Query::fuzzy(words, example.care),
        };
        let query = changes.apply(&query, example)?;
        let query = match (what.mismatches, what.mode) {
            (None, Mode::Adaptive) => query.conjoined().into_owned(),
            _ => query,
        };
        let shown = query.clone();
        let [before, after] = &example.clip.around;
        let query = query.of_excerpt(before, after);
        let form = match (what.mismatches, what.mode) {
            (Some(mismatches), mode) => {
                let tolerant = mismatches.of(&query)?;
                Form::Mismatch(match mode {
                    Mode::Adaptive => tolerant.restricted_to(changes.care(example.care)),
                    Mode::Exact | Mode::Fuzzy => tolerant,
                })
            }
            (None, Mode::Exact | Mode::Fuzzy) => Form::Exact(query),
            (None, Mode::Adaptive) => Form::Adaptive(query),
        };
        let mut of_parts = Vec::new();
        if changes.is_empty() && matches!(form, Form::Adaptive(_)) {
            for (_, bits) in library.parts() {
                let coarse = Query::fuzzy(words, example.care & bits);
                if coarse.positions().len() > 1 {
                    of_parts.push((bits, coarse));
                }
            }
        }
        Ok(Asked {
            form,
            shown,
            care: changes.care(example.care),
            of_parts,
            indexes: what.indexes,
            engine: what.engine,
        })
    }

    /// What is asked for, with the lengths that the example has.
    pub(super) fn query(&self) -> &Query {
        &self.shown
    }

    /// The hits of all clips that count.
    pub(super) fn find(&self, library: &Library) -> Result<Gathered<Hit, PlanStep>, Failure> {
        let (hits, plans) = library.search_each(|open| self.find_in(open))?;
        Ok((hits, plans.into_iter().flatten().collect()))
    }

    fn find_in(&self, open: &OpenShard) -> Result<Found, Failure> {
        if let Form::Adaptive(query) = &self.form {
            let parts = self.parts_to_search(open, query)?;
            if !parts.is_empty() {
                return self.find_in_parts(open, query, &parts);
            }
        }
        let (path, shard) = self.index_in(open);
        let answer = self.ask(shard).map_err(|e| Failure::input(path, e))?;
        let step = PlanStep::new(path, &answer);
        Ok((answer.hits, vec![step]))
    }

    fn ask<B: AsRef<[u8]>>(&self, shard: &Shard<B>) -> Result<Answer, ShardError> {
        match &self.form {
            Form::Exact(query) => search_exact_with(shard, query, self.engine),
            Form::Mismatch(query) => search_mismatch_with(shard, query, self.engine),
            Form::Adaptive(query) => search_adaptive_with(shard, query, self.engine),
        }
    }

    /// The words of a clip and the hits in it, best first: those that [`find`](Self::find) has there.
    pub(super) fn find_in_clip(
        &self,
        library: &Library,
        clip: &Clip,
    ) -> Result<(Vec<u64>, Vec<Hit>), Failure> {
        let (words, index) = index_of(library, clip)?;
        let answer = self.ask(&index);
        let answer = answer.map_err(|e| Failure::input(Path::new(&clip.name), e))?;
        Ok((words, answer.hits))
    }

    /// The index of a part that has all features of the query, if the query is one of runs of segments;
    /// else that of all features.
    fn index_in<'s>(&self, open: &'s OpenShard) -> (&'s Path, &'s Shard<Mmap>) {
        let is_of_runs = match &self.form {
            Form::Exact(_) => false,
            Form::Adaptive(_) => true,
            Form::Mismatch(query) => query.care() != u64::MAX,
        };
        if is_of_runs && self.indexes != IndexArg::Joint {
            return open.index_for(self.care);
        }
        (&open.path, &open.shard)
    }

    /// The parts to put a query to that goes across parts; none if the index of all features is to be
    /// searched.
    fn parts_to_search<'s>(
        &'s self,
        open: &'s OpenShard,
        query: &Query,
    ) -> Result<Vec<(&'s OpenPart, &'s Query)>, Failure> {
        if self.indexes == IndexArg::Joint || open.part_for(self.care).is_some() {
            return Ok(Vec::new());
        }
        let part_of = |bits: &u64| open.parts.iter().find(|part| part.entry.bits == *bits);
        let parts = self.of_parts.iter();
        let parts: Vec<_> = parts
            .filter_map(|(bits, coarse)| Some((part_of(bits)?, coarse)))
            .collect();
        if self.indexes == IndexArg::Parts || parts.is_empty() {
            return Ok(parts);
        }
        let cost = |path, estimate: Result<EngineCosts, ShardError>| {
            estimate
                .map(|costs| costs.least())
                .map_err(|e| Failure::input(path, e))
        };
        let joint = cost(&open.path, estimate_adaptive(&open.shard, query))?;
        let mut in_parts = 0;
        for (part, coarse) in &parts {
            in_parts += cost(&part.path, estimate_adaptive(&part.shard, coarse))?;
        }
        Ok(if in_parts + VERIFY_COST < joint {
            parts
        } else {
            Vec::new()
        })
    }

    fn find_in_parts(
        &self,
        open: &OpenShard,
        query: &Query,
        parts: &[(&OpenPart, &Query)],
    ) -> Result<Found, Failure> {
        let mut steps = Vec::new();
        let mut hits = Vec::new();
        for (part, coarse) in parts {
            let answer = search_adaptive_with(&part.shard, coarse, self.engine)
                .map_err(|e| Failure::input(&part.path, e))?;
            steps.push(PlanStep::new(&part.path, &answer));
            hits.push(answer.hits);
        }
        let hits: Vec<&[Hit]> = hits.iter().map(Vec::as_slice).collect();
        let places: Vec<_> = combine(&hits)
            .into_iter()
            .map(|hit| (hit.doc, hit.span))
            .collect();
        let n_places = places.len();
        let found = search_adaptive_around(&open.shard, query, places)
            .map_err(|e| Failure::input(&open.path, e))?;
        steps.push(PlanStep::verified(&open.path, n_places, found.len()));
        Ok((found, steps))
    }
}
