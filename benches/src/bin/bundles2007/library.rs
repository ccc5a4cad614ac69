//! As many frames of real motion as are asked for: all takes, then their mirror images.

use std::ops::Range;
use std::path::Path;

use anyhow::{Context, Result, ensure};
use cli::bundling::{layout, pose_vectors};
use cli::output::Voice;
use cli::recording::{Files, ReadOptions, parse};
use cli::source::{ClipRef, find_clips};
use mocap_io::{Motion, mirror_pairs};
use ndarray::{Array2, ArrayView2, Axis, concatenate, s};

/// Motions in the order of their paths, `cmu` first, then of the same paths mirrored, of one skeleton and
/// rate, until there are `n_frames`; and how many takes have another skeleton, rate, or cannot be read.
pub(crate) fn motions(data: &Path, n_frames: usize) -> Result<(Vec<Motion>, usize)> {
    let clips = find_clips(&["cmu", "hdm05"].map(|folder| data.join(folder)))?;
    let options = ReadOptions::default();
    let (mut motions, mut n_read, mut n_refused): (Vec<Motion>, usize, usize) = (Vec::new(), 0, 0);
    // A few at a time, so that small sizes do not read everything.
    for some in clips.chunks(16) {
        let (read, skipped) = Voice::default().batch(some, "reading", |clip: &ClipRef| {
            let files = Files::read(&clip.path, &options)?;
            parse(&clip.path, files, &options)
        });
        n_refused += skipped.len();
        for (_, loaded) in read {
            let motion = loaded.recording.motion().cloned();
            let is_like = |first: &Motion, motion: &Motion| {
                layout(first) == layout(motion) && first.rate.hz() == motion.rate.hz()
            };
            match motion.filter(|motion| motions.first().is_none_or(|f| is_like(f, motion))) {
                Some(motion) => {
                    n_read += motion.n_frames();
                    motions.push(motion);
                }
                None => n_refused += 1,
            }
        }
        if n_read >= n_frames {
            break;
        }
    }
    let mut mirrored = Vec::new();
    for motion in &motions {
        if n_read >= n_frames {
            break;
        }
        let mirror = motion.mirror(&mirror_pairs(&motion.skeleton))?;
        n_read += mirror.n_frames();
        mirrored.push(mirror);
    }
    motions.append(&mut mirrored);
    ensure!(
        n_read >= n_frames,
        "expected {n_frames} frames, found {n_read}"
    );
    Ok((motions, n_refused))
}

/// Pose vectors of the first `n_frames` frames, and the frames of each clip.
pub(crate) fn vectors(
    motions: &[Motion],
    n_frames: usize,
) -> Result<(Array2<f64>, Vec<Range<usize>>)> {
    let (mut parts, mut ranges, mut end) = (Vec::new(), Vec::new(), 0);
    for motion in motions {
        let n = motion.n_frames().min(n_frames - end);
        if n == 0 {
            continue;
        }
        let all = pose_vectors(motion)?;
        parts.push(all.slice(s![..n, ..]).to_owned());
        ranges.push(end..end + n);
        end += n;
    }
    let views: Vec<ArrayView2<'_, f64>> = parts.iter().map(|part| part.view()).collect();
    let vectors = concatenate(Axis(0), &views).context("motions of one skeleton")?;
    Ok((vectors, ranges))
}
