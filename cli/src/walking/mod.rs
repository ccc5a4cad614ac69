//! Walks through bundle graphs, made into motions (Beaudoin et al. 2007, section 4; spec.md i.25).

mod contact;
mod footlock;
mod soften;

use std::collections::BTreeMap;
use std::ops::Range;

use bundles::{Piece, Submotion, Walk};
use mocap_io::{BlendError, Motion, blend_along};
use relfeat::BodyMap;

pub use contact::{Contacts, FOOT_POINTS, skate};
pub use footlock::footlock;

/// A clip that walks lead through.
#[derive(Clone, Debug)]
pub struct WalkClip {
    /// The clip, Y up, at the rate of the graph's frames.
    pub motion: Motion,
    /// Which joint is which body point, if that is known.
    pub map: Option<BodyMap>,
    /// The graph's frame of the clip's first pose.
    pub first: usize,
}

/// The clips of a walk, by their index in the graph.
pub type WalkClips = BTreeMap<usize, WalkClip>;

/// Why a walk cannot be played.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlayError {
    /// The graph was made of other clips.
    #[error("the walk leads through frames {}..={} of clip {clip}, which are not there", span.start, span.end)]
    Frames {
        /// Index of the clip.
        clip: usize,
        /// The graph's frames.
        span: Range<usize>,
    },
    /// Two clips cannot be blended or joined.
    #[error("clips {first} and {second} do not go together: {error}")]
    Blend {
        /// Index of the clip before.
        first: usize,
        /// Index of the clip after.
        second: usize,
        /// Why not.
        error: BlendError,
    },
    /// Nothing is played.
    #[error("the walk has no pieces")]
    Empty,
}

impl WalkClip {
    /// Frames of the motion; `None` where the graph's frames are not the clip's.
    fn frames(&self, span: &Range<usize>) -> Option<Range<usize>> {
        let range = span.start.checked_sub(self.first)?..span.end.checked_sub(self.first)? + 1;
        (range.start < range.end && range.end <= self.motion.n_frames()).then_some(range)
    }
}

/// The first and the last submotion of a piece.
#[must_use]
pub fn sides(piece: &Piece) -> (&Submotion, &Submotion) {
    match piece {
        Piece::Plain(submotion) => (submotion, submotion),
        Piece::Blend { entry, exit, .. } => (entry, exit),
    }
}

/// The motion of a walk, at the rate and on the skeleton of its first clip; a frame more than its
/// pieces have together.
///
/// A blend mixes entry and exit as [`blend_along`] does, at the places and with the weights of
/// [`Piece::frame`]: joint rotations along the shortest arc, height, pitch and roll in the facing
/// frame, and steps over the floor added up. Each piece goes on from the place and heading where the
/// one before ends ([`Motion::concatenate`] with the one pose that both have).
///
/// A bundle may be a few frames long, and a blend in it as good as a jump: one that is shorter than 0.3 s
/// is spread by the mean of poses before and after, the more the shorter it is, and a jump over 0.2 s.
///
/// O(channels · frames · log pieces).
///
/// # Errors
/// [`PlayError`] if the clips are not those of the graph, or differ in skeleton or rate.
pub fn play(walk: &Walk, clips: &WalkClips) -> Result<Motion, PlayError> {
    let played = walk.pieces.iter().map(|piece| {
        let (entry, exit) = sides(piece);
        Ok((play_piece(piece, clips)?, entry.clip, exit.clip))
    });
    let mut played: Vec<(Motion, usize, usize)> = played.collect::<Result<_, PlayError>>()?;
    // Joined two by two, so that no frame is copied more often than the logarithm of the pieces.
    while played.len() > 1 {
        let pairs = played.chunks(2).map(|pair| match pair {
            [(a, first, end), (b, start, last)] => {
                let joined = a.concatenate(b, 1).map_err(|error| PlayError::Blend {
                    first: *end,
                    second: *start,
                    error,
                })?;
                Ok((joined, *first, *last))
            }
            rest => Ok(rest[0].clone()),
        });
        played = pairs.collect::<Result<_, PlayError>>()?;
    }
    let (motion, ..) = played.pop().ok_or(PlayError::Empty)?;
    Ok(soften::soften(motion, walk))
}

fn play_piece(piece: &Piece, clips: &WalkClips) -> Result<Motion, PlayError> {
    let cut = |submotion: &Submotion| {
        let Submotion { clip, span } = submotion;
        let cut = clips.get(clip).and_then(|source| {
            let frames = source.frames(span)?;
            source.motion.slice(frames)
        });
        cut.ok_or(PlayError::Frames {
            clip: *clip,
            span: span.clone(),
        })
    };
    let (entry, exit) = sides(piece);
    let first = cut(entry)?;
    if matches!(piece, Piece::Plain(_)) {
        return Ok(first);
    }
    let second = cut(exit)?;
    let frames = (0..=piece.n_frames()).filter_map(|k| piece.frame(k));
    let frames = frames.map(|frame| {
        // Rounding must not lead beyond the ends.
        let place = |at: f64, span: &Range<usize>| (at - span.start as f64).min(span.len() as f64);
        let places = (
            place(frame.entry, &entry.span),
            place(frame.exit, &exit.span),
        );
        (places, frame.weight)
    });
    let (path, weights): (Vec<_>, Vec<_>) = frames.unzip();
    blend_along(&first, &second, &path, &weights).map_err(|error| PlayError::Blend {
        first: entry.clip,
        second: exit.clip,
        error,
    })
}
