//! `motif search --explain`: where hits agree with the example, feature by feature.

#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::ops::Range;
use std::path::Path;

use relfeat::FeatureSet;
use segidx::Query;
use serde::Serialize;

use super::asked::Asked;
use super::example::Example;
use super::hits::{HitJson, Matched, SearchResult};
use super::mismatch::list;
use crate::failure::Failure;
use crate::library::{Clip, ClipId, Library};
use crate::output::count;
use crate::picture::agreement::{Cell, Panel, Sheet, agreement_sheet};
use crate::selection::names;

/// Hits that a picture shows at most.
pub const MOST_PANELS: usize = 12;

/// Masked features that the line below a hit names.
const LEAST_NAMED: usize = 3;

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
    fn n_alike(&self, stretch: &Stretch, bit: usize) -> usize {
        let words = self.alike.get(stretch.hit.clone()).unwrap_or_default();
        words.iter().filter(|alike| *alike >> bit & 1 == 1).count()
    }

    /// The features compared at `stretch` that agree all the time, and those that do not.
    fn compared(&self, stretch: &Stretch) -> (u64, u64) {
        let compared = stretch.compared & self.known;
        let words = self.alike.get(stretch.hit.clone()).unwrap_or_default();
        let always = words.iter().fold(u64::MAX, |all, alike| all & alike);
        (compared & always, compared & !always)
    }

    fn cells(&self, bit: usize) -> Vec<Cell> {
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

/// The set bits, the lowest first.
fn bits(bits: u64) -> impl Iterator<Item = usize> {
    (0..u64::BITS as usize).filter(move |bit| bits >> bit & 1 == 1)
}

/// A hit in a line: the compared features that differ and where, and the masked features that are least alike.
fn summary(set: &FeatureSet, agreement: &Agreement) -> String {
    let stretches = || agreement.stretches.iter();
    let compared = stretches().fold(0, |all, s| all | s.compared) & agreement.known;
    let different = stretches().fold(0, |all, s| all | agreement.compared(s).1);
    let n = compared.count_ones() as usize;
    let n_equal = n - different.count_ones() as usize;
    let mut text = match different {
        0 => format!("{} equal", count(n, "feature")),
        _ => format!("{n_equal} of {} equal", count(n, "feature")),
    };
    for bit in bits(different) {
        let numbered = stretches().zip(1..);
        let differs = |s: &Stretch| agreement.compared(s).1 >> bit & 1 == 1;
        let at: Vec<usize> = numbered
            .filter(|(s, _)| differs(s))
            .map(|(_, at)| at)
            .collect();
        let name = &set.features()[bit].name;
        text += &format!(", {name} differs in segment {}", list(&at));
    }
    let shares: Vec<(usize, usize, usize)> = bits(agreement.known)
        .filter_map(|bit| {
            let masked = stretches().filter(|s| s.compared >> bit & 1 == 0);
            let (alike, all) = masked.fold((0, 0), |(alike, all), s| {
                (alike + agreement.n_alike(s, bit), all + s.hit.len())
            });
            (all > 0).then_some((bit, alike, all))
        })
        .collect();
    if shares.is_empty() {
        return text;
    }
    let (alike, all) = shares.iter().fold((0, 0), |(a, b), s| (a + s.1, b + s.2));
    text += &format!("; {} masked, alike {}", shares.len(), percent(alike, all));
    let mut least: Vec<_> = shares
        .into_iter()
        .filter(|(_, alike, all)| alike < all)
        .collect();
    // By share, then by number: those come in order, and the sort is stable.
    least.sort_by(|a, b| (a.1 * b.2).cmp(&(b.1 * a.2)));
    least.truncate(LEAST_NAMED);
    let least = least
        .into_iter()
        .map(|(bit, alike, all)| format!("{} {}", set.features()[bit].name, percent(alike, all)));
    let least: Vec<String> = least.collect();
    if !least.is_empty() {
        text += &format!(", least {}", least.join(", "));
    }
    text
}

/// A share, rounded down, so that only all is 100 %.
fn percent(part: usize, all: usize) -> String {
    format!("{} %", 100 * part / all.max(1))
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
        let span = matched.hit.span();
        let asked = word_ranges(query);
        let positions = query
            .positions()
            .iter()
            .zip(&asked)
            .zip(&matched.hit.segments);
        let stretches = positions.map(|((position, asked), hit)| Stretch {
            query: asked.clone(),
            hit: hit.start - span.start..hit.end - span.start,
            compared: position.set.masks().iter().fold(0, |all, m| all | m.care()) & set.all(),
        });
        let agreement = Agreement::new(
            &example.clip.words,
            words.get(span.clone()).unwrap_or_default(),
            stretches.collect(),
            set.all() & example.clip.meta.available & clip.meta.available,
        );
        let asked = asked
            .iter()
            .map(|words| example.source_span(words.clone(), self.library.rate));
        let frames: Vec<_> = frames.iter().copied().zip(asked).collect();
        Explained::new(set, agreement, &frames)
    }
}

/// Writes the picture of explained hits, [`MOST_PANELS`] at most.
///
/// # Errors
/// [`Failure::Io`].
pub(super) fn write_picture(
    path: &Path,
    library: &Library,
    result: &SearchResult,
) -> Result<(), Failure> {
    let query = &result.query;
    let all = names(&library.features.set, library.features.set.all());
    let explained = result
        .hits
        .iter()
        .filter_map(|hit| Some((hit, hit.explained.as_ref()?)));
    let panels = explained.take(MOST_PANELS).map(|(hit, explained)| Panel {
        captions: captions(hit),
        segments: explained
            .agreement
            .stretches
            .iter()
            .map(|s| s.hit.clone())
            .collect(),
        rows: (0..all.len())
            .map(|bit| explained.agreement.cells(bit))
            .collect(),
    });
    let panels: Vec<Panel> = panels.collect();
    let n_more = result.n_hits - panels.len();
    let mut title = format!(
        "{} frames {}-{}: {}",
        tail(&query.clip),
        query.start,
        query.end,
        count(result.n_hits, "hit")
    );
    if n_more > 0 {
        title += &format!(", {n_more} of them left out");
    }
    let sheet = Sheet {
        title: &title,
        names: &all,
        panels: &panels,
        rate: library.rate,
    };
    let png = agreement_sheet(&sheet).to_png();
    let written = png
        .map_err(std::io::Error::other)
        .and_then(|png| std::fs::write(path, png));
    written.map_err(|e| Failure::io(path, e))
}

fn captions(hit: &HitJson) -> Vec<String> {
    let mut cost = format!("cost {}", hit.cost);
    if let Some(metres) = hit.dtw {
        cost += &format!(", dtw {metres:.3} m");
    }
    if hit.mirrored {
        cost += ", sides exchanged";
    }
    vec![
        format!("{}: {}", hit.rank, tail(&hit.clip)),
        format!(
            "frames {}-{}, {:.2}-{:.2} s",
            hit.start, hit.end, hit.start_s, hit.end_s
        ),
        cost,
    ]
}

/// A path's folder and name.
fn tail(path: &str) -> String {
    let parts: Vec<&str> = path.rsplitn(3, ['/', '\\']).collect();
    parts
        .into_iter()
        .take(2)
        .rev()
        .collect::<Vec<_>>()
        .join("/")
}
