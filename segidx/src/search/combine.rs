//! Hits of several feature sets at once (spec j.3).

use std::ops::Range;

use crate::{DocId, Hit};

/// A place where a hit of each feature set lies.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct CombinedHit {
    /// The document.
    pub doc: DocId,
    /// Sum of the costs of the hits.
    pub cost: u64,
    /// The smallest interval that contains all cores, or what the hulls share if no hit has a core. In frames of the
    /// document.
    pub span: Range<usize>,
    /// Per feature set the number of its hit, 0-based in the order given.
    pub hits: Vec<usize>,
}

/// Combines the adaptive hits of one query in several feature sets: one hit of each set, in one document, such that the
/// hulls have a frame in common and the core of each meets the hull of every other. [`Hit::core`] and [`Hit::span`] are
/// core and hull; a hit without a core meets everything that its hull does.
///
/// Per set, `hits_of_sets` has the hits of the query coarsened to its features ([`Query::fuzzy`](crate::Query::fuzzy)
/// with their bits), in whatever order. They may come from different shards if documents have the same numbers there.
/// A set of which the query has no feature accepts everything and must be left out. Without sets there are no hits.
/// Sorted by `(cost, doc, start, end, hits)`.
///
/// No hit of the joint query is lost. Let it be found in frames J, one run per position. In the features of one set,
/// neighbouring positions that agree are one run, so that a hit of that set begins in the run that J begins in and ends
/// in the run that J ends in: its hull contains J. It passes from its first to its second run, and to its last, where
/// J does, so its core lies in J. Hence J is in all hulls, and all cores are in J. But a combination needs not be a hit
/// of the joint query, since nothing else is asked of the order of changes in different sets;
/// [`search_adaptive_around`](crate::search_adaptive_around) finds out.
///
/// Cost: O(n log n) for n hits, and for each set O(combinations so far · hits near them).
/// Source: spec j.3; 2005 paper, section 6.1, has no rule.
///
/// ```
/// use segidx::{IndexBuilder, Query, combine, search_adaptive, search_adaptive_around};
///
/// let words = [0b00, 0b01, 0b11, 0b10, 0b00];
/// let shard_of = |set: u64| {
///     let mut builder = IndexBuilder::new();
///     builder.push("clip", [], &words.map(|word| word & set)).map(|()| builder.build())
/// };
/// let found = |set| search_adaptive(&shard_of(set)?, &Query::fuzzy(&words, set)).map_err(Box::<dyn std::error::Error>::from);
/// let (lower, upper) = (found(0b01)?, found(0b10)?);
/// let combined = combine(&[&lower, &upper]);
/// // The lower bit goes on in frame 1 and off in frame 3, the upper one a frame later.
/// assert_eq!(combined[0].span, 0..5);
///
/// let places = combined.into_iter().map(|hit| (hit.doc, hit.span));
/// let query = Query::fuzzy(&words, 0b11);
/// let hits = search_adaptive_around(&shard_of(0b11)?, &query, places)?;
/// assert_eq!(hits[0].segments, [0..1, 1..2, 2..3, 3..4, 4..5]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn combine(hits_of_sets: &[&[Hit]]) -> Vec<CombinedHit> {
    let mut sets = hits_of_sets.iter().map(|hits| Sweep::new(hits));
    let Some(first) = sets.next() else {
        return Vec::new();
    };
    let mut combined: Vec<Combination> = first.hits.iter().map(Combination::of).collect();
    for set in sets {
        combined = combined
            .iter()
            .flat_map(|combination| {
                let near = set.near(combination).iter();
                near.filter_map(|other| combination.with(other))
            })
            .collect();
    }
    let mut found: Vec<CombinedHit> = combined.into_iter().map(Combination::finish).collect();
    found.sort_unstable_by(|a, b| {
        let key = |hit: &CombinedHit| (hit.cost, hit.doc, hit.span.start, hit.span.end);
        key(a).cmp(&key(b)).then_with(|| a.hits.cmp(&b.hits))
    });
    found
}

