//! From a shard to the hits of a scene.

use std::ops::Range;

use super::bound::{Extent, bounds};
use super::join::{Found, Join};
use super::{Scene, SceneHit};
use crate::{DocId, Hit, Shard, ShardError, search_adaptive};

/// All hits of a scene: spans of a document for which each line has an adaptive hit there, such that
///
/// - the runs satisfy every relation of the scene;
/// - two lines that no chain of relations connects overlap as in spec j.3: the core of each meets the hull of the
///   other;
/// - the span, the smallest interval that contains all cores, is no longer than the scene allows.
///
/// The core of a line reaches from the last frame of its first run to the first frame of its last one. Against spec
/// j.3, the core of a line of one run is that run, so that no core is empty; unspecified positions belong to the hull
/// but not to the core. Combinations with the same span are one hit, whose lines are those of the first of them: the
/// earliest hit of line 0, then of line 1, and so on. Sorted by `(cost, doc, start)`, the cost being the frames of the
/// span. Relations among lines that are connected already only ever take hits away, as does
/// [`Scene::within`]; a relation between lines that are not takes their overlap's place.
///
/// Cost: one [`search_adaptive`] per line, and per document O(N² · L · B · log N) at worst for N hits of L lines in it
/// and B bounds, two per relation and four per pair of unconnected lines, however many combinations there are. N² is
/// also the most spans a document can have; [`Relation::Within`](super::Relation::Within) or [`Scene::within`] bring
/// it near N.
///
/// ```
/// use segidx::{IndexBuilder, Mask, Progression, Relation, RunRef, Scene, search_scene};
///
/// let mut builder = IndexBuilder::new();
/// //                       bit 0 is on here: vvvv        bit 1 here: vvvv
/// builder.push("clip", [], &[0b00, 0b00, 0b01, 0b01, 0b00, 0b00, 0b10, 0b10, 0b00])?;
/// let index = builder.build();
///
/// let pulse = |bit: u64| {
///     Progression::new([0, bit, 0].map(|value| Some(Mask::new(bit, value).into())))
/// };
/// let [a, b] = [0, 1].map(|line| RunRef { line, position: 1 });
/// let scene = Scene::new(vec![pulse(0b01)?, pulse(0b10)?], vec![Relation::Before(a, b)])?;
/// let hits = search_scene(&index, &scene)?;
/// assert_eq!(hits.len(), 1);
/// assert_eq!(hits[0].cores, [1..5, 5..9]);
/// assert_eq!(hits[0].span, 1..9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
///
/// [`ShardError`] if a page that the search needs is damaged.
pub fn search_scene<B: AsRef<[u8]>>(
    shard: &Shard<B>,
    scene: &Scene,
) -> Result<Vec<SceneHit>, ShardError> {
    let lines = scene.lines().iter().map(|line| {
        let mut hits = search_adaptive(shard, line.query())?;
        hits.sort_unstable_by_key(|hit| (hit.doc, hit.span().start));
        Ok(hits)
    });
    let lines: Vec<Vec<Hit>> = lines.collect::<Result<_, _>>()?;
    let bounds = bounds(scene);
    let numbered = scene.lines().iter().enumerate();
    let cores: Vec<Extent> = numbered
        .map(|(line, progression)| Extent::core(line, progression))
        .collect();
    let mut hits = Vec::new();
    let documents = lines[0].chunk_by(|a, b| a.doc == b.doc);
    for doc in documents.map(|hits| hits[0].doc) {
        let Some(document) = shard.document(doc)? else {
            continue;
        };
        let of_line = scene.lines().iter().zip(&lines).map(|(line, hits)| {
            let hits = &hits[of_document(hits, doc)];
            let runs = hits.iter().map(|hit| line.runs(hit, document.n_frames()));
            runs.collect()
        });
        let join = Join::new(of_line.collect(), &cores, &bounds);
        let found = join.spans();
        hits.extend(found.iter().map(|f| scene_hit(doc, scene, &join, f)));
    }
    hits.sort_unstable_by_key(|hit| (hit.cost(), hit.doc, hit.span.start));
    Ok(hits)
}

fn of_document(hits: &[Hit], doc: DocId) -> Range<usize> {
    hits.partition_point(|hit| hit.doc < doc)..hits.partition_point(|hit| hit.doc <= doc)
}

fn scene_hit(doc: DocId, scene: &Scene, join: &Join<'_>, found: &Found) -> SceneHit {
    let mut cores = Vec::with_capacity(found.hits.len());
    let mut lines = Vec::with_capacity(found.hits.len());
    for (line, (progression, &hit)) in scene.lines().iter().zip(&found.hits).enumerate() {
        let runs = join.runs(line, hit);
        let core = Extent::core(line, progression);
        cores.push(range(core.start.of(runs), core.end.of(runs)));
        let of_position = |position| progression.run_of(position).map(|run| runs[run].clone());
        lines.push(
            (0..progression.n_positions())
                .filter_map(of_position)
                .collect(),
        );
    }
    SceneHit {
        doc,
        span: range(found.span.0, found.span.1),
        cores,
        lines,
    }
}

/// Edges of cores lie inside their document, so neither is negative.
fn range(start: i64, end: i64) -> Range<usize> {
    start as usize..end as usize
}
