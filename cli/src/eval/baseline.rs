//! What templates are compared with: a single example, as feature matrix, as quaternions, as coordinates
//! (Table 4 of the 2006 paper).
//!
//! The example is the first training clip of the class. All three are matched with the steps and weights
//! of templates, (1,1), (1,2), (2,1) of weights 1, 1, 2, and costs are means over the example's frames; hits
//! are chosen alike.

use dtw::{Dtw, DtwError, Ends, StepPattern};
use mtemplate::{MotionTemplate, ShortClips, TemplateError};
use ndarray::{Array2, ArrayView1, ArrayView2, Axis, concatenate, s};
use rayon::prelude::*;
use serde::Serialize;

use super::clips::Clip;
use super::hits::Response;
use super::{Documents, Trial, responses};
use crate::failure::Failure;

mod poses;

pub use poses::{Named, Poses};

/// A way to match a single example.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Baseline {
    /// Its relational feature matrix, by the share of features that differ.
    #[serde(rename = "RF")]
    Features,
    /// Unit quaternions of all joints but the root, within their parents; the mean over joints of the
    /// angle between them on the sphere, in radians.
    Q,
    /// Coordinates of the body points seen from the root, turned with the root and scaled to one body
    /// size; Euclidean distance of the whole pose.
    #[serde(rename = "3D")]
    Coordinates,
}

impl Baseline {
    /// In the order of Table 4.
    pub const ALL: [Baseline; 3] = [Baseline::Features, Baseline::Q, Baseline::Coordinates];

    /// The paper's name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Baseline::Features => "RF",
            Baseline::Q => "Q",
            Baseline::Coordinates => "3D",
        }
    }
}

/// How the test clips answer the first training clip of a class. `None` if there is none, or if it has no
/// poses of the kind (markers have no joints that turn). A test clip without them does not answer.
///
/// # Errors
/// [`Failure`] if the words of the clip are not of the trial's features.
pub fn match_example(
    trial: &Trial<'_>,
    class: usize,
    baseline: Baseline,
    documents: Documents,
) -> Result<Option<Vec<Response>>, Failure> {
    let Some(example) = trial.training(class).next() else {
        return Ok(None);
    };
    let of_clip = |e: TemplateError| Failure::input(&example.file.path, e);
    if baseline == Baseline::Features {
        let template = MotionTemplate::from_words(&example.words, trial.n_features);
        // All values are 0 or 1, whatever the threshold.
        let quantized = template.and_then(|t| t.quantize(0.0)).map_err(of_clip)?;
        let quantized = quantized.with_short_clips(documents.short_clips());
        return Ok(Some(responses(&quantized, trial, documents)));
    }
    let Some(query) = poses_of(example, baseline) else {
        return Ok(None);
    };
    let tests = trial.tests();
    let costs = |clip: &Clip| {
        poses_of(clip, baseline).and_then(|poses| local_costs(query, poses, baseline))
    };
    let of_class = |e| Failure::Usage(format!("{}: {e}", trial.classes[class]));
    let responses = match documents {
        Documents::Apart(short_clips) => {
            let apart = tests.par_iter().map(|clip| {
                let respond = |costs: Array2<f64>| respond(costs.view(), short_clips);
                costs(clip).map_or(Ok(Response::default()), respond)
            });
            apart.collect()
        }
        Documents::Joined => {
            // No number: what lacks poses is aligned with nothing.
            let none =
                |clip: &Clip| Array2::from_elem((query.values.nrows(), clip.words.len()), f64::NAN);
            let each = tests
                .par_iter()
                .map(|clip| costs(clip).unwrap_or_else(|| none(clip)));
            respond_joined(&each.collect::<Vec<_>>())
        }
    };
    responses.map(Some).map_err(of_class)
}

fn poses_of(clip: &Clip, baseline: Baseline) -> Option<&Named> {
    let poses = clip.poses.as_ref()?;
    match baseline {
        Baseline::Features => None,
        Baseline::Q => poses.rotations.as_ref(),
        Baseline::Coordinates => poses.coordinates.as_ref(),
    }
}