/// What counts of a hit.
struct Place {
    number: usize,
    doc: DocId,
    cost: u64,
    hull: Range<usize>,
    core: Option<Range<usize>>,
}

/// The hits of one set in order of document and first frame.
struct Sweep {
    hits: Vec<Place>,
    /// Per hit the latest document and end of the hits up to it.
    reach: Vec<(DocId, usize)>,
}

impl Sweep {
    fn new(hits: &[Hit]) -> Sweep {
        let places = hits.iter().enumerate().map(|(number, hit)| Place {
            number,
            doc: hit.doc,
            cost: hit.cost,
            hull: hit.span(),
            core: hit.core(),
        });
        let mut hits: Vec<Place> = places.filter(|place| !place.hull.is_empty()).collect();
        hits.sort_unstable_by_key(|place| (place.doc, place.hull.start, place.number));
        let latest = |reach: &mut Option<(DocId, usize)>, place: &Place| {
            let own = (place.doc, place.hull.end);
            *reach = Some(reach.map_or(own, |reach| reach.max(own)));
            *reach
        };
        let reach = hits.iter().scan(None, latest).collect();
        Sweep { hits, reach }
    }

    /// The hits whose hulls could meet those of a combination, and maybe some more.
    fn near(&self, combination: &Combination) -> &[Place] {
        let Combination { doc, hulls, .. } = combination;
        let first = self
            .reach
            .partition_point(|&reach| reach <= (*doc, hulls.start));
        let end = self
            .hits
            .partition_point(|place| (place.doc, place.hull.start) < (*doc, hulls.end));
        self.hits.get(first..end).unwrap_or_default()
    }
}

/// Hits of the first few sets that go together.
#[derive(Clone)]
struct Combination {
    doc: DocId,
    cost: u64,
    hits: Vec<usize>,
    /// What all hulls share, never empty. An interval meets each of the hulls if it meets this, and so on for cores.
    hulls: Range<usize>,
    /// From the latest start of a core to the earliest end of one, in this order whichever is first.
    cores: Option<(usize, usize)>,
    /// The smallest interval with all cores.
    span: Option<Range<usize>>,
}

impl Combination {
    fn of(place: &Place) -> Combination {
        Combination {
            doc: place.doc,
            cost: place.cost,
            hits: vec![place.number],
            hulls: place.hull.clone(),
            cores: place.core.as_ref().map(|core| (core.start, core.end)),
            span: place.core.clone(),
        }
    }

    /// The combination with one hit more, if they go together.
    fn with(&self, other: &Place) -> Option<Combination> {
        let hull = &other.hull;
        let meets_hulls =
            |place: &Range<usize>| place.start < self.hulls.end && self.hulls.start < place.end;
        let in_doc = other.doc == self.doc && meets_hulls(hull);
        let core_meets = other.core.as_ref().is_none_or(meets_hulls);
        // An interval meets several others if it starts before the first of their ends and ends after the last start.
        let met_by_cores = self
            .cores
            .is_none_or(|(start, end)| hull.start < end && start < hull.end);
        if !(in_doc && core_meets && met_by_cores) {
            return None;
        }
        let core = other.core.clone();
        Some(Combination {
            doc: self.doc,
            cost: self.cost.saturating_add(other.cost),
            hits: [&self.hits[..], &[other.number]].concat(),
            hulls: hull.start.max(self.hulls.start)..hull.end.min(self.hulls.end),
            cores: match (self.cores, &core) {
                (Some((start, end)), Some(core)) => {
                    Some((start.max(core.start), end.min(core.end)))
                }
                (cores, core) => cores.or(core.as_ref().map(|core| (core.start, core.end))),
            },
            span: match (self.span.clone(), core) {
                (Some(span), Some(core)) => {
                    Some(span.start.min(core.start)..span.end.max(core.end))
                }
                (span, core) => span.or(core),
            },
        })
    }

    fn finish(self) -> CombinedHit {
        CombinedHit {
            doc: self.doc,
            cost: self.cost,
            span: self.span.unwrap_or(self.hulls),
            hits: self.hits,
        }
    }
}
