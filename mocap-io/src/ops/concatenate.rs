use ndarray::{Axis, concatenate, s};

use super::blend::{BlendError, check, comparable, mix_frames, smoothstep};
use super::root::Facing;
use crate::Motion;

impl Motion {
    /// The frames of this motion, then those of `next` where they are. Nothing is moved: what
    /// [`Motion::slice`] cut apart fits together again to the bit. O(frames · channels).
    ///
    /// The result has the skeleton of this motion; if offsets differ its roots are those of
    /// [`Motion::with_free_roots`].
    ///
    /// # Errors
    /// [`BlendError`] if skeletons or rates differ.
    pub fn append(&self, next: &Motion) -> Result<Motion, BlendError> {
        check(self, next)?;
        let in_unit = next.in_unit(self.unit);
        let (first, next) = if self.skeleton == in_unit.skeleton {
            (self.clone(), in_unit)
        } else {
            comparable(self, next)?
        };
        let channels = concatenate(Axis(0), &[first.dense().view(), next.dense().view()])
            .expect("both have the channels of one skeleton");
        Ok(Motion { channels, ..first })
    }

    /// This motion, and `next` moved on the floor so that it goes on where this one ends, the last `overlap`
    /// frames faded into the first ones of `next`. The result has `overlap` frames less than both together.
    ///
    /// With an overlap, place and heading of the two agree in its middle: in frame `overlap / 2` of it, or
    /// the nearest one that has a heading in both. The fade follows a smoothstep; its frames
    /// mix roots and joints like [`Motion::sampled`] does. Without one, the step across the join
    /// is the mean of the last step before and the first one after it, so that a walk does not stop for a
    /// frame; [`Motion::append`] joins without moving. Frames before the overlap stay to the bit, and frames
    /// after it keep their shape and their height.
    ///
    /// The result has the skeleton of this motion, with roots that can be moved
    /// ([`Motion::with_free_roots`]). O(frames · channels).
    ///
    /// # Errors
    /// [`BlendError`] if skeletons or rates differ, if more frames overlap than a motion has, or where
    /// neither motion shows how to meet the other.
    pub fn concatenate(&self, next: &Motion, overlap: usize) -> Result<Motion, BlendError> {
        let (first, next) = comparable(self, next)?;
        let (n_first, n_next) = (first.n_frames(), next.n_frames());
        let longest = n_first.min(n_next);
        if overlap > longest {
            return Err(BlendError::Overlap { longest, overlap });
        }
        let by = match (longest, overlap) {
            (0, _) => Facing::default(),
            (_, 0) => step_across(&first, &next).ok_or(BlendError::NoHeading)?,
            _ => meet(&first, &next, overlap).ok_or(BlendError::NoHeading)?,
        };
        let next = next.shifted(by);
        let (whole, moved) = (first.dense(), next.dense());
        let weight = |i: usize| smoothstep((i + 1) as f64 / (overlap + 1) as f64);
        let weights: Vec<f64> = (0..overlap).map(weight).collect();
        let join = n_first - overlap;
        let ends = whole.slice(s![join.., ..]).to_owned();
        let starts = moved.slice(s![..overlap, ..]).to_owned();
        let faded = mix_frames(&first, &ends, &starts, &weights);
        let before = whole.slice(s![..join, ..]);
        let after = moved.slice(s![overlap.., ..]);
        let channels = concatenate(Axis(0), &[before, faded.view(), after])
            .expect("all have the channels of one skeleton");
        Ok(Motion {
            channels,
            ..first.without_frames()
        })
    }
}

/// The motion that lets both agree as near as possible to the middle of the overlap.
fn meet(first: &Motion, next: &Motion, overlap: usize) -> Option<Facing> {
    let start = first.n_frames() - overlap;
    let mut frames: Vec<usize> = (0..overlap).collect();
    frames.sort_by_key(|&i| i.abs_diff(overlap / 2));
    frames.into_iter().find_map(|i| {
        let (there, here) = (first.facing(start + i)?, next.facing(i)?);
        Some(there.then(here.inverse()))
    })
}

/// The motion that makes the step across the join the mean of the steps around it.
fn step_across(first: &Motion, next: &Motion) -> Option<Facing> {
    let last = first.n_frames() - 1;
    let (end, start) = (first.facing(last)?, next.facing(0)?);
    let before = last.checked_sub(1).and_then(|i| first.facing(i));
    let step_before = before.map(|before| end.step_from(before));
    let step_after = next.facing(1).map(|after| after.step_from(start));
    let step = match (step_before, step_after) {
        (Some(before), Some(after)) => before.mix(after, 0.5),
        (before, after) => before.or(after).unwrap_or_default(),
    };
    Some(end.then(step).then(start.inverse()))
}
