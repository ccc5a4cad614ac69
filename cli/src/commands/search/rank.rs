//! `motif search --rank`: in which order hits are told.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use relfeat::source_frame;

use super::example::{Example, unread};
use super::hits::Matched;
use crate::align::mean_distance;
use crate::align::pose::shared_points;
use crate::failure::{Failure, Skipped};
use crate::library::Clip;
use crate::output::Voice;
use crate::recording::ReadOptions;
use crate::source::ClipRef;
use crate::take::Take;

/// Poses per second that are compared, at most; less where the example or the clip of the hit has less. Motions of
/// people have next to nothing above 10 Hz.
pub const MAX_POSE_RATE: f64 = 30.0;

/// Hits that are refined unless asked otherwise.
pub const DEFAULT_REFINED: usize = 50;

/// What hits are put in order by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Ranking {
    /// The differences of segment lengths (2005 paper, section 6.2).
    #[default]
    Frames,
    /// The best by frames by how near their poses come to the example's, the others after them.
    Dtw {
        /// How many are compared; 0 for all.
        refine: usize,
    },
}

/// Compares hits with the example they are hits of.
pub(super) struct Comparison<'a> {
    /// Examples, and whether they are mirrored.
    pub(super) sides: &'a [(Example, bool)],
    /// Words per second.
    pub(super) word_rate: f64,
    pub(super) options: &'a ReadOptions,
    pub(super) voice: Voice,
}

impl Comparison<'_> {
    /// Compares the poses of the first `n` hits with the example's, all if it is 0, and puts those hits in the order of
    /// what [`mean_distance`] says, equals in the order they had. Hits that cannot be compared follow, then the rest.
    ///
    /// Poses are normalised as `motif align` does it, at [`MAX_POSE_RATE`] at most, and compared from end to end;
    /// the body of the hit is scaled to the example's, so distances are metres on that. A hit of the mirrored
    /// example is compared with the mirrored one. Every file is read once.
    ///
    /// Returns the files that could not be read or compared.
    pub(super) fn refine(&self, hits: &mut [(Arc<Clip>, Matched)], n: usize) -> Vec<Skipped> {
        let n = if n == 0 {
            hits.len()
        } else {
            n.min(hits.len())
        };
        let hits = &mut hits[..n];
        let (files, mut skipped) = by_file(hits);
        let clips: Vec<ClipRef> = files.keys().cloned().collect();
        let (compared, unread) = self.voice.batch(&clips, "comparing", |file| {
            let take = Take::load(file, self.options)?;
            let distance = |&k: &usize| (k, self.distance(&hits[k], &take));
            Ok(files[file].iter().map(distance).collect::<Vec<_>>())
        });
        skipped.extend(unread);
        for (file, distances) in compared {
            for (k, distance) in distances {
                match distance {
                    Ok(distance) => hits[k].1.dtw = Some(distance),
                    Err(failure) => {
                        let one = Skipped::new(&file.path, &failure);
                        if !skipped.contains(&one) {
                            skipped.push(one);
                        }
                    }
                }
            }
        }
        hits.sort_by(|(_, a), (_, b)| match (a.dtw, b.dtw) {
            (Some(a), Some(b)) => a.total_cmp(&b),
            (a, b) => b.is_some().cmp(&a.is_some()),
        });
        let n_left = hits.iter().filter(|(_, hit)| hit.dtw.is_none()).count();
        if n_left > 0 {
            self.voice.note(&format!(
                "{n_left} of the {n} best hits could not be compared; they stand behind the others"
            ));
        }
        skipped
    }

    /// The mean distance along the best path, in metres on the body of the example.
    fn distance(
        &self,
        (clip, matched): &(Arc<Clip>, Matched),
        take: &Take,
    ) -> Result<f64, Failure> {
        let refused = |message: String| Failure::input(&take.clip.path, message);
        let (found, expected) = (take.loaded.recording.n_frames(), clip.meta.source_frames);
        if found as u64 != expected {
            return Err(refused(format!(
                "expected the {expected} frames that were indexed, found {found}"
            )));
        }
        // There are hits of those that were asked.
        let side = self.sides.iter().find(|side| side.1 == matched.mirrored);
        let example = &side.unwrap_or(&self.sides[0]).0;
        let example = example.take.as_ref().ok_or_else(|| unread("--rank dtw"))?;
        let points = shared_points(&example.map, &take.map).map_err(|e| refused(e.to_string()))?;
        let rates = (example.rate(), clip.meta.source_rate);
        let rate = rates.0.min(rates.1).min(MAX_POSE_RATE);
        let span = matched.hit.span();
        let span = clip.meta.source_span(span, clip.n_words, self.word_rate);
        let frames = (
            sampled(example.span.range(), rates.0, rate),
            sampled(span.range(), rates.1, rate),
        );
        let sizes = (
            example.body().size(&points, &frames.0),
            take.body().size(&points, &frames.1),
        );
        let scale = match sizes {
            (Some(example), Some(hit)) => example / hit,
            _ => 1.0,
        };
        let (asked, _) = example.body().poses(&points, &frames.0, 1.0);
        let (found, _) = take.body().poses(&points, &frames.1, scale);
        let distance = mean_distance(&asked, &found, rate).map_err(|e| refused(e.to_string()))?;
        distance.ok_or_else(|| {
            let which = match asked.n_frames() {
                0 => "the example",
                _ => "the hit",
            };
            refused(format!(
                "no frame of {which} has a root and more than half of the body"
            ))
        })
    }
}

/// The hits of each file, whatever spans of it are clips.
fn by_file(hits: &[(Arc<Clip>, Matched)]) -> (BTreeMap<ClipRef, Vec<usize>>, Vec<Skipped>) {
    let mut files: BTreeMap<ClipRef, Vec<usize>> = BTreeMap::new();
    let mut skipped = Vec::new();
    for (k, (clip, _)) in hits.iter().enumerate() {
        match ClipRef::parse(clip.name.as_ref()) {
            Ok(ClipRef { path, .. }) => {
                let file = ClipRef { path, span: None };
                files.entry(file).or_default().push(k);
            }
            Err(failure) => skipped.push(Skipped::new(Path::new(&clip.name), &failure)),
        }
    }
    (files, skipped)
}

/// The frames of `span` that are nearest to the steps of `rate`, the first frame being the first step.
fn sampled(span: Range<usize>, source_rate: f64, rate: f64) -> Vec<usize> {
    let frames = (0..).map(|k| {
        span.start
            .saturating_add(source_frame(k, source_rate, rate))
    });
    frames.take_while(|&frame| frame < span.end).collect()
}
