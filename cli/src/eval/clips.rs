//! Labelled clips as they are matched.

use relfeat::FeatureSet;

use super::baseline::Poses;
use super::folders::{Folders, LabelledFile};
use crate::failure::{Failure, Skipped};
use crate::output::Voice;
use crate::recording::ReadOptions;
use crate::source::ClipRef;
use crate::take::Take;

/// A labelled clip.
#[derive(Clone, Debug)]
pub struct Clip {
    /// Its file.
    pub file: ClipRef,
    /// 0-based index of the class that it shows.
    pub class: usize,
    /// A word for each step of the rate.
    pub words: Vec<u64>,
    /// Frames of the source.
    pub n_frames: usize,
    /// Poses at the words, if baselines are wanted.
    pub poses: Option<Poses>,
}

/// What clips are read for.
#[derive(Clone, Copy, Debug)]
pub struct Reading<'a> {
    /// How files are read.
    pub options: &'a ReadOptions,
    /// The features.
    pub set: &'a FeatureSet,
    /// Words per second.
    pub rate: f64,
    /// Whether poses are kept as well.
    pub poses: PosesKept,
}

/// Whether the poses that baselines compare are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PosesKept {
    /// Words alone.
    No,
    /// Poses as well.
    Yes,
}

/// Reads all clips, in their order; those that cannot be read are left out and listed.
#[must_use]
pub fn read(folders: &Folders, reading: &Reading<'_>, voice: Voice) -> (Vec<Clip>, Vec<Skipped>) {
    let files: Vec<ClipRef> = folders.files.iter().map(|f| f.file.clone()).collect();
    let (done, skipped) = voice.batch(&files, "reading", |file| words_and_poses(file, reading));
    // Both are in the order of the files.
    let mut labelled = folders.files.iter();
    let clips = done.into_iter().filter_map(|(file, clip)| {
        let LabelledFile { class, .. } = labelled.find(|one| one.file == file)?;
        let class = *class;
        Some(Clip { class, ..clip })
    });
    (clips.collect(), skipped)
}

fn words_and_poses(file: &ClipRef, reading: &Reading<'_>) -> Result<Clip, Failure> {
    let take = Take::load(file, reading.options)?;
    let words = take.words(reading.set, reading.rate)?;
    if words.words.is_empty() {
        return Err(Failure::input(&file.path, "the clip has no frames"));
    }
    let poses = match reading.poses {
        PosesKept::No => None,
        PosesKept::Yes => Some(Poses::of(&take, &words.frames)),
    };
    Ok(Clip {
        file: file.clone(),
        class: 0,
        words: words.words,
        n_frames: take.span.range().len(),
        poses,
    })
}
