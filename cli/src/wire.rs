//! The only place where one crate's types become another's.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use mocap_io::Warning;
use mtemplate::Preselection;
use relfeat::{BodyMap, BodyPoint, FeatureSet, source_frame};
use segidx::{KeyframeQuery, Mask};
use serde::{Deserialize, Serialize};

use crate::failure::Failure;
use crate::recording::{Files, ReadOptions};
use crate::source::{ClipRef, Span};
use crate::take::Take;

/// What a library keeps of a clip beside its words.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ClipMeta {
    /// Frames per second of the source file.
    pub source_rate: f64,
    /// Frames of the source file.
    pub source_frames: u64,
    /// First source frame of the clip; its words start here.
    pub first_frame: u64,
    /// One past the last source frame of the clip.
    pub end_frame: u64,
    /// First word of the whole file's words that belongs to the clip.
    pub first_word: u64,
    /// Features that the rig lacks no body point for.
    pub available: u64,
    /// The rig that placed the body points.
    pub rig: String,
    /// [`Files::content`] of the clip when it was read.
    pub content: u64,
}

impl ClipMeta {
    /// Source frames of the words `words` of this clip (0-based, end exclusive), such that
    /// neighbouring words have neighbouring frames and the clip's last word ends where the clip ends.
    #[must_use]
    pub fn source_span(&self, words: std::ops::Range<usize>, n_words: usize, rate: f64) -> Span {
        let frame = |word: usize| {
            let whole = word.saturating_add(self.first_word as usize);
            let frame = source_frame(whole, self.source_rate, rate);
            frame.clamp(self.first_frame as usize, self.end_frame as usize)
        };
        let start = match words.start {
            0 => self.first_frame as usize,
            word => frame(word),
        };
        let end = match words.end {
            word if word >= n_words => self.end_frame as usize,
            word => frame(word),
        };
        Span { start, end }
    }
}

/// Time spent per stage.
#[derive(Clone, Copy, Debug, Default)]
pub struct StageTimes {
    /// Reading the file and parsing it.
    pub read: Duration,
    /// Forward kinematics.
    pub kinematics: Duration,
    /// Body map, features and words.
    pub features: Duration,
}

/// The words of a clip and what belongs to them.
#[derive(Clone, Debug)]
pub struct ClipWords {
    /// One word per step of the library rate.
    pub words: Vec<u64>,
    /// The words of the file before these, and after them.
    pub around: [Vec<u64>; 2],
    /// For the library.
    pub meta: ClipMeta,
    /// Body points that the features needed and the rig lacks.
    pub missing: Vec<BodyPoint>,
    /// Gaps of markers that were filled, as asked.
    pub filled: usize,
    /// What was odd.
    pub warnings: Vec<(PathBuf, Warning)>,
    /// Time spent.
    pub times: StageTimes,
}

/// From a file to words.
///
/// # Errors
/// [`Failure`]: a file that cannot be read, a skeleton that no rig fits, a span beyond the end.
pub fn clip_words(
    clip: &ClipRef,
    options: &ReadOptions,
    set: &FeatureSet,
    rate: f64,
) -> Result<ClipWords, Failure> {
    let start = Instant::now();
    let files = Files::read(&clip.path, options)?;
    let read = start.elapsed();
    let mut words = words_of(clip, files, options, set, rate)?;
    words.times.read += read;
    Ok(words)
}

/// From the bytes of a clip to words.
///
/// # Errors
/// As [`clip_words`].
pub fn words_of(
    clip: &ClipRef,
    files: Files,
    options: &ReadOptions,
    set: &FeatureSet,
    rate: f64,
) -> Result<ClipWords, Failure> {
    let content = files.content(options);
    let take = Take::new(clip, files, options)?;
    take_words(&take, content, set, rate)
}

/// From a clip that has been read to words; `content` is that of its files.
///
/// # Errors
/// [`Failure::Input`] if features cannot be computed.
pub fn take_words(
    take: &Take,
    content: u64,
    set: &FeatureSet,
    rate: f64,
) -> Result<ClipWords, Failure> {
    let start = Instant::now();
    let words = take.words(set, rate)?;
    let unavailable = set.unavailable(&take.map);
    let mut missing: Vec<BodyPoint> = unavailable.iter().flat_map(|u| u.missing.clone()).collect();
    missing.sort_unstable();
    missing.dedup();
    let loaded = &take.loaded;
    Ok(ClipWords {
        words: words.words,
        around: [words.before, words.after],
        meta: ClipMeta {
            source_rate: take.rate(),
            source_frames: loaded.recording.n_frames() as u64,
            first_frame: take.span.start as u64,
            end_frame: take.span.end as u64,
            first_word: words.first_word,
            available: available(set, &take.map),
            rig: take.map.rig().to_owned(),
            content,
        },
        missing,
        filled: loaded.filled.len(),
        warnings: loaded.warnings.clone(),
        times: StageTimes {
            features: start.elapsed(),
            ..take.times
        },
    })
}

/// The bits of the features that can be computed with a body map.
#[must_use]
pub fn available(set: &FeatureSet, map: &BodyMap) -> u64 {
    set.unavailable(map)
        .iter()
        .fold(set.all(), |bits, gone| bits & !(1 << gone.feature_idx))
}

/// The clip's span, or all frames.
///
/// # Errors
/// [`Failure::Input`] for a span that reaches beyond the file.
pub fn check_span(clip: &ClipRef, n_frames: usize) -> Result<Span, Failure> {
    match clip.span {
        None => Ok(Span {
            start: 0,
            end: n_frames,
        }),
        Some(span) if span.end <= n_frames => Ok(span),
        Some(span) => Err(Failure::input(
            &clip.path,
            format!(
                "expected a span within 0-{n_frames}, found {}-{}",
                span.start, span.end
            ),
        )),
    }
}

/// Keyframes of a template as a query to an index. The gaps are those of the preselection.
#[must_use]
pub fn keyframe_query(preselection: &Preselection) -> KeyframeQuery {
    let masks = preselection.keyframes().iter();
    let mut masks = masks.map(|keyframe| Mask::new(keyframe.care, keyframe.value));
    // There is one at least; of none, everything would be accepted.
    let first = masks.next().unwrap_or(Mask::new(0, 0));
    let gaps = preselection.gaps().into_iter();
    gaps.zip(masks)
        .fold(KeyframeQuery::new(first), |query, (gap, mask)| {
            query.then(gap, mask)
        })
}
