//! The motion that is looked for.

use std::ops::Range;

use relfeat::{FeatureSet, source_frame};

use super::super::{tell_filled, tell_warnings};
use crate::failure::Failure;
use crate::library::{Clip, Library};
use crate::output::Voice;
use crate::recording::ReadOptions;
use crate::selection;
use crate::source::{ClipRef, Span};
use crate::take::Take;
use crate::wire::{ClipMeta, ClipWords, StageTimes, take_words};

/// An example in the words of a library, and the same for its left/right mirrored body.
#[derive(Debug)]
pub(super) struct Example {
    /// Its file, with its span if one was asked for.
    pub(super) source: ClipRef,
    /// What its words were computed from; `None` if they are the library's.
    pub(super) take: Option<Take>,
    pub(super) clip: ClipWords,
    /// The features compared.
    pub(super) care: u64,
}

impl Example {
    /// Reads an example. Without `patterns` it is compared on all features that its rig has.
    pub(super) fn read(
        clip: &ClipRef,
        library: &Library,
        patterns: &[String],
        (options, voice): (&ReadOptions, Voice),
    ) -> Result<Example, Failure> {
        Self::of_take(Take::load(clip, options)?, library, patterns, voice)
    }

    /// An example that has been read.
    pub(super) fn of_take(
        take: Take,
        library: &Library,
        patterns: &[String],
        voice: Voice,
    ) -> Result<Example, Failure> {
        let set = &library.features.set;
        let asked = selection::select(set, patterns)?;
        let source = take.clip.clone();
        let words = take_words(&take, 0, set, library.rate)?;
        tell_warnings(voice, words.warnings.iter());
        tell_filled(voice, words.filled);
        let lacking = asked & !words.meta.available;
        if lacking != 0 {
            let message = lacks(set, &words, lacking);
            if !patterns.is_empty() {
                return Err(Failure::input(&source.path, message));
            }
            voice.note(&format!(
                "{}: {message}; searching without",
                source.path.display()
            ));
        }
        Ok(Example {
            source,
            take: Some(take),
            clip: words,
            care: asked & !lacking,
        })
    }

    /// Source frames of a clip of the library, in the library's own words: no file is read. They are the words that
    /// [`read`](Self::read) gives for these frames of the file; those around them are the clip's.
    pub(super) fn indexed(
        library: &Library,
        clip: &Clip,
        frames: Span,
        patterns: &[String],
    ) -> Result<Example, Failure> {
        let set = &library.features.set;
        let asked = selection::select(set, patterns)?;
        let source = ClipRef::parse(clip.name.as_ref())?;
        let meta = &clip.meta;
        let known = meta.first_frame as usize..meta.end_frame as usize;
        let Span { start, end } = frames;
        if start >= end || start < known.start || end > known.end {
            return Err(Failure::Usage(format!(
                "expected frames within {}-{}, found {start}-{end}",
                known.start, known.end
            )));
        }
        let lacking = asked & !meta.available;
        if lacking != 0 && !patterns.is_empty() {
            let gone = selection::names(set, lacking).join(", ");
            return Err(Failure::Usage(format!("the clip's rig lacks {gone}")));
        }
        let words = library.words(clip.id)?;
        let span = words_within(meta, words.len(), frames, library.rate);
        Ok(Example {
            source: ClipRef {
                span: Some(frames),
                ..source
            },
            take: None,
            clip: ClipWords {
                meta: ClipMeta {
                    first_frame: start as u64,
                    end_frame: end as u64,
                    first_word: meta.first_word + span.start as u64,
                    ..meta.clone()
                },
                around: [words[..span.start].to_vec(), words[span.end..].to_vec()],
                words: words[span].to_vec(),
                missing: Vec::new(),
                filled: 0,
                warnings: Vec::new(),
                times: StageTimes::default(),
            },
            care: asked & !lacking,
        })
    }

    /// The left/right mirrored example, compared on the features of the other sides.
    pub(super) fn mirrored(&self, library: &Library) -> Result<Example, Failure> {
        let set = &library.features.set;
        let take = self.take.as_ref().ok_or_else(|| unread("--mirror"))?;
        let take = take.mirrored();
        let clip = take_words(&take, 0, set, library.rate)?;
        let care = set.mirrored(self.care);
        let lacking = care & !clip.meta.available;
        if lacking != 0 {
            let message = format!("mirrored, {}", lacks(set, &clip, lacking));
            return Err(Failure::input(&take.clip.path, message));
        }
        Ok(Example {
            source: self.source.clone(),
            take: Some(take),
            clip,
            care,
        })
    }

    /// The source frames of words of the example.
    pub(super) fn source_span(&self, words: std::ops::Range<usize>, rate: f64) -> [usize; 2] {
        let meta = &self.clip.meta;
        let span = meta.source_span(words, self.clip.words.len(), rate);
        [span.start, span.end]
    }
}

/// That something needs more than the words of a library.
pub(super) fn unread(what: &str) -> Failure {
    Failure::Usage(format!(
        "{what}: expected an example that is read from its file"
    ))
}

/// The words of a clip that stand for these source frames: those whose frame is one of them.
fn words_within(meta: &ClipMeta, n_words: usize, frames: Span, rate: f64) -> Range<usize> {
    let before = |end: usize| {
        let mut words = 0..n_words;
        let frame =
            |word: usize| source_frame(meta.first_word as usize + word, meta.source_rate, rate);
        // Frames increase with words.
        words.position(|word| frame(word) >= end).unwrap_or(n_words)
    };
    let start = before(frames.start);
    start..before(frames.end).max(start)
}

fn lacks(set: &FeatureSet, words: &ClipWords, lacking: u64) -> String {
    let gone = selection::names(set, lacking).join(", ");
    let missing: Vec<&str> = words.missing.iter().map(|p| p.name()).collect();
    format!("its rig has no {}, so it lacks {gone}", missing.join(", "))
}
