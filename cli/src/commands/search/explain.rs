//! `motif search --explain`: where hits agree with the example, feature by feature.

mod agreement;
mod place;
mod sheet;
mod summary;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::ops::Range;

use relfeat::FeatureSet;
use segidx::{Hit, Query};
use serde::Serialize;

pub use self::agreement::{Agreement, Stretch};
pub use self::place::{HitPlace, explain_indexed, explain_take};
pub use self::sheet::MOST_PANELS;
pub(super) use self::sheet::write_picture;
use self::summary::{bits, summary};
use super::asked::Asked;
use super::example::Example;
use super::hits::{HitJson, Matched};
use crate::failure::Failure;
use crate::library::{Clip, ClipId, Library};
use crate::selection::names;

/// Why a hit is one, as JSON a list of its segments.
#[derive(Clone, Debug, Serialize)]
#[serde(transparent)]
pub struct Explained {
    /// Per position of the query.
    pub segments: Vec<SegmentJson>,
    /// In one line.
    #[serde(skip)]
    pub summary: String,
    /// What it comes from.
    #[serde(skip)]
    pub agreement: Agreement,
}

/// A segment of a hit beside the query's.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SegmentJson {
    /// Counted from 1.
    pub segment: usize,
    /// Frames of the hit's file.
    pub frames: [usize; 2],
    /// Frames of the example's file.
    pub query_frames: [usize; 2],
    /// Features compared that are the same as the query's all the time.
    pub equal: Vec<String>,
    /// Features compared that are not.
    pub different: Vec<String>,
    /// Features not compared that both rigs have.
    pub masked: Vec<MaskedJson>,
}

/// A feature that was not compared.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MaskedJson {
    /// Its name.
    pub feature: String,
    /// The share of the segment's words in which it is as in the query, see [`Agreement`].
    pub agreement: f64,
}

impl Explained {
    fn new(
        set: &FeatureSet,
        agreement: Agreement,
        frames: &[([usize; 2], [usize; 2])],
    ) -> Explained {
        let segments = agreement.stretches.iter().zip(frames).zip(1..);
        let segments = segments.map(|((stretch, &(frames, query_frames)), segment)| {
            let (equal, different) = agreement.compared(stretch);
            let masked = bits(agreement.known & !stretch.compared);
            let masked = masked.map(|bit| MaskedJson {
                feature: set.features()[bit].name.clone(),
                agreement: agreement.n_alike(stretch, bit) as f64 / stretch.hit.len().max(1) as f64,
            });
            SegmentJson {
                segment,
                frames,
                query_frames,
                equal: names(set, equal),
                different: names(set, different),
                masked: masked.collect(),
            }
        });
        Explained {
            segments: segments.collect(),
            summary: summary(set, &agreement),
            agreement,
        }
    }
}

/// The words of an example that each position of its query stands for.
pub(super) fn word_ranges(query: &Query) -> Vec<Range<usize>> {
    let positions = query.positions().iter();
    let ranges = positions.scan(0, |start, position| {
        let range = *start..*start + position.n_frames.unwrap_or(0);
        *start = range.end;
        Some(range)
    });
    ranges.collect()
}

/// What hits are explained by.
pub(super) struct Explainer<'a> {
    pub(super) library: &'a Library,
    /// Examples, and whether they are mirrored.
    pub(super) sides: &'a [(Example, bool)],
    /// What each of them asked.
    pub(super) asked: &'a [Asked],
}

impl Explainer<'_> {
    /// Explains hits that are listed. Words come from the library, those of a clip once.
    ///
    /// # Errors
    /// [`Failure::Input`] where the library is damaged.
    pub(super) fn explain<'a>(
        &self,
        listed: impl Iterator<Item = (usize, &'a Clip, &'a Matched)>,
        hits: &mut [HitJson],
    ) -> Result<(), Failure> {
        let mut words: BTreeMap<ClipId, Vec<u64>> = BTreeMap::new();
        for ((_, clip, matched), json) in listed.zip(hits) {
            let words = match words.entry(clip.id) {
                Entry::Occupied(known) => known.into_mut(),
                Entry::Vacant(new) => new.insert(self.library.words(clip.id)?),
            };
            json.explained = Some(self.one(clip, matched, words, &json.segments));
        }
        Ok(())
    }

    fn one(
        &self,
        clip: &Clip,
        matched: &Matched,
        words: &[u64],
        frames: &[[usize; 2]],
    ) -> Explained {
        let set = &self.library.features.set;
        // There are hits of those that were asked.
        let side = self
            .sides
            .iter()
            .position(|side| side.1 == matched.mirrored);
        let side = side.unwrap_or(0);
        let (example, query) = (&self.sides[side].0, self.asked[side].query());
        let agreement = agreement(set, (example, query), clip, (&matched.hit, words));
        let asked = word_ranges(query);
        let asked = asked
            .into_iter()
            .map(|words| example.source_span(words, self.library.rate));
        let frames: Vec<_> = frames.iter().copied().zip(asked).collect();
        Explained::new(set, agreement, &frames)
    }
}

fn agreement(
    set: &FeatureSet,
    (example, query): (&Example, &Query),
    clip: &Clip,
    (hit, words): (&Hit, &[u64]),
) -> Agreement {
    let span = hit.span();
    let positions = query.positions().iter().zip(word_ranges(query));
    let stretches = positions.zip(&hit.segments);
    let stretches = stretches.map(|((position, asked), hit)| Stretch {
        query: asked,
        hit: hit.start - span.start..hit.end - span.start,
        compared: position.set.masks().iter().fold(0, |all, m| all | m.care()) & set.all(),
    });
    Agreement::new(
        &example.clip.words,
        words.get(span.clone()).unwrap_or_default(),
        stretches.collect(),
        set.all() & example.clip.meta.available & clip.meta.available,
    )
}
