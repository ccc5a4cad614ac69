//! A clip as it was read, and where its joints are.

use std::time::Instant;

use ndarray::{Array3, Axis};
use relfeat::{BodyMap, FeatureSet, extract, source_frame};

use crate::failure::Failure;
use crate::recording::{Files, Loaded, ReadOptions, body_map, parse};
use crate::source::{ClipRef, Span};
use crate::wire::{StageTimes, check_span};

/// A clip as it was read.
#[derive(Clone, Debug)]
pub struct Take {
    /// Its file, with its span if one was asked for.
    pub clip: ClipRef,
    /// What the file holds.
    pub loaded: Loaded,
    /// The frames asked for.
    pub span: Span,
    /// Shape `(frames, joints, 3)`, metres, Y up, of the whole file.
    pub positions: Array3<f32>,
    /// Which joint is which body point.
    pub map: BodyMap,
    /// What it took so far.
    pub times: StageTimes,
}

impl Take {
    /// Reads a clip.
    ///
    /// # Errors
    /// [`Failure`]: a file that cannot be read, a skeleton that no rig fits, a span beyond the end.
    pub fn load(clip: &ClipRef, options: &ReadOptions) -> Result<Take, Failure> {
        let start = Instant::now();
        let files = Files::read(&clip.path, options)?;
        let read = start.elapsed();
        let mut take = Take::new(clip, files, options)?;
        take.times.read += read;
        Ok(take)
    }

    /// Makes a clip of the bytes of its files.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn new(clip: &ClipRef, files: Files, options: &ReadOptions) -> Result<Take, Failure> {
        let start = Instant::now();
        let loaded = parse(&clip.path, files, options)?;
        let span = check_span(clip, loaded.recording.n_frames())?;
        let mut times = StageTimes {
            read: start.elapsed(),
            ..StageTimes::default()
        };
        let start = Instant::now();
        let positions = loaded.recording.positions();
        times.kinematics = start.elapsed();
        Ok(Take {
            map: body_map(&clip.path, &loaded.recording, options)?,
            clip: clip.clone(),
            loaded,
            span,
            positions,
            times,
        })
    }

    /// The same motion of the left/right mirrored body.
    #[must_use]
    pub fn mirrored(&self) -> Take {
        let mut mirrored = self.clone();
        mirrored
            .positions
            .index_axis_mut(Axis(2), 0)
            .mapv_inplace(|x| -x);
        mirrored.map = self.map.mirrored();
        mirrored
    }

    /// Frames per second of the file.
    #[must_use]
    pub fn rate(&self) -> f64 {
        self.loaded.recording.rate().0.hz()
    }

    /// Frames of the span that are nearest to a step of `rate`, the number of the first such step, and the words
    /// there.
    ///
    /// # Errors
    /// [`Failure::Input`] if features cannot be computed.
    pub fn words(&self, set: &FeatureSet, rate: f64) -> Result<TakeWords, Failure> {
        let words = extract(set, self.positions.view(), &self.map, self.rate(), rate);
        let words = words.map_err(|e| Failure::input(&self.clip.path, e))?.words;
        let frames: Vec<usize> = (0..words.len())
            .map(|k| source_frame(k, self.rate(), rate))
            .collect();
        // Frames increase, so those of the span follow each other.
        let span = self.span.range();
        let first = frames.partition_point(|&frame| frame < span.start);
        let end = frames.partition_point(|&frame| frame < span.end);
        let steps = first..end.max(first);
        Ok(TakeWords {
            first_word: first as u64,
            frames: frames[steps.clone()].to_vec(),
            words: words[steps.clone()].to_vec(),
            before: words[..steps.start].to_vec(),
            after: words[steps.end..].to_vec(),
        })
    }
}

/// The words of a clip, one per step of a rate.
#[derive(Clone, Debug)]
pub struct TakeWords {
    /// The step of the first word, counted from the start of the file.
    pub first_word: u64,
    /// The source frame of each word.
    pub frames: Vec<usize>,
    /// The words.
    pub words: Vec<u64>,
    /// The words of the file before them.
    pub before: Vec<u64>,
    /// The words of the file after them.
    pub after: Vec<u64>,
}
