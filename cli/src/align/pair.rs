//! From two files to two sequences of comparable poses.

use relfeat::{BodyPoint, FeatureSet};

use super::Side;
use super::pose::{Body, Poses, TooFewPoints, shared_points};
use crate::failure::Failure;
use crate::take::{Take, TakeWords};
use crate::wire::available;

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

impl Take {
    /// Its body, for poses.
    #[must_use]
    pub fn body(&self) -> Body<'_> {
        Body {
            positions: self.positions.view(),
            map: &self.map,
        }
    }
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
        let (words_a, words_b) = (a.words(set, rate)?, b.words(set, rate)?);
        let (size_a, size_b) = (
            a.body().size(&points, &words_a.frames),
            b.body().size(&points, &words_b.frames),
        );
        let (scale_a, scale_b) = match (size_a, size_b) {
            (Some(size_a), Some(size_b)) => {
                let mean = (size_a + size_b) / 2.0;
                (mean / size_a, mean / size_b)
            }
            _ => (1.0, 1.0),
        };
        let posed = |take: &Take, TakeWords { frames, words, .. }: &TakeWords, scale: f32| {
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
            a: posed(a, &words_a, scale_a),
            b: posed(b, &words_b, scale_b),
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
