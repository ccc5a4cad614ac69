//! The definitions, frame by frame and pair by pair.

use std::ops::Range;

use bundles::ndarray::{Array1, Array2};

/// Label, clip and frames of each run, by looking at one frame after the other.
pub(crate) fn spell(labels: &[u32], clips: &[Range<usize>]) -> Vec<(u32, usize, Vec<usize>)> {
    let mut runs: Vec<(u32, usize, Vec<usize>)> = Vec::new();
    for (frame, &label) in labels.iter().enumerate() {
        let Some(clip) = clips.iter().position(|clip| clip.contains(&frame)) else {
            continue;
        };
        match runs.last_mut() {
            Some(run) if run.0 == label && run.1 == clip => run.2.push(frame),
            _ => runs.push((label, clip, vec![frame])),
        }
    }
    runs
}

pub(crate) fn mean(frames: &[usize]) -> f64 {
    frames.iter().sum::<usize>() as f64 / frames.len() as f64
}

/// d(a, b) as the larger of both Mahalanobis distances.
pub(crate) fn distance(means: &Array2<f64>, sigmas: &Array1<f64>, a: usize, b: usize) -> f64 {
    let mut squares = 0.0;
    for dim in 0..means.ncols() {
        squares += (means[[b, dim]] - means[[a, dim]]).powi(2);
    }
    f64::max(squares.sqrt() / sigmas[a], squares.sqrt() / sigmas[b])
}

/// The median of the distances of all neighbours within a clip, by sorting.
pub(crate) fn threshold(
    runs: &[(u32, usize, Vec<usize>)],
    means: &Array2<f64>,
    sigmas: &Array1<f64>,
) -> Option<f64> {
    let mut distances = Vec::new();
    for j in 1..runs.len() {
        if runs[j].1 == runs[j - 1].1 {
            distances.push(distance(
                means,
                sigmas,
                runs[j - 1].0 as usize,
                runs[j].0 as usize,
            ));
        }
    }
    distances.sort_by(f64::total_cmp);
    match distances.len() {
        0 => None,
        n if n % 2 == 1 => Some(distances[n / 2]),
        n => Some(distances[n / 2 - 1] / 2.0 + distances[n / 2] / 2.0),
    }
}