/// Of each pair of frames, over what both have; `None` if that is nothing.
fn local_costs(query: &Named, clip: &Named, baseline: Baseline) -> Option<Array2<f64>> {
    let (query, clip) = query.common(clip)?;
    let cost = match baseline {
        Baseline::Q => mean_angle,
        Baseline::Features | Baseline::Coordinates => distance,
    };
    let shape = (query.nrows(), clip.nrows());
    let between = |(i, j)| cost(query.row(i), clip.row(j));
    Some(Array2::from_shape_fn(shape, between))
}

/// The mean over quaternions of the angle between them on the sphere, where a quaternion and its opposite
/// are one point.
fn mean_angle(a: ArrayView1<'_, f64>, b: ArrayView1<'_, f64>) -> f64 {
    let n = a.len() / 4;
    let dot = |k: usize| (4 * k..4 * k + 4).map(|i| a[i] * b[i]).sum::<f64>();
    let angles = (0..n).map(|k| dot(k).abs().min(1.0).acos());
    angles.sum::<f64>() / n as f64
}

fn distance(a: ArrayView1<'_, f64>, b: ArrayView1<'_, f64>) -> f64 {
    let squares = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b));
    squares.sum::<f64>().sqrt()
}

/// How a clip answers an example, by the local costs of their frames. A cost that is no number
/// closes its pair of frames. A short clip is held as [`ShortClips::Held`] says.
fn respond(costs: ArrayView2<'_, f64>, short_clips: ShortClips) -> Result<Response, DtwError> {
    let (n, m) = costs.dim();
    let missing = (n / 2 + 1).saturating_sub(m);
    if short_clips == ShortClips::Held && m > 0 && missing > 0 {
        let frame = |held: usize| held.saturating_sub(missing / 2).min(m - 1);
        let held = Array2::from_shape_fn((n, m + missing), |(i, j)| costs[[i, frame(j)]]);
        let whole = respond(held.view(), ShortClips::Unmatched)?;
        let mut curve = vec![None; m];
        curve[m - 1] = whole.best();
        return Ok(Response::of_curve(&curve, |_| Some(0)));
    }
    let stream = Aligned::new(costs)?;
    Ok(Response::of_curve(&stream.curve, |last| stream.start(last)))
}

/// How clips answer an example as one stream, by the local costs of each.
fn respond_joined(costs: &[Array2<f64>]) -> Result<Vec<Response>, DtwError> {
    let views: Vec<ArrayView2<'_, f64>> = costs.iter().map(|costs| costs.view()).collect();
    let Ok(joined) = concatenate(Axis(1), &views) else {
        return Ok(Vec::new());
    };
    let stream = Aligned::new(joined.view())?;
    let lengths = costs.iter().map(|costs| costs.ncols());
    Ok(Response::divided(
        &stream.curve,
        |last| stream.start(last),
        lengths,
    ))
}

/// An example aligned with stretches of a clip.
struct Aligned<'a> {
    costs: ArrayView2<'a, f64>,
    dtw: Dtw,
    /// The least cost of a stretch that ends with each frame.
    curve: Vec<Option<f64>>,
}

impl<'a> Aligned<'a> {
    fn new(costs: ArrayView2<'a, f64>) -> Result<Self, DtwError> {
        let (n, m) = costs.dim();
        let dtw = Dtw::default().with_steps(StepPattern::slope_limited([1.0, 1.0, 2.0])?);
        let open = dtw.clone().with_ends(Ends::Open);
        let curve = open.end_costs_with(n, m, |i, j| costs[[i, j]])?;
        let mean = |cost: Option<f64>| cost.map(|cost| cost / n as f64);
        Ok(Self {
            costs,
            dtw: dtw.with_ends(Ends::OpenBegin),
            curve: curve.into_iter().map(mean).collect(),
        })
    }

    /// Where the cheapest stretch begins that ends with frame `last`.
    fn start(&self, last: usize) -> Option<usize> {
        // A hit is at most twice as long as the example.
        let from = (last + 1).saturating_sub(2 * self.costs.nrows());
        let path = self.dtw.align_of(self.costs.slice(s![.., from..=last]));
        let (_, first) = *path.ok()??.steps.first()?;
        Some(from + first)
    }
}

#[cfg(test)]
mod tests;
