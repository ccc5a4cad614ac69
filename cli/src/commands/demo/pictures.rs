//! Pictures of the tour.

use std::fs;
use std::path::Path;

use ndarray::s;

use super::DemoSearch;
use super::corpus::Corpus;
use crate::commands::search::HitJson;
use crate::failure::Failure;
use crate::library::Library;
use crate::picture::Image;
use crate::picture::heatmap::feature_heatmap;
use crate::picture::strip::{StripConfig, contact_sheet, skeleton_strip, strokes, three_quarter};
use crate::recording::{ReadOptions, load};
use crate::selection;
use crate::source::{ClipRef, Span};
use crate::wire::clip_words;

impl Corpus {
    /// For each search the example, its best hit by somebody else, and its best hit in a take.
    pub(super) fn strips(&self, searches: &[DemoSearch]) -> Result<Image, Failure> {
        let mut rows = Vec::new();
        for one in searches {
            let query = &one.search.query;
            let whole = Span {
                start: query.start,
                end: query.end,
            };
            rows.push((
                format!("{} example", one.class),
                strip(Path::new(&query.clip), whole)?,
            ));
            let performer = |clip: &str| Path::new(clip).parent().map(Path::to_owned);
            let is_take = |h: &&HitJson| self.file(&h.clip).is_some_and(|f| f.class.is_none());
            let mut hits = one.search.hits.iter();
            let other = hits.find(|h| performer(&h.clip) != performer(&query.clip) && !is_take(h));
            let take = one.search.hits.iter().find(is_take);
            for hit in other.into_iter().chain(take) {
                let caption = format!("{}, hit {}", self.short(&hit.clip), hit.rank);
                rows.push((caption, strip(Path::new(&hit.clip), near_core(hit))?));
            }
        }
        Ok(contact_sheet(&rows))
    }

    /// The features of the first take.
    pub(super) fn heatmap(&self, library: &Library) -> Result<Image, Failure> {
        let take = self.files.iter().find(|f| f.class.is_none());
        let take = take.ok_or_else(|| Failure::input(&self.dir, "no take"))?;
        let clip = ClipRef {
            path: take.path.clone(),
            span: None,
        };
        let set = &library.features.set;
        let words = clip_words(&clip, &ReadOptions::default(), set, library.rate)?.words;
        Ok(feature_heatmap(
            &selection::names(set, set.all()),
            &words,
            library.rate,
        ))
    }
}

/// A hit with at most a second of its first and last segment: in a long take these reach from the
/// motion before to the motion behind.
fn near_core(hit: &HitJson) -> Span {
    let rate = (hit.end - hit.start) as f64 / (hit.end_s - hit.start_s).max(f64::MIN_POSITIVE);
    let second = rate.round() as usize;
    let first = hit.segments.first().map_or(hit.start, |s| s[1]);
    let last = hit.segments.last().map_or(hit.end, |s| s[0]);
    Span {
        start: hit.start.max(first.saturating_sub(second)),
        end: hit.end.min(last + second),
    }
}

/// Poses of a span, as the readers see the file.
fn strip(path: &Path, span: Span) -> Result<Image, Failure> {
    let recording = load(path, &ReadOptions::default())?.recording;
    let positions = recording.positions();
    let names = recording.names();
    let bones = recording.bones();
    let find = |name: &str| names.iter().position(|n| *n == name).unwrap_or(0);
    let cut = positions.slice(s![span.range(), .., ..]);
    let camera = three_quarter(
        cut,
        find("lfemur"),
        find("rfemur"),
        StripConfig::default().camera,
    );
    let config = StripConfig {
        camera,
        ..StripConfig::default()
    };
    Ok(skeleton_strip(cut, &strokes(&names, &bones), &config))
}

pub(super) fn write_picture(path: &Path, image: &Image) -> Result<(), Failure> {
    let png = image.to_png().map_err(|e| Failure::input(path, e))?;
    fs::write(path, png).map_err(|e| Failure::io(path, e))
}
