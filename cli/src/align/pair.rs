//! From two files to two sequences of comparable poses.

use ndarray::Array3;
use relfeat::{BodyMap, BodyPoint, FeatureSet, extract, source_frame};

use super::Side;
use super::pose::{Body, Poses, TooFewPoints, shared_points};
use crate::failure::Failure;
use crate::recording::{Loaded, ReadOptions, body_map, load};
use crate::source::{ClipRef, Span};
use crate::wire::{available, check_span};

/// A clip as it was read.
#[derive(Clone, Debug)]
pub struct Take {
    /// Its file, with its span if one was asked for.
    pub clip: ClipRef,
    /// What the file holds.
    pub loaded: Loaded,
    /// The frames asked for.
    pub span: Span,
    positions: Array3<f32>,
    map: BodyMap,
}

impl Take {
    /// Reads a clip.
    ///
    /// # Errors
    /// [`Failure`]: a file that cannot be read, a skeleton that no rig fits, a span beyond the end.
    pub fn load(clip: &ClipRef, options: &ReadOptions) -> Result<Take, Failure> {
        let loaded = load(&clip.path, options)?;
        Ok(Take {
            span: check_span(clip, loaded.recording.n_frames())?,
            positions: loaded.recording.positions(),
            map: body_map(&clip.path, &loaded.recording, options)?,
            clip: clip.clone(),
            loaded,
        })
    }

    /// Frames per second of the file.
    #[must_use]
    pub fn rate(&self) -> f64 {
        self.loaded.recording.rate().0.hz()
    }

    fn body(&self) -> Body<'_> {
        Body {
            positions: self.positions.view(),
            map: &self.map,
        }
    }

    /// Frames of the span that are nearest to a step of `rate`, and the words there.
    fn words(&self, set: &FeatureSet, rate: f64) -> Result<(Vec<usize>, Vec<u64>), Failure> {
        let words = extract(set, self.positions.view(), &self.map, self.rate(), rate);
        let words = words.map_err(|e| Failure::input(&self.clip.path, e))?.words;
        let frames = (0..words.len()).map(|k| source_frame(k, self.rate(), rate));
        let in_span = frames
            .zip(words)
            .filter(|(frame, _)| self.span.range().contains(frame));
        Ok(in_span.unzip())
    }
}

/// One clip of a pair.
#[derive(Clone, Debug)]
pub struct Posed {
    /// Normalised poses.
    pub poses: Poses,
    /// A feature word per pose.
    pub words: Vec<u64>,
    /// The source frame of each pose.
    pub frames: Vec<usize>,
    /// Frames that have no pose, because the root or half of the body is missing.
    pub left_out: usize,
}

/// Two clips on common ground.
#[derive(Clone, Debug)]
pub struct Pair {
    /// The first clip.
    pub a: Posed,
    /// The second one.
    pub b: Posed,
    /// The body points compared.
    pub points: Vec<BodyPoint>,
    /// Poses per second of both.
    pub rate: f64,
}

impl Pair {
    /// Poses of two clips at `rate`, of the body points that both have, and words of the features that
    /// both have.
    ///
    /// # Errors
    /// [`Failure::Input`] if features cannot be computed; the inner error if the clips have too few body points
    /// in common.
    pub fn new(
        a: &Take,
        b: &Take,
        set: &FeatureSet,
        rate: f64,
    ) -> Result<Result<Pair, TooFewPoints>, Failure> {
        let points = match shared_points(&a.map, &b.map) {
            Ok(points) => points,
            Err(too_few) => return Ok(Err(too_few)),
        };
        let common = available(set, &a.map) & available(set, &b.map);
        let (frames_a, words_a) = a.words(set, rate)?;
        let (frames_b, words_b) = b.words(set, rate)?;
        let (size_a, size_b) = (
            a.body().size(&points, &frames_a),
            b.body().size(&points, &frames_b),
        );
        let (scale_a, scale_b) = match (size_a, size_b) {
            (Some(size_a), Some(size_b)) => {
                let mean = (size_a + size_b) / 2.0;
                (mean / size_a, mean / size_b)
            }
            _ => (1.0, 1.0),
        };
        let posed = |take: &Take, frames: &[usize], words: &[u64], scale: f32| {
            let (poses, kept) = take.body().poses(&points, frames, scale);
            let is_kept = |frame: &usize| kept.binary_search(frame).is_ok();
            let words = frames.iter().zip(words).filter(|(frame, _)| is_kept(frame));
            Posed {
                words: words.map(|(_, word)| word & common).collect(),
                left_out: frames.len() - kept.len(),
                poses,
                frames: kept,
            }
        };
        let pair = Pair {
            a: posed(a, &frames_a, &words_a, scale_a),
            b: posed(b, &frames_b, &words_b, scale_b),
            points,
            rate,
        };
        Ok(Ok(pair))
    }
}

impl Posed {
    /// For [`align`](super::align).
    #[must_use]
    pub fn side(&self) -> Side<'_> {
        Side {
            poses: &self.poses,
            words: &self.words,
        }
    }
}
