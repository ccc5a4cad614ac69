//! The motion that is looked for.

use relfeat::FeatureSet;

use super::super::{tell_filled, tell_warnings};
use crate::failure::Failure;
use crate::library::Library;
use crate::output::Voice;
use crate::recording::ReadOptions;
use crate::selection;
use crate::source::ClipRef;
use crate::take::Take;
use crate::wire::{ClipWords, take_words};

/// An example in the words of a library, and the same for its left/right mirrored body.
#[derive(Debug)]
pub(super) struct Example {
    pub(super) take: Take,
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
        let set = &library.features.set;
        let asked = selection::select(set, patterns)?;
        let take = Take::load(clip, options)?;
        let words = take_words(&take, 0, set, library.rate)?;
        tell_warnings(voice, words.warnings.iter());
        tell_filled(voice, words.filled);
        let lacking = asked & !words.meta.available;
        if lacking != 0 {
            let message = lacks(set, &words, lacking);
            if !patterns.is_empty() {
                return Err(Failure::input(&clip.path, message));
            }
            voice.note(&format!(
                "{}: {message}; searching without",
                clip.path.display()
            ));
        }
        Ok(Example {
            take,
            clip: words,
            care: asked & !lacking,
        })
    }

    /// The left/right mirrored example, compared on the features of the other sides.
    pub(super) fn mirrored(&self, library: &Library) -> Result<Example, Failure> {
        let set = &library.features.set;
        let take = self.take.mirrored();
        let clip = take_words(&take, 0, set, library.rate)?;
        let care = set.mirrored(self.care);
        let lacking = care & !clip.meta.available;
        if lacking != 0 {
            let message = format!("mirrored, {}", lacks(set, &clip, lacking));
            return Err(Failure::input(&take.clip.path, message));
        }
        Ok(Example { take, clip, care })
    }

    /// The source frames of words of the example.
    pub(super) fn source_span(&self, words: std::ops::Range<usize>, rate: f64) -> [usize; 2] {
        let meta = &self.clip.meta;
        let span = meta.source_span(words, self.clip.words.len(), rate);
        [span.start, span.end]
    }
}

fn lacks(set: &FeatureSet, words: &ClipWords, lacking: u64) -> String {
    let gone = selection::names(set, lacking).join(", ");
    let missing: Vec<&str> = words.missing.iter().map(|p| p.name()).collect();
    format!("its rig has no {}, so it lacks {gone}", missing.join(", "))
}
